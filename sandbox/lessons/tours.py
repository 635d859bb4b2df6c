"""The guided tours that the program brings along: a lesson of a few steps for every scene."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from sandbox.lessons.lesson import Lesson, Step
from sandbox.lessons.reading import SUFFIX, read_lesson
from scenes import registry

FOLDER = Path(__file__).parent / "built_in" / "tours"


@cache
def scenes() -> tuple[str, ...]:
    """Names of the scenes that have a tour."""
    there = {path.stem for path in FOLDER.glob(f"*{SUFFIX}")}
    return tuple(name for name in registry.names() if name in there)


@cache
def tour(scene: str) -> Lesson | None:
    """The tour of a scene; None if it has none."""
    return read_lesson(FOLDER / f"{scene}{SUFFIX}") if scene in scenes() else None


def is_tour(lesson: Lesson) -> bool:
    """Is that the tour of its scene, and no lesson?"""
    return lesson is tour(lesson.scene)


def steps(scene: str) -> tuple[Step, ...]:
    """Its steps; nothing if it has none."""
    found = tour(scene)
    return () if found is None else found.steps

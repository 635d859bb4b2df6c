"""Lessons and tours that were put aside, to be gone on with at the very step."""

from __future__ import annotations

from dataclasses import dataclass

from sandbox.lessons import tours
from sandbox.lessons.answers import Given
from sandbox.lessons.lesson import Lesson
from sandbox.lessons.moments import Moment
from sandbox.window.asking import Open
from sandbox.window.stage import Stage


@dataclass(frozen=True, slots=True)
class Aside:
    """Where somebody was in a lesson, what was answered, and what there was then."""

    lesson: Lesson
    index: int
    done: bool
    told: bool
    given: Given | None
    question: Open
    then: Moment | None
    view: str
    runs: object  # what ran; where that is gone, the step's scene begins anew

    @property
    def tour(self) -> bool:
        """Is it a tour, and no lesson?"""
        return tours.is_tour(self.lesson)


class Shelf:
    """One place for each lesson, the latest last."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self._asides: dict[tuple[bool, str], Aside] = {}
        self._begun = 0  # how often something else has begun to run
        stage.at_new_scene(self._something_begins)

    def put(self, aside: Aside) -> None:
        """Keep it as the latest."""
        self.forget(aside.lesson)
        self._asides[aside.tour, aside.lesson.name] = aside

    def forget(self, lesson: Lesson) -> None:
        """It begins anew, or is gone on with."""
        self._asides.pop((tours.is_tour(lesson), lesson.name), None)

    @property
    def latest(self) -> Aside | None:
        """A lesson, whatever runs now, or the tour of the scene that does; None if there is none."""
        scene, asides = self.stage.panes.scene, reversed(self._asides.values())
        return next((one for one in asides if not one.tour or one.lesson.scene == scene), None)

    @property
    def runs(self) -> object:
        """Tells what runs from what ran before."""
        panes = self.stage.panes
        return self._begun, panes.packings, panes.seed

    def _something_begins(self) -> None:
        self._begun += 1

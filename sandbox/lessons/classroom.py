"""The lessons that the program brings along, and those in a folder."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from core.errors import InputError, did_you_mean
from sandbox.lessons.lesson import Lesson
from sandbox.lessons.reading import SUFFIX, is_lesson, read_lesson

FOLDER = Path(__file__).parent / "built_in" / "lessons"
MOST_SHOWN, MOST_LOOKED_AT = 24, 200  # files of a folder


@cache
def names() -> tuple[str, ...]:
    """Of the lessons that the program brings along, in the order in which they build on each other."""
    return tuple(sorted((path.stem for path in FOLDER.glob(f"*{SUFFIX}")), key=_place))


def _place(name: str) -> tuple[int, str]:
    order = ("poisson", "mixture", "arches", "yield", "friction", "residual")
    return order.index(name) if name in order else len(order), name


@cache
def lesson(name: str) -> Lesson:
    """One of them."""
    return read_lesson(path_of(name))


def named(name: str) -> Lesson:
    """One of them by its name, or that of a file. Raises InputError for what is neither, or is malformed."""
    if name in names():
        return lesson(name)
    if not Path(name).suffix and not Path(name).exists():
        raise InputError(
            f"no lesson {name!r}{did_you_mean(name, names())}; there are: {', '.join(names())}"
        )
    return read_lesson(name)


def path_of(name: str) -> Path:
    """Where one of them is written."""
    return FOLDER / f"{name}{SUFFIX}"


@dataclass(frozen=True, slots=True)
class LessonHere:
    """A lesson in a folder: where it is, and what it says; None where it is malformed."""

    path: Path
    lesson: Lesson | None


def lessons_here(folder: Path) -> tuple[LessonHere, ...]:
    """The lessons of a folder by name; what does not say that it is one is left out."""
    try:
        paths = sorted(folder.glob(f"*{SUFFIX}"))[:MOST_LOOKED_AT]
    except OSError:
        return ()
    return tuple(LessonHere(path, _read(path)) for path in paths if is_lesson(path))[:MOST_SHOWN]


def _read(path: Path) -> Lesson | None:
    try:
        return read_lesson(path)
    except InputError:
        return None

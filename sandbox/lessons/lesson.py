"""What a lesson is: steps that set something up, ask, wait until it is done, and explain; with what is to be printed.

A guided tour is a lesson of a few steps. All of it is data, read from a file (``sandbox.lessons.reading``); nothing in it is run.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from sandbox.words import language
from scenes.parameter import Value

# What a lesson can keep out of sight besides the parameters of its scenes: sections of the panel, and what there is to do.
SECTIONS = ("hand", "grains", "geometry", "solver", "curves", "files", "looks")
DEEDS = (
    "packing",
    "seed",
    "view",
    "chains",
    "compare",
    "drive",
    "brush",
    "explore",
    "record",
    "export",
    "measure",
)

ROUNDING = 1e-9  # of a number: what nobody has typed
# Which way a handle is to go: on the screen, or towards the middle of what there is and away from it.
WAYS = ("left", "right", "up", "down", "inwards", "outwards")

Kind = Literal["choice", "number", "sketch"]


@dataclass(frozen=True, slots=True)
class Said:
    """A text in some languages, by their codes; English is always there, unless there is no text at all."""

    by_language: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        """In the present language, or else in English."""
        return self.by_language.get(language.present(), self.by_language.get(language.SOURCE, ""))

    def __bool__(self) -> bool:
        return bool(self.by_language)


@dataclass(frozen=True, slots=True)
class Condition:
    """What a person is asked to do; exactly one of these is set, ``by``, ``way``, ``or_event`` and ``below`` apart."""

    moved: str = ""  # a handle, from where it was
    by: float = 0.0  # at least so far [R]
    way: str = ""  # in that one of ``WAYS``; none: whichever way
    event: str = ""  # a kind of event since then
    or_event: str = ""  # or another kind
    view: str = ""  # another way to look at the grains
    setting: str = ""  # a parameter has another value than before
    below: float = math.inf  # or one that is at most so large
    out: int = 0  # so many more grains have left
    force: float = 0.0  # what is plotted has come to so much
    grains: int = 0  # so many grains have been placed or erased
    walls: int = 0  # so many walls have been drawn
    increments: int = 0  # so many more increments have been made


@dataclass(frozen=True, slots=True)
class Predict:
    """A question to be answered before anything is measured; ``answer`` is shown after."""

    kind: Kind
    ask: Said
    options: tuple[Said, ...] = ()  # of a choice
    right: float | None = (
        None  # the option, counted from 0, or the number; None: there is no wrong one
    )
    within: float = 0.0  # a number is right that is no further off
    unit: str = ""  # of the number
    axes: tuple[float, float, float, float] = (
        0.0,
        1.0,
        0.0,
        1.0,
    )  # of a sketch: along low, high; up low, high
    answer: Said = Said()
    names: tuple[Said, Said] = (Said(), Said())  # of the axes, along and up, for paper

    def is_right(self, given: float) -> bool | None:
        """Is that the right option or number? None where nothing is."""
        if self.right is None:
            return None
        off, most = abs(given - self.right), self.within if self.kind == "number" else 0.0
        return off <= most or math.isclose(off, most, abs_tol=ROUNDING * abs(self.right))


@dataclass(frozen=True, slots=True)
class Step:
    """One step. Without packings the scene goes on as it is."""

    key: str
    say: Said = Said()
    do: Said = Said()  # what a person is asked to do
    why: Said = Said()  # shown once it is done
    scene: str = ""  # where packings begin it: another than the lesson's
    packings: tuple[str, ...] = ()  # begins the scene anew, side by side if there are several
    settings: Mapping[str, Value] = field(default_factory=dict)
    view: str = ""
    until: Condition | None = None
    predict: Predict | None = None
    hide: frozenset[str] = frozenset()  # controls, in this step alone
    minutes: int = 0  # that it takes; 0: not said


@dataclass(frozen=True, slots=True)
class Task:
    """Something for the worksheet alone, with so many lines to write on."""

    text: Said
    answer: Said
    lines: int = 4


@dataclass(frozen=True, slots=True)
class Lesson:
    """A lesson, or a guided tour of a scene."""

    name: str  # of its file, without folder and suffix
    scene: str
    steps: tuple[Step, ...]
    title: Said = Said()  # none: that of the scene
    about: Said = Said()  # a sentence for the menu
    minutes: int = 0
    seed: int | None = None  # None: that of the scene before
    aims: tuple[Said, ...] = ()
    prior: tuple[Said, ...] = ()  # what is known before
    tasks: tuple[Task, ...] = ()
    hide: frozenset[str] = frozenset()  # controls, in all steps

    def scene_of(self, index: int) -> str:
        """The scene that runs in a step."""
        begun = (step for step in reversed(self.steps[: index + 1]) if step.packings)
        return next((step.scene or self.scene for step in begun), self.scene)

    def texts(self) -> Iterator[tuple[str, Said]]:
        """Every text and where it stands."""
        yield "title", self.title
        yield "about", self.about
        yield from ((f"aims {n}", said) for n, said in enumerate(self.aims, 1))
        yield from ((f"prior {n}", said) for n, said in enumerate(self.prior, 1))
        for step in self.steps:
            yield from (
                (f"{step.key} {part}", getattr(step, part)) for part in ("say", "do", "why")
            )
            if step.predict is not None:
                yield f"{step.key} ask", step.predict.ask
                yield f"{step.key} answer", step.predict.answer
                yield from (
                    (f"{step.key} axis {n}", name) for n, name in enumerate(step.predict.names, 1)
                )
                yield from (
                    (f"{step.key} option {n}", o) for n, o in enumerate(step.predict.options, 1)
                )
        for number, task in enumerate(self.tasks, 1):
            yield f"task {number}", task.text
            yield f"task {number} answer", task.answer

"""What was predicted and answered in lessons, as a table without personal data: no names, and of the time the day alone.

A row is added as soon as it is given, whole, also where several write to one file. Cells are numbers and keys, never texts of a
lesson.
"""

from __future__ import annotations

import datetime
import re
import secrets
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from core.arrays import Floats
from core.errors import InputError, reason_of
from sandbox.files import cells
from sandbox.files.lines import append_lines
from sandbox.lessons.lesson import Lesson, Predict, Step
from sandbox.session.frame import Frame

COLUMNS = (
    "date",
    "sitting",
    "lesson",
    "step",
    "what",
    "packing",
    "kind",
    "given",
    "unit",
    "right",
    "when",
)
PREDICTED, NO_GUESS, MEASURED = "predicted", "no guess", "measured"
BEFORE, AFTER = "before", "after"  # the answer was shown in this sitting
VERDICTS = {True: "yes", False: "no", None: ""}
_ODD = re.compile(r"[^0-9A-Za-z_.-]")

Given = float | tuple[Floats, Floats]  # an option from 0, a number, or a sketched curve: along, up


class Answers:
    """The answers of one sitting: of whoever sits at this window until it is closed."""

    def __init__(self, path: Path | None = None) -> None:
        """``path``: the table that grows; None: none is kept. Raises InputError for a file that is another table."""
        self.path = path
        self.trouble = ""  # why the table cannot be written at the moment
        self._sitting = secrets.token_hex(
            3
        )  # tells rows of one sitting from others, and nothing else
        self._waiting: list[Sequence[str]] = []
        self._shown: set[tuple[str, str]] = set()  # lessons and steps whose answer was shown
        self._check()

    def predicted(self, lesson: Lesson, step: Step, given: Given | None) -> None:
        """A prediction, or an answer where nothing is measured; None: somebody went on without one."""
        predict = step.predict
        assert predict is not None
        when = AFTER if (lesson.name, step.key) in self._shown else BEFORE
        if given is None:
            self._add(lesson, step, NO_GUESS, when=when)
            return
        right = VERDICTS[predict.is_right(given) if isinstance(given, float) else None]
        self._add(lesson, step, PREDICTED, given=_cell(predict, given), right=right, when=when)

    def shown(self, lesson: Lesson, step: Step) -> None:
        """Whoever sits here has seen what comes out in a step: another prediction is none."""
        self._shown.add((lesson.name, step.key))

    def measured(self, lesson: Lesson, step: Step, given: Given, frames: Sequence[Frame]) -> None:
        """What the curves came to where one was sketched, a row a packing; nothing for other predictions."""
        if isinstance(given, float):
            return
        for frame in frames:
            curve = at_columns(frame.curve_stroke, frame.curve_force, given[0])
            points = _points(given[0], curve)
            self._add(lesson, step, MEASURED, packing=frame.packing, given=points)

    def _add(
        self,
        lesson: Lesson,
        step: Step,
        what: str,
        *,
        packing: str = "",
        given: str = "",
        right: str = "",
        when: str = "",
    ) -> None:
        if self.path is None:
            return
        assert step.predict is not None
        day = datetime.date.today().isoformat()
        name = _ODD.sub("_", lesson.name).lstrip("-.") or "lesson"
        kind, unit = step.predict.kind, _ODD.sub(" ", step.predict.unit).strip().lstrip("-.")
        self._waiting.append(
            (day, self._sitting, name, step.key, what, packing, kind, given, unit, right, when)
        )
        self.write()

    def write(self) -> None:
        """Add what waits; what cannot be written waits on, and ``trouble`` says why."""
        if self.path is None or not self._waiting:
            return
        try:
            self._check()
            rows: list[Sequence[str]] = [] if self._started() else [COLUMNS]
            append_lines(self.path, cells.lines([*rows, *self._waiting]))
        except InputError as error:
            self.trouble = str(error)
        except OSError as error:
            self.trouble = f"cannot write {self.path}: {reason_of(error)}"
        else:
            self._waiting.clear()
            self.trouble = ""

    def _started(self) -> bool:
        return self.path is not None and self.path.exists() and self.path.stat().st_size > 0

    def _check(self) -> None:
        if not self._started():
            return
        assert self.path is not None
        with self.path.open("rb") as file:
            first = file.readline(1000)
        if first.strip() != ",".join(COLUMNS).encode():
            raise InputError(
                f"{self.path}: this is no table of answers, or one of an older program; give another name"
            )


def at_columns(stroke: Floats, force: Floats, along: Floats) -> Floats:
    """A measured curve at places along the axis, where it was first there; nan where it has not come to."""
    count = min(stroke.size, force.size)
    sound = np.isfinite(stroke[:count]) & np.isfinite(force[:count])
    x, y = stroke[:count][sound], force[:count][sound]
    if x.size < 2:
        return np.full(along.size, np.nan)
    reached = np.maximum.accumulate(x)
    first = np.concatenate(([True], reached[1:] > reached[:-1]))
    values: Floats = np.interp(along, reached[first], y[first])
    return np.where((along >= x[0]) & (along <= reached[-1]), values, np.nan)


def mean_distance(stroke: Floats, force: Floats, along: Floats, up: Floats) -> float:
    """How far a measured curve lies from a sketched one, up or down, in the mean over where both are; nan if that is nowhere."""
    away = np.abs(at_columns(stroke, force, along) - up)
    both = np.isfinite(away)
    return float(away[both].mean()) if both.any() else float("nan")


def _cell(predict: Predict, given: Given) -> str:
    if not isinstance(given, float):
        return _points(*given)
    return str(round(given) + 1) if predict.kind == "choice" else f"{given:.6g}"


def _points(along: Floats, up: Floats) -> str:
    """``x:y`` by ``x:y``, as far as there are values."""
    return " ".join(f"{x:.4g}:{y:.4g}" for x, y in zip(along, up, strict=True) if np.isfinite(y))

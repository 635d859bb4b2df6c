"""A claim of the paper, the runs that it takes to measure it, and what was found."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Floats
from sandbox.studies.paper.runs import Request, Result

SURE = 2.0  # standard errors that a difference must exceed to be counted as one


@dataclass(frozen=True)
class Measured:
    """A quantity, one value a seed."""

    what: str
    unit: str
    values: tuple[float, ...]

    @classmethod
    def of(cls, what: str, unit: str, values: ArrayLike) -> Measured:
        """From anything that is a row of numbers."""
        row = np.atleast_1d(np.asarray(values, dtype=np.float64))
        return cls(what, unit, tuple(map(float, row)))

    @property
    def mean(self) -> float:
        """Mean over seeds."""
        return float(np.mean(self.values))

    @property
    def spread(self) -> float | None:
        """Standard deviation over seeds, or None of a single one."""
        return float(np.std(self.values, ddof=1)) if len(self.values) > 1 else None

    @property
    def error(self) -> float:
        """Standard error of the mean; 0 of a single value, which is then no matter of chance."""
        return (self.spread or 0.0) / math.sqrt(len(self.values))

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        if self.spread is None:
            return f"{self.what} {number(self.mean)}{unit}"
        return f"{self.what} {number(self.mean)} ± {number(self.spread, 2)}{unit}"


@dataclass(frozen=True)
class Finding:
    """What was measured, and whether the claim holds. ``holds`` is None where it could not be measured."""

    holds: bool | None
    decided_by: str  # the number that decides, and what it had to be
    measured: tuple[Measured, ...] = ()
    remark: str = ""  # what else a reader should know: above all why a claim fails

    @property
    def verdict(self) -> str:
        """In words."""
        words = {True: "holds", False: "does not hold", None: "not measured"}
        return words[self.holds]


@dataclass(frozen=True)
class Line:
    """A row of points of a figure. ``kind`` chooses the colour: regular, auxetic, mixed, or other."""

    label: str
    kind: str
    x: Floats
    y: Floats
    spread: Floats | None = None  # of y: error bars
    points: bool = False  # marks instead of a line
    dashed: bool = False


@dataclass(frozen=True)
class Panel:
    """One pair of axes."""

    title: str
    x_label: str  # with its unit
    y_label: str
    lines: tuple[Line, ...]
    log_x: bool = False
    log_y: bool = False


@dataclass(frozen=True)
class Figure:
    """One figure of the paper, measured again."""

    file: str  # without the suffix
    title: str
    panels: Callable[[Sequence[Result]], Sequence[Panel]]


@dataclass(frozen=True)
class Claim:
    """What the paper says, and how it is put to the test. ``runs`` is asked whether to be quick."""

    name: str
    source: str  # the paper's figure or appendix
    words: str  # the paper's
    runs: Callable[[bool], Sequence[Request]]
    judge: Callable[[Sequence[Result]], Finding]
    figures: tuple[Figure, ...] = field(default=())
    bears_short_runs: bool = False  # ``judge`` knows what to do with runs that ended early

    def find(self, results: Sequence[Result]) -> Finding:
        """Judge, unless a run has failed or ended early. ``results`` are those of ``runs``, in any order."""
        failed = [
            result
            for result in results
            if result.failure is not None or (result.ended and not self.bears_short_runs)
        ]
        if failed:
            first = failed[0].request
            which = f"{first.scene}, {first.packing}, seed {first.seed}"
            return Finding(
                None,
                f"{len(failed)} of {len(results)} runs failed, the first ({which}): {failed[0].trouble}",
            )
        try:
            return self.judge(results)
        except Unmeasurable as why:
            return Finding(None, str(why))


class Unmeasurable(Exception):
    """The runs went well and yet do not say what is asked."""


# Arithmetic that claims share.


def over_seeds(results: Sequence[Result], value: Callable[[Result], float]) -> Floats:
    """A number of each run (S,), in the order of seeds."""
    ordered = sorted(results, key=lambda result: result.request.seed)
    return np.array([value(result) for result in ordered], dtype=np.float64)


def of_kind(results: Sequence[Result], kind: str) -> list[Result]:
    """The runs of one kind of packing."""
    return [result for result in results if result.request.packing == kind]


def where(results: Sequence[Result], name: str, value: object) -> list[Result]:
    """The runs with that value of a setting that they name."""
    return [r for r in results if dict(r.request.settings).get(name) == value]


def ratio(above: Measured, below: Measured) -> tuple[float, float]:
    """Ratio of two means, and its standard error by propagation."""
    if below.mean == 0.0:
        raise Unmeasurable(f"{below.what} is 0: no ratio can be taken")
    value = above.mean / below.mean
    relative = [
        measured.error / measured.mean if measured.mean else 0.0 for measured in (above, below)
    ]
    return value, abs(value) * math.hypot(*relative)


def surely_above(value: float, error: float, bound: float) -> bool:
    """Whether ``value`` exceeds ``bound`` by more than chance."""
    return value - SURE * error > bound


def cross(x: Floats, y: Floats, at: float) -> float:
    """y where x first reaches ``at``, between two points of a curve (M,) each. Raises Unmeasurable beyond its end."""
    reached = np.flatnonzero(x >= at)
    if not len(reached):
        raise Unmeasurable(f"a run ended at {number(float(x.max()))}, before {number(at)}")
    k = int(reached[0])
    if k == 0:
        return float(y[0])
    share = (at - x[k - 1]) / (x[k] - x[k - 1])
    return float(y[k - 1] + share * (y[k] - y[k - 1]))


def number(value: float, digits: int = 3) -> str:
    """A number for people: few digits, a true minus sign."""
    if not math.isfinite(value):
        return "no number"
    text = f"{value:.{digits}g}"
    if "e" in text and 1e-4 <= abs(value) < 1e5:
        text = f"{value:.0f}"
    if "e" in text:
        mantissa, power = text.split("e")
        text = f"{mantissa}e{int(power)}"
    return text.replace("-", "−")

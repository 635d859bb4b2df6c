"""A sentence of the paper, taken apart into what it asserts; the runs that it takes to measure that, and what was found."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Floats
from sandbox.ensemble.estimates import Estimate, Exact, Ratio, Student
from sandbox.studies.common.verdicts import FAILS, HOLDS, OPEN, Demand, pair, verdicts
from sandbox.studies.paper.runs import Request, Result

NOT_MEASURED = "not measured"
VERDICTS = (HOLDS, FAILS, OPEN, NOT_MEASURED)
# What a part of a sentence can be about.
ASPECTS = ("direction", "factor", "trend", "collapse", "share", "value")


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

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        if self.spread is None:
            return f"{self.what} {number(self.mean)}{unit}"
        return f"{self.what} {number(self.mean)} ± {number(self.spread, 2)}{unit}"


@dataclass(frozen=True)
class Threshold:
    """What a quantity must be, and why just that. Written down before the seeds that judge were run."""

    demand: Demand
    reason: str

    def __str__(self) -> str:
        low, high = self.demand.low, self.demand.high
        if math.isfinite(low) and math.isfinite(high):
            return f"between {number(low)} and {number(high)}"
        return f"above {number(low)}" if math.isfinite(low) else f"below {number(high)}"


# Thresholds that many parts share.
MORE = Threshold(Demand(1.0), "a direction: the words say more, not how much")
LESS = Threshold(Demand(high=1.0), "a direction: the words say less, not how much")
MUCH = Threshold(Demand(2.0), "“much” is read as a factor of two at least")
TWICE = Threshold(
    Demand(1.5, 2.0 / 0.75),
    "“twice” is read as two within a factor of 4/3: beyond that one would say half as much again, or three times",
)
SAME = Threshold(
    Demand(0.75, 1.0 / 0.75),
    "“collapse”, “almost the same” are read as 1 within a factor of 4/3: hardly seen in the paper's plots, and less than the "
    "least factor that it calls a difference",
)
RISES = Threshold(Demand(0.0), "a direction: it is there, or not")
FALLS = Threshold(Demand(high=0.0), "a direction: it is there, or not")
SUBLINEAR = Threshold(Demand(high=1.0), "the exponent of a straight line is 1")


@dataclass(frozen=True)
class Reading:
    """What runs say about a quantity."""

    estimate: Estimate
    measured: tuple[Measured, ...] = ()
    remark: str = ""


Measure = Callable[[Sequence[Result]], Reading]


@dataclass(frozen=True)
class Variation:
    """The same quantity under another condition, which the verdict may hang on."""

    condition: str
    measure: Measure


@dataclass(frozen=True)
class Part:
    """One thing that a sentence asserts."""

    aspect: str  # one of ``ASPECTS``
    says: str  # in plain words
    quantity: str  # that decides
    threshold: Threshold
    measure: Measure
    variations: tuple[Variation, ...] = ()


@dataclass(frozen=True)
class Varied:
    """What a variation came to."""

    condition: str
    reading: Reading | None
    why: str = ""  # there is none

    def contradicts(self, demand: Demand) -> bool:
        """Whether its 95 % interval lies wholly where the statement does not hold."""
        if self.reading is None:
            return False
        low, high = self.reading.estimate.interval()
        return high <= demand.low or low >= demand.high


@dataclass(frozen=True)
class Finding:
    """What was found about a part. ``p`` is corrected for the number of verdicts once ``settle`` has seen all of them."""

    part: Part
    reading: Reading | None
    verdict: str
    p: float | None = None
    why: str = ""  # it was not measured, or not established
    varied: tuple[Varied, ...] = ()

    @property
    def decided_by(self) -> str:
        """The number that decides, with its interval, and what it had to be."""
        if self.reading is None:
            return self.why
        what = f"{self.part.quantity}: {with_interval(self.reading.estimate)}, must be {self.part.threshold}"
        return f"{what}; {self.why}" if self.why else what


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
    """A sentence of the paper, and how it is put to the test. ``runs`` is asked whether to be quick."""

    name: str
    source: str  # the paper's figure or appendix
    words: str  # the paper's
    runs: Callable[[bool], Sequence[Request]]
    parts: tuple[Part, ...]
    figures: tuple[Figure, ...] = field(default=())
    bears_short_runs: bool = False  # it knows what to do with runs that ended early

    def find(self, results: Sequence[Result]) -> list[Finding]:
        """Measure each part, unless a run has failed or ended early. ``results`` are those of ``runs``, in its order.

        Verdicts are open until ``settle`` has seen those of the whole study.
        """
        failed = [
            result
            for result in results
            if result.failure is not None or (result.ended and not self.bears_short_runs)
        ]
        if failed:
            first = failed[0].request
            which = f"{first.scene}, {first.packing}, seed {first.seed}"
            why = f"{len(failed)} of {len(results)} runs failed, the first ({which}): {failed[0].trouble}"
            return [Finding(part, None, NOT_MEASURED, why=why) for part in self.parts]
        return [_measured(part, results) for part in self.parts]


class Unmeasurable(Exception):
    """The runs went well and yet do not say what is asked."""


def _measured(part: Part, results: Sequence[Result]) -> Finding:
    varied = []
    for variation in part.variations:
        try:
            varied.append(Varied(variation.condition, variation.measure(results)))
        except Unmeasurable as why:
            varied.append(Varied(variation.condition, None, str(why)))
    try:
        return Finding(part, part.measure(results), OPEN, varied=tuple(varied))
    except Unmeasurable as reason:
        return Finding(part, None, NOT_MEASURED, why=str(reason), varied=tuple(varied))


def settle(findings: Sequence[Finding]) -> list[Finding]:
    """Verdicts of all parts of a study together: wrong in any of them at most once in twenty studies (Holm).

    What a variation contradicts hangs on it, and is not established, whatever the p-value.
    """
    known = [(f.reading.estimate, f.part.threshold.demand) for f in findings if f.reading]
    decided = iter(verdicts(known))
    settled = []
    for finding in findings:
        if finding.reading is None:
            settled.append(finding)
            continue
        verdict, p = next(decided)
        why = ""
        against = [v for v in finding.varied if v.contradicts(finding.part.threshold.demand)]
        if verdict == HOLDS and against:
            verdict, why = OPEN, f"with {against[0].condition} it is otherwise"
        settled.append(Finding(finding.part, finding.reading, verdict, p, why, finding.varied))
    return settled


# Arithmetic that claims share.


def over_seeds(results: Sequence[Result], value: Callable[[Result], float]) -> Floats:
    """A number of each run (S,), in the order of seeds."""
    return np.array([v for _, v in by_seed(results, value)], dtype=np.float64)


def by_seed(results: Sequence[Result], value: Callable[[Result], float]) -> list[tuple[int, float]]:
    """(seed, number) of each run, in the order of seeds."""
    ordered = sorted(results, key=lambda result: result.request.seed)
    return [(result.request.seed, value(result)) for result in ordered]


def of_kind(results: Sequence[Result], kind: str) -> list[Result]:
    """The runs of one kind of packing."""
    return [result for result in results if result.request.packing == kind]


def where(results: Sequence[Result], **settings: object) -> list[Result]:
    """The runs with those values of settings that they name."""
    return [
        r
        for r in results
        if all(dict(r.request.settings).get(name) == value for name, value in settings.items())
    ]


def ratio(
    above: Measured,
    below: Measured,
    rows: tuple[Sequence[tuple[int, float]], ...],
    remark: str = "",
) -> Reading:
    """Ratio of two means, seed by seed: one seed gives both kinds the same sizes in the same places."""
    one, other = pair(*rows)
    if not len(one):
        raise Unmeasurable(f"no seed has both {above.what} and {below.what}")
    if not float(np.mean(other)) > 0.0:
        raise Unmeasurable(f"{below.what} is not above 0: no ratio can be taken")
    return Reading(Ratio.of(one, other), (above, below), remark)


def mean_of(measured: Measured, remark: str = "") -> Reading:
    """The mean over seeds."""
    return Reading(Student.mean(measured.values), (measured,), remark)


def exactly(value: float, *measured: Measured, remark: str = "") -> Reading:
    """A number that is no matter of chance."""
    return Reading(Exact(value), measured, remark)


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


def with_interval(estimate: Estimate) -> str:
    """Value and 95 % interval, for people."""
    if isinstance(estimate, Exact):
        return number(estimate.value)
    low, high = estimate.interval()
    if not (math.isfinite(low) and math.isfinite(high)):
        return f"{number(estimate.value)} (no interval)"
    return f"{number(estimate.value)} ({number(low)} to {number(high)})"


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

"""A textbook or published case: the runs that measure it, and what must come out, with a tolerance that has a reason."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from sandbox import __version__
from sandbox.ensemble.estimates import Estimate
from sandbox.studies.common.verdicts import Demand, verdicts

DATA_VERSION = 1  # of what a run writes down
FIRST = 101  # seed that judges; protocols were tried on seeds below
Numbers = dict[str, float]
Asking = Callable[[], None]  # is called between increments, and may break the run off


@dataclass(frozen=True)
class Job:
    """One run of a case. Settings are numbers by name; a run that is no matter of chance has seed 0."""

    case: str
    settings: tuple[tuple[str, float], ...] = ()
    seed: int = 0

    def of(self, name: str) -> float:
        """A setting."""
        return dict(self.settings)[name]

    def key(self) -> str:
        """Changes with all that the run depends on."""
        words = json.dumps([asdict(self), DATA_VERSION, __version__])
        return hashlib.sha256(words.encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Row:
    """What a job came to."""

    job: Job
    numbers: Numbers
    seconds: float = 0.0

    def __getitem__(self, name: str) -> float:
        return self.numbers[name]


@dataclass(frozen=True)
class Check:
    """One number of a case: measured, expected, within which tolerance, on which seeds."""

    quantity: str
    estimate: Estimate
    expected: str  # in words or as a closed form, with its number
    demand: Demand
    reason: str  # of the tolerance
    seeds: tuple[int, ...] = ()

    def data(self, verdict: str, p: float) -> dict[str, Any]:
        """For a file of results; ``p`` is corrected for the number of verdicts."""
        return {
            "quantity": self.quantity,
            "value": self.estimate.value,
            "interval": list(self.estimate.interval()),
            "expected": self.expected,
            "low": self.demand.low,
            "high": self.demand.high,
            "reason": self.reason,
            "verdict": verdict,
            "p_holm": p,
        }


@dataclass(frozen=True)
class Case:
    """``jobs`` is asked whether to be quick; ``run`` carries one out; ``judge`` is given all rows in their order."""

    name: str
    title: str
    source: str
    jobs: Callable[[bool], list[Job]]
    run: Callable[[Job, Asking], Numbers]
    judge: Callable[[Sequence[Row]], list[Check]]
    limits: str = ""  # what a quasistatic model cannot say about it


def within(expected: float, tolerance: float) -> Demand:
    """Expected ± tolerance."""
    return Demand(expected - tolerance, expected + tolerance)


def seeds(count: int, quick: bool, quickly: int = 3) -> range:
    """Those that judge."""
    return range(FIRST, FIRST + (quickly if quick else count))


def seeds_of(rows: Sequence[Row]) -> tuple[int, ...]:
    """Of the runs that are a matter of chance."""
    return tuple(sorted({row.job.seed for row in rows} - {0}))


def where(rows: Sequence[Row], **settings: float) -> list[Row]:
    """The rows with those settings, in the order of seeds."""
    found = [row for row in rows if all(row.job.of(n) == v for n, v in settings.items())]
    return sorted(found, key=lambda row: row.job.seed)


def judged(checks: Sequence[Check]) -> list[tuple[str, float]]:
    """(verdict, p-value) of all checks of a study together, corrected for their number."""
    return verdicts([(check.estimate, check.demand) for check in checks])

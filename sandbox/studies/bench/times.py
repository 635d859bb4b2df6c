"""Times on a machine that also does other things: many short runs, taken in turn."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from sandbox.ensemble.clock import clock


@dataclass(frozen=True)
class Times:
    """Repeated measurements of one thing [s]. The least says what the code costs, the median what it cost here and now."""

    seconds: tuple[float, ...]

    @property
    def least(self) -> float:
        """The fastest run [s]."""
        return min(self.seconds)

    @property
    def middle(self) -> float:
        """The median [s]."""
        return float(median(self.seconds))

    def data(self, unit: float) -> dict[str, float]:
        """Least and median in ``unit`` [s], for a report."""
        return {"min": self.least / unit, "median": self.middle / unit}


def in_turn(
    jobs: Mapping[str, Callable[[int], object]],
    *,
    seconds: float,
    run: float = 2e-3,
    clock: Callable[[], float] = clock,
) -> dict[str, Times]:
    """Time ``jobs`` A, B, A, B, … for about ``seconds`` in all; what slows the machine down then slows all of them.

    A job is called with how often it shall do its work; that is chosen so that one call takes about ``run`` [s].
    """
    often: dict[str, int] = {}
    for name, job in jobs.items():
        job(1)
        start = clock()
        job(1)
        often[name] = max(1, round(run / max(clock() - start, 1e-7)))
    found: dict[str, list[float]] = {name: [] for name in jobs}
    end = time.perf_counter() + seconds
    while time.perf_counter() < end or any(len(times) < 3 for times in found.values()):
        for name, job in jobs.items():
            start = clock()
            job(often[name])
            found[name].append((clock() - start) / often[name])
    return {name: Times(tuple(times)) for name, times in found.items()}


def exponent(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Slope of log value over log size by least squares: values ∝ sizes^slope."""
    import numpy as np

    slope, _ = np.polyfit(np.log(sizes), np.log(values), 1)
    return float(slope)

"""Verdicts: when a difference is no chance, asked of many statements at once. Pure arithmetic.

A verdict asks for both sides, so "does not hold" needs as much evidence as "holds", and what has neither is "not established".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.arrays import Floats
from sandbox.ensemble.estimates import CONFIDENCE, Estimate, Exact

LEVEL = 1.0 - CONFIDENCE  # of being wrong in any of the verdicts of a study
HOLDS, FAILS, OPEN = "holds", "does not hold", "not established"


@dataclass(frozen=True)
class Demand:
    """What a value must be for a statement to hold: beyond ``low``, and short of ``high``."""

    low: float = -math.inf
    high: float = math.inf

    def holds(self, value: float) -> bool:
        """Whether a value that is known meets it."""
        return self.low < value < self.high

    def p(self, estimate: Estimate) -> tuple[float, float]:
        """p-values (of the statement being false, of its being true): what is small can be excluded.

        Between two bounds both must be met, two one-sided tests (Schuirmann 1987, doi:10.1007/BF01068419); to miss either is
        enough, which gives two chances to be wrong.
        """
        met, missed = [], []
        if math.isfinite(self.low):
            met.append(estimate.p_above(self.low))
            missed.append(estimate.p_below(self.low))
        if math.isfinite(self.high):
            met.append(estimate.p_below(self.high))
            missed.append(estimate.p_above(self.high))
        return max(met), min(1.0, len(missed) * min(missed))


def holm(p: Sequence[float]) -> list[float]:
    """p-values such that all of those below a level together are wrong no more often than that (Holm 1979, jstor:4615733)."""
    order = sorted(range(len(p)), key=p.__getitem__)
    adjusted, largest = [1.0] * len(p), 0.0
    for rank, k in enumerate(order):
        largest = max(largest, min(1.0, (len(p) - rank) * p[k]))
        adjusted[k] = largest
    return adjusted


def verdicts(
    cases: Sequence[tuple[Estimate, Demand]], level: float = LEVEL
) -> list[tuple[str, float]]:
    """(verdict, p-value after Holm's correction over all of them) of each case.

    Each verdict is two-sided: it may fall either way, so it counts twice the smaller p-value. Exact numbers are no matter of
    chance, and are not counted.
    """
    sides = [demand.p(estimate) for estimate, demand in cases]
    chance = [k for k, (estimate, _) in enumerate(cases) if not isinstance(estimate, Exact)]
    corrected = dict(
        zip(chance, holm([min(1.0, 2.0 * min(sides[k])) for k in chance]), strict=True)
    )
    found = []
    for k, (false, true) in enumerate(sides):
        p = corrected.get(k, min(false, true))
        found.append((OPEN if p >= level else HOLDS if false < true else FAILS, p))
    return found


def pair(
    one: Sequence[tuple[int, float]], other: Sequence[tuple[int, float]]
) -> tuple[Floats, Floats]:
    """Values of (seed, value) for the seeds that both have, in the order of seeds, (S,) each."""
    first, second = dict(one), dict(other)
    seeds = sorted(first.keys() & second.keys())
    return np.array([first[s] for s in seeds]), np.array([second[s] for s in seeds])

"""Sizes of avalanches: how many survive a size, and whether they forget how large they are already. Pure arithmetic.

An avalanche that goes on with the same chance after each grain, and clogs with the hazard q, has P(s) = q (1 − q)^(s − 1). One
that did not end in a clog (the hopper ran empty, the run was broken off) says that it survived that many grains, and no more.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from sandbox.ensemble.estimates import Share, Student

MANY = 1e6  # degrees of freedom of a normal deviate


def survival(sizes: Floats, clogged: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Sizes (K,) at which avalanches (A,) clogged, and the share that grows larger, (K,), by Kaplan and Meier's estimate
    (doi:10.1080/01621459.1958.10501452).
    """
    at = np.unique(sizes[clogged])
    alive = np.array([(sizes >= s).sum() for s in at], dtype=np.float64)
    ended = np.array([(clogged & (sizes == s)).sum() for s in at], dtype=np.float64)
    return at, np.asarray(np.cumprod(1.0 - ended / alive), dtype=np.float64)


def hazard(sizes: Floats, clogged: NDArray[np.bool_]) -> Share | None:
    """Clogs over grains that left: the maximum likelihood estimate of q. None where none left."""
    grains = round(float(sizes.sum()))
    return Share(int(clogged.sum()), grains) if grains else None


def mean_size(sizes: Floats, clogged: NDArray[np.bool_]) -> tuple[float, float, float]:
    """1/q, the mean size of an avalanche that nothing else ends, and its interval; infinite where none clogged."""
    share = hazard(sizes, clogged)
    if share is None:
        return math.nan, math.nan, math.nan
    low, high = share.interval()
    return tuple(1.0 / q if q > 0.0 else math.inf for q in (share.value, high, low))  # type: ignore[return-value]


def memory(sizes: Floats, clogged: NDArray[np.bool_]) -> Student | None:
    """Logarithm of the hazard beyond the mean size over that up to it: 0 for exponentially many, whatever q.

    With the error of a ratio of two shares (Katz et al., doi:10.2307/2530610), each with half a clog more so that none is
    empty. None if no avalanche clogged, or none is larger than the mean.
    """
    whole = hazard(sizes, clogged)
    if whole is None or not whole.hits:
        return None
    split = math.floor(1.0 / whole.value)
    early = int((clogged & (sizes <= split)).sum()), float(np.minimum(sizes, split).sum())
    late = int((clogged & (sizes > split)).sum()), float(np.maximum(sizes - split, 0.0).sum())
    if not late[1]:
        return None
    (a, n), (b, m) = ((clogs + 0.5, grains + 0.5) for clogs, grains in (early, late))
    error = math.sqrt(max(1.0 / b - 1.0 / m, 0.0) + max(1.0 / a - 1.0 / n, 0.0))
    return Student(math.log((b / m) / (a / n)), error, MANY)

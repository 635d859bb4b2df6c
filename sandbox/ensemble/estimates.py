"""What was measured, and how sure that is: intervals of means, ratios, exponents and shares. Pure arithmetic.

Every estimate has a value, an interval at any confidence, and two p-values against a bound: how likely so large (``p_above``) or
so small (``p_below``) a value would come of a true one that is not beyond the bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

CONFIDENCE = 0.95


class Estimate(Protocol):
    """What was measured, and how sure that is."""

    @property
    def value(self) -> float:
        """The measured one."""

    def interval(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """(low, high); infinite where nothing is known."""

    def p_above(self, bound: float) -> float:
        """p-value of the true value being at most ``bound``."""

    def p_below(self, bound: float) -> float:
        """p-value of the true value being at least ``bound``."""


@dataclass(frozen=True)
class Exact:
    """A number that is no matter of chance."""

    value: float

    def interval(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """The number itself."""
        del confidence
        return self.value, self.value

    def p_above(self, bound: float) -> float:
        """0 or 1."""
        return 0.0 if self.value > bound else 1.0

    def p_below(self, bound: float) -> float:
        """0 or 1."""
        return 0.0 if self.value < bound else 1.0


@dataclass(frozen=True)
class Student:
    """A value with a standard error of so many degrees of freedom (Student 1908, doi:10.1093/biomet/6.1.1)."""

    value: float
    error: float
    freedom: float

    @classmethod
    def mean(cls, values: ArrayLike) -> Student:
        """The mean of independent values (S,)."""
        row = np.atleast_1d(np.asarray(values, dtype=np.float64))
        if len(row) < 2:
            return cls(float(row.mean()), math.inf, 0.0)
        return cls(float(row.mean()), float(row.std(ddof=1)) / math.sqrt(len(row)), len(row) - 1.0)

    @classmethod
    def difference(cls, one: ArrayLike, other: ArrayLike) -> Student:
        """Mean of ``one`` less that of ``other``, not paired (Welch 1947, doi:10.1093/biomet/34.1-2.28)."""
        a, b = cls.mean(one), cls.mean(other)
        error = math.hypot(a.error, b.error)
        if not math.isfinite(error):
            return cls(a.value - b.value, math.inf, 0.0)
        parts = a.error**4 / a.freedom + b.error**4 / b.freedom
        freedom = error**4 / parts if parts > 0.0 else a.freedom + b.freedom
        return cls(a.value - b.value, error, freedom)

    @classmethod
    def exponent(cls, x: ArrayLike, y: ArrayLike) -> Student:
        """n in y ∝ xⁿ, by least squares through the logarithms of points (M,), all positive."""
        u, v = (np.log(np.asarray(row, dtype=np.float64)) for row in (x, y))
        u, v = u - u.mean(), v - v.mean()
        slope = float(u @ v / (u @ u))
        if len(u) < 3:
            return cls(slope, math.inf, 0.0)
        left = v - slope * u
        return cls(slope, math.sqrt(float(left @ left) / (len(u) - 2) / float(u @ u)), len(u) - 2.0)

    def interval(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """The t interval."""
        half = _t(confidence, self.freedom) * self.error if math.isfinite(self.error) else math.inf
        return self.value - half, self.value + half

    def p_above(self, bound: float) -> float:
        """One-sided t test."""
        return _tail(self.value - bound, self.error, self.freedom)

    def p_below(self, bound: float) -> float:
        """One-sided t test."""
        return _tail(bound - self.value, self.error, self.freedom)


@dataclass(frozen=True)
class Ratio:
    """Mean of ``above`` over mean of ``below``, paired (S,) and (S,), by Fieller's theorem.

    A ratio is beyond r where above − r · below is beyond 0, which is a t test (Fieller 1954,
    doi:10.1111/j.2517-6161.1954.tb00159.x). Raises ValueError unless the mean of ``below`` is positive.
    """

    above: tuple[float, ...]
    below: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.above) != len(self.below):
            raise ValueError("a paired ratio needs as many values above as below")
        if not float(np.mean(self.below)) > 0.0:
            raise ValueError("a ratio needs a positive mean below")

    @classmethod
    def of(cls, above: ArrayLike, below: ArrayLike) -> Ratio:
        """Of anything that is a row of numbers."""
        rows = (np.atleast_1d(np.asarray(row, dtype=np.float64)) for row in (above, below))
        one, other = (tuple(map(float, row)) for row in rows)
        return cls(one, other)

    @property
    def value(self) -> float:
        """Ratio of the means."""
        return float(np.mean(self.above) / np.mean(self.below))

    def interval(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """All r that a t test does not refuse; without bounds where the mean below could be 0."""
        count = len(self.above)
        if count < 2:
            return -math.inf, math.inf
        cov = np.cov(self.above, self.below) * _t(confidence, count - 1.0) ** 2 / count
        a, b = float(np.mean(self.above)), float(np.mean(self.below))
        # (b² − c_bb) r² − 2 (ab − c_ab) r + (a² − c_aa) ≤ 0
        square, cross, rest = b * b - cov[1, 1], a * b - cov[0, 1], a * a - cov[0, 0]
        if square <= 0.0:
            return -math.inf, math.inf
        root = math.sqrt(max(cross * cross - square * rest, 0.0))
        return float((cross - root) / square), float((cross + root) / square)

    def p_above(self, bound: float) -> float:
        """One-sided t test of above − bound · below."""
        return self._less(bound).p_above(0.0)

    def p_below(self, bound: float) -> float:
        """One-sided t test of above − bound · below."""
        return self._less(bound).p_below(0.0)

    def _less(self, bound: float) -> Student:
        return Student.mean(np.array(self.above) - bound * np.array(self.below))


@dataclass(frozen=True)
class Share:
    """So many of so many."""

    hits: int
    count: int

    @property
    def value(self) -> float:
        """Their share."""
        return self.hits / self.count

    def interval(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """Wilson's (1927, doi:10.1080/01621459.1927.10502953), in closed form."""
        z = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
        p, n = self.value, self.count
        middle = p + 0.5 * z * z / n
        half = z * math.sqrt(p * (1.0 - p) / n + 0.25 * (z / n) ** 2)
        whole = 1.0 + z * z / n
        low = 0.0 if self.hits == 0 else (middle - half) / whole
        return low, 1.0 if self.hits == n else (middle + half) / whole

    def p_above(self, bound: float) -> float:
        """Exact binomial test."""
        return self._p(bound, "greater")

    def p_below(self, bound: float) -> float:
        """Exact binomial test."""
        return self._p(bound, "less")

    def _p(self, bound: float, side: str) -> float:
        from scipy.stats import binomtest

        return float(binomtest(self.hits, self.count, bound, side).pvalue)


@dataclass(frozen=True)
class Apart:
    """Difference of two independent shares. Only 0 is asked of it."""

    one: Share
    other: Share

    @property
    def value(self) -> float:
        """The one less the other."""
        return self.one.value - self.other.value

    def interval(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """From both Wilson intervals (Newcombe 1998, doi:10.1002/(SICI)1097-0258(19980430)17:8<873::AID-SIM779>3.0.CO;2-I)."""
        (l1, u1), (l2, u2) = self.one.interval(confidence), self.other.interval(confidence)
        p1, p2 = self.one.value, self.other.value
        return (
            self.value - math.hypot(p1 - l1, u2 - p2),
            self.value + math.hypot(u1 - p1, p2 - l2),
        )

    def p_above(self, bound: float) -> float:
        """Fisher's exact test. Raises ValueError for a bound other than 0."""
        return self._p(bound, "greater")

    def p_below(self, bound: float) -> float:
        """Fisher's exact test. Raises ValueError for a bound other than 0."""
        return self._p(bound, "less")

    def _p(self, bound: float, side: str) -> float:
        from scipy.stats import fisher_exact

        if bound != 0.0:
            raise ValueError("the difference of two shares is held against 0 only")
        table = [[s.hits, s.count - s.hits] for s in (self.one, self.other)]
        return float(fisher_exact(table, side).pvalue)


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Interval of a share at 95 %."""
    return Share(hits, count).interval()


def _t(confidence: float, freedom: float) -> float:
    """Student's t that is exceeded either way with probability 1 − confidence."""
    from scipy.stats import t

    return float(t.ppf(0.5 + 0.5 * confidence, freedom))


def _tail(distance: float, error: float, freedom: float) -> float:
    """Probability that t exceeds distance over error; 1 where nothing is known of the error."""
    if not math.isfinite(error):
        return 1.0
    if error == 0.0:
        return 0.0 if distance > 0.0 else 1.0
    from scipy.stats import t

    return float(t.sf(distance / error, freedom))

"""How well a share is known."""

from __future__ import annotations


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Interval of a share at 95 % (Wilson 1927, doi:10.1080/01621459.1927.10502953)."""
    from scipy.stats import binomtest

    interval = binomtest(hits, count).proportion_ci(0.95, method="wilson")
    return float(interval.low), float(interval.high)

"""Intervals and verdicts: against closed forms, against SciPy's own, and by simulation of how often they are right."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytest.importorskip("scipy")

from scipy import stats

from sandbox.ensemble.estimates import Apart, Estimate, Ratio, Share, Student, wilson
from sandbox.studies.common.verdicts import OPEN, Demand, verdicts

TRIES = 4000
# Of a share of 0.95 in that many tries: five standard deviations, so that no seed has to be looked for.
SCATTER = 5.0 * math.sqrt(0.95 * 0.05 / TRIES)


def test_three_seeds_need_a_t_of_4_3() -> None:
    """Two standard errors with three seeds are 82 %, not 95; it takes 4.303 for that."""
    low, high = Student.mean([1.0, 2.0, 3.0]).interval()
    assert (high - low) / 2.0 == pytest.approx(4.302652729911275 / math.sqrt(3.0))
    within = 1.0 - 2.0 * Student.mean([1.0, 2.0, 3.0]).p_above(2.0 - 2.0 / math.sqrt(3.0))
    assert within == pytest.approx(2.0 / math.sqrt(2.0 + 4.0))  # closed form for 2 degrees


def test_mean_and_difference_are_scipys() -> None:
    random = np.random.default_rng(1)
    a, b = random.normal(1.0, 1.0, 9), random.normal(0.5, 3.0, 14)
    assert Student.mean(a).p_above(0.4) == pytest.approx(
        stats.ttest_1samp(a, 0.4, alternative="greater").pvalue
    )
    assert Student.mean(a).p_below(0.4) == pytest.approx(
        stats.ttest_1samp(a, 0.4, alternative="less").pvalue
    )
    welch = stats.ttest_ind(a, b, equal_var=False)
    mine = Student.difference(a, b)
    assert mine.interval() == pytest.approx(welch.confidence_interval(0.95))
    assert 2.0 * min(mine.p_above(0.0), mine.p_below(0.0)) == pytest.approx(welch.pvalue)


def test_exponent_is_the_slope_of_the_logarithms() -> None:
    x = np.geomspace(0.01, 1.0, 7)
    exact = Student.exponent(x, 3.0 * x**0.55)
    assert exact.value == pytest.approx(0.55)
    assert exact.error == pytest.approx(0.0, abs=1e-12)
    y = x**0.55 * np.exp(np.random.default_rng(2).normal(0.0, 0.1, 7))
    line = stats.linregress(np.log(x), np.log(y))
    fit = Student.exponent(x, y)
    assert (fit.value, fit.error) == pytest.approx((line.slope, line.stderr))
    assert fit.freedom == 5.0


def test_one_value_establishes_nothing() -> None:
    alone = Student.mean([3.0])
    assert alone.interval() == (-math.inf, math.inf)
    assert alone.p_above(0.0) == alone.p_below(100.0) == 1.0
    assert Ratio.of([3.0], [1.0]).interval() == (-math.inf, math.inf)
    assert Student.exponent([1.0, 2.0], [1.0, 2.0]).p_above(0.0) == 1.0
    assert verdicts([(alone, Demand(0.0))])[0][0] == OPEN


def test_fieller_by_its_closed_form_without_error_below() -> None:
    """Where all values below are the same, the interval is that of the mean over that number."""
    above = [3.0, 4.0, 5.5, 4.4]
    low, high = Student.mean(above).interval()
    assert Ratio.of(above, [2.0] * 4).interval() == pytest.approx((low / 2.0, high / 2.0))
    proportional = Ratio.of(above, [2.0 * a for a in above])
    assert proportional.interval() == pytest.approx((0.5, 0.5))
    unknown = Ratio.of(above, [3.0, -2.9, 2.0, -1.9])
    assert unknown.interval() == (-math.inf, math.inf)
    with pytest.raises(ValueError, match="positive"):
        Ratio.of(above, [-1.0] * 4)
    with pytest.raises(ValueError, match="as many"):
        Ratio.of(above, [1.0])


@pytest.mark.parametrize("side", ["low", "high"])
def test_interval_and_test_agree(side: str) -> None:
    """At the end of a 95 % interval the one-sided p-value is 2.5 %."""
    random = np.random.default_rng(3)
    estimates: list[Estimate] = [
        Student.mean(random.normal(1.0, 1.0, 6)),
        Student.difference(random.normal(1.0, 1.0, 6), random.normal(0.0, 2.0, 5)),
        Ratio.of(random.normal(3.0, 1.0, 8), random.normal(2.0, 0.3, 8)),
    ]
    for estimate in estimates:
        low, high = estimate.interval()
        p = estimate.p_above(low) if side == "low" else estimate.p_below(high)
        assert p == pytest.approx(0.025)


def test_coverage_of_a_mean_and_a_ratio() -> None:
    """The 95 % interval has the true value in it 95 times of 100, for few seeds and for pairs that go together."""
    random = np.random.default_rng(4)
    hits = {"mean": 0, "ratio": 0}
    for _ in range(TRIES):
        common = random.normal(0.0, 0.5, 5)
        above, below = (m + common + random.normal(0.0, s, 5) for m, s in ((6.0, 1.0), (3.0, 0.4)))
        low, high = Student.mean(above).interval()
        hits["mean"] += low < 6.0 < high
        low, high = Ratio.of(above, below).interval()
        hits["ratio"] += low < 2.0 < high
    for share in hits.values():
        assert share / TRIES == pytest.approx(0.95, abs=SCATTER)


def test_coverage_of_an_exponent() -> None:
    random = np.random.default_rng(5)
    x = np.geomspace(1.0, 10.0, 6)
    noise = np.exp(random.normal(0.0, 0.2, (TRIES, 6)))
    inside = 0
    for row in noise:
        low, high = Student.exponent(x, x**0.5 * row).interval()
        inside += low < 0.5 < high
    assert inside / TRIES == pytest.approx(0.95, abs=SCATTER)


def test_wilson_interval_by_its_closed_form() -> None:
    """z = 1.96: (p + z²/2n ± z √(p(1−p)/n + z²/4n²)) / (1 + z²/n)."""
    z, n, p = 1.959963984540054, 20, 0.6
    middle, half = p + z * z / (2 * n), z * (p * (1 - p) / n + z * z / (4 * n * n)) ** 0.5
    low, high = wilson(12, 20)
    assert low == pytest.approx((middle - half) / (1 + z * z / n))
    assert high == pytest.approx((middle + half) / (1 + z * z / n))
    assert wilson(20, 20)[1] == 1.0


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_coverage_of_a_share(share: float) -> None:
    """Exactly, over all outcomes: a Wilson interval of 40 has the true share in it about 95 times of 100."""
    weight = stats.binom.pmf(np.arange(41), 40, share)
    inside = [low <= share <= high for low, high in (wilson(k, 40) for k in range(41))]
    assert float(weight @ np.array(inside)) == pytest.approx(0.95, abs=0.03)


def test_tests_of_shares_are_exact() -> None:
    """All 5 of 5: p = share⁵. 3 of 3 against 0 of 3: one table in (6 choose 3)."""
    assert Share(5, 5).p_above(0.5) == pytest.approx(0.5**5)
    assert Share(0, 5).p_below(0.5) == pytest.approx(0.5**5)
    apart = Apart(Share(3, 3), Share(0, 3))
    assert apart.value == 1.0
    assert apart.p_above(0.0) == pytest.approx(1.0 / 20.0)
    assert apart.p_below(0.0) == pytest.approx(1.0)
    low, high = apart.interval()
    assert 0.0 < low < high == 1.0
    with pytest.raises(ValueError, match="against 0"):
        apart.p_above(0.1)

"""Sizes of avalanches that are known to be exponential, or not, and the two forms of their decay."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("scipy")

from core.arrays import Floats
from sandbox.studies.clogging.fits import Falls, divergence, exponential, preference
from sandbox.sweep.sizes import mean_size, memory, survival

MOST = 60.0  # grains in the hopper


def cut(sizes: Floats) -> tuple[Floats, np.ndarray]:
    """As a hopper that runs empty sees them."""
    return np.minimum(sizes, MOST), sizes <= MOST


def test_a_hopper_that_runs_empty_does_not_hide_the_mean() -> None:
    rng = np.random.default_rng(1)
    sizes, clogged = cut(rng.geometric(0.02, 400).astype(float))
    assert not clogged.all()
    mean, low, high = mean_size(sizes, clogged)
    assert low < 50.0 < high
    assert mean == pytest.approx(50.0, rel=0.15)
    at, share = survival(sizes, clogged)
    assert share[-1] == pytest.approx(0.98**MOST, abs=0.06)
    assert np.all(np.diff(at) > 0.0)


def test_what_remembers_its_size_is_told_from_what_does_not() -> None:
    rng = np.random.default_rng(2)
    forgets = memory(*cut(rng.geometric(0.05, 500).astype(float)))
    ages = memory(*cut(np.ceil(30.0 * rng.weibull(2.0, 500))))
    assert forgets is not None
    assert ages is not None
    low, high = forgets.interval()
    assert low < 0.0 < high
    assert ages.interval()[0] > np.log(1.5)
    assert memory(np.array([9.0]), np.array([False])) is None


@pytest.mark.parametrize("diverges", [False, True])
def test_the_form_that_made_the_avalanches_is_preferred(diverges: bool) -> None:
    rng = np.random.default_rng(3)
    width = np.repeat([2.0, 2.5, 3.0, 3.5, 4.0], 300)
    q = 0.12 * (4.15 - width) ** 1.5 if diverges else np.exp(0.3 - 0.35 * width**2)
    sizes = rng.geometric(q).astype(float)
    falls = Falls(width, np.minimum(sizes, 2000.0), (sizes <= 2000.0).astype(float))
    one, other = exponential(falls), divergence(falls)
    low, high = preference(one, other).interval()
    assert (high < 0.0) if diverges else (low > -0.003)
    assert (one.criterion > other.criterion) == diverges
    better = other if diverges else one
    assert better.hazard(np.array([3.0]))[0] == pytest.approx(
        0.12 * 1.15**1.5 if diverges else np.exp(0.3 - 0.35 * 9.0), rel=0.15
    )

"""FIRE's steering: what becomes of dt, α and the velocity after an evaluation."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.steering import (
    ALPHA_DECAY,
    ALPHA_START,
    DT_GROW,
    DT_SHRINK,
    DT_SHRINK_FLOOR,
    LEAST_COSINE,
    steer,
)

UNHURRIED = settings(deadline=None)  # the first call compiles
POSITIVE = st.floats(1e-6, 1e6)


@UNHURRIED
@given(POSITIVE, POSITIVE, st.floats(LEAST_COSINE + 1e-6, 1.0), st.floats(1e-3, ALPHA_START))
def test_downhill_velocity_is_turned_and_keeps_its_length(
    force: float, speed: float, cosine: float, alpha: float
) -> None:
    """keep v + turn F has the length of v when F and v are parallel, and is nearer to F than v was when they are not."""
    dt, dt_max = 0.01, 0.0105
    power = cosine * force * speed
    longer, less, keep, push = steer(power, force**2, speed**2, dt, alpha, dt_max)
    assert longer == pytest.approx(min(DT_GROW * dt, dt_max))
    assert less == pytest.approx(alpha * ALPHA_DECAY)
    turn = push - 0.5 * longer  # the rest is the first half of the next kick
    assert (keep * speed + turn * force) == pytest.approx(
        speed, rel=1e-9, abs=1e-9 * longer * force
    )
    along = keep * cosine * speed + turn * force
    across = keep * math.sqrt(1.0 - cosine**2) * speed
    assert along / math.hypot(along, across) >= cosine - 1e-6 - 1e-6 * longer * force / speed


@UNHURRIED
@given(POSITIVE, POSITIVE, st.floats(-1.0, LEAST_COSINE - 1e-6), st.floats(1e-9, ALPHA_START))
def test_velocity_that_goes_no_longer_downhill_is_thrown_away(
    force: float, speed: float, cosine: float, alpha: float
) -> None:
    shorter, again, keep, push = steer(
        cosine * force * speed, force**2, speed**2, 0.01, alpha, 0.05
    )
    assert keep == 0.0
    assert again == ALPHA_START
    assert shorter == pytest.approx(DT_SHRINK * 0.01)
    assert push == pytest.approx(0.5 * shorter)


def test_the_time_step_has_bounds() -> None:
    dt_max = 0.08
    dt = dt_max
    for _ in range(1000):
        dt, *_ = steer(-1.0, 1.0, 1.0, dt, 0.1, dt_max)
    assert dt == pytest.approx(DT_SHRINK_FLOOR * dt_max)
    for _ in range(1000):
        dt, *_ = steer(1.0, 1.0, 1.0, dt, 0.1, dt_max)
    assert dt == dt_max


def test_grains_without_forces_do_not_divide_by_zero() -> None:
    _, alpha, keep, push = steer(0.0, 0.0, 0.0, 0.01, 0.1, 0.05)
    assert (alpha, keep) == (ALPHA_START, 0.0)
    assert math.isfinite(push)

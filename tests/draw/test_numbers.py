"""Round numbers and numbers as text."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.draw.numbers import (
    FINER,
    RoundScale,
    are_counts,
    decimals_for,
    nice_ceiling,
    number,
    percent,
    short_number,
    ticks,
    typical_largest,
)

positive = st.floats(1e-9, 1e9)


@given(value=positive)
def test_nice_ceiling_is_the_next_round_number(value: float) -> None:
    for steps, most in (((1.0, 2.0, 5.0, 10.0), 2.5), (FINER, 1.34)):
        top = nice_ceiling(value, steps)
        assert value <= top * (1 + 1e-8)
        assert top <= most * value * (1 + 1e-8)


@given(low=st.floats(-1e6, 1e6), span=st.floats(1e-6, 1e6), most=st.integers(1, 20))
def test_ticks_are_within_and_not_too_many(low: float, span: float, most: int) -> None:
    high = low + span
    found = ticks(low, high, most)
    assert len(found) <= most + 1
    # Where numbers are large beside their span, a tick is a rounded product with a rounded step.
    slack = 1e-6 * span + 2.0 * math.ulp(max(abs(low), abs(high)))
    assert all(low - slack <= tick <= high + slack for tick in found)


@pytest.mark.parametrize("high", [0.0, -1.0, math.nan, math.inf])
def test_no_ticks_without_a_range(high: float) -> None:
    assert ticks(0.0, high, 5) == []


@pytest.mark.parametrize(
    ("value", "decimals", "text"),
    [
        (1.234, 2, "1.23"),
        (-0.5, 1, "−0.5"),
        (-0.0004, 2, "0.00"),
        (math.nan, 1, "—"),
        (math.inf, 1, "—"),
        (12.0, 0, "12"),
    ],
)
def test_number(value: float, decimals: int, text: str) -> None:
    assert number(value, decimals) == text


@pytest.mark.parametrize(
    ("step", "decimals"), [(1.0, 0), (5.0, 0), (0.5, 1), (0.1, 1), (0.02, 2), (0.0, 0)]
)
def test_decimals(step: float, decimals: int) -> None:
    assert decimals_for(step) == decimals


@pytest.mark.parametrize(
    ("share", "text"), [(0.008, "1 %"), (0.012, "2 %"), (0.0004, "0.05 %"), (0.3, "50 %")]
)
def test_percent_is_an_upper_bound(share: float, text: str) -> None:
    assert percent(share) == text


def test_scale_grows_at_once_and_shrinks_late() -> None:
    scale = RoundScale(0.1)
    assert scale.follow(math.nan) == 0.1
    assert scale.follow(0.9) == 1.0
    assert scale.follow(1.1) == 1.2
    assert scale.follow(0.5) == 1.2
    assert scale.follow(0.2) == pytest.approx(0.2)
    assert scale.follow(1e-9) == pytest.approx(0.1)


def test_typical_largest_ignores_what_is_no_number() -> None:
    assert typical_largest(np.array([])) == 0.0
    assert typical_largest(np.array([np.nan, np.inf])) == 0.0
    assert typical_largest(np.linspace(0, 1, 101)) == pytest.approx(0.99)


def test_what_is_counted_is_written_so() -> None:
    whole, halves = np.array([0.0, 3.0, 54.0]), np.array([0.0, 0.5])
    assert are_counts("", whole)
    assert not are_counts("", whole, halves)
    assert not are_counts("k R", whole)  # a force may be whole by chance
    assert ticks(0.0, 1.0, 5, counts=True) == [0.0, 1.0]
    assert ticks(0.0, 54.0, 4, counts=True) == [0.0, 20.0, 40.0]
    assert ticks(0.0, 1.0, 5) == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (54.0, "54"),
        (20_000, "20000"),
        (123_456.0, "123456"),
        (0.8, "0.8"),
        (-0.35, "−0.35"),
        (1e-8, "1e-8"),
    ],
)
def test_whole_numbers_are_written_in_full(value: float, text: str) -> None:
    assert short_number(value) == text.replace("e-", "e−")

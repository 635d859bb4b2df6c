"""Fronts, extrapolation and bifurcations: pure functions on numbers with known answers."""

from __future__ import annotations

import math

import pytest

from sandbox.studies.accuracy.fronts import (
    cost_at,
    extrapolate,
    first_beyond,
    front,
    lead,
    rms,
    slope,
)


def test_front_keeps_what_nothing_beats() -> None:
    points = [
        (4.0, 0.1),
        (1.0, 1.0),
        (2.0, 0.5),
        (3.0, 0.6),
        (5.0, 0.1),
        (0.5, math.nan),
        (0.0, 0.0),
    ]
    assert front(points) == [1, 2, 0]


def test_front_of_equal_costs_is_the_better_one() -> None:
    assert front([(1.0, 0.2), (1.0, 0.1)]) == [1]
    assert front([]) == []


def test_cost_between_points_is_straight_in_the_logarithms() -> None:
    points = [(1.0, 1e-1), (100.0, 1e-3)]
    assert cost_at(points, 1e-2) == pytest.approx(10.0)
    assert cost_at(points, 0.5) == 1.0
    assert math.isnan(cost_at(points, 1e-4))
    assert math.isnan(cost_at([], 1e-4))


def test_cost_on_the_way_to_an_exact_point() -> None:
    assert cost_at([(1.0, 1e-1), (7.0, 0.0)], 1e-3) == 7.0


def test_lead_is_the_ratio_at_equal_error() -> None:
    ours = [(1.0, 1e-1), (10.0, 1e-3)]
    theirs = [(3.0, 1e-1), (50.0, 1e-3), (90.0, 1e-9)]
    least, middle = lead(ours, theirs)
    assert least == pytest.approx(3.0)
    assert middle == pytest.approx(math.sqrt(15.0))
    assert all(math.isnan(ratio) for ratio in lead(ours, [(1.0, 1e-9)]))


def test_extrapolation_finds_the_hard_limit_of_a_parabola_in_1_over_c() -> None:
    stiffness = [25.0, 100.0, 50.0, 200.0]
    value = [2.0 + 3.0 / c + 5.0 / c**2 for c in stiffness]
    limit, doubt = extrapolate(stiffness, value)
    assert limit == pytest.approx(2.0, abs=1e-12)
    assert 0.0 < doubt < 1e-3
    with pytest.raises(ValueError, match="three"):
        extrapolate([1.0, 2.0], [1.0, 2.0])


def test_first_place_where_walks_part() -> None:
    assert first_beyond([1.0, 2.0, 3.0], [0.0, 0.3, 0.1], 0.2) == 2.0
    assert first_beyond([1.0, 2.0], [0.0, 0.1], 0.2) is None
    assert first_beyond([1.0, 2.0], [0.0, math.nan], 0.2) == 2.0
    assert first_beyond([], [], 0.2) is None


def test_means_and_slopes() -> None:
    assert rms([3.0, 4.0]) == pytest.approx(math.sqrt(12.5))
    assert math.isnan(rms([]))
    assert slope([1.0, 10.0, 100.0], [2.0, 0.2, 0.02]) == pytest.approx(-1.0)
    assert math.isnan(slope([1.0, 2.0], [0.0, 1.0]))

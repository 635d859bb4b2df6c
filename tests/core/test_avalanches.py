"""Stress drops, changes of contact forces matched by the grains' labels, and how many grains take part."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core import observables
from core.avalanches import force_changes, participation, stress_drops, weights
from core.packing import Packing


def test_drops_are_found_where_they_happen() -> None:
    stress = np.array([0.0, 1.0, 0.4, 0.39, 0.9, 0.1])
    places, sizes = stress_drops(stress, 0.05)
    assert places.tolist() == [2, 5]
    assert sizes == pytest.approx([0.6, 0.8])
    assert stress_drops(np.zeros(1), 0.1)[0].tolist() == []


def test_changes_are_matched_by_label_whatever_the_order() -> None:
    # A row of four; then the third grain moves away from the fourth, and the grains are renumbered.
    before = Packing([0.0, 1.9, 3.8, 5.7], np.zeros(4))
    after = Packing([0.0, 1.9, 3.7, 5.7], np.zeros(4)).select(np.ones(4, dtype=bool))
    order = np.array([2, 0, 3, 1])
    shuffled = Packing(after.x[order], after.y[order], label=order)
    changes = force_changes(
        observables.grain_contacts(before),
        observables.grain_contacts(shuffled),
        before.label,
        shuffled.label,
    )
    stiffness = float(before.contact_stiffness[0])
    found = {
        (int(a), int(b)): float(c)
        for a, b, c in zip(changes.i, changes.j, changes.change, strict=True)
    }
    assert found[(0, 1)] == pytest.approx(0.0, abs=1e-9)
    assert found[(1, 2)] == pytest.approx(0.1 * stiffness)
    assert found[(2, 3)] == pytest.approx(-0.1 * stiffness)  # this contact opened
    weight = weights(changes, shuffled.label)
    assert weight[order.tolist().index(0)] == pytest.approx(0.0, abs=1e-9)
    assert weight[order.tolist().index(2)] == pytest.approx(2.0 * (0.1 * stiffness) ** 2)


def test_a_grain_that_left_takes_part_no_more() -> None:
    packing = Packing([0.0, 1.9, 3.8], np.zeros(3))
    fewer = packing.select(np.array([True, False, True]))
    changes = force_changes(
        observables.grain_contacts(packing),
        observables.grain_contacts(fewer),
        packing.label,
        fewer.label,
    )
    assert len(changes.change) == 2
    assert weights(changes, fewer.label).shape == (2,)
    assert np.all(weights(changes, fewer.label) > 0.0)
    nobody = packing.select(np.zeros(3, dtype=bool))
    assert weights(changes, nobody.label).shape == (0,)


def test_participation_of_all_and_of_one() -> None:
    assert participation(np.full(50, 3e-200)) == pytest.approx(1.0)
    assert participation(np.eye(50)[7]) == pytest.approx(1.0 / 50.0)
    assert participation(np.zeros(50)) == 0.0
    assert participation(np.zeros(0)) == 0.0
    half = np.repeat([0.0, 2.0], 25)
    assert participation(half) == pytest.approx(0.5)


@given(st.lists(st.floats(0.0, 1e6), min_size=1, max_size=40))
def test_participation_lies_between_one_grain_and_all(weight: list[float]) -> None:
    share = participation(np.array(weight))
    if max(weight) > 0.0:
        assert 1.0 / len(weight) - 1e-9 <= share <= 1.0 + 1e-9

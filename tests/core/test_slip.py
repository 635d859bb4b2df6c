"""What is no slip, and how much is one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from core.friction import Friction
from core.packing import Packing
from core.rigid import RigidBody, RigidWorld
from core.slip import TANGENTIAL_STIFFNESS
from tests.core.friction_examples import (
    EPSILON,
    MU,
    Case,
    Floats,
    case,
    rotation,
    stretch,
    turn_shapes,
)


def slips_of(made: Case) -> Floats:
    """Slips of all contacts that touch [R], cut to what they can hold."""
    _, slips, forces = made.relaxation().slips()
    assert not forces.sliding.any()
    return slips


def turned_as_one(made: Case, angle: float) -> Case:
    """Grains, their shapes and bodies turned by ``angle`` about a point."""
    centre = np.array([[3.0], [-2.0]])
    packing = made.before.copy()
    packing.state[:2] = centre + rotation(angle) @ (packing.state[:2] - centre)
    turn_shapes(packing.state, angle)
    place = made.placed.copy()
    place[:, :2] = (centre + rotation(angle) @ (place[:, :2].T - centre)).T
    place[:, 2] += angle
    friction = Friction(10.0, len(packing))
    turned = np.full(len(packing), angle)
    return Case(made.before, made.world, made.placed, friction, packing, turned, place)


def test_turning_everything_is_no_slip() -> None:
    """Strained grains and bodies turned together as one rigid whole: what counts as slip is of second order."""
    made = case(5)
    slips = [np.abs(slips_of(turned_as_one(made, angle))) for angle in (1e-3, 5e-4, 2.5e-4)]
    assert slips[0].max() < 10.0 * 1e-3**2
    assert slips[0].max() / slips[1].max() == pytest.approx(4.0, rel=0.02)
    assert slips[1].max() / slips[2].max() == pytest.approx(4.0, rel=0.02)


def test_carrying_everything_along_is_no_slip() -> None:
    made = case(5)
    packing, place = made.before.copy(), made.placed.copy()
    packing.state[:2] += np.array([[0.11], [-0.07]])
    place[:, :2] += 0.11, -0.07
    still = np.zeros(len(packing))
    moved = Case(made.before, made.world, made.placed, Friction(MU, 20), packing, still, place)
    assert slips_of(moved).max() <= 200 * EPSILON


@pytest.mark.parametrize("share", [0.0, 0.4])
def test_an_ellipse_that_turns_on_a_plate_counts_its_turn_once(share: float) -> None:
    """Shape and spin turned together by α: its material has gone by h α. The spin alone: by a b α / h. Both to second order."""
    packing = Packing([0.0], [0.95], 1.0, 0.3, 50.0)
    packing.set_axes(1.0 + 0.3 * share, 1.0 - 0.2 * share, 0.4)
    world = RigidWorld([RigidBody("floor", segments=[(-9.0, 0.0, 9.0, 0.0, 0.0)])])
    placed = world.placement()
    (a,), (b,) = packing.semi_axes
    h = float(np.hypot(*(stretch(packing.state[2:, 0]) @ [0.0, 1.0])))
    for angle in (1e-4, -1e-4):
        for both in (True, False):
            moved = packing.copy()
            if both:
                turn_shapes(moved.state, angle)
            made = Case(packing, world, placed, Friction(10.0, 1), moved, np.full(1, angle), placed)
            expected = angle * (h if both else float(a * b) / h)
            assert slips_of(made) == pytest.approx([expected], abs=angle**2)
    if share:
        assert abs(h - float(a * b) / h) > 0.01


def test_rough_plates_resist_a_shear_of_the_grain_between_them() -> None:
    """q2 from 0 to 0.07 R carries the material at the plates by ∓ q2 p/h; they hold it with k_t each, and at μ = 10 none slides.

    So f = ∓ k_t q2 p/h on the grain, 1.746 k R, −2 k_t q2 p²/h² on q2 and 2 k_t q2 p ab/h² on the spin, with h² = p² + q2²:
    rolled by q2 p/ab, it no longer slips.
    """
    packing = Packing([0.0], [0.0], 1.0, 0.3, 50.0)
    plates = [
        RigidBody(name, position=(0.0, y), segments=[(-9.0, 0.0, 9.0, 0.0, 0.0)])
        for name, y in (("floor", -0.9), ("top", 0.9))
    ]
    world = RigidWorld(plates)
    sheared = packing.copy()
    sheared.state[4] = 0.07
    placed = world.placement()
    made = Case(packing, world, placed, Friction(10.0, 1), sheared, np.zeros(1), placed)
    energy, forces = made.forces()
    h = math.hypot(1.0, 0.07)
    pull = TANGENTIAL_STIFFNESS * 50.0 * 0.07 / h
    assert pull == pytest.approx(1.7457, abs=1e-4)
    expected = [0.0, 0.0, -2.0 * pull / h, 2.0 * pull * (1.0 - 0.07**2) / h]
    assert forces[[0, 1, 4, 5], 0] == pytest.approx(expected, abs=1e-12)
    assert energy == pytest.approx(pull * 0.07 / h, rel=1e-12)
    held = made.relaxation().slips()[2]
    assert sorted(held.fx) == pytest.approx([-pull, pull], rel=1e-12)
    rolled = replace(made, turned=np.full(1, 0.07 / (1.0 - 0.07**2)))
    assert np.abs(rolled.forces()[1]).max() < 1e-12


def test_a_new_contact_begins_at_nothing() -> None:
    """Open by g⁰ at the origin, it holds the share Δ/(Δ + g⁰) of the way that its surfaces have gone: none as they meet."""
    before = Packing([0.0, 2.01], [0.0, 0.0])
    none = np.zeros((0, 3))
    for overlap in (1e-9, 1e-4, 0.01):
        moved = before.copy()
        moved.state[0, 1] = 2.0 - overlap
        made = Case(before, RigidWorld(), none, Friction(10.0, 2), moved, np.full(2, 1e-4), none)
        way = 2e-4 * (1.0 - 0.5 * overlap)
        expected = overlap / (overlap + 0.01) * way
        assert slips_of(made) == pytest.approx([expected], rel=1e-6)

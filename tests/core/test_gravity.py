"""Gravity: weights, their energy, columns that press on their floor, and grains that fall."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core import fire, observables
from core.friction import Friction
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.system import System
from tests.core import examples, reference_friction

G = 0.05  # [k/R]
TOLERANCE = 1e-7
CAREFUL = Settings(0.05, TOLERANCE, force_floor=1e-6, max_iterations=100_000)


def floor() -> RigidBody:
    return RigidBody("floor", segments=[(-30.0, 0.0, 30.0, 0.0, 0.0)])


def rest(engine: Quasistatic, rounds: int = 1) -> observables.RigidContacts:
    """Let everything come to rest."""
    for _ in range(rounds):
        engine.begin({})
        increment = engine.relax(engine.system.solver.max_iterations)
        assert increment is not None
        assert increment.report.reason is StopReason.CONVERGED
    return engine.contacts()[1]


@pytest.mark.parametrize("gravity", [(0.0, -0.3), (0.7, 0.2)])
@pytest.mark.parametrize("box", [None, examples.BOXES["periodic in x"]], ids=["open", "periodic"])
def test_twin(gravity: tuple[float, float], box: PeriodicBox | None) -> None:
    """Weights come on top of all other forces, wherever the minimiser keeps a grain; shapes feel nothing of them."""
    packing = examples.random_grains(30, 9.0, 1, box)
    bare, with_weight = Relaxation(packing), Relaxation(packing, gravity=gravity)
    energy, forces = reference_friction.weight(packing, gravity)
    rise = with_weight.run(1).energy - bare.run(1).energy
    change = with_weight.forces() - bare.forces()
    scale = np.abs(bare.forces()).max()
    assert rise == pytest.approx(energy, abs=1e-12 * bare.report().energy)
    assert np.abs(change[:2] - forces).max() <= 1e-12 * scale
    assert np.abs(change[2:]).max() <= 1e-12 * scale


def test_weights_are_slopes_of_their_energy() -> None:
    """Linear in the places: differences are exact but for rounding of the energy."""
    packing = examples.random_grains(5, 40.0, 2)
    gravity = (0.3, -0.4)
    energy, forces = reference_friction.weight(packing, gravity)
    whole = Relaxation(packing, gravity=gravity).run(1).energy
    for row in range(2):
        for i in range(5):
            moved = packing.copy()
            moved.state[row, i] += 0.5
            drop = whole - Relaxation(moved, gravity=gravity).run(1).energy
            lone = reference_friction.weight(moved, gravity)[0]
            assert energy - lone == pytest.approx(0.5 * forces[row, i], abs=1e-13)
            if len(observables.grain_contacts(packing).i) == 0:
                assert drop == pytest.approx(0.5 * forces[row, i], abs=1e-12)


def column(count: int, nu: float) -> tuple[Quasistatic, examples.Floats]:
    """Grains of several sizes, one upon the other; and their weights [k R]."""
    radius: examples.Floats = 0.8 + 0.1 * np.arange(count, dtype=np.float64) % 0.4
    y = np.cumsum(2.0 * radius) - radius
    packing = Packing(np.zeros(count), y, radius, nu)
    return Quasistatic(
        System(packing, RigidWorld([floor()]), CAREFUL, gravity=(0.0, -G))
    ), G * radius**2


@pytest.mark.parametrize("nu", [-0.8, 0.0, 0.8])
def test_a_column_presses_with_the_weight_above(nu: float) -> None:
    """Every contact carries what lies above it, the floor all of it.

    Each grain is in balance to the tolerance times the mean contact force, below 0.5 k R; the errors add up along the column.
    """
    count = 6
    engine, weights = column(count, nu)
    bodies = rest(engine)
    pairs = observables.grain_contacts(engine.packing)
    assert len(pairs.i) == count - 1
    above = np.cumsum(weights[::-1])[::-1]
    tolerance = count * 0.5 * TOLERANCE
    assert engine.reactions[0, :2] == pytest.approx([0.0, -above[0]], abs=tolerance)
    assert bodies.normal_force == pytest.approx([above[0]], abs=tolerance)
    upper = np.maximum(pairs.i, pairs.j)
    assert pairs.normal_force == pytest.approx(above[upper], abs=tolerance)


def test_pressure_grows_with_depth_without_walls_that_rub() -> None:
    """Janssen's silo without friction is a liquid: walls carry no weight, and pressure is the weight above over the width.

    A hexagonal stack in a box. The vertical force through each level is summed over the contacts that cross it.
    """
    rows, pitch = 8, 1.99
    x = np.concatenate([pitch * (np.arange(4 - k % 2) + 0.5 * (k % 2)) for k in range(rows)])
    y = np.concatenate([np.full(4 - k % 2, 1.0 + math.sqrt(3.0) * k) for k in range(rows)])
    row = np.concatenate([np.full(4 - k % 2, k) for k in range(rows)])
    width = 4.0 * pitch
    walls = [
        RigidBody(name, segments=[(at, -5.0, at, 40.0, 0.0)])
        for name, at in (("left", -0.5 * pitch), ("right", width - 0.5 * pitch))
    ]
    count = len(x)
    packing = Packing(x, y, 1.0, np.tile([0.8, -0.5], count // 2))
    world = RigidWorld([floor(), *walls])
    engine = Quasistatic(System(packing, world, CAREFUL, gravity=(0.0, -G)))
    rest(engine)
    weight = G * count
    balance = count * TOLERANCE
    assert engine.reactions[0, 1] == pytest.approx(-weight, abs=balance)
    assert np.abs(engine.reactions[1:, 1]).max() < 1e-12
    assert engine.reactions[1, 0] == pytest.approx(-engine.reactions[2, 0], abs=balance)
    pairs = observables.grain_contacts(engine.packing)
    pressures = []
    for level in range(1, rows):
        upper_i = row[pairs.i] >= level
        crossing = upper_i != (row[pairs.j] >= level)
        through = np.where(upper_i, pairs.fy, -pairs.fy)[crossing].sum()
        pressures.append(through / width)
    expected = [G * int((row >= level).sum()) / width for level in range(1, rows)]
    assert pressures == pytest.approx(expected, abs=balance)


def test_walls_that_rub_carry_weight() -> None:
    """With friction the same silo stands partly on its walls (Janssen); the sum of all still is the weight."""
    rows, per_row = 8, 4
    x = np.concatenate([1.98 * np.arange(per_row) + (k % 2) for k in range(rows)])
    y = np.concatenate([np.full(per_row, 1.0 + 1.72 * k) for k in range(rows)])
    walls = [
        RigidBody(name, segments=[(at, -5.0, at, 40.0, 0.0)])
        for name, at in (("l", -1.0), ("r", 7.9))
    ]
    packing = Packing(x, y, 1.0, 0.5)
    world = RigidWorld([floor(), *walls])
    engine = Quasistatic(System(packing, world, CAREFUL, Friction(0.5, len(packing)), (0.0, -G)))
    rest(engine, 6)
    weight = G * len(packing)
    assert engine.reactions[:, 1].sum() == pytest.approx(-weight, abs=1e-5)
    assert engine.reactions[1:, 1].max() < -0.01 * weight
    assert -engine.reactions[0, 1] < 0.98 * weight


@pytest.mark.parametrize("height", [1.2, 4.0])
@pytest.mark.parametrize("mu", [None, 0.5])
def test_a_free_grain_falls_to_the_floor(height: float, mu: float | None) -> None:
    """It comes to rest where the floor carries it: C Δ = weight, and never goes through however long it falls."""
    packing = Packing([0.3], [height], 1.0, 0.2, 50.0)
    friction = None if mu is None else Friction(mu, 1)
    engine = Quasistatic(System(packing, RigidWorld([floor()]), CAREFUL, friction, (0.0, -G)))
    contacts = rest(engine)
    assert contacts.overlap == pytest.approx([G / 50.0], rel=1e-6)
    assert packing.x[0] == pytest.approx(0.3, abs=1e-12)
    relaxed = Relaxation(packing, engine.world.primitives()[0], gravity=(0.0, -G)).run(1).energy
    _, lifted = examples.forces(packing, engine.world.primitives()[0])
    assert relaxed < G * height
    assert lifted[1, 0] == pytest.approx(G, rel=1e-6)


def test_nothing_to_hold_it() -> None:
    """A grain with no floor falls until the iterations are used up; that is said, and all stays finite."""
    packing = Packing([0.0], [0.0])
    engine = Quasistatic(
        System(packing, RigidWorld(), Settings(max_iterations=500), gravity=(0.0, -G))
    )
    engine.begin({})
    increment = engine.relax(1000)
    assert increment is not None
    assert increment.report.reason is StopReason.ITERATION_LIMIT
    assert packing.y[0] < -1.0
    assert np.all(np.isfinite(packing.state))


def test_direction_does_not_matter() -> None:
    """A tilted world under tilted gravity is the same world."""
    heights = []
    for angle in (0.0, 0.6, 2.9):
        c, s = math.cos(angle), math.sin(angle)
        engine, _ = column(4, 0.3)
        upright = engine.packing
        tilted = Packing(-s * upright.y, c * upright.y, upright.rest_radius, 0.3)
        world = RigidWorld([floor()])
        world["floor"].angle = angle
        engine = Quasistatic(System(tilted, world, CAREFUL, gravity=(G * s, -G * c)))
        rest(engine)
        heights.append(-s * tilted.x + c * tilted.y)
        assert np.abs(c * tilted.x + s * tilted.y).max() < 1e-6
    for other in heights[1:]:
        assert other == pytest.approx(heights[0], abs=1e-6)


def test_without_gravity_no_code_for_it() -> None:
    Relaxation(Packing([0.0], [0.0])).run(1)
    assert any(str(signature[4]) == "none" for signature in fire.run.signatures)

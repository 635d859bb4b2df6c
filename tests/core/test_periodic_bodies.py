"""Periodic cells with rigid bodies in them, and cells that are squeezed and sheared."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core import observables
from core.friction import Friction
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment, Quasistatic
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.system import System
from tests.core import examples

Floats = examples.Floats
WIDTH = 12.0
CELLS = st.lists(st.integers(-3, 3), min_size=20, max_size=20)
FEW = settings(max_examples=10, deadline=None)


def serrated(shift: float = 0.0) -> RigidWorld:
    """Two rows of discs, one a serrated plate below, the other above, that close up with themselves around the cell."""
    rows = [
        [(shift + WIDTH * k / 20, 0.1 * (k % 3), 0.35) for k in range(20)],
        [(shift + WIDTH * k / 15, 0.2 * (k % 2), 0.5) for k in range(15)],
    ]
    low = RigidBody("low", "body", position=(0.0, 0.0), discs=rows[0], axis=(1.0, 0.0))
    high = RigidBody("high", "body", position=(2.0, 6.0), discs=rows[1], axis=(1.0, 0.0))
    return RigidWorld([low, high])


def between_plates(seed: int) -> Packing:
    packing = examples.random_grains(20, WIDTH, seed, PeriodicBox(WIDTH), strain=0.1)
    packing.state[1] *= 6.0 / WIDTH
    return packing


@FEW
@given(st.integers(0, 20), CELLS, st.floats(-40.0, 40.0))
def test_bodies_do_not_care_where_the_cell_begins(
    seed: int, cells: list[int], shift: float
) -> None:
    """Everything shifted by any amount, and every grain put into any image: the same contacts, forces and reactions.

    Coordinates of up to 80 R are rounded to 1e-14 R, which C, up to 200 k, turns into 2e-12 k R a contact, and a dozen
    contacts a body and levers of 20 R into 1e-9.
    """
    packing, world = between_plates(seed), serrated()
    moved = packing.copy()
    moved.state[0] += shift + WIDTH * np.array(cells)
    rows, owner = world.primitives()
    contacts = observables.body_contacts(packing, rows)
    reactions = observables.reactions(contacts, owner, world.placement())
    energy, forces = examples.forces(packing, rows)
    for body in world.bodies:
        body.position = (body.position[0] + shift, body.position[1])
    rows, owner = world.primitives()
    found = observables.body_contacts(moved, rows)
    assert np.array_equal(found.primitive, contacts.primitive)
    assert np.array_equal(found.grain, contacts.grain)
    assert found.overlap == pytest.approx(contacts.overlap, abs=1e-12)
    assert found.x - moved.x[found.grain] == pytest.approx(
        contacts.x - packing.x[contacts.grain], abs=1e-12
    )
    again = observables.reactions(found, owner, world.placement())
    assert np.abs(reactions).max() > 1.0
    assert np.abs(again - reactions).max() < 1e-9
    energy_again, forces_again = examples.forces(moved, rows)
    assert energy_again == pytest.approx(energy, rel=1e-11)
    assert np.abs(forces_again - forces).max() < 1e-10


def drive(
    packing: Packing, world: RigidWorld, targets: dict[str, tuple[float, float]], mu: float
) -> tuple[Quasistatic, list[Increment]]:
    friction = Friction(mu, len(packing)) if mu else None
    engine = Quasistatic(
        System(packing, world, Settings(0.04, 1e-6, max_iterations=30_000), friction)
    )
    done = []
    for _ in range(4):
        engine.begin(targets)
        increment = engine.relax(30_000)
        assert increment is not None
        assert increment.report.reason is StopReason.CONVERGED
        done.append(increment)
    return engine, done


def stacked(shift: float = 0.0, cells: list[int] | None = None) -> Packing:
    """Two hexagonal layers that fill the gap of the serrated plates firmly."""
    x = np.concatenate([np.arange(6) * 2.0, np.arange(6) * 2.0 + 1.0])
    y = np.concatenate([np.full(6, 1.35), np.full(6, 3.1)])
    extra = np.arange(6) * 2.0
    x, y = np.concatenate([x, extra]), np.concatenate([y, np.full(6, 4.75)])
    images = WIDTH * np.array(cells or [0] * 18)[:18]
    return Packing(x + shift + images, y, 1.0, [-0.5, 0.5] * 9, box=PeriodicBox(WIDTH))


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_a_sheared_layer_does_not_care_where_the_cell_begins(mu: float) -> None:
    """Four increments of the upper plate, across the edge of the cell or not; equal to what 1e-6 of tolerance leaves open."""
    cells = np.random.default_rng(3).integers(-2, 3, 18).tolist()
    plain, many = drive(stacked(), serrated(), {"high": (9.0, 6.0)}, mu)
    world = serrated(5.37)
    other, same = drive(stacked(5.37, cells), world, {"high": (9.0, 6.0)}, mu)
    for one, two in zip(many, same, strict=True):
        assert np.abs(one.reactions[:, :2]).max() > 0.5
        assert np.abs(two.reactions[:, :2] - one.reactions[:, :2]).max() < 1e-4
        # Discs shifted inside the bodies: the torque about the same position differs by the lever.
        torque = two.reactions[:, 2] - 5.37 * two.reactions[:, 1]
        assert np.abs(torque - one.reactions[:, 2]).max() < 1e-2
    assert np.abs(other.packing.state[1:] - plain.packing.state[1:]).max() < 1e-5
    if mu:
        assert plain.friction is not None
        assert other.friction is not None
        mine, theirs = plain.friction.remembered(), other.friction.remembered()
        assert set(mine) == set(theirs)
        assert max(abs(v) for v in mine.values()) > 1e-3
        assert max(abs(mine[k] - theirs[k]) for k in mine) < 1e-5


# Cells that change.

CELL = PeriodicBox(11.0, 10.0, 1.3)


def dense(seed: int = 1, count: int = 36) -> Packing:
    """A packing well above jamming in a skewed cell, relaxed."""
    random = np.random.default_rng(seed)
    packing = Packing(
        random.uniform(0.0, CELL.width, count),
        random.uniform(0.0, CELL.height, count),
        random.uniform(0.9, 1.1, count),
        random.choice([-0.6, 0.3, 0.8], count),
        box=CELL,
    )
    settle(packing)
    return packing


def settle(packing: Packing, tolerance: float = 1e-10) -> float:
    relaxation = Relaxation(packing, tolerance=tolerance, max_iterations=200_000)
    report = relaxation.run(200_000)
    assert report.reason is StopReason.CONVERGED
    relaxation.write_back()
    return report.energy


def step_box(packing: Packing, target: PeriodicBox, mu: float = 0.0) -> Quasistatic:
    """One increment towards ``target``, begun and not relaxed."""
    friction = Friction(mu, len(packing)) if mu else None
    engine = Quasistatic(System(packing, RigidWorld(), Settings(0.05, 1e-8), friction))
    engine.begin({}, target)
    return engine


def test_a_step_of_the_cell() -> None:
    """No side changes by more than the step, and all arrive; open directions stay open."""
    engine = step_box(dense(), PeriodicBox(10.98, 12.0, 1.0))
    assert engine.packing.box == PeriodicBox(10.98, 10.05, 1.25)
    bar = Packing([0.0, 3.0, 6.0], [0.0, 0.0, 0.0], box=PeriodicBox(9.0))
    engine = step_box(bar, PeriodicBox(8.0))
    assert engine.packing.box == PeriodicBox(8.95)
    assert engine.packing.x == pytest.approx(np.array([0.0, 3.0, 6.0]) * 8.95 / 9.0)
    assert np.all(engine.packing.y == 0.0)


@pytest.mark.parametrize(
    "target", [(12.0, 10.0, 1.3), (11.0, 9.0, 1.3), (11.0, 10.0, 2.0), (10.0, 11.0, 0.0)]
)
def test_a_cell_changes_affinely(target: tuple[float, float, float]) -> None:
    """Every distance between nearest images changes by the one gradient, wherever the grains' images are stored."""
    packing = dense()
    random = np.random.default_rng(5)
    up = random.integers(-2, 3, len(packing))
    across = random.integers(-2, 3, len(packing))
    before = observables.grain_contacts(packing)
    scattered = packing.copy()
    scattered.state[0] += across * CELL.width + up * CELL.shift
    scattered.state[1] += up * CELL.height
    step_box(scattered, PeriodicBox(*target))
    new = scattered.box
    assert new is not None
    old_cell = np.array([[CELL.width, CELL.shift], [0.0, CELL.height]])
    new_cell = np.array([[new.width, new.shift], [0.0, new.height]])
    gradient = new_cell @ np.linalg.inv(old_cell)
    expected = gradient @ np.array([before.dx, before.dy])
    lattice = np.linalg.inv(new_cell)
    d = np.array(
        [
            scattered.x[before.j] - scattered.x[before.i],
            scattered.y[before.j] - scattered.y[before.i],
        ]
    )
    windings = lattice @ (d - expected)
    assert np.abs(windings - np.rint(windings)).max() < 1e-12


@pytest.mark.parametrize("strain", ["xx", "yy", "xy"])
def test_stress_is_virtual_work(strain: str) -> None:
    """σ A = −dE/dε in equilibrium, by central differences of the relaxed energy.

    At equilibrium the energy does not change to first order as the grains move, so relaxed and affine derivatives agree.
    The truncation error is at most the change of the estimate as the step doubles; the rounding 1e-15 E / step.
    """
    packing = dense()
    stress = observables.stress(observables.grain_contacts(packing), CELL.area)
    assert stress[0, 1] == pytest.approx(stress[1, 0], abs=1e-8)

    def energy(by: float) -> float:
        moved = packing.copy()
        box = {
            "xx": PeriodicBox(CELL.width * (1.0 + by), CELL.height, CELL.shift * (1.0 + by)),
            "yy": PeriodicBox(CELL.width, CELL.height * (1.0 + by), CELL.shift),
            "xy": PeriodicBox(CELL.width, CELL.height, CELL.shift + by * CELL.height),
        }[strain]
        step_box(moved, box)
        assert moved.box == box
        return settle(moved)

    def slope(step: float) -> float:
        return -(energy(step) - energy(-step)) / (2.0 * step)

    k = {"xx": (0, 0), "yy": (1, 1), "xy": (0, 1)}[strain]
    narrow, wide = slope(2e-5), slope(4e-5)
    measured = stress[k] * CELL.area
    assert abs(narrow - measured) <= abs(wide - narrow) + 1e-6 * abs(stress[0, 0]) * CELL.area


def test_uniform_deformation() -> None:
    """One grain a cell of a square lattice, squeezed alike along x and y: the energy of its four half-contacts, exactly."""
    n, spacing = 6, 1.9
    x, y = np.meshgrid(np.arange(n) * spacing, np.arange(n) * spacing)
    packing = Packing(x.ravel(), y.ravel(), 1.0, 0.3, box=PeriodicBox(n * spacing, n * spacing))
    settle(packing)
    engine = step_box(packing, PeriodicBox(n * spacing - 0.05, n * spacing - 0.05))
    increment = engine.relax(50_000)
    assert increment is not None
    pitch = spacing - 0.05 / n
    # By symmetry all stay circles of one radius p: E/N = κ(1+ν)/(4 A0) (p² − 1)² + C (2p − pitch)².
    kappa = 4.0 * 50.0 / (48.0 * (1.0 - 0.3**2))

    def slope(p: float) -> float:
        return kappa * 1.3 * (p * p - 1.0) * p + 4.0 * 50.0 * (2.0 * p - pitch)

    low, high = 0.5, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if slope(middle) < 0.0 else (low, middle)
    expected = n * n * (0.25 * kappa * 1.3 * (low**2 - 1.0) ** 2 + 50.0 * (2.0 * low - pitch) ** 2)
    assert increment.report.energy == pytest.approx(expected, rel=1e-9)
    assert engine.packing.p == pytest.approx(np.full(n * n, low), abs=1e-9)


def test_a_small_cycle_returns() -> None:
    """Without friction and without rearrangement: back at the old cell every grain is back, and so is the energy."""
    packing = dense()
    start = packing.copy()
    energy = settle(packing)
    engine = Quasistatic(
        System(packing, RigidWorld(), Settings(0.002, 1e-9, max_iterations=100_000))
    )
    ways = [PeriodicBox(10.996, 9.998, 1.304), CELL]
    for way in ways:
        for _ in range(3):
            engine.begin({}, way)
            increment = engine.relax(100_000)
            assert increment is not None
    assert increment is not None
    assert engine.packing.box is not None
    assert engine.packing.box.width == pytest.approx(CELL.width, abs=1e-14)
    assert increment.report.energy == pytest.approx(energy, rel=1e-9)
    apart = engine.packing.state - start.state
    apart[:2] -= apart[:2].mean(axis=1, keepdims=True)
    assert np.abs(apart[:, held(start)]).max() < 1e-6


def held(packing: Packing) -> list[int]:
    """Grains with contacts; the others are free."""
    contacts = observables.grain_contacts(packing)
    return sorted({*contacts.i.tolist(), *contacts.j.tolist()})


def test_frictional_contacts_across_the_edge_slip_like_others() -> None:
    """A cell sheared with friction: where grains are stored changes nothing, also not at contacts through the edges.

    The slips are some 6e-4 R, less than where the shapes did not count: grains that go with the cell slip less.
    """
    random = np.random.default_rng(9)
    packing = dense()
    up, across = random.integers(-2, 3, (2, len(packing)))
    scattered = packing.copy()
    scattered.state[0] += across * CELL.width + up * CELL.shift
    scattered.state[1] += up * CELL.height
    memories = []
    for one in (packing, scattered):
        friction = Friction(0.5, len(one))
        engine = Quasistatic(
            System(one, RigidWorld(), Settings(0.02, 1e-8, max_iterations=100_000), friction)
        )
        for _ in range(3):
            engine.begin({}, PeriodicBox(CELL.width + 0.03, CELL.height - 0.03, CELL.shift + 0.05))
            increment = engine.relax(100_000)
            assert increment is not None
            assert increment.report.reason is StopReason.CONVERGED
        memories.append(friction.remembered())
    plain, other = memories
    assert set(plain) == set(other)
    assert max(abs(v) for v in plain.values()) > 5e-4
    assert max(abs(plain[k] - other[k]) for k in plain) < 1e-6


def test_a_cell_that_fails_goes_back() -> None:
    engine = step_box(dense(), PeriodicBox(10.0, 9.0))
    assert engine._relaxation is not None
    engine._relaxation.run(1)
    engine._relaxation._minimizer.state[0, 0] = math.nan
    increment = engine.relax(100)
    assert increment is not None
    assert increment.report.reason is StopReason.NOT_FINITE
    assert engine.packing.box == CELL
    assert np.all(np.isfinite(engine.packing.state))

"""Forces are derivatives of the energy, in both charts; symmetries; Newton's third law; virtual work."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core import observables, reference
from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidBody, RigidWorld
from tests.core import examples

EPSILON = float(np.finfo(np.float64).eps)
STEP = 1e-5  # [R]
FEW = settings(max_examples=15, deadline=None)


def assert_derivative(energy: Callable[[float], float], force: float) -> None:
    """force = −dE/dx, by central differences of width h.

    Their error has two parts. Cut off: h² E'''/6, or, where a contact opens within the step, C h; either is at most
    the change of the estimate when h doubles. Rounding: each energy is good to a few ε E.
    """
    narrow = (energy(-STEP) - energy(STEP)) / (2.0 * STEP)
    wide = (energy(-2.0 * STEP) - energy(2.0 * STEP)) / (4.0 * STEP)
    rounding = 16.0 * EPSILON * abs(energy(0.0)) / STEP
    assert abs(narrow - force) <= abs(wide - narrow) + rounding


@pytest.mark.parametrize("seed", range(3))
def test_smooth_chart(seed: int) -> None:
    packing = examples.random_grains(12, 6.0, seed)
    primitives, _ = examples.bodies().primitives()
    _, forces = examples.forces(packing, primitives)
    for row in range(5):
        for i in range(len(packing)):

            def energy(change: float, row: int = row, i: int = i) -> float:
                moved = packing.copy()
                moved.state[row, i] += change
                return examples.energy(moved, primitives)

            assert_derivative(energy, forces[row, i])


@pytest.mark.parametrize("seed", range(3))
def test_paper_chart(seed: int) -> None:
    """Forces of the twin on x, y, θ, a, b against the energy of the kernels."""
    packing = examples.random_grains(12, 6.0, seed)
    primitives, _ = examples.bodies().primitives()
    _, forces = reference.energy_and_forces(packing, primitives)
    grains = reference.ellipses(packing)
    forces[2] *= [grain.a**2 - grain.b**2 for grain in grains]
    for row, name in enumerate(reference.Ellipse._fields):
        for i, grain in enumerate(grains):

            def energy(
                change: float, name: str = name, i: int = i, grain: reference.Ellipse = grain
            ) -> float:
                g = grain._replace(**{name: getattr(grain, name) + change})
                moved = packing.copy()
                moved.state[:, i] = (
                    g.x,
                    g.y,
                    0.5 * (g.a + g.b),
                    0.5 * (g.a - g.b) * math.cos(2.0 * g.theta),
                    0.5 * (g.a - g.b) * math.sin(2.0 * g.theta),
                )
                return examples.energy(moved, primitives)

            assert_derivative(energy, forces[row, i])


def rotation(angle: float) -> examples.Floats:
    """Matrix (5, 5) that turns a state or its forces: positions by ``angle``, shapes by twice that."""
    matrix = np.eye(5)
    for first, turn in ((0, angle), (3, 2.0 * angle)):
        c, s = math.cos(turn), math.sin(turn)
        matrix[first : first + 2, first : first + 2] = [[c, -s], [s, c]]
    return matrix


def turned(packing: Packing, angle: float) -> Packing:
    twin = packing.copy()
    twin.state[:] = rotation(angle) @ packing.state
    return twin


@FEW
@given(st.floats(-7.0, 7.0), st.integers(0, 5))
def test_rotation(angle: float, seed: int) -> None:
    """The whole scene turned: the same energy, forces turned with it. Rounding as in test_twins."""
    packing = examples.random_grains(15, 7.0, seed)
    world = examples.bodies()
    energy, forces = examples.forces(packing, world.primitives()[0])
    for body in world.bodies:
        (x, y), c, s = body.position, math.cos(angle), math.sin(angle)
        body.position, body.angle = (c * x - s * y, s * x + c * y), body.angle + angle
    energy_after, after = examples.forces(turned(packing, angle), world.primitives()[0])
    assert energy_after == pytest.approx(energy, rel=1e-12)
    assert np.max(np.abs(after - rotation(angle) @ forces)) <= 1e-12 * np.max(np.abs(forces))


@pytest.mark.parametrize("seed", range(4))
def test_mirror(seed: int) -> None:
    """y → −y, so q2 → −q2."""
    mirror = np.diag([1.0, -1.0, 1.0, 1.0, -1.0])
    packing = examples.random_grains(15, 7.0, seed)
    primitives, _ = examples.bodies().primitives()
    energy, forces = examples.forces(packing, primitives)
    packing.state[:] = mirror @ packing.state
    primitives[:, [2, 4, 6]] *= -1.0
    energy_after, after = examples.forces(packing, primitives)
    assert energy_after == pytest.approx(energy, rel=1e-12)
    assert np.max(np.abs(after - mirror @ forces)) <= 1e-12 * np.max(np.abs(forces))


@FEW
@given(st.permutations(range(15)), st.sampled_from(list(examples.BOXES)))
def test_swap_of_grains(order: list[int], box: str) -> None:
    """Grains have no number: another order changes no more than the order of sums."""
    packing = examples.random_grains(15, 7.0, 1, examples.BOXES[box])
    energy, forces = examples.forces(packing)
    swapped = packing.copy()
    swapped.state[:] = packing.state[:, order]
    for name in ("rest_radius", "poisson_ratio", "contact_stiffness", "label"):
        setattr(swapped, name, getattr(packing, name)[order])
    energy_after, after = examples.forces(swapped)
    assert energy_after == pytest.approx(energy, rel=1e-12)
    assert np.max(np.abs(after - forces[:, order])) <= 1e-12 * np.max(np.abs(forces))


@FEW
@given(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0), st.sampled_from(list(examples.BOXES)))
def test_translation(x: float, y: float, box: str) -> None:
    """The whole packing shifted, also across the sides of its box. Coordinates of 60 R instead of 6 R: a digit fewer."""
    packing = examples.random_grains(15, 7.0, 3, examples.BOXES[box])
    energy, forces = examples.forces(packing)
    packing.state[0] += x
    packing.state[1] += y
    energy_after, after = examples.forces(packing)
    assert energy_after == pytest.approx(energy, rel=1e-11)
    assert np.max(np.abs(after - forces)) <= 1e-11 * np.max(np.abs(forces))


@pytest.mark.parametrize("seed", range(6))
def test_third_law(seed: int) -> None:
    """Out of equilibrium too: forces on grains and on bodies cancel, and so do their torques.

    The torque of a grain is the one on its centre and the one that turns its shape, F_θ = (q1 F_q2 − q2 F_q1)·2.
    """
    packing = examples.random_grains(25, 9.0, seed)
    world = examples.bodies()
    primitives, owner = world.primitives()
    _, forces = examples.forces(packing, primitives)
    contacts = observables.body_contacts(packing, primitives)
    placement = world.placement()
    reactions = observables.reactions(contacts, owner, placement)
    fx, fy, _, f1, f2 = forces
    lever = placement[:, 0] * reactions[:, 1] - placement[:, 1] * reactions[:, 0]
    torque = np.sum(packing.x * fy - packing.y * fx + 2.0 * (packing.q1 * f2 - packing.q2 * f1))
    scale = np.max(np.abs(forces)) * len(packing)
    assert abs(fx.sum() + reactions[:, 0].sum()) <= 1e-14 * scale
    assert abs(fy.sum() + reactions[:, 1].sum()) <= 1e-14 * scale
    # Levers are up to 12 R long.
    assert abs(torque + np.sum(reactions[:, 2] + lever)) <= 12e-14 * scale


@pytest.mark.parametrize("box", examples.BOXES.values(), ids=examples.BOXES.keys())
@pytest.mark.parametrize("seed", range(2))
def test_reactions_are_virtual_work(seed: int, box: PeriodicBox | None) -> None:
    """Force and torque on a body = −dE/d(position, angle) with the grains held still, also across periodic sides."""
    world = examples.bodies()
    if box is None:
        packing = examples.random_grains(25, 9.0, seed)
    else:
        packing = examples.random_grains(80, 18.0, seed, box)
        world.remove("floor")
    primitives, owner = world.primitives()
    contacts = observables.body_contacts(packing, primitives)
    measured = observables.reactions(contacts, owner, world.placement())
    assert np.all(np.any(measured != 0.0, axis=1))
    for b in range(len(world.bodies)):
        for k in range(3):

            def energy(change: float, b: int = b, k: int = k) -> float:
                moved = [replace(body) for body in world.bodies]
                placement = world.placement()
                placement[b, k] += change
                shifted = RigidWorld(moved)
                shifted.place(placement)
                return examples.energy(packing, shifted.primitives()[0])

            assert_derivative(energy, measured[b, k])


def test_balance_of_reactions_in_equilibrium() -> None:
    """Five tilted walls around compressed grains: the sum of all forces and torques on the walls vanishes.

    Each is the sum of the residuals of the grains, N of them, times the mean contact force.
    """
    angles = np.arange(5) * 2.0 * math.pi / 5 + 0.2
    corners = [(6.0 * math.cos(t), 6.0 * math.sin(t)) for t in angles]
    walls = [
        RigidBody(f"wall {k}", position=corners[k], segments=[(0.0, 0.0, *side, 0.1)])
        for k in range(5)
        for side in [tuple(np.subtract(corners[(k + 1) % 5], corners[k]))]
    ]
    world = RigidWorld(walls)
    primitives, owner = world.primitives()
    random = np.random.default_rng(4)
    r, t = 4.5 * np.sqrt(random.random(30)), random.uniform(0.0, 2.0 * math.pi, 30)
    nu = random.choice([-0.8, 0.8], 30)
    packing = Packing(r * np.cos(t), r * np.sin(t), 0.9, nu)
    relaxation = Relaxation(packing, primitives, tolerance=1e-8, max_iterations=60_000)
    report = relaxation.run(60_000)
    assert report.reason is StopReason.CONVERGED
    relaxation.write_back()
    contacts = observables.body_contacts(packing, primitives)
    placement = world.placement()
    reactions = observables.reactions(contacts, owner, placement)
    lever = placement[:, 0] * reactions[:, 1] - placement[:, 1] * reactions[:, 0]
    limit = len(packing) * report.residual * report.mean_contact_force
    assert np.abs(reactions[:, :2]).max() > 1e3 * limit
    assert np.abs(reactions[:, :2].sum(axis=0)).max() <= limit
    # A residual force on a centre has a lever of at most 6 R, one on a shape turns it with |q| < 1 R.
    assert abs(np.sum(reactions[:, 2] + lever)) <= 8.0 * limit
    stress = observables.stress(observables.grain_contacts(packing), 1.0, contacts, packing)
    assert abs(stress[0, 1] - stress[1, 0]) <= 4.0 * limit

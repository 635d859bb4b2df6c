"""What is measured on packings, against definitions."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core import observables
from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation, StopReason
from tests.core import examples

STEP = 1e-5


def strained(packing: Packing, xx: float, xy: float, yy: float) -> Packing:
    """Centres and box moved affinely by x += xx x + xy y, y += yy y; shapes as they were."""
    assert packing.box is not None
    twin = packing.copy()
    twin.state[0] += xx * packing.x + xy * packing.y
    twin.state[1] += yy * packing.y
    box = packing.box
    # The image one cell up stands at (shift, height).
    shift = box.shift + xx * box.shift + xy * box.height
    twin.box = PeriodicBox(box.width * (1.0 + xx), box.height * (1.0 + yy), shift)
    return twin


@pytest.mark.parametrize("seed", range(3))
def test_stress_is_work_per_strain(seed: int) -> None:
    """σ_ij = −(1/area) dE/dε_ij at fixed shapes, in any state, also out of equilibrium; compression positive.

    Central differences: cut-off of the order h C, where a contact opens, and rounding 1e-16 E/h.
    """
    packing = examples.random_grains(40, 9.0, seed, PeriodicBox(9.0, 9.5, 1.3))
    assert packing.box is not None
    area = packing.box.area
    measured = observables.stress(observables.grain_contacts(packing), area)

    def work(direction: Callable[[float], Packing]) -> float:
        energy = [examples.energy(direction(h)) for h in (STEP, -STEP)]
        return -(energy[0] - energy[1]) / (2.0 * STEP * area)

    near = 1e-3 * STEP * 200.0 + 1e-6 * abs(measured).max()
    assert measured[0, 0] == pytest.approx(work(lambda h: strained(packing, h, 0.0, 0.0)), abs=near)
    assert measured[1, 1] == pytest.approx(work(lambda h: strained(packing, 0.0, 0.0, h)), abs=near)
    assert measured[0, 1] == pytest.approx(work(lambda h: strained(packing, 0.0, h, 0.0)), abs=near)
    assert observables.pressure(measured) == pytest.approx(0.5 * (measured[0, 0] + measured[1, 1]))


def test_stress_of_one_pair() -> None:
    """Two circles, force f along their branch d: σ = f d n⊗n / area."""
    packing = Packing([0.0, 1.8 * 0.6], [0.0, 1.8 * 0.8], 1.0, 0.0, 50.0)
    stress = observables.stress(observables.grain_contacts(packing), 10.0)
    n = np.array([0.6, 0.8])
    assert stress == pytest.approx(10.0 * 1.8 * np.outer(n, n) / 10.0)


def test_stress_is_symmetric_in_equilibrium_only() -> None:
    """Pair forces are not central, so σ_xy − σ_yx, the torque per area, tests convergence."""
    packing = examples.random_grains(40, 9.0, 0, PeriodicBox(9.0, 9.5))
    assert packing.box is not None
    stress = observables.stress(observables.grain_contacts(packing), packing.box.area)
    assert abs(stress[0, 1] - stress[1, 0]) > 1e-3
    relaxation = Relaxation(packing, tolerance=1e-8, max_iterations=50_000)
    report = relaxation.run(50_000)
    assert report.reason is StopReason.CONVERGED
    relaxation.write_back()
    stress = observables.stress(observables.grain_contacts(packing), packing.box.area)
    # Torque on a shape is 2 (q1 F2 − q2 F1), and |q| < 1 R.
    limit = 4.0 * 40 * report.residual * report.mean_contact_force / packing.box.area
    assert abs(stress[0, 1] - stress[1, 0]) <= limit


def test_wall_forces_enter_the_stress() -> None:
    """A circle between two plates: σ_yy area = force × distance of the plates' faces (less the overlaps)."""
    plates = np.array(
        [[0.0, -3.0, s, 1.0, 0.0, 3.0, s, 0.0] for s in (-0.95, 0.95)], dtype=np.float64
    )
    packing = Packing([0.0], [0.0], 1.0, 0.0, 50.0)
    contacts = observables.body_contacts(packing, plates)
    pairs = observables.grain_contacts(packing)
    stress = observables.stress(pairs, 4.0, contacts, packing)
    # Contact points are those of the grain's outline, 1 R from its centre.
    assert stress == pytest.approx(np.array([[0.0, 0.0], [0.0, 2.5 * 2.0 / 4.0]]))


def hexagon(box: PeriodicBox | None = None) -> Packing:
    """Seven discs that touch: one in the middle, six around."""
    angle = np.arange(6) * math.pi / 3.0
    x, y = 1.99 * np.cos(angle), 1.99 * np.sin(angle)
    return Packing([0.0, *x], [0.0, *y], box=box)


def test_coordination_without_rattlers() -> None:
    """12 contacts of 7 grains, each outer one with three; a grain outside with one contact is a rattler."""
    packing = hexagon()
    z = observables.coordination(packing, observables.grain_contacts(packing))
    assert list(z) == pytest.approx([24.0 / 7.0, 24.0 / 7.0])
    more = Packing([*packing.x, 1.99 * 2.0, 20.0], [*packing.y, 0.0, 20.0])
    z = observables.coordination(more, observables.grain_contacts(more))
    assert list(z) == pytest.approx([26.0 / 9.0, 24.0 / 7.0])


def test_rattlers_fall_one_after_another() -> None:
    """A chain has no backbone at all: its ends are loose, and then the next ones."""
    chain = Packing(1.99 * np.arange(6.0), np.zeros(6))
    everyone, backbone = observables.coordination(chain, observables.grain_contacts(chain))
    assert everyone == pytest.approx(10.0 / 6.0)
    assert backbone == 0.0


def test_coordination_with_walls() -> None:
    """A grain held by three walls: three contacts, none of them shared."""
    corner = np.array(
        [
            [0.0, -9.0, -0.99, 1.0, 0.0, 9.0, -0.99, 0.0],
            [0.0, -0.99, -9.0, 0.0, 1.0, -0.99, 9.0, 0.0],
            [0.0, 0.99, -9.0, 0.0, 1.0, 0.99, 9.0, 0.0],
        ]
    )
    packing = Packing([0.0], [0.0])
    bodies = observables.body_contacts(packing, corner)
    pairs = observables.grain_contacts(packing)
    assert observables.coordination(packing, pairs, bodies) == (3.0, 3.0)
    assert observables.coordination(packing, pairs) == (0.0, 0.0)


def test_nothing_to_measure() -> None:
    packing = Packing([], [])
    contacts = observables.grain_contacts(packing)
    bodies = observables.body_contacts(packing, examples.bodies().primitives()[0])
    assert len(contacts.i) == len(bodies.grain) == 0
    assert observables.coordination(packing, contacts) == (0.0, 0.0)
    assert np.array_equal(observables.stress(contacts, 1.0, bodies, packing), np.zeros((2, 2)))
    placement = np.zeros((2, 3))
    owner = np.zeros(len(examples.bodies().primitives()[0]), dtype=np.int64)
    assert np.array_equal(observables.reactions(bodies, owner, placement), placement)


def test_packing_fraction() -> None:
    packing = Packing([0.0, 5.0], [0.0, 0.0], [1.0, 2.0])
    packing.state[2] = 9.0
    assert observables.packing_fraction(packing, 10.0) == pytest.approx(5.0 * math.pi / 10.0)


def test_force_drops() -> None:
    """Each unbroken fall is one drop."""
    force = [0.0, 1.0, 3.0, 2.5, 2.0, 2.0, 1.0, 4.0, 5.0, 4.5]
    assert observables.force_drops(np.array(force)) == pytest.approx([1.0, 1.0, 0.5])
    for nothing in ([], [1.0], [1.0, 1.0], [1.0, 2.0]):
        assert observables.force_drops(np.array(nothing)).size == 0


@given(st.lists(st.floats(-100.0, 100.0), max_size=40))
def test_rises_less_drops_is_the_way(force: list[float]) -> None:
    """Sum of rises − sum of drops = last − first."""
    curve = np.array(force)
    drops = observables.force_drops(curve)
    rises = observables.force_drops(-curve)
    assert np.all(drops > 0.0)
    if curve.size:
        assert rises.sum() - drops.sum() == pytest.approx(curve[-1] - curve[0], abs=1e-9)


def test_pressure_in_one_squeezed_grain() -> None:
    """A circle between two others, pushed with F: p = F/(πR), difference of the principal stresses 2F/(πR)."""
    radius = 1.3
    packing = Packing([0.0, 2.5, 5.0], [1.0, 1.0, 1.0], rest_radius=radius)
    pairs = observables.grain_contacts(packing)
    none = np.zeros((0, 8))
    bodies = observables.body_contacts(packing, none)
    pressure, along, across = observables.grain_stress(packing, pairs, bodies, none)
    force = float(packing.contact_stiffness[0]) * (2.0 * radius - 2.5)
    assert pressure[1] == pytest.approx(force / (math.pi * radius))
    assert along[1] == pytest.approx(force / (math.pi * radius))
    assert across == pytest.approx(np.zeros(3))
    assert pressure[0] == pytest.approx(0.5 * pressure[1])


@pytest.mark.parametrize("seed", range(3))
def test_pressure_in_grains_is_work_per_growth(seed: int) -> None:
    """Σ p_i A_i = dE/d ln λ / 2 when all shapes grow by λ about centres that stay: among grains and among bodies."""
    packing = examples.random_grains(40, 9.0, seed)
    world = examples.bodies()
    primitives = world.primitives()[0]
    pressure = observables.grain_stress(
        packing,
        observables.grain_contacts(packing),
        observables.body_contacts(packing, primitives),
        primitives,
    )[0]
    p, q1, q2 = packing.state[2:]
    total = float(np.sum(pressure * np.pi * (p * p - q1 * q1 - q2 * q2)))

    def energy(growth: float) -> float:
        """Of the contacts alone: what the grains store themselves is left out."""
        grown = packing.copy()
        grown.state[2:] *= growth
        pairs = observables.grain_contacts(grown)
        bodies = observables.body_contacts(grown, primitives)
        return 0.5 * float(
            np.sum(pairs.normal_force * pairs.overlap)
            + np.sum(bodies.normal_force * bodies.overlap)
        )

    work = (energy(1.0 + STEP) - energy(1.0 - STEP)) / (2.0 * STEP)
    assert total > 0.0
    assert total == pytest.approx(0.5 * work, rel=1e-4)


def test_branches_to_bodies_need_the_packing() -> None:
    packing = examples.random_grains(5, 6.0, 1)
    contacts = observables.grain_contacts(packing)
    bodies = observables.body_contacts(packing, np.zeros((0, 8)))
    assert np.all(np.isfinite(observables.stress(contacts, 30.0, bodies, packing)))
    with pytest.raises(ValueError, match="need the packing"):
        observables.stress(contacts, 30.0, bodies)

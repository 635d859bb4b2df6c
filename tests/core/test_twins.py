"""Every kernel against its slow twin, which is written from the equations in another chart.

Tolerance: an overlap of some 0.1 R is a difference of lengths of some R, each rounded to 2e-16 of
itself, and a force adds up a few dozen of them: a relative error of 1e-14 of the largest force is
to be expected, 1e-12 leaves two digits for unlucky packings, and no wrong formula comes that close.
"""

from __future__ import annotations

import numpy as np
import pytest

from core import observables, reference
from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation, StopReason
from core.rigid_contacts import DISC, EDGE, VERTEX
from tests.core import examples

RELATIVE = 1e-12


def assert_twins(packing: Packing, primitives: examples.Floats | None = None) -> None:
    energy, forces = examples.forces(packing, primitives)
    expected_energy, in_paper_chart = reference.energy_and_forces(packing, primitives)
    expected = reference.to_smooth_chart(packing, in_paper_chart)
    assert energy == pytest.approx(expected_energy, rel=RELATIVE)
    assert np.max(np.abs(forces - expected)) <= RELATIVE * np.max(np.abs(expected))


@pytest.mark.parametrize("box", examples.BOXES.values(), ids=examples.BOXES.keys())
@pytest.mark.parametrize("seed", range(3))
def test_grains(box: PeriodicBox | None, seed: int) -> None:
    assert_twins(examples.random_grains(40, 9.0, seed, box))


@pytest.mark.parametrize("seed", range(12))
def test_grains_among_bodies(seed: int) -> None:
    packing = examples.random_grains(20, 9.0, seed)
    assert_twins(packing, examples.bodies().primitives()[0])


@pytest.mark.parametrize("box", examples.BOXES.values(), ids=examples.BOXES.keys())
def test_grains_among_bodies_in_a_box(box: PeriodicBox | None) -> None:
    """Grains anywhere, many of them in other cells than the bodies."""
    packing = examples.random_grains(100, 20.0, 1, box)
    world = examples.bodies()
    world.remove("floor")
    primitives, _ = world.primitives()
    assert_twins(packing, primitives)
    touching = observables.body_contacts(packing, primitives)
    assert len(touching.grain) > 3
    if box is not None:
        assert np.any(np.hypot(packing.x - 4.0, packing.y - 4.0)[touching.grain] > 8.0)


def test_the_examples_touch_every_kind_of_primitive() -> None:
    primitives, _ = examples.bodies().primitives()
    met: set[float] = set()
    for seed in range(12):
        packing = examples.random_grains(20, 9.0, seed)
        met |= set(primitives[observables.body_contacts(packing, primitives).primitive, 0])
    assert met == {EDGE, VERTEX, DISC}


def test_circles_at_rest() -> None:
    """Where the paper's chart is singular."""
    packing = Packing([0.0, 1.9, 2.0], [0.0, 0.1, 1.7], 1.0, [-0.8, 0.0, 0.8])
    assert_twins(packing, examples.bodies().primitives()[0])


def test_one_grain() -> None:
    assert_twins(examples.random_grains(1, 1.0, 5))


def test_circles_are_soft_discs() -> None:
    """Two circles of one stiffness: E = C Δ²/2, F = C Δ along the line of centres, F_p = −C Δ."""
    packing = Packing([0.0, 1.8], [0.0, 0.0], 1.0, 0.3, 50.0)
    energy, forces = examples.forces(packing)
    assert energy == pytest.approx(50.0 * 0.2**2 / 2.0, rel=1e-14)
    expected = np.array([[-10.0, 10.0], [0.0, 0.0], [-10.0, -10.0], [-10.0, -10.0], [0.0, 0.0]])
    assert forces == pytest.approx(expected, abs=1e-13)


def test_unlike_grains_are_half_springs_in_series() -> None:
    """Each half of the contact has twice its grain's C: 1/C_ij = (1/C_i + 1/C_j)/2."""
    packing = Packing([0.0, 1.8], [0.0, 0.0], 1.0, 0.0, [10.0, 90.0])
    assert examples.energy(packing) == pytest.approx(18.0 * 0.2**2 / 2.0, rel=1e-14)


@pytest.mark.parametrize("seed", range(4))
def test_measured_contacts(seed: int) -> None:
    """What is measured on a packing is what acts in it."""
    packing = examples.random_grains(30, 9.0, seed, examples.BOXES["sheared"])
    grains = reference.ellipses(packing)
    contacts = observables.grain_contacts(packing)
    found = set()
    for k in range(len(contacts.i)):
        i, j = int(contacts.i[k]), int(contacts.j[k])
        twin = reference.grain_contact(packing, grains, i, j)
        assert twin is not None
        assert (contacts.fx[k], contacts.fy[k]) == pytest.approx(twin.force, rel=1e-9, abs=1e-11)
        assert contacts.overlap[k] == pytest.approx(twin.overlap, abs=1e-14)
        assert contacts.normal_force[k] == pytest.approx(twin.normal_force, abs=1e-12)
        r = np.hypot(contacts.dx[k], contacts.dy[k])
        assert (-contacts.dx[k] / r, -contacts.dy[k] / r) == pytest.approx(twin.n, abs=1e-14)
        found.add((min(i, j), max(i, j)))
    near = reference.near_pairs(packing, 0.0)
    assert found == {p for p in near if reference.grain_contact(packing, grains, *p) is not None}


@pytest.mark.parametrize("box", examples.BOXES.values(), ids=examples.BOXES.keys())
def test_measured_reactions(box: PeriodicBox | None) -> None:
    packing = examples.random_grains(60, 18.0, 0, box)
    primitives, _ = examples.bodies().primitives()
    contacts = observables.body_contacts(packing, primitives)
    owner = np.arange(len(primitives))
    measured = observables.reactions(contacts, owner, np.zeros((len(primitives), 3)))
    expected = reference.reactions(packing, primitives)
    assert np.max(np.abs(measured - expected)) <= RELATIVE * np.max(np.abs(expected))


@pytest.mark.parametrize("row", range(5))
@pytest.mark.parametrize("with_bodies", [False, True])
def test_nan_stays_nan(row: int, with_bodies: bool) -> None:
    """One bad number anywhere in a packing is reported, never computed away."""
    packing = examples.random_grains(12, 5.0, 2)
    packing.state[row, 7] = np.nan
    primitives = examples.bodies().primitives()[0] if with_bodies else None
    report = Relaxation(packing, primitives).run(100)
    assert report.reason is StopReason.NOT_FINITE
    assert np.isnan(report.residual)


@pytest.mark.parametrize("row", range(5))
def test_nan_passes_through_the_kernels(row: int) -> None:
    """A grain that turns nan after the lists were built spoils the sums that it has a part in."""
    relaxation = Relaxation(examples.random_grains(12, 5.0, 2))
    relaxation.run(1)
    relaxation._minimizer.state[row, 3] = np.nan
    report = relaxation.run(1)
    assert report.reason is StopReason.NOT_FINITE
    assert np.isnan(report.energy)
    assert np.isnan(relaxation._minimizer.force[:, 3]).any()

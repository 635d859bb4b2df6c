"""Physics that holds for any packing: it only relaxes downhill, and does not care about places, names, units or directions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core import observables
from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation, Report, StopReason
from core.rigid import RigidWorld
from sandbox.studies.stability import rigs
from sandbox.studies.stability.watch import Watch

BOUNDED = settings(max_examples=25, deadline=None, derandomize=True)
SIDE = 9.0


@st.composite
def packings(draw: st.DrawFn) -> Packing:
    """Few to many grains of any material, anywhere in a periodic cell, of any shape."""
    count = draw(st.integers(1, 30))
    random = np.random.default_rng(draw(st.integers(0, 2**32)))
    most = draw(st.sampled_from([0.0, 0.8, 0.99, 0.9999]))
    stiffness = draw(st.sampled_from([2.5, 10.0, 50.0, 1e3]))
    smallest = draw(st.sampled_from([0.1, 0.7, 1.0]))
    strain = draw(st.sampled_from([0.0, 0.3, 0.8]))
    radius = random.uniform(smallest, 1.0, count)
    x, y = random.uniform(-SIDE, 2.0 * SIDE, (2, count))
    packing = Packing(
        x,
        y,
        radius,
        random.uniform(-most, most, count),
        stiffness,
        box=PeriodicBox(SIDE, SIDE, draw(st.sampled_from([0.0, 2.3, -31.7]))),
    )
    a, b = radius * (1.0 + strain * random.uniform(-1.0, 0.5, (2, count)))
    packing.set_axes(a, b, random.uniform(-4.0, 4.0, count))
    return packing


def relaxed(packing: Packing, tolerance: float = 1e-4) -> tuple[Relaxation, Report]:
    relaxation = Relaxation(packing, tolerance=tolerance, max_iterations=20_000)
    report = relaxation.run(20_000)
    relaxation.write_back()
    return relaxation, report


def energy(packing: Packing) -> float:
    """As it stands [k R²]."""
    return Relaxation(packing).run(1).energy


@BOUNDED
@given(packings(), st.sampled_from([0.0, 0.5]))
def test_relaxing_never_gains_energy_and_ends_in_balance(packing: Packing, friction: float) -> None:
    watch = Watch(60.0)
    solver = rigs.settings(step=0.02, tolerance=1e-3, max_iterations=20_000)
    engine = rigs.engine(packing, RigidWorld(), friction=friction, solver=solver)
    watch.step(engine)
    box = packing.box
    assert box is not None
    watch.step(engine, box=PeriodicBox(box.width - 0.02, box.height - 0.02, box.shift))
    assert not watch.broken, watch.broken
    assert watch.reasons[StopReason.NOT_FINITE] == 0


@BOUNDED
@given(packings(), st.integers(0, 2**32))
def test_energy_and_forces_know_no_order_no_place_and_no_side(packing: Packing, seed: int) -> None:
    before = energy(packing)
    random = np.random.default_rng(seed)
    order = random.permutation(len(packing))
    shuffled = packing.copy()
    for name in ("rest_radius", "poisson_ratio", "contact_stiffness", "label"):
        setattr(shuffled, name, getattr(packing, name)[order])
    shuffled.state = np.ascontiguousarray(packing.state[:, order])
    assert energy(shuffled) == pytest.approx(before, rel=1e-9)
    moved = packing.copy()
    moved.state[:2] += random.uniform(-5.0, 5.0, (2, 1))
    assert energy(moved) == pytest.approx(before, rel=1e-7, abs=1e-9)
    # Mirrored in a vertical line, the cell shears the other way.
    mirrored = packing.copy()
    mirrored.state[[0, 4]] *= -1.0
    assert packing.box is not None
    mirrored.box = PeriodicBox(SIDE, SIDE, -packing.box.shift)
    assert energy(mirrored) == pytest.approx(before, rel=1e-7, abs=1e-9)


@BOUNDED
@given(packings(), st.sampled_from([0.25, 4.0, 1024.0]))
def test_energy_goes_with_the_square_of_the_unit(packing: Packing, unit: float) -> None:
    twin = packing.copy()
    twin.state = packing.state * unit
    twin.rest_radius = packing.rest_radius * unit
    assert packing.box is not None
    twin.box = PeriodicBox(SIDE * unit, SIDE * unit, packing.box.shift * unit)
    assert energy(twin) == pytest.approx(energy(packing) * unit**2, rel=1e-12)


@BOUNDED
@given(packings())
def test_stress_is_symmetric_and_forces_add_up_where_it_converged(packing: Packing) -> None:
    relaxation, report = relaxed(packing)
    total = relaxation.forces()[:2].sum(axis=1)
    contacts = observables.grain_contacts(packing)
    magnitude = float(np.abs(contacts.normal_force).sum()) + 1.0
    assert np.abs(total).max() <= 1e-9 * magnitude
    if report.reason is not StopReason.CONVERGED:
        return
    left = report.residual * report.mean_contact_force
    tensor = observables.stress(contacts, 1.0)
    turn = 2.0 * math.sqrt(2.0) * float(np.hypot(packing.q1, packing.q2).sum())
    assert abs(tensor[0, 1] - tensor[1, 0]) <= turn * left + 1e-9 * magnitude

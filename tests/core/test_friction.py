"""The friction of one increment: against its slow twin, as motion of material points, its balances, laws and symmetries."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from core import fire, observables, reference
from core.errors import InputError
from core.friction import Friction
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.system import System
from tests.core import reference_friction
from tests.core.friction_examples import (
    CAREFUL,
    EPSILON,
    FEW,
    MU,
    RELATIVE,
    Case,
    Floats,
    box_of_grains,
    case,
    rotation,
    rubbing,
    stretch,
    wander,
)


def assert_twins(made: Case) -> list[reference_friction.Tangential]:
    """Compare all forces and the energy; the contacts."""
    whole = made.relaxation()
    energy, forces = rubbing(whole, made.relaxation(friction=False))
    before = made.twin()
    made.world.place(made.place)
    rows = made.world.primitives()[0]
    twin = (made.packing, made.turned, rows, before)
    expected_energy, in_paper_chart, torque = reference_friction.friction_energy_and_forces(*twin)
    expected = np.vstack([reference.to_smooth_chart(made.packing, in_paper_chart), torque])
    assert np.max(np.abs(forces - expected)) <= RELATIVE * np.max(np.abs(whole.forces()))
    assert energy == pytest.approx(expected_energy, abs=RELATIVE * whole.report().energy)
    return reference_friction.frictional_contacts(*twin)


CELLS = {
    "open": None,
    "periodic": PeriodicBox(9.0, 9.5),
    "sheared": PeriodicBox(9.0, 9.5, 2.3),
    "periodic in x": PeriodicBox(9.0),
}


@pytest.mark.parametrize("size", [0.0, 0.003, 0.3])
@pytest.mark.parametrize("seed", range(4))
def test_twin(seed: int, size: float) -> None:
    """Nearly all contacts stick at 0.003 R, a third slides at 0.3 R; there some were open before, and some have opened since."""
    made = case(seed, size, move=max(size, 0.02))
    contacts = assert_twins(made)
    sliding = np.mean([one.sliding for one in contacts])
    known = set(made.friction.remembered())
    assert sliding < 0.1 if size < 0.1 else 0.2 < sliding < 0.8
    if size > 0.1:
        assert any(one.gap > 0.0 for one in contacts)
        assert known - {one.labels for one in contacts}


@pytest.mark.parametrize("box", CELLS.values(), ids=CELLS.keys())
@pytest.mark.parametrize("seed", range(3))
def test_twin_in_a_cell(seed: int, box: PeriodicBox | None) -> None:
    """Bodies among grains of a cell, whose contacts reach through its edges."""
    contacts = assert_twins(case(seed, 0.02, box))
    assert {one.j >= 0 for one in contacts} == {True, False}


def test_twin_where_a_cell_changes() -> None:
    """Sides and shift of the cell change, and the grains go with them: the way counts that the touched image has gone."""
    made = case(2, 0.01, PeriodicBox(9.0, 9.5, 2.3), bodies=False)
    made.packing.state[:2] = made.before.state[:2] * np.array([[9.1 / 9.0], [9.45 / 9.5]])
    made.packing.state[0] += 0.15 * made.before.state[1] / 9.5
    made.packing.box = PeriodicBox(9.1, 9.45, 2.45)
    assert_twins(made)


def lone_pair(other: str, seed: int) -> Case:
    """A strained, turned grain that sticks to another, to the end or the side of a plate, or to a disc."""
    random = np.random.default_rng(seed)
    world = RigidWorld()
    if other != "grain":
        shapes = {
            "edge": RigidBody("body", segments=[(-5.0, 0.0, 5.0, 0.0, 0.2)]),
            "vertex": RigidBody("body", segments=[(0.1, 0.0, 0.1, -5.0, 0.2)]),
            "disc": RigidBody("body", discs=[(0.2, -0.6, 0.8)]),
        }
        world = RigidWorld([shapes[other]])
    packing = Packing([0.0, 0.5], [1.0, -0.75 if other == "grain" else 50.0], 1.0, 0.3, 50.0)
    a, b = random.uniform(0.95, 1.2, (2, 2))
    packing.set_axes(a, b, random.uniform(-2.0, 2.0, 2))
    moved, turned = wander(packing, seed, 1e-3)
    placed = world.placement()
    return Case(packing, world, placed, Friction(10.0, 2), moved, turned, placed + 1e-3)


@pytest.mark.parametrize("other", ["grain", "edge", "vertex", "disc"])
@pytest.mark.parametrize("seed", range(3))
def test_friction_does_work_where_material_points_pass_each_other(other: str, seed: int) -> None:
    """The generalised forces times any velocities are −f times t·(v_i − v_j) of the material points that touch, by differences.

    A material point X of a grain is at x + U R(φ) X. Between grains the force acts half way between the outlines: on an arm of
    Δ/2 from there, which turns with the material. The differences are good to 1e-9 of velocities of 1 R.
    """
    made = lone_pair(other, seed)
    _, forces = made.forces()
    (contact,) = made.contacts()
    n = np.array(contact.n)
    t = np.array([-n[1], n[0]])
    pull = float(-forces[:2, 0] @ t)
    assert abs(pull) > 1e-4
    assert np.abs(forces[:2, 0] + pull * t).max() < 1e-12
    state = np.vstack([made.packing.state, made.turned])
    # The twin's overlap is that of its cap.
    arm = 0.5 * contact.cap / (10.0 * 50.0) if other == "grain" else 0.0

    def point(now: Floats, k: int, outwards: Floats) -> Floats:
        back = rotation(-state[5, k])
        e = stretch(state[2:5, k]) @ outwards
        material = back @ (e / np.hypot(*e))
        where = now[:2, k] + stretch(now[2:5, k]) @ rotation(now[5, k]) @ material
        return np.array(where - arm * rotation(now[5, k]) @ back @ outwards)

    random = np.random.default_rng(seed)
    h = 1e-5

    def apart(now: Floats) -> Floats:
        mine = point(now, 0, n)
        return mine - point(now, 1, -n) if other == "grain" else mine

    for _ in range(20):
        velocity = random.uniform(-1.0, 1.0, (6, 2))
        passing = float(t @ (apart(state + h * velocity) - apart(state - h * velocity))) / (2.0 * h)
        counted = velocity if other == "grain" else velocity[:, :1]
        work = float(np.sum(forces[:, : counted.shape[1]] * counted))
        assert work == pytest.approx(-pull * passing, abs=1e-8 * abs(pull))


@pytest.mark.parametrize("box", [None, PeriodicBox(9.0, 9.5, 2.3)], ids=["open", "periodic"])
@pytest.mark.parametrize("seed", range(3))
def test_forces_add_up_to_nothing(seed: int, box: PeriodicBox | None) -> None:
    made = case(seed, 0.1, box, bodies=False)
    whole = made.relaxation().forces()
    assert np.abs(whole[:2].sum(axis=1)).max() <= 200 * EPSILON * np.abs(whole).max()


@given(st.integers(0, 30), st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
@FEW
def test_third_law(seed: int, x: float, y: float) -> None:
    """Forces, torques on spins and on shapes, and reactions of the bodies, about any point: all add up to nothing.

    What friction does to a spin alone is not f times a lever from the centre: the shape takes its part.
    """
    made = case(seed)
    whole = made.relaxation()
    _, (fx, fy, _, on_q1, on_q2, torque) = rubbing(whole, made.relaxation(friction=False))
    packing = made.packing
    on_shapes = 2.0 * (packing.q1 * on_q2 - packing.q2 * on_q1)
    _, owner = made.world.primitives()
    on_bodies = whole.slips()[2].reactions(owner, made.place)
    lever_x, lever_y = made.place[:, 0] - x, made.place[:, 1] - y
    balance = [
        fx.sum() + on_bodies[:, 0].sum(),
        fy.sum() + on_bodies[:, 1].sum(),
        np.sum((packing.x - x) * fy - (packing.y - y) * fx + torque + on_shapes)
        + np.sum(lever_x * on_bodies[:, 1] - lever_y * on_bodies[:, 0] + on_bodies[:, 2]),
    ]
    assert np.abs(on_bodies).max() > 0.1
    scale = np.abs(whole.forces()).max() * 40.0  # longest lever
    assert np.abs(balance).max() <= 100 * EPSILON * scale


def test_stress_counts_friction() -> None:
    """In equilibrium Σ_c F_i d_j over all contacts is symmetric, and is what the bodies' forces at their places make of it.

    That follows from Σ_c F = 0 and Σ_c (torque) = 0 on every grain, for spins and shapes each on their own. All is balanced to
    1e-9 of forces of 1 k R.
    """
    packing, world = box_of_grains()
    settings = Settings(0.05, 1e-9, force_floor=1e-6, max_iterations=50_000)
    engine = Quasistatic(System(packing, world, settings, Friction(MU, len(packing))))
    for k in range(8):
        engine.begin({"plate": (min(0.05 * k, 0.2), world["plate"].position[1])})
        increment = engine.relax(50_000)
        assert increment is not None
        assert increment.report.reason is StopReason.CONVERGED
    assert increment is not None
    friction, bodies = increment.friction, increment.body_contacts
    assert friction is not None
    bare = observables.stress(increment.grain_contacts, 1.0, bodies, packing)
    whole = bare + friction.stress(1.0, bodies=True)
    assert abs(whole[0, 1] - whole[1, 0]) < 1e-6
    assert np.abs(friction.stress(1.0)).max() > 1e-2
    outside = friction.j < 0
    expected = -np.array(
        [
            [
                np.sum(f * bodies.x) + np.sum(g * friction.x[outside]),
                np.sum(f * bodies.y) + np.sum(g * friction.y[outside]),
            ]
            for f, g in ((bodies.fx, friction.fx[outside]), (bodies.fy, friction.fy[outside]))
        ]
    )
    assert whole == pytest.approx(expected, abs=1e-6)
    inner = observables.stress(increment.grain_contacts, 1.0) + friction.stress(1.0)
    assert np.abs(inner - whole).max() > 0.1


def same_after(made: Case, change: str) -> tuple[Case, Floats]:
    """The case under a symmetry, and how its forces (6, N) transform, (6, 6)."""
    transform, parity, angle = np.eye(6), 1.0, 0.7
    if change == "mirror":
        parity = -1.0
        transform = np.diag([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0])
    else:
        transform[:2, :2], transform[3:5, 3:5] = rotation(angle), rotation(2.0 * angle)
    before, packing = made.before.copy(), made.packing.copy()
    for grains in (before, packing):
        grains.state[:] = transform[:5, :5] @ grains.state
    friction = made.friction.copy()
    friction._slips = parity * friction._slips
    turned = parity * made.turned
    other = Case(before, made.world, made.placed, friction, packing, turned, made.place)
    return other, transform


@pytest.mark.parametrize("change", ["mirror", "rotation"])
@pytest.mark.parametrize("size", [0.003, 0.3])
def test_symmetries(change: str, size: float) -> None:
    made = case(2, size, bodies=False)
    other, transform = same_after(made, change)
    _, forces = made.forces()
    _, transformed = other.forces()
    assert np.abs(forces).max() > 1.0
    scale = np.abs(made.relaxation().forces()).max()
    assert np.abs(transformed - transform @ forces).max() <= RELATIVE * scale


def permuted(packing: Packing, order: NDArray[np.int64]) -> Packing:
    twin = packing.copy()
    twin.state = np.ascontiguousarray(packing.state[:, order])
    for name in ("rest_radius", "poisson_ratio", "contact_stiffness", "label"):
        setattr(twin, name, getattr(packing, name)[order])
    return twin


def test_permutation() -> None:
    """Grains in another order find their memories by their labels."""
    made = case(4)
    order = np.random.default_rng(0).permutation(20)
    other = replace(
        made,
        before=permuted(made.before, order),
        packing=permuted(made.packing, order),
        turned=made.turned[order],
        friction=made.friction.copy(),
    )
    _, forces = made.forces()
    _, shuffled = other.forces()
    scale = np.abs(made.relaxation().forces()).max()
    assert np.abs(shuffled - forces[:, order]).max() <= RELATIVE * scale


@FEW
@example(690, 0.2141552856248463)  # an overlap of 2e-4 R
@given(st.integers(0, 1000), st.floats(0.0, 0.3))
def test_never_beyond_the_cap(seed: int, size: float) -> None:
    """Against normal forces that are measured on the packing, not taken from the kernel."""
    made = case(seed % 20, size, move=size)
    forces = made.relaxation().slips()[2]
    made.world.place(made.place)
    pairs = observables.grain_contacts(made.packing)
    bodies = observables.body_contacts(made.packing, made.world.primitives()[0])
    assert len(forces.i) == len(pairs.i) + len(bodies.grain)
    # An overlap is what is left of lengths of some R: the smaller it is, the more of it is their rounding.
    rounding = 32.0 * np.finfo(np.float64).eps / min(*pairs.overlap, *bodies.overlap)
    assert forces.beyond_cone(MU / 1.05 * (1.0 + rounding), len(made.packing), pairs, bodies) == 0.0
    if forces.sliding.any():
        assert forces.beyond_cone(MU / 1.05 * (1.0 - 1e-9), len(made.packing), pairs, bodies) > 0.0


def test_off_leaves_no_trace() -> None:
    """No spin, no arrays, and kernels without the term."""
    packing, world = box_of_grains()
    engine = Quasistatic(System(packing, world, CAREFUL))
    engine.begin({"plate": (0.05, world["plate"].position[1])})
    relaxation = engine._relaxation
    assert relaxation is not None
    engine.relax(20_000)
    assert relaxation._contacts is None
    assert relaxation.friction_terms is None
    for array in relaxation._minimizer[:5]:
        assert array.shape[0] == (3 if array is relaxation._minimizer.support else 5)
    for signature in fire.run.signatures:
        box_type, rigid_type, friction_type = map(str, signature[1:4])
        minimizer = str(signature[0])
        assert "FrictionTerms" not in minimizer + box_type + rigid_type
        assert friction_type == "none" or "FrictionTerms" in friction_type
    assert any(str(signature[3]) == "none" for signature in fire.run.signatures)


@pytest.mark.parametrize("coefficient", [0.0, -0.5, math.nan, math.inf])
def test_impossible_coefficients(coefficient: float) -> None:
    with pytest.raises(InputError, match="greater than 0") as error:
        Friction(coefficient, 3)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("row", range(6))
def test_nan_is_found(row: int) -> None:
    """Also through the bounds of the force, which would turn it into the cap."""
    made = case(3)
    relaxation = made.relaxation()
    grain = relaxation.slips()[2].i[0]
    (place,) = np.flatnonzero(relaxation._minimizer.identity == grain)
    relaxation._minimizer.state[row, place] = np.nan
    assert relaxation.run(1).reason is StopReason.NOT_FINITE


@pytest.mark.parametrize("count", [0, 1])
def test_no_contacts(count: int) -> None:
    packing = Packing(np.zeros(count), np.zeros(count))
    world = RigidWorld([RigidBody("far", position=(50.0, 0.0), discs=[(0.0, 0.0, 1.0)], held=True)])
    engine = Quasistatic(System(packing, world, CAREFUL, Friction(MU, count)))
    engine.begin({"far": (49.0, 0.0)})
    increment = engine.relax(100)
    assert increment is not None
    assert increment.report.reason is StopReason.CONVERGED
    assert engine.friction is not None
    assert engine.friction.remembered() == {}

"""The friction of one increment: against its slow twin, as motion of material points, its laws and symmetries, and its memory."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from core import fire, observables, reference
from core.errors import InputError
from core.friction import Friction
from core.frictional_contacts import BODY, GRAIN, FrictionForces
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.slip import TANGENTIAL_STIFFNESS
from core.system import System
from tests.core import examples, reference_friction

Floats = examples.Floats
EPSILON = float(np.finfo(np.float64).eps)
RELATIVE = 1e-12  # where it comes from: see test_twins.py
MU = 0.4
FEW = settings(max_examples=15, deadline=None)


@dataclass
class Case:
    """Where slips are counted from, and where grains and bodies are now."""

    before: Packing
    world: RigidWorld
    placed: Floats  # of the bodies, before
    friction: Friction
    packing: Packing
    turned: Floats
    place: Floats

    def relaxation(self, *, friction: bool = True, skin: float = 0.3) -> Relaxation:
        """One that has looked at the forces once."""
        self.world.place(self.placed)
        rows, owner = self.world.primitives()
        origin = self.friction.begin(self.before, rows, owner, self.placed, self.place)
        self.world.place(self.place)
        rows = self.world.primitives()[0]
        relaxation = Relaxation(self.packing, rows, origin if friction else None, skin=skin)
        if friction:
            relaxation._minimizer.state[5] = self.turned
        relaxation.run(1)
        return relaxation

    def forces(self) -> tuple[float, Floats]:
        """Energy [k R²] and forces (6, N) of friction alone."""
        return rubbing(self.relaxation(), self.relaxation(friction=False))

    def twin(self) -> reference_friction.Before:
        self.world.place(self.placed)
        rows, owner = self.world.primitives()
        return reference_friction.Before(
            self.before,
            self.friction.remembered(),
            self.friction.coefficient,
            rows,
            (self.place - self.placed)[owner, 2],
        )

    def contacts(self) -> list[reference_friction.Tangential]:
        """As the twin has them."""
        before = self.twin()
        self.world.place(self.place)
        rows = self.world.primitives()[0]
        return reference_friction.frictional_contacts(self.packing, self.turned, rows, before)


def rubbing(with_friction: Relaxation, without: Relaxation) -> tuple[float, Floats]:
    """Energy and forces (6, N) by which two relaxations differ."""
    forces = with_friction.forces()
    forces[:5] -= without.forces()
    return with_friction.report().energy - without.report().energy, forces


def remember(friction: Friction, packing: Packing, world: RigidWorld, seed: int) -> None:
    """Give every contact a memory of up to 0.9 of what it can hold."""
    pairs = observables.grain_contacts(packing)
    bodies = observables.body_contacts(packing, world.primitives()[0])
    label = packing.label
    a, b = label[pairs.i], label[pairs.j]
    keys = np.concatenate(
        [
            np.minimum(a, b) * GRAIN + np.maximum(a, b),
            label[bodies.grain] * GRAIN + BODY + bodies.primitive,
        ]
    )
    overlap = np.concatenate([pairs.overlap, bodies.overlap])
    order = np.argsort(keys)
    share = np.random.default_rng(seed).uniform(-0.9, 0.9, len(keys))
    limit = friction.coefficient / TANGENTIAL_STIFFNESS * overlap[order]
    friction.remember(friction.spin, keys[order], share * limit)


def wander(packing: Packing, seed: int, size: float) -> tuple[Packing, Floats]:
    """The packing with every grain moved, deformed and turned a bit."""
    random = np.random.default_rng(seed + 100)
    moved = packing.copy()
    moved.state += random.uniform(-size, size, moved.state.shape)
    return moved, random.uniform(-size, size, len(packing))


def case(
    seed: int,
    size: float = 0.01,
    box: PeriodicBox | None = None,
    bodies: bool = True,
    move: float = 0.02,
) -> Case:
    """Grains and bodies anywhere that have gone up to ``size`` and ``move`` since every contact remembered something."""
    packing = examples.random_grains(20, 9.0, seed, box)
    world = examples.bodies() if bodies else RigidWorld()
    if box is not None and bodies:
        world.remove("floor")  # it is too long for a cell
    placed = world.placement()
    friction = Friction(MU, len(packing))
    remember(friction, packing, world, seed)
    place = placed + np.random.default_rng(seed).uniform(-move, move, placed.shape)
    moved, turned = wander(packing, seed, size)
    return Case(packing, world, placed, friction, moved, turned, place)


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


def stretch(state: Floats) -> Floats:
    """U (2, 2) from p, q1, q2."""
    p, q1, q2 = state
    return np.array([[p + q1, q2], [q2, p - q1]])


def rotation(angle: float) -> Floats:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def turn_shapes(state: Floats, angle: float) -> None:
    """Turn the ellipses of (5, N) in place."""
    state[3:5] = rotation(2.0 * angle) @ state[3:5]


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
    packing.set_axes(*random.uniform(0.95, 1.2, (2, 2)), random.uniform(-2.0, 2.0, 2))
    moved, turned = wander(packing, seed, 1e-3)
    placed = world.placement()
    return Case(packing, world, placed, Friction(10.0, 2), moved, turned, placed + 1e-3)


@pytest.mark.parametrize("other", ["grain", "edge", "vertex", "disc"])
@pytest.mark.parametrize("seed", range(3))
def test_friction_does_work_where_material_points_pass_each_other(other: str, seed: int) -> None:
    """The generalised forces times any velocities are −f times t·(v_i − v_j) of the material points that touch, by differences.

    A material point X of a grain is at x + U R(φ) X. Between grains the force acts half way between the outlines: on an arm of Δ/2
    from there, which turns with the material. The differences are good to 1e-9 of velocities of 1 R.
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
    for _ in range(20):
        velocity = random.uniform(-1.0, 1.0, state.shape)
        h = 1e-5

        def apart(by: float, velocity: Floats = velocity) -> Floats:
            now = state + by * velocity
            mine = point(now, 0, n)
            return mine - point(now, 1, -n) if other == "grain" else mine

        passing = float(t @ (apart(h) - apart(-h))) / (2.0 * h)
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


# What is no slip, and how much is one.


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
    """q2 from 0 to 0.07 R carries the material at the plates by ∓ q2 p/h, which they hold with k_t each; nothing slides at μ = 10.

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


# Symmetries.


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
@given(st.integers(0, 1000), st.floats(0.0, 1.0))
def test_never_beyond_the_cap(seed: int, size: float) -> None:
    """Against normal forces that are measured on the packing, not taken from the kernel."""
    made = case(seed % 20, size, move=size)
    forces = made.relaxation().slips()[2]
    made.world.place(made.place)
    pairs = observables.grain_contacts(made.packing)
    bodies = observables.body_contacts(made.packing, made.world.primitives()[0])
    assert len(forces.i) == len(pairs.i) + len(bodies.grain)
    assert forces.beyond_cone(MU / 1.05 * (1.0 + 1e-12), pairs, bodies) == 0.0
    if size > 0.01:
        assert forces.beyond_cone(MU / 1.05 * (1.0 - 1e-9), pairs, bodies) > 0.0


# New lists, corners and cells: nothing jumps.


def again(relaxation: Relaxation) -> Floats:
    """Forces (6, N) of the state as it is, after new lists have been made for it."""
    relaxation._relist()
    fire.evaluate(
        relaxation._minimizer,
        relaxation._box,
        relaxation._rigid,
        relaxation.friction_terms,
        None,
        None,
    )
    return relaxation.forces()


@pytest.mark.parametrize("size", [0.003, 0.3])
@pytest.mark.parametrize("seed", range(4))
def test_new_lists_leave_forces_as_they_are(seed: int, size: float) -> None:
    """What contacts hold is committed: sticking, sliding and new ones, twice over."""
    made = case(seed, size, move=size)
    relaxation = made.relaxation()
    before = relaxation.forces()
    slips = relaxation.slips()
    tolerance = RELATIVE * np.abs(before).max()
    for _ in range(2):
        assert np.abs(again(relaxation) - before).max() <= tolerance
        later = relaxation.slips()
        assert np.array_equal(later[0], slips[0])
        assert np.abs(later[1] - slips[1]).max() <= RELATIVE


def follow(made: Case, path: Floats, *, commit: bool) -> Floats:
    """Forces of friction (T, 6) on the first grain of ``made`` as its centre goes along ``path`` (T, 2), without turning."""
    found = []
    for x, y in path:
        packing = made.packing.copy()
        packing.state[:2, 0] = x, y
        step = replace(made, packing=packing)
        found.append(step.forces()[1][:, 0])
        if commit:
            keys, slips, _ = step.relaxation().slips()
            made.friction.end(keys, slips, np.zeros(len(packing)))
            made = replace(made, before=packing)
    return np.array(found)


def round_the_end(steps: int, *, commit: bool, polygon: bool, meets: bool = False) -> Floats:
    """A tilted ellipse dragged along a side, over its corner and down, and pressed on all the while.

    ``meets``: two other plates end where this one does, below it.
    """
    body = RigidBody("plate", segments=[(-6.0, 0.0, 0.0, 0.0, 0.3)])
    if polygon:
        body = RigidBody(
            "plate", polygons=[(((-6.0, -4.0), (0.0, -4.0), (0.0, 0.0), (-6.0, 0.0)), 0.3)]
        )
    others = [
        RigidBody(name, segments=[(0.0, 0.0, x, -4.0, 0.3)])
        for name, x in (("under", -3.0), ("below", -2.0))
    ]
    world = RigidWorld([*others, body] if meets else [body])
    packing = Packing([-0.3], [1.2], 1.0, 0.3, 50.0)
    packing.set_axes(1.1, 0.95, 0.6)
    s = np.linspace(-0.3, 0.9 if polygon else 0.5, steps)
    angle = np.clip(s, 0.0, None) / 1.2 * 2.0
    path = np.array([np.minimum(s, 0.0) + 1.2 * np.sin(angle), 1.2 * np.cos(angle)]).T
    placed = world.placement()
    made = Case(packing, world, placed, Friction(10.0, 1), packing, np.zeros(1), placed)
    return follow(made, path, commit=commit)


@pytest.mark.parametrize(
    ("commit", "polygon"), [(False, False), (True, False), (True, True)], ids=str
)
def test_no_jump_at_a_corner(commit: bool, polygon: bool) -> None:
    """From a side onto the corner at its end, and on to the next side: the change a step goes to zero with the step."""
    most = [
        np.abs(np.diff(round_the_end(steps, commit=commit, polygon=polygon), axis=0)).max()
        for steps in (60, 120)
    ]
    assert most[0] < 4.0
    assert most[1] == pytest.approx(0.5 * most[0], rel=0.15)


def test_no_jump_at_a_corner_where_other_plates_end() -> None:
    """The corner is that of its own plate, however many there are in that place."""
    most = [
        np.abs(np.diff(round_the_end(steps, commit=True, polygon=False, meets=True), axis=0)).max()
        for steps in (60, 120)
    ]
    assert most[1] == pytest.approx(0.5 * most[0], rel=0.15)


@pytest.mark.parametrize("commit", [False, True])
def test_no_jump_where_a_grain_crosses_the_edge_of_a_cell(commit: bool) -> None:
    """Along a wall that runs through the cell: as in the open, also where another image becomes the nearest to the wall."""
    path = np.array([np.linspace(4.2, 4.8, 13), np.full(13, 0.95)]).T
    found = []
    for box, away in ((None, 0.0), (PeriodicBox(9.0), 0.0), (PeriodicBox(9.0), 18.0)):
        world = RigidWorld([RigidBody("floor", segments=[(-7.0, 0.0, 7.0, 0.0, 0.0)])])
        packing = Packing([4.1 + away], [0.95], 1.0, 0.3, 50.0, box=box)
        packing.set_axes(1.1, 0.95, 0.6)
        placed = world.placement()
        made = Case(packing, world, placed, Friction(10.0, 1), packing, np.zeros(1), placed)
        found.append(follow(made, path + [away, 0.0], commit=commit))
    assert np.abs(found[0]).max() > 1.0
    for other in found[1:]:
        assert np.abs(other - found[0]).max() < 1e-11


@given(st.integers(-2, 2), st.integers(-2, 2), st.integers(-2, 2), st.integers(-2, 2))
@FEW
def test_no_jump_where_grains_cross_the_edge_of_a_sheared_cell(
    across: int, up: int, later_across: int, later_up: int
) -> None:
    """Two grains in a cell whose shift changes, stored in any image before and in any other after: as the same two in the open.

    Of the images that touch, the way counts that they have gone.
    """
    here, there, mu = np.array([4.0, 4.5]), np.array([5.5, 5.6]), 10.0
    none, still = np.zeros((0, 3)), np.zeros(2)
    way = np.array([0.013, -0.004])

    def made(cells: tuple[PeriodicBox | None, PeriodicBox | None]) -> Case:
        packings = []
        for box, on, (k, m) in zip(
            cells, (0.0, 1.0), ((across, up), (later_across, later_up)), strict=True
        ):
            second = there + on * way
            if box is not None:
                second = second + [k * box.width + m * box.shift, m * box.height]
            packing = Packing(*zip(here, second, strict=True), 1.0, 0.3, 50.0, box=box)
            packing.set_axes([1.1, 1.0], [0.95, 1.05], [0.6, -0.3])
            packings.append(packing)
        return Case(packings[0], RigidWorld(), none, Friction(mu, 2), packings[1], still, none)

    _, expected = made((None, None)).forces()
    _, forces = made((PeriodicBox(9.0, 9.5, 8.8), PeriodicBox(9.0, 9.5, 9.1))).forces()
    assert np.abs(expected).max() > 0.1
    assert np.abs(forces - expected).max() < 1e-11


# What contacts remember.


def test_memory_is_written_and_found_again() -> None:
    made = case(6)
    relaxation = made.relaxation()
    keys, slips, answer = relaxation.slips()
    contacts = {one.labels: one for one in made.contacts()}
    label = made.packing.label
    made.friction.end(keys, slips, made.turned)
    remembered = made.friction.remembered()
    assert set(remembered) == set(contacts)
    for labels, one in contacts.items():
        assert remembered[labels] == pytest.approx(one.pull / one.stiffness, abs=1e-13)
    assert len(answer.i) == len(contacts)
    for k in range(len(answer.i)):
        i, j = int(label[answer.i[k]]), int(answer.j[k])
        one = contacts[
            (i, -1 - int(answer.primitive[k]))
            if j < 0
            else (min(i, int(label[j])), max(i, int(label[j])))
        ]
        side = 1.0 if int(label[one.i]) == i else -1.0
        on_i = side * one.pull * np.array([one.n[1], -one.n[0]])
        assert [answer.fx[k], answer.fy[k]] == pytest.approx(on_i, abs=1e-11)
        if side > 0.0:
            assert [answer.x[k], answer.y[k]] == pytest.approx(one.at, abs=1e-13)
        assert answer.sliding[k] == one.sliding
    assert np.array_equal(made.friction.spin, made.turned)


def stay(friction: Friction, packing: Packing, before: Packing | None = None) -> FrictionForces:
    """An increment in which grains go from ``before``, or nothing moves, and what is left is remembered."""
    none, still = np.zeros((0, 3)), np.zeros(len(packing))
    made = Case(before or packing, RigidWorld(), none, friction, packing, still, none)
    keys, slips, forces = made.relaxation().slips()
    friction.end(keys, slips, still)
    return forces


def test_memory_of_lost_contacts_is_dropped_and_new_ones_begin_at_nothing() -> None:
    packing = Packing([0.0, 1.9, 3.8], [0.0, 0.0, 0.0])
    friction = Friction(MU, 3)
    remember(friction, packing, RigidWorld(), 1)
    assert set(friction.remembered()) == {(0, 1), (1, 2)}
    kept = friction.remembered()[1, 2]
    assert kept != 0.0
    packing.state[1, 0] = 3.0
    stay(friction, packing)
    assert friction.remembered() == {(1, 2): pytest.approx(kept, abs=1e-15)}
    packing.state[1, 0] = 0.0
    stay(friction, packing)
    assert friction.remembered() == {(0, 1): 0.0, (1, 2): pytest.approx(kept, abs=1e-15)}


def test_a_lighter_contact_remembers_less() -> None:
    """Where the normal force falls, the memory shrinks to what the cap can hold, in the same increment."""
    packing = Packing([0.0, 1.8], [0.0, 0.0])
    friction = Friction(MU, 2)
    remember(friction, packing, RigidWorld(), 2)
    (before,) = friction.remembered().values()
    lighter = packing.copy()
    lighter.state[0, 1] = 1.999
    forces = stay(friction, lighter, packing)
    (after,) = friction.remembered().values()
    assert after == pytest.approx(math.copysign(MU * 0.001 / TANGENTIAL_STIFFNESS, before))
    assert abs(after) < abs(before)
    assert forces.sliding.all()


def test_grains_leave() -> None:
    made = case(7)
    made = replace(made, packing=made.before, turned=np.zeros(20), place=made.placed)
    keep = np.ones(20, dtype=bool)
    keep[[0, 5, 11]] = False
    before = made.friction.remembered()
    made.friction.spin = np.arange(20.0)
    made.friction.select(keep)
    assert np.array_equal(made.friction.spin, np.arange(20.0)[keep])
    left = made.before.select(keep)
    made = replace(made, before=left, packing=left, turned=np.zeros(17))
    keys, slips, _ = made.relaxation().slips()
    made.friction.end(keys, slips, np.zeros(17))
    after = made.friction.remembered()
    expected = {k for k in before if not {0, 5, 11} & set(k)}
    assert set(after) == expected
    assert all(after[k] == pytest.approx(before[k], abs=1e-14) for k in expected)


def test_copy_and_hash() -> None:
    friction = case(8).friction
    twin = friction.copy()
    assert twin.hash() == friction.hash()
    assert twin.remembered() == friction.remembered()
    twin.spin[3] += 1e-15
    assert twin.hash() != friction.hash()
    twin = friction.copy()
    twin._slips[0] += 1e-15
    assert twin.hash() != friction.hash()
    assert twin.remembered() != friction.remembered()
    assert Friction(0.1, 3).hash() != Friction(0.2, 3).hash()


def box_of_grains(count: int = 25) -> tuple[Packing, RigidWorld]:
    """A random packing between two plates and two walls; the upper plate is a piston in both senses."""
    random = np.random.default_rng(count)
    side = math.sqrt(count)
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    packing = Packing(
        1.8 * x.ravel() + random.uniform(-0.05, 0.05, count),
        1.8 * y.ravel() + random.uniform(-0.05, 0.05, count),
        random.uniform(0.9, 1.0, count),
        random.choice([-0.8, 0.8], count),
    )
    low, high = -0.9, 1.8 * side - 0.9
    floor = RigidBody("floor", segments=[(low - 5.0, low, high + 5.0, low, 0.0)])
    left = RigidBody("left", segments=[(low, low - 5.0, low, high + 5.0, 0.0)])
    right = RigidBody("right", segments=[(high, low - 5.0, high, high + 5.0, 0.0)])
    plate = RigidBody(
        "plate",
        position=(0.0, high),
        segments=[(-9.0, 0.0, 30.0, 0.0, 0.0)],
        axis=(1.0, 0.0),
    )
    return packing, RigidWorld([floor, left, right, plate])


CAREFUL = Settings(step=0.05, tolerance=1e-4, max_iterations=20_000)


def sheared(slices: list[int]) -> Quasistatic:
    """The plate goes forth by 0.25 R; every increment cut into slices of so many iterations."""
    packing, world = box_of_grains()
    engine = Quasistatic(System(packing, world, CAREFUL, Friction(MU, len(packing))))
    for _ in range(6):
        engine.begin({"plate": (0.25, world["plate"].position[1])})
        turn = 0
        while engine.relax(slices[turn % len(slices)]) is None:
            turn += 1
    return engine


def test_slices_change_nothing() -> None:
    whole = sheared([20_000])
    for slices in ([7], [1, 50, 3]):
        cut = sheared(slices)
        assert cut.packing.hash() == whole.packing.hash()
        assert cut.friction is not None
        assert whole.friction is not None
        assert cut.friction.hash() == whole.friction.hash()


def sheared_on(step: float, skin: float) -> tuple[Quasistatic, int]:
    """A settled packing sheared in five increments of ``step``: the engine, and how often new lists came in the middle of one."""
    packing, world = box_of_grains()
    settings = Settings(step=0.05, tolerance=1e-6, max_iterations=20_000)
    engine = Quasistatic(System(packing, world, settings, Friction(MU, len(packing))))
    renewed = 0
    for k in range(7):
        targets = {"plate": (0.25, world["plate"].position[1])} if k > 1 else {}
        if k == 2:
            engine.system.solver = replace(settings, step=step, skin=skin)
        engine.begin(targets)
        relaxation = engine.relaxation
        assert relaxation is not None
        first = None
        while engine.relax(1) is None:
            first = relaxation.friction_terms if first is None else first
            if relaxation.friction_terms is not first:
                first = relaxation.friction_terms
                renewed += k > 1
    return engine, renewed


def test_memory_survives_new_lists() -> None:
    """A skin of a hundredth takes other lists, and the answer is the same as long as none are made in the middle of an increment.

    Where they are, what contacts hold by then is remembered, and so is what has slid on the minimiser's way: the answer then is
    another equilibrium, near by. Measured in steps of 0.005 R: 2e-4 R, and 2e-3 of the forces.
    """
    seldom, often = sheared_on(0.001, 0.3), sheared_on(0.001, 0.003)
    assert seldom[1] == often[1] == 0
    assert np.abs(seldom[0].packing.state - often[0].packing.state).max() < 1e-10
    for engine in (seldom[0], often[0]):
        assert engine.friction is not None
    mine, theirs = (e.friction.remembered() for e, _ in (seldom, often) if e.friction is not None)
    assert set(mine) == set(theirs)
    assert max(abs(v) for v in mine.values()) > 1e-3
    assert max(abs(mine[k] - theirs[k]) for k in mine) < 1e-10
    seldom, often = sheared_on(0.005, 0.3), sheared_on(0.005, 0.003)
    assert seldom[1] == 0
    assert often[1] > 0
    assert np.abs(seldom[0].packing.state - often[0].packing.state).max() < 1e-3
    scale = np.abs(seldom[0].reactions).max()
    assert np.abs(seldom[0].reactions - often[0].reactions).max() < 0.01 * scale


@pytest.mark.parametrize("reason", [StopReason.COLLAPSED, StopReason.NOT_FINITE])
def test_a_failed_increment_leaves_memory_and_spins(reason: StopReason) -> None:
    engine = sheared([20_000])
    friction = engine.friction
    assert friction is not None
    memory, packing, spin = friction.hash(), engine.packing.hash(), friction.spin.copy()
    assert np.abs(spin).max() > 1e-3
    engine.begin({"plate": (1.0, engine.world["plate"].position[1])})
    assert engine._relaxation is not None
    engine._relaxation.run(1)
    state = engine._relaxation._minimizer.state
    state[:, 3] = np.nan if reason is StopReason.NOT_FINITE else state[:, 3]
    if reason is StopReason.COLLAPSED:
        state[2, 3] = -10.0
    increment = engine.relax(20_000)
    assert increment is not None
    assert increment.report.reason is reason
    assert increment.friction is None
    assert (friction.hash(), engine.packing.hash()) == (memory, packing)
    assert np.array_equal(friction.spin, spin)
    engine.begin({"plate": (0.3, engine.world["plate"].position[1])})
    again = engine.relax(20_000)
    assert again is not None
    assert again.report.reason is StopReason.CONVERGED


def test_off_leaves_no_trace() -> None:
    """No spin, no arrays, and kernels without the term."""
    packing, world = box_of_grains()
    engine = Quasistatic(System(packing, world, CAREFUL))
    engine.begin({"plate": (0.05, world["plate"].position[1])})
    relaxation = engine._relaxation
    assert relaxation is not None
    engine.relax(20_000)
    assert relaxation._friction is None
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


@pytest.mark.parametrize("label", [[0, 2**30], [-1, 4]])
def test_impossible_labels(label: list[int]) -> None:
    """A memory is found by a number made of both labels: they must fit."""
    with pytest.raises(InputError, match="from 0 to 1073741823"):
        Packing([0.0, 1.0], [0.0, 0.0], label=label)
    friction = Friction(MU, 2)
    stay(friction, Packing([0.0, 1.9], [0.0, 0.0], label=[2**30 - 1, 0]))
    assert set(friction.remembered()) == {(0, 2**30 - 1)}


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


def remembering(keys: list[tuple[int, int]]) -> Friction:
    """Friction of 4 grains with a memory of (label, primitive) contacts with bodies, of slips 1, 2, …"""
    friction = Friction(0.5, 4)
    packed = np.array([label * 2**31 + 2**30 + primitive for label, primitive in keys])
    friction.remember(np.arange(4.0), packed, np.arange(1.0, len(keys) + 1.0))
    return friction


def test_walls_that_are_taken_away_are_forgotten() -> None:
    friction = remembering([(0, 0), (0, 2), (0, 5), (1, 1), (1, 3)])
    friction.forget_primitives(1, 2)
    assert friction.remembered() == {(0, -1): 1.0, (0, -4): 3.0, (1, -2): 5.0}
    keys, _ = friction.memory()
    assert np.all(np.diff(keys) > 0)


def test_grains_that_come_have_not_turned() -> None:
    friction = remembering([])
    friction.rearrange(np.array([3, 1, -1]))
    assert friction.spin.tolist() == [3.0, 1.0, 0.0]


def test_memory_is_taken_up_only_if_it_is_whole() -> None:
    friction = remembering([(0, 0), (1, 1)])
    keys, slips = friction.memory()
    twin = Friction(0.5, 4)
    twin.remember(friction.spin, keys, slips)
    assert twin.hash() == friction.hash()
    for spin, bad_keys, bad_slips in (
        (friction.spin[:3], keys, slips),
        (friction.spin, keys[::-1], slips),
        (friction.spin, -keys, slips),
        (friction.spin, keys, slips[:1]),
        (friction.spin, keys, np.full(2, np.nan)),
        (np.full(4, np.inf), keys, slips),
    ):
        with pytest.raises(InputError):
            twin.remember(spin, bad_keys, bad_slips)
        assert twin.hash() == friction.hash()

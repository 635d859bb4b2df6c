"""The friction of one increment: against its slow twin, as a derivative, its laws and symmetries, and what contacts remember."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from core import fire, observables
from core.errors import InputError
from core.friction import (
    TANGENTIAL_STIFFNESS,
    Friction,
    FrictionTerms,
    FrozenContacts,
    add_friction_forces,
    settle_places,
)
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.system import System
from tests.core import examples, reference_friction

Floats = examples.Floats
EPSILON = float(np.finfo(np.float64).eps)
RELATIVE = 1e-12  # where it comes from: see test_twins.py
MU = 0.4
FEW = settings(max_examples=15, deadline=None)


@dataclass
class Case:
    """A strained packing among bodies that are about to move, with memories of every contact; half of them slide."""

    packing: Packing
    world: RigidWorld
    before: Floats
    after: Floats
    friction: Friction

    def freeze(self) -> FrozenContacts:
        return freeze(self.friction, self.packing, self.world, self.before, self.after)


def freeze(
    friction: Friction, packing: Packing, world: RigidWorld, before: Floats, after: Floats
) -> FrozenContacts:
    world.place(before)
    primitives, owner = world.primitives()
    pairs = observables.grain_contacts(packing)
    touching = observables.body_contacts(packing, primitives)
    return friction.begin(packing, pairs, touching, primitives, owner, before, after)


def remember(friction: Friction, frozen: FrozenContacts, packing: Packing, seed: int) -> None:
    """Give every contact a memory of up to 0.9 of what it can hold."""
    share = np.random.default_rng(seed).uniform(-0.9, 0.9, len(frozen.keys))
    terms = frozen.terms
    blank = -(terms.tx * packing.x[terms.i] + terms.ty * packing.y[terms.i])
    pair = terms.j >= 0
    blank[pair] += terms.tx[pair] * packing.x[terms.j[pair]]
    blank[pair] += terms.ty[pair] * packing.y[terms.j[pair]]
    slips = share * terms.cap / terms.stiffness
    still = frozen.terms._replace(offset=blank + slips)
    friction.end(replace(frozen, terms=still), packing, np.zeros(len(packing)))


def case(
    seed: int, box: PeriodicBox | None = None, bodies: bool = True, move: float = 0.02
) -> Case:
    packing = examples.random_grains(20, 9.0, seed, box)
    world = examples.bodies() if bodies else RigidWorld()
    before = world.placement()
    after = before + np.random.default_rng(seed).uniform(-move, move, before.shape)
    friction = Friction(MU, len(packing))
    made = Case(packing, world, before, before, friction)
    remember(friction, made.freeze(), packing, seed)
    made.after = after
    return made


def evaluate(terms: FrictionTerms, packing: Packing, turned: Floats) -> tuple[float, Floats]:
    """Energy [k R²] and forces on x, y, spin (3, N) of friction alone, by the kernel."""
    count = len(packing)
    state = np.concatenate([packing.state, turned[None]])
    force = np.zeros((6, count))
    settle_places(np.arange(count), terms)
    energy = add_friction_forces(state, force, terms)
    assert not force[2:5].any()
    return energy, force[[0, 1, 5]]


def wander(packing: Packing, seed: int, size: float) -> tuple[Packing, Floats]:
    """The packing with every grain moved, deformed and turned a bit."""
    random = np.random.default_rng(seed + 100)
    moved = packing.copy()
    moved.state += random.uniform(-size, size, moved.state.shape)
    return moved, random.uniform(-size, size, len(packing))


@pytest.mark.parametrize("size", [0.0, 0.003, 0.3])
@pytest.mark.parametrize("seed", range(4))
def test_twin(seed: int, size: float) -> None:
    """Nearly all contacts stick at 0.003 R, most slide at 0.3 R."""
    made = case(seed)
    frozen = made.freeze()
    moved, turned = wander(made.packing, seed, size)
    energy, forces = evaluate(frozen.terms, moved, turned)
    primitives, owner = made.world.primitives()
    motion = surface_motion(made, frozen, owner)
    twin = reference_friction.frozen_friction(
        made.packing, MU, made.friction.remembered(), primitives
    )
    twin = [one._replace(carried=motion.get(one.labels, 0.0)) for one in twin]
    assert len(twin) == len(frozen.keys)
    expected_energy, expected = reference_friction.friction_energy_and_forces(
        twin, (moved.state - made.packing.state)[:2], turned
    )
    scale = np.max(np.abs(expected))
    # A slip is the rounded difference of coordinates of some 10 R; times k_t, up to 100 k, that is 1e-13 k R a contact.
    assert np.max(np.abs(forces - expected)) <= RELATIVE * scale + 1e-12
    assert energy == pytest.approx(expected_energy, rel=RELATIVE)


def surface_motion(
    made: Case, frozen: FrozenContacts, owner: NDArray[np.int64]
) -> dict[tuple[int, int], float]:
    """Motion of the bodies' surfaces along t at every contact [R], by labels: translation and small rotation of a rigid body."""
    shift = made.after - made.before
    found = {}
    for k in np.flatnonzero(frozen.terms.j < 0):
        m = int(frozen.primitive[k])
        b = int(owner[m])
        lever = np.array([frozen.x[k], frozen.y[k]]) - made.before[b, :2]
        velocity = shift[b, :2] + shift[b, 2] * np.array([-lever[1], lever[0]])
        tangent = np.array([frozen.terms.tx[k], frozen.terms.ty[k]])
        label = int(made.packing.label[frozen.terms.i[k]])
        found[label, -1 - m] = float(velocity @ tangent)
    return found


def test_twin_in_a_relaxation() -> None:
    """With everything else, and with the minimiser's own order of grains."""
    made = case(3)
    frozen = made.freeze()
    moved, _ = wander(made.packing, 3, 0.01)
    rows = made.world.primitives()[0]
    with_friction = Relaxation(moved, rows, frozen.terms)
    energy = with_friction.run(1).energy
    without = Relaxation(moved, rows)
    bare = without.run(1).energy
    alone, forces = evaluate(frozen.terms, moved, np.zeros(len(moved)))
    assert energy - bare == pytest.approx(alone, abs=RELATIVE * energy)
    everything = with_friction.forces()
    scale = np.max(np.abs(everything))
    assert np.max(np.abs(everything[:2] - without.forces()[:2] - forces[:2])) <= RELATIVE * scale
    assert np.max(np.abs(everything[2:5] - without.forces()[2:])) <= RELATIVE * scale
    assert np.max(np.abs(everything[5] - forces[2])) <= RELATIVE * scale


@pytest.mark.parametrize("size", [0.001, 0.6])
def test_forces_are_derivatives(size: float) -> None:
    """Central differences of width h = 1e-6, where all stick and where most slide.

    The potential is quadratic or linear, so all but rounding is exact, unless a contact begins to slide within h: there the
    error is at most k_t h, 1e-4 k R.
    """
    made = case(1)
    terms = made.freeze().terms
    moved, turned = wander(made.packing, 1, size)
    energy, forces = evaluate(terms, moved, turned)
    slides = np.isclose(np.abs(terms.pull), terms.cap, rtol=1e-12, atol=0.0)
    assert slides.mean() > 0.5 if size > 0.1 else not slides.any()
    step = 1e-6
    for i in range(len(moved)):
        for row in range(3):

            def shifted(by: float, row: int = row, i: int = i) -> float:
                state, spin = moved.copy(), turned.copy()
                if row < 2:
                    state.state[row, i] += by
                else:
                    spin[i] += by
                return evaluate(terms, state, spin)[0]

            slope = (shifted(-step) - shifted(step)) / (2.0 * step)
            tolerance = 100.0 * step + 16.0 * EPSILON * energy / step
            assert abs(slope - forces[row, i]) <= tolerance


@pytest.mark.parametrize("box", [None, PeriodicBox(9.0, 9.5, 2.3)], ids=["open", "periodic"])
@pytest.mark.parametrize("seed", range(3))
def test_forces_add_up_to_nothing(seed: int, box: PeriodicBox | None) -> None:
    made = case(seed, box, bodies=False)
    moved, turned = wander(made.packing, seed, 0.1)
    _, forces = evaluate(made.freeze().terms, moved, turned)
    assert np.abs(forces[:2].sum(axis=1)).max() <= 100 * EPSILON * np.abs(forces).max()


def test_stress_counts_friction() -> None:
    """In equilibrium Σ_c F_i d_j over all contacts is symmetric, and is what the bodies' forces at their places make of it.

    That follows from Σ_c F = 0 and Σ_c (torque) = 0 on every grain: for spins and shapes each on their own. All is balanced to
    1e-9 of forces of 1 k R, but t and the levers are those before the last increment, so that one is a repetition.
    """
    packing, world = box_of_grains()
    settings = Settings(0.05, 1e-9, force_floor=1e-6, max_iterations=50_000)
    engine = Quasistatic(System(packing, world, settings, Friction(MU, len(packing))))
    for k in range(40):
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


@given(st.integers(0, 30), st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
@FEW
def test_third_law(seed: int, x: float, y: float) -> None:
    """Forces, spin torques and reactions of the bodies, about any point: where the contacts are, all add up to nothing."""
    made = case(seed)
    made.after = made.before
    frozen = made.freeze()
    packing = made.packing
    _, (fx, fy, torque) = evaluate(frozen.terms, packing, np.zeros(len(packing)))
    _, owner = made.world.primitives()
    forces = made.friction.end(frozen, packing, np.zeros(len(packing)))
    on_bodies = forces.reactions(owner, made.before)
    lever_x, lever_y = made.before[:, 0] - x, made.before[:, 1] - y
    balance = [
        fx.sum() + on_bodies[:, 0].sum(),
        fy.sum() + on_bodies[:, 1].sum(),
        np.sum((packing.x - x) * fy - (packing.y - y) * fx + torque)
        + np.sum(lever_x * on_bodies[:, 1] - lever_y * on_bodies[:, 0] + on_bodies[:, 2]),
    ]
    assert np.abs(on_bodies).max() > 0.1
    scale = np.abs([fx, fy, torque]).max() * 40.0  # longest lever
    assert np.abs(balance).max() <= 100 * EPSILON * scale


def test_turning_everything_is_no_slip() -> None:
    """Grains and bodies turned together by a small angle as one rigid whole: no contact slips, to first order."""
    made = case(5)
    friction = Friction(MU, len(made.packing))
    centre = np.array([3.0, -2.0])
    angle = 1e-6
    made.after = made.before.copy()
    made.after[:, 0] -= angle * (made.before[:, 1] - centre[1])
    made.after[:, 1] += angle * (made.before[:, 0] - centre[0])
    made.after[:, 2] += angle
    frozen = freeze(friction, made.packing, made.world, made.before, made.after)
    turned = made.packing.copy()
    turned.state[0] -= angle * (made.packing.y - centre[1])
    turned.state[1] += angle * (made.packing.x - centre[0])
    evaluate(frozen.terms, turned, np.full(len(turned), angle))
    slips = frozen.terms.pull / frozen.terms.stiffness
    assert np.abs(slips).max() <= 100 * EPSILON * 20.0  # coordinates of up to 20 R


def same_after(made: Case, change: str) -> tuple[Case, Floats, float]:
    """The case under a symmetry; how its forces on (x, y) transform (2, 2); and the sign of spin."""
    matrix, parity = np.eye(2), 1.0
    if change == "mirror":
        matrix, parity = np.diag([-1.0, 1.0]), -1.0
    elif change == "rotation":
        c, s = math.cos(0.7), math.sin(0.7)
        matrix = np.array([[c, -s], [s, c]])
    packing = made.packing.copy()
    packing.state[:2] = matrix @ packing.state[:2]
    if change == "mirror":
        packing.state[4] *= -1.0
    elif change == "rotation":
        c, s = math.cos(1.4), math.sin(1.4)
        packing.state[3:] = np.array([[c, -s], [s, c]]) @ packing.state[3:]
    return Case(packing, made.world, made.before, made.after, made.friction), matrix, parity


@pytest.mark.parametrize("change", ["mirror", "rotation"])
def test_symmetries(change: str) -> None:
    made = case(2, bodies=False)
    other, matrix, parity = same_after(made, change)
    other.friction = made.friction.copy()
    other.friction._slips = parity * other.friction._slips
    _, forces = evaluate(made.freeze().terms, made.packing, np.zeros(20))
    _, transformed = evaluate(other.freeze().terms, other.packing, np.zeros(20))
    assert np.abs(forces).max() > 1.0
    scale = np.abs(forces).max()
    assert np.abs(transformed[:2] - matrix @ forces[:2]).max() <= RELATIVE * scale
    assert np.abs(transformed[2] - parity * forces[2]).max() <= RELATIVE * scale


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
    other = Case(
        permuted(made.packing, order), made.world, made.before, made.after, made.friction.copy()
    )
    _, forces = evaluate(made.freeze().terms, made.packing, np.zeros(20))
    _, shuffled = evaluate(other.freeze().terms, other.packing, np.zeros(20))
    assert np.abs(shuffled - forces[:, order]).max() <= RELATIVE * np.abs(forces).max()


@FEW
@given(st.integers(0, 1000), st.floats(0.0, 1.0))
def test_never_beyond_the_cap(seed: int, size: float) -> None:
    made = case(seed % 20)
    terms = made.freeze().terms
    evaluate(terms, *wander(made.packing, seed, size))
    assert np.all(np.abs(terms.pull) <= terms.cap)
    assert terms.stiffness[: terms.pairs[0]].max() <= TANGENTIAL_STIFFNESS * 200.0


# What contacts remember.


def test_memory_is_written_and_found_again() -> None:
    made = case(6)
    frozen = made.freeze()
    moved, turned = wander(made.packing, 6, 0.01)
    evaluate(frozen.terms, moved, turned)
    pulls = frozen.terms.pull.copy()
    answer = made.friction.end(frozen, moved, turned)
    assert np.hypot(answer.fx, answer.fy) == pytest.approx(np.abs(pulls), abs=1e-11)
    assert np.array_equal(answer.sliding, np.abs(pulls) == frozen.terms.cap)
    remembered = made.friction.remembered()
    assert len(remembered) == len(frozen.keys)
    limit = frozen.terms.cap / frozen.terms.stiffness
    label = made.packing.label
    for k in range(len(frozen.keys)):
        i, j = int(label[frozen.terms.i[k]]), int(frozen.terms.j[k])
        key = (i, -1 - int(frozen.primitive[k]))
        if j >= 0:
            key = (min(i, int(label[j])), max(i, int(label[j])))
        assert abs(remembered[key]) <= limit[k]
        assert remembered[key] == pytest.approx(pulls[k] / frozen.terms.stiffness[k], abs=1e-13)
    assert np.array_equal(made.friction.spin, turned)


def test_memory_of_lost_contacts_is_dropped_and_new_ones_begin_at_nothing() -> None:
    packing = Packing([0.0, 1.9, 3.8], [0.0, 0.0, 0.0])
    friction = Friction(MU, 3)
    none = np.zeros((0, 3))
    remember(friction, freeze(friction, packing, RigidWorld(), none, none), packing, 1)
    assert set(friction.remembered()) == {(0, 1), (1, 2)}
    kept = friction.remembered()[1, 2]
    assert kept != 0.0
    packing.state[1, 0] = 3.0
    frozen = freeze(friction, packing, RigidWorld(), none, none)
    friction.end(frozen, packing, np.zeros(3))
    assert friction.remembered() == {(1, 2): pytest.approx(kept, abs=1e-15)}
    packing.state[1, 0] = 0.0
    frozen = freeze(friction, packing, RigidWorld(), none, none)
    friction.end(frozen, packing, np.zeros(3))
    assert friction.remembered() == {(0, 1): 0.0, (1, 2): pytest.approx(kept, abs=1e-15)}


def test_a_lighter_contact_remembers_less() -> None:
    """Where the normal force has fallen, the memory shrinks to what the new cap can hold: energy is lost, never made."""
    packing = Packing([0.0, 1.8], [0.0, 0.0])
    friction = Friction(MU, 2)
    none = np.zeros((0, 3))
    remember(friction, freeze(friction, packing, RigidWorld(), none, none), packing, 2)
    (before,) = friction.remembered().values()
    packing.state[0, 1] = 1.999
    frozen = freeze(friction, packing, RigidWorld(), none, none)
    friction.end(frozen, packing, np.zeros(2))
    (after,) = friction.remembered().values()
    assert after == pytest.approx(math.copysign(MU * 0.001 / TANGENTIAL_STIFFNESS, before))
    assert abs(after) < abs(before)


def test_grains_leave() -> None:
    made = case(7)
    keep = np.ones(20, dtype=bool)
    keep[[0, 5, 11]] = False
    before = made.friction.remembered()
    made.friction.spin = np.arange(20.0)
    made.friction.select(keep)
    assert np.array_equal(made.friction.spin, np.arange(20.0)[keep])
    made.packing = made.packing.select(keep)
    made.after = made.before
    made.friction.end(made.freeze(), made.packing, np.zeros(17))
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


def sheared(slices: list[int], skin: float = 0.3) -> Quasistatic:
    """The plate goes forth by 0.25 R; every increment cut into slices of so many iterations."""
    packing, world = box_of_grains()
    settings = Settings(step=0.05, tolerance=1e-4, skin=skin, max_iterations=20_000)
    engine = Quasistatic(System(packing, world, settings, Friction(MU, len(packing))))
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


def test_memory_survives_new_lists() -> None:
    """A skin of a hundredth rebuilds the lists again and again; the path is then rounded otherwise, and stays the same.

    Both ways end within the tolerance of one equilibrium: 1e-4 of a mean contact force of 0.08 k R, over a softest
    stiffness of some 0.1 k, is 1e-4 R.
    """
    seldom, often = sheared([20_000]), sheared([20_000], skin=0.003)
    assert np.abs(seldom.packing.state - often.packing.state).max() < 1e-4
    assert seldom.friction is not None
    assert often.friction is not None
    mine, theirs = seldom.friction.remembered(), often.friction.remembered()
    assert set(mine) == set(theirs)
    assert max(abs(v) for v in mine.values()) > 1e-3
    assert max(abs(mine[k] - theirs[k]) for k in mine) < 1e-4


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
    assert engine._frozen is None
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
    largest = Packing([0.0, 1.9], [0.0, 0.0], label=[2**30 - 1, 0])
    friction = Friction(MU, 2)
    none = np.zeros((0, 3))
    friction.end(freeze(friction, largest, RigidWorld(), none, none), largest, np.zeros(2))
    assert set(friction.remembered()) == {(0, 2**30 - 1)}


@pytest.mark.parametrize("row", range(6))
def test_nan_is_found(row: int) -> None:
    """Also through the bounds of the force, which would turn it into the cap."""
    made = case(3)
    terms = made.freeze().terms
    relaxation = Relaxation(made.packing, made.world.primitives()[0], terms)
    relaxation.run(1)
    (place,) = np.flatnonzero(relaxation._minimizer.identity == terms.i[0])
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

"""What frictional contacts and grains remember from one increment to the next."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.friction import Friction
from core.packing import Packing
from core.quasistatic import Quasistatic
from core.relaxation import StopReason
from core.rigid import RigidWorld
from core.settings import Settings
from core.slip import TANGENTIAL_STIFFNESS
from core.system import System
from tests.core.friction_examples import MU, box_of_grains, case, remember, sheared, stay


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
    another equilibrium, near by. Measured in steps of 0.005 R: 1e-4 R, and 1e-3 of the forces.
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


@pytest.mark.parametrize("label", [[0, 2**30], [-1, 4]])
def test_impossible_labels(label: list[int]) -> None:
    """A memory is found by a number made of both labels: they must fit."""
    with pytest.raises(InputError, match="from 0 to 1073741823"):
        Packing([0.0, 1.0], [0.0, 0.0], label=label)
    friction = Friction(MU, 2)
    stay(friction, Packing([0.0, 1.9], [0.0, 0.0], label=[2**30 - 1, 0]))
    assert set(friction.remembered()) == {(0, 2**30 - 1)}


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

"""Load increments: nothing passes through anything, and the answer depends on neither clock nor guess."""

from __future__ import annotations

import math
from dataclasses import fields

import numpy as np
import pytest

from core import generate, observables
from core.errors import InputError
from core.generate import Recipe
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment, Quasistatic
from core.relaxation import StopReason
from core.rigid import Point, RigidBody, RigidWorld, wall
from core.settings import LONGEST_STEP, Settings
from core.system import System

BOX: list[Point] = [(0.0, 0.0), (14.0, 0.0), (14.0, 10.0), (0.0, 10.0)]
RADIUS = 1.6
TIGHT = 1e-7
_PACKED: dict[float, Packing] = {}


def scene(packing_fraction: float = 0.86, **settings: float) -> Quasistatic:
    """Some 45 mixed grains around an intruder in a closed box, always the same."""
    intruder = RigidBody(
        "intruder", "intruder", position=(3.0, 5.0), discs=[(0.0, 0.0, RADIUS)], held=True
    )
    world = RigidWorld([wall("walls", BOX, 0.8, closed=True), intruder])
    if packing_fraction not in _PACKED:
        _PACKED[packing_fraction] = generate.pack(
            Recipe(), seed=3, outline=BOX, world=world, packing_fraction=packing_fraction
        )
    return Quasistatic(System(_PACKED[packing_fraction].copy(), world, Settings(**settings)))  # type: ignore[arg-type]


def increment(run: Quasistatic, targets: dict[str, Point], slices: int = 10**9) -> Increment:
    run.begin(targets)
    while True:
        done = run.relax(slices)
        if done is not None:
            return done


def test_a_flung_intruder_passes_through_nothing() -> None:
    """Pulled at a point far outside, then at another: at every increment no centre of a grain is in the intruder, all are in
    the box, and every overlap is small against the grains."""
    run = scene(step=0.15, hand_strength=40.0)
    rearranged = 0.0
    for target in ((1e3, 400.0), (-1e3, -1e3), (1e4, 0.0)):
        for _ in range(110):
            before = run.packing.state[:2].copy()
            done = increment(run, {"intruder": target})
            assert done.report.reason in (StopReason.CONVERGED, StopReason.ITERATION_LIMIT)
            x, y = run.world["intruder"].position
            # Into a wall by one substep at most, before the collision is seen.
            assert max(RADIUS - x, x + RADIUS - 14.0, RADIUS - y, y + RADIUS - 10.0) <= 0.15 / 4.0
            assert np.all(generate.inside(BOX, run.packing.x, run.packing.y))
            assert np.min(np.hypot(run.packing.x - x, run.packing.y - y)) > RADIUS
            # A grain caught between intruder and wall bears what the hand gives; a third of the least radius is far from through.
            assert done.body_contacts.overlap.max(initial=0.0) < 0.25
            assert np.all(run.packing.semi_axes[1] > 0.0)
            moved = np.hypot(*(run.packing.state[:2] - before))
            rearranged = max(rearranged, float(moved.max()))
        # At the wall, or before it where the grains between take all that the hand gives.
        assert done.stopped["intruder"] in ("wall", "force limit")
    assert rearranged > 0.15


def test_slices_change_nothing() -> None:
    """Increments cut into calls of any length: the same bits in grains, bodies and reports."""
    ends = []
    for slices in (10**9, 200, 7):
        run = scene(step=0.1)
        reports = [increment(run, {"intruder": (12.0, 6.0)}, slices).report for _ in range(15)]
        ends.append((run.packing.hash(), run.world.placement().tolist(), reports))
    assert ends[0] == ends[1] == ends[2]


def test_a_small_way_and_back() -> None:
    """Before any contact changes the packing is an elastic body: it comes back to where it was.

    Positions of two equilibria of residual r differ by r f / k_min; the softest mode of a packing with some contacts more
    than it needs has k_min of some 1e-3 k. Rattlers carry no force and stay where they are put.
    """
    run = scene(0.95, step=1e-5, tolerance=1e-9, max_iterations=100_000)
    for _ in range(2):
        start = increment(run, {})
    state, energy = run.packing.state.copy(), start.report.energy
    network = set(
        zip(start.grain_contacts.i.tolist(), start.grain_contacts.j.tolist(), strict=True)
    )
    x, y = run.world["intruder"].position
    there = increment(run, {"intruder": (x + 1e-5, y)})
    away = run.packing.state.copy()
    back = increment(run, {"intruder": (x, y)})
    for done in (there, back):
        assert done.report.reason is StopReason.CONVERGED
        assert network == set(
            zip(done.grain_contacts.i.tolist(), done.grain_contacts.j.tolist(), strict=True)
        )
    slack = start.report.residual * start.report.mean_contact_force / 1e-3
    assert np.max(np.abs(run.packing.state - state)) <= slack
    assert np.max(np.abs(away - state)) > 10.0 * slack
    assert back.report.energy == pytest.approx(energy, rel=1e-9)
    # Work done on the packing = force times way, to second order.
    work = there.report.energy - energy
    mean = 0.5 * (there.reactions[1, 0] + start.reactions[1, 0])
    assert work == pytest.approx(-mean * 1e-5, rel=1e-3)


def test_the_guess_does_not_change_the_answer() -> None:
    """With and without the predictor: the same contacts and forces to within the tolerance, as long as nothing rearranges."""
    ends = []
    for predictor in (True, False):
        run = scene(0.95, step=0.002, tolerance=1e-8, max_iterations=100_000)
        increment(run, {})
        for _ in range(6):
            if not predictor:
                run._last = np.zeros_like(run._last)
            done = increment(run, {"intruder": (12.0, 5.0)})
            assert done.report.reason is StopReason.CONVERGED
        ends.append((run.packing.state.copy(), done))
    (with_guess, first), (without, second) = ends
    held = np.zeros(with_guess.shape[1], dtype=bool)
    for grains in (first.grain_contacts.i, first.grain_contacts.j, first.body_contacts.grain):
        held[grains] = True
    slack = 1e-8 * first.report.mean_contact_force / 1e-3
    assert np.max(np.abs(with_guess - without)[:, held]) <= slack
    assert first.report.energy == pytest.approx(second.report.energy, rel=1e-6)
    assert first.reactions == pytest.approx(second.reactions, abs=1e-5)


def test_a_free_grain_stays_where_it_was_left() -> None:
    """Pushed by the intruder, then left: there is no inertia, whatever the predictor makes of the push."""
    intruder = RigidBody("intruder", "intruder", discs=[(0.0, 0.0, 1.5)], held=True)
    run = Quasistatic(System(Packing([2.6], [0.1]), RigidWorld([intruder]), Settings(step=0.1)))
    for _ in range(8):
        increment(run, {"intruder": (9.0, 0.0)})
    pushed = run.packing.state.copy()
    assert pushed[0, 0] > 3.0
    for _ in range(8):
        increment(run, {"intruder": (-9.0, 0.0)})
    # The first step back may still relax what the last push left over.
    assert np.max(np.abs(run.packing.state - pushed)) < 0.01
    left = run.packing.hash()
    for _ in range(8):
        increment(run, {"intruder": (9.0, 9.0)})
    assert run.packing.hash() == left


def test_increments_report_what_they_did() -> None:
    run = scene(step=0.1)
    busy = [run.busy]
    assert run.progress() is None
    run.begin({"intruder": (12.0, 5.0)})
    busy.append(run.busy)
    assert run.relax(1) is None
    progress = run.progress()
    assert progress is not None
    assert progress.iterations == 1
    with pytest.raises(RuntimeError, match="not finished"):
        run.begin({})
    with pytest.raises(RuntimeError, match="middle of an increment"):
        run.remove(np.zeros(len(run.packing), dtype=bool))
    done = run.relax(10**9)
    assert done is not None
    busy.append(run.busy)
    assert busy == [False, True, False]
    with pytest.raises(RuntimeError, match="no increment"):
        run.relax(1)
    assert done.moved["intruder"] == pytest.approx((0.1, 0.0))
    assert done.stopped == {}
    for _ in range(9):
        done = increment(run, {"intruder": (12.0, 5.0)})
    primitives, owner = run.world.primitives()
    contacts = observables.body_contacts(run.packing, primitives)
    measured = observables.reactions(contacts, owner, run.world.placement())
    assert np.array_equal(done.reactions, measured)
    # The intruder is pushed back.
    assert done.reactions[1, 0] < 0.0


def test_reactions_balance_in_a_closed_box() -> None:
    """In equilibrium the forces on walls and intruder cancel, to within the sum of the residuals of all grains."""
    run = scene(step=0.1, tolerance=1e-6, max_iterations=100_000)
    for _ in range(5):
        done = increment(run, {"intruder": (12.0, 5.0)})
    assert done.report.reason is StopReason.CONVERGED
    limit = len(run.packing) * done.report.residual * done.report.mean_contact_force
    assert np.abs(done.reactions[:, :2].sum(axis=0)).max() <= limit
    assert np.abs(done.reactions[1, 0]) > 100.0 * limit


def test_a_failed_increment_leaves_the_last_good_state() -> None:
    """A plate driven through grains that cannot escape, with no mercy: grains and plate are where they were before."""
    plate = RigidBody(
        "plate",
        "piston",
        position=(0.0, 2.2),
        segments=[(-3.0, 0.0, 3.0, 0.0, 0.1)],
        axis=(0.0, 1.0),
    )
    floor = RigidBody("floor", segments=[(-3.0, 0.0, 3.0, 0.0, 0.1)])
    run = Quasistatic(System(Packing([0.0], [1.1]), RigidWorld([floor, plate]), Settings(step=0.2)))
    for _ in range(30):
        state, placement = run.packing.state.copy(), run.world.placement()
        done = increment(run, {"plate": (0.0, -9.0)})
        assert np.all(np.isfinite(run.packing.state))
        if done.report.reason in (StopReason.COLLAPSED, StopReason.NOT_FINITE):
            assert np.array_equal(run.packing.state, state)
            assert np.array_equal(run.world.placement(), placement)
            break
    else:
        # It slipped out sideways or bore it all: then it must at least be whole.
        assert run.packing.semi_axes[1].min() > 0.0


def assert_contacts_as_things_stand(run: Quasistatic) -> None:
    pairs, bodies = run.contacts()
    for field in fields(pairs):
        now = getattr(observables.grain_contacts(run.packing), field.name)
        assert np.array_equal(getattr(pairs, field.name), now), field.name
    for field in fields(bodies):
        now = getattr(observables.body_contacts(run.packing, run.world.primitives()[0]), field.name)
        assert np.array_equal(getattr(bodies, field.name), now), field.name


def test_contacts_are_kept_only_while_nothing_changes() -> None:
    run = scene(step=0.1)
    assert_contacts_as_things_stand(run)
    assert run.contacts() is run.contacts()
    for target in ((12.0, 5.0), (3.0, 9.0)):
        increment(run, {"intruder": target})
        assert_contacts_as_things_stand(run)
    saved = run.save()
    run.begin({"intruder": (12.0, 5.0)})
    run.relax(5)
    relaxation = run.relaxation
    assert relaxation is not None
    relaxation.write_back()  # as studies do that look on
    assert_contacts_as_things_stand(run)
    run.restore(saved)
    assert_contacts_as_things_stand(run)
    run.remove(run.packing.x > 9.0)
    assert_contacts_as_things_stand(run)
    run.packing.contact_stiffness = 0.5 * run.packing.contact_stiffness
    run.look_again()
    assert_contacts_as_things_stand(run)
    run.world.remove("walls")
    run.take_over(run.packing.copy())
    assert_contacts_as_things_stand(run)


def test_contacts_after_tries_that_are_taken_back() -> None:
    run = scene(step=0.1, hand_strength=1e-3)
    for _ in range(20):
        done = increment(run, {"intruder": (12.0, 5.0)})
        assert_contacts_as_things_stand(run)
        if done.share == 0.0:
            return
    raise AssertionError("the hand has never overpowered itself")


def test_grains_can_leave() -> None:
    run = scene(step=0.1)
    increment(run, {"intruder": (12.0, 5.0)})
    gone = run.packing.x > 9.0
    labels = run.packing.label[~gone].tolist()
    run.remove(gone)
    assert run.packing.label.tolist() == labels
    done = increment(run, {"intruder": (12.0, 5.0)})
    assert done.report.reason is StopReason.CONVERGED
    run.remove(np.ones(len(run.packing), dtype=bool))
    done = increment(run, {"intruder": (12.0, 5.0)})
    assert done.report.iterations == 0
    assert not done.reactions.any()


@pytest.mark.parametrize("settings", [{"step": 0.0}, {"step": 0.3}, {"step": math.nan}])
def test_impossible_steps(settings: dict[str, float]) -> None:
    with pytest.raises(InputError, match="increment"):
        Settings(**settings)  # type: ignore[arg-type]


def test_steps_are_small_against_the_smallest_grain() -> None:
    grains = Packing([0.0, 5.0], [0.0, 0.0], [1.0, 0.5])
    Quasistatic(System(grains, RigidWorld(), Settings(step=0.5 * LONGEST_STEP)))
    with pytest.raises(InputError, match="smallest radius"):
        Quasistatic(System(grains, RigidWorld(), Settings(step=0.51 * LONGEST_STEP)))


def test_an_increment_needs_an_iteration() -> None:
    with pytest.raises(InputError, match="iteration"):
        Settings(max_iterations=0)


def test_what_a_changing_cell_does_to_grains_is_not_their_own_motion() -> None:
    """Free grains go with the cell; two that come to touch move beyond that, apart from each other."""
    cell = PeriodicBox(10.0, 10.0)
    run = Quasistatic(System(Packing([2.0, 4.005, 7.0], [3.0, 3.0, 8.0], box=cell), RigidWorld([])))
    before = run.packing.state.copy()
    run.begin({}, PeriodicBox(9.95, 9.95, 0.02))
    while run.relax(1_000) is None:
        pass
    assert np.hypot(*(run.packing.state - before)[:2])[2] > 0.02
    assert run.own_motion()[:, 2] == pytest.approx(np.zeros(2), abs=1e-12)
    own = run.own_motion()
    assert own[0, 0] < -1e-4
    assert own[0, 1] > 1e-4
    assert own[0, 0] + own[0, 1] == pytest.approx(0.0, abs=1e-3 * abs(own[0, 0]))
    run.remove(np.array([True, False, False]))
    assert run.own_motion().shape == (2, 2)

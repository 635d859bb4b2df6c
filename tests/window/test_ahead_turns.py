"""What becomes of increments that are ready and unseen: shown one a picture, dropped where the hand turns, and gone then."""

from __future__ import annotations

import gc
import math
import weakref
from pathlib import Path

import numpy as np
import pytest

from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import (
    Change,
    Command,
    Erase,
    Grab,
    Move,
    Protocol,
    Recall,
    Release,
    Reset,
    Undo,
)
from sandbox.session.session import Session
from sandbox.window.solvers import solver_thread
from sandbox.window.solvers.ahead import DEPTH, Pace, Ready
from sandbox.window.solvers.conductor import Conductor
from sandbox.window.solvers.solver_thread import SolverThread
from tests.window.by_hand import SCENES, ByHand, assert_replayed, by_hand
from tests.window.fake_session import FakeSession, wait_until

SLICE = 60  # iterations: most increments take several slices here


@pytest.fixture(autouse=True)
def no_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small slices, and no pictures of increments under way."""
    monkeypatch.setattr(solver_thread, "SLICE", SLICE)
    monkeypatch.setattr(solver_thread, "LONGEST_SLICE", SLICE)
    monkeypatch.setattr(solver_thread, "PICTURE", math.inf)


def pulled(scene: str = "intruder", x: float = 40.0) -> ByHand:
    """A body on its way to the right, all ready that may be."""
    hands = by_hand(scene)
    hands.conductor.submit(Grab(SCENES[scene][0]))
    hands.conductor.submit(Move(SCENES[scene][0], x, hands.sessions[0].frame().handles[0].y))
    hands.work()
    return hands


def ready(hands: ByHand) -> list[Ready]:
    return list(hands.solvers[0]._member.ready)


def place(hands: ByHand) -> tuple[float, float]:
    frame = hands.solvers[0].snapshot.frame
    assert frame is not None
    return frame.handles[0].x, frame.handles[0].y


def test_no_more_is_ready_than_may_be_and_a_picture_shows_the_next() -> None:
    hands = pulled()
    assert (hands.shown, len(ready(hands))) == (1, DEPTH)  # the first is seen: a grab has begun it
    hands.conductor.show()
    seen = hands.shown
    assert seen > 1
    assert len(ready(hands)) == DEPTH - (seen - 1)
    hands.work()
    assert len(ready(hands)) == DEPTH
    assert hands.sessions[0].finished == seen + DEPTH


@pytest.mark.parametrize(
    "command",
    [
        Release("intruder"),
        Move("intruder", -5.0, 0.0),
        Protocol(True),
        Change("step", 0.1),
        Erase(2.0, 2.0, 3.0),
        Reset(),
        Undo(),
    ],
)
def test_what_is_ready_is_dropped(command: Command) -> None:
    hands = pulled()
    hands.conductor.show()
    hands.work()
    session, seen = hands.sessions[0], hands.solvers[0].snapshot
    assert seen.made is not None
    hands.slices(1)
    hands.conductor.submit(command)
    assert not ready(hands)
    while hands.solvers[0]._member.back:
        hands.slice()
    assert session.finished == hands.shown
    assert len(session.history) == hands.shown + 1
    assert session.run.settled.engine.packing.hash() == seen.made.kept.engine.packing.hash()
    assert session.run.checkpoints.last == hands.shown
    hands.work()
    stamps = [stamp for stamp, done in session.log().commands if done == command]
    assert stamps == [seen.frame.increment]  # type: ignore[union-attr]


def test_a_body_that_is_let_go_stays_where_it_was_seen() -> None:
    hands = pulled()
    hands.conductor.show()
    there = place(hands)
    hands.conductor.submit(Release("intruder"))
    hands.settle()
    assert place(hands) == there


def test_a_hand_that_goes_on_drops_nothing() -> None:
    hands = pulled("hopper")
    y = place(hands)[1]
    for further in range(1, 5):
        before = ready(hands)
        hands.conductor.submit(Move("piston", 0.0, y - 6.0 - 0.05 * further))
        assert ready(hands) == before
        hands.conductor.show()
        hands.work()
    moves = [stamp for stamp, done in hands.sessions[0].log().commands if isinstance(done, Move)]
    assert moves[1:] == sorted(moves[1:])
    assert all(stamp <= hands.shown + DEPTH for stamp in moves)


def test_a_hand_that_turns_is_followed_in_the_next_picture() -> None:
    hands = pulled()
    for _ in range(5):
        hands.conductor.show()
        hands.work()
    x, y = place(hands)
    for angle in (0.05, 0.1):  # a little aside is the same way
        before = ready(hands)
        hands.conductor.submit(Move("intruder", x + 5.0, y + 5.0 * math.tan(angle)))
        assert ready(hands) == before
    hands.conductor.submit(Move("intruder", x, y + 5.0))
    hands.work()
    hands.conductor.show()
    assert place(hands)[1] > y
    assert place(hands)[0] == pytest.approx(x, abs=1e-6)


def test_a_hand_that_comes_back_is_followed_in_the_next_picture() -> None:
    hands = pulled(x=place(by_hand("intruder"))[0] + 0.05 * 6)
    hands.conductor.show()
    hands.work()
    x, y = place(hands)
    hands.conductor.submit(Move("intruder", x + 0.02, y))
    hands.settle()
    assert place(hands)[0] == pytest.approx(x + 0.02)
    assert hands.sessions[0].finished == 3


def test_moves_that_are_dropped_come_again() -> None:
    hands = pulled()
    x, y = place(hands)
    hands.conductor.submit(Move("intruder", x + 20.0, y))
    hands.conductor.show()
    hands.work()  # an increment after that is ready now
    hands.conductor.submit(Change("regular_poisson_ratio", 0.4))
    hands.work()
    done = hands.sessions[0].log().commands[-3:]
    assert [command for _, command in done] == [
        Move("intruder", 40.0, y),
        Move("intruder", x + 20.0, y),
        Change("regular_poisson_ratio", 0.4),
    ]
    assert done[1][0] == done[2][0]


def test_a_pause_holds_what_is_seen_and_a_step_is_one_increment() -> None:
    hands = pulled()
    hands.conductor.show()
    seen = hands.shown
    hands.conductor.pause(True)
    hands.settle()
    assert (hands.shown, hands.sessions[0].finished) == (seen, seen)
    for count in (1, 2):
        hands.conductor.step()
        hands.settle()
        assert (hands.shown, hands.sessions[0].finished) == (seen + count, seen + count)


def test_a_set_speed_is_that_of_what_is_seen() -> None:
    hands = pulled()
    seen = hands.shown
    hands.conductor.set_speed(1e9)
    hands.slices(30)
    assert not ready(hands)
    assert hands.shown == hands.sessions[0].finished > seen


def test_the_end_is_what_is_seen() -> None:
    hands = pulled()
    hands.conductor.show()
    seen = hands.shown
    hands.finish()
    assert hands.sessions[0].log().end == seen
    assert_replayed(hands.sessions[0], hands.sessions[0].log())


def test_a_recalled_future_comes_back_with_what_is_seen() -> None:
    hands = pulled()
    for _ in range(8):
        hands.conductor.show()
        hands.work()
    last = hands.shown
    hands.conductor.submit(Recall(3))
    hands.work()
    hands.conductor.pause(False)
    hands.work()
    assert (hands.shown, len(ready(hands))) == (3, DEPTH)
    hands.conductor.pause(True)
    hands.settle()
    assert hands.sessions[0].run.checkpoints.last == last
    frame = hands.sessions[0].frame()
    assert (frame.increment, frame.last_kept) == (3, last)


def test_what_was_dropped_leaves_nothing_behind() -> None:
    hands = pulled()
    session = hands.sessions[0]
    x, y = place(hands)
    history, dropped = session.run.history, []
    for turn in range(12):
        hands.conductor.show()
        hands.work()
        dropped += [weakref.ref(one) for one in ready(hands)]
        hands.conductor.submit(Move("intruder", x + 9.0 * (-1) ** turn, y))
        hands.work()
    seen = hands.shown
    hands.conductor.submit(Release("intruder"))
    hands.settle()
    gc.collect()
    assert not [one for one in dropped if one() is not None]
    assert session.run.history is history
    assert len(history) == seen + 1
    assert len(session.run.checkpoints) == seen + 1
    assert session.run.checkpoints.size == sum(
        session.run.checkpoints.at(n).size for n in session.run.checkpoints.increments
    )


def test_what_was_seen_can_be_saved_though_the_run_has_turned_since(tmp_path: Path) -> None:
    hands = pulled()
    hands.conductor.show()
    made, frame = hands.solvers[0].snapshot.made, hands.solvers[0].snapshot.frame
    assert made is not None
    assert frame is not None
    force = frame.curve_force.copy()
    hands.work()
    hands.conductor.submit(Move("intruder", 0.0, 0.0))
    hands.work()
    write_scene(tmp_path / "it.scene", made)
    again = Session.from_file(read_scene(tmp_path / "it.scene"))
    again.build()
    assert np.array_equal(again.frame().curve_force, force)
    assert np.array_equal(frame.curve_force, force)


def test_a_picture_of_an_increment_under_way_is_never_taken_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(solver_thread, "PICTURE", 0.0)
    hands = by_hand("intruder")
    x, y = place(hands)
    hands.conductor.submit(Grab("intruder"))
    hands.conductor.submit(Move("intruder", x + 9.0, y))
    session = hands.sessions[0]
    while session.finished < 3:
        hands.slice()
    while not hands.solvers[0].snapshot.frame.busy:  # type: ignore[union-attr]
        hands.slice()
    there, finished = place(hands), session.finished
    while session.finished == finished:
        hands.slice()
    hands.conductor.submit(Release("intruder"))
    hands.settle()
    assert place(hands) == there
    assert session.finished == finished + 1


def test_one_a_picture_and_more_only_where_solvers_wait_for_it() -> None:
    pace = Pace()
    assert [pace.count(ready, 6) for ready in (0, 1, 3, 5, 2)] == [0, 1, 1, 1, 1]
    assert [pace.count(6, 6) for _ in range(7)] == [2, 3, 4, 5, 6, 6, 6]
    assert [pace.count(5, 6) for _ in range(6)] == [5, 4, 3, 2, 1, 1]


def test_a_thread_that_fails_ahead_says_so_at_once() -> None:
    session = FakeSession()
    conductor = Conductor(depth=DEPTH)
    solver = SolverThread(session, conductor)
    solver.start()
    conductor.submit(Protocol(True))
    wait_until(lambda: session.increments > DEPTH)
    session.fail = RuntimeError("lost")
    for _ in range(DEPTH):
        conductor.show()
    wait_until(lambda: solver.snapshot.phase == "failed")
    conductor.show()
    assert solver.snapshot.phase == "failed"
    assert solver.stop()

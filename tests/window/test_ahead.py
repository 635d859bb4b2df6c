"""Working ahead changes nothing but when: whatever a person does at whatever picture, all that is kept is what a replay gives."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sandbox.session.commands import (
    Change,
    Command,
    Erase,
    Grab,
    Move,
    Protocol,
    Recall,
    Redo,
    Release,
    Reset,
    Undo,
)
from sandbox.session.session import Session
from sandbox.window.solvers import ahead, solver_thread
from sandbox.window.solvers.ahead import DEPTH, Pace
from tests.window.by_hand import SCENES, ByHand, assert_replayed, by_hand, rows

SLICE = 60  # iterations: most increments take several slices here
BOUNDED = settings(
    max_examples=5,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)


@pytest.fixture(autouse=True)
def no_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small slices, and no pictures of increments under way."""
    monkeypatch.setattr(solver_thread, "SLICE", SLICE)
    monkeypatch.setattr(solver_thread, "LONGEST_SLICE", SLICE)
    monkeypatch.setattr(solver_thread, "PICTURE", math.inf)


# What a person does, and how many pictures and slices of work pass before the next.

near = st.floats(-2.0, 14.0)


def commands(handle: str) -> st.SearchStrategy[Command]:
    hand: st.SearchStrategy[Command] = st.one_of(
        st.builds(Move, st.just(handle), near, near),
        st.builds(Move, st.just(handle), st.just(3.0), st.floats(-30.0, 30.0)),
        st.builds(Grab, st.just(handle)),
        st.builds(Release, st.just(handle)),
    )
    other: st.SearchStrategy[Command] = st.one_of(
        st.builds(Protocol, st.booleans()),
        st.just(Reset()),
        st.just(Undo()),
        st.just(Redo()),
        st.builds(Recall, st.integers(0, 30)),
        st.builds(Change, st.just("regular_poisson_ratio"), st.sampled_from([0.3, 0.5, 9.0])),
        st.builds(Change, st.just("step"), st.sampled_from([0.05, 0.1])),
        st.builds(Erase, near, near, st.floats(0.0, 2.0)),
    )
    return st.one_of(hand, hand, hand, other)


Deed = tuple[Command, int, int]


def glide(handle: str) -> st.SearchStrategy[list[Deed]]:
    """A hand in motion: it asks for a place further on in every picture, and then for something else."""
    pictures = st.lists(st.tuples(st.integers(0, 2), st.integers(1, 20)), min_size=2, max_size=8)
    return st.builds(
        lambda each, then: [
            *((Move(handle, 6.0, -41.0 - k), *one) for k, one in enumerate(each)),
            (then, 1, 10),
        ],
        pictures,
        commands(handle),
    )


def deeds(handle: str, most: int = 5) -> st.SearchStrategy[list[Deed]]:
    one = st.tuples(commands(handle), st.integers(0, 8), st.integers(0, 20)).map(lambda it: [it])
    many = st.lists(st.one_of(glide(handle), one), min_size=1, max_size=most)
    return many.map(lambda lists: [deed for deeds in lists for deed in deeds])


def begin(hands: ByHand, handle: str) -> None:
    """Somebody pulls."""
    hands.conductor.submit(Grab(handle))
    hands.conductor.submit(Move(handle, 6.0, -40.0))
    hands.slices(60)


def act(hands: ByHand, steps: Sequence[Deed]) -> None:
    """Each command, then pictures with some slices of work between them."""
    for command, pictures, slices in steps:
        hands.conductor.submit(command)
        for _ in range(pictures):
            hands.slices(slices)
            hands.conductor.show()
        if hands.conductor.paused and slices % 2:
            hands.conductor.pause(False)


def check_replay(scene: str, data: st.DataObject) -> None:
    handle = SCENES[scene][0]
    hands = by_hand(scene)
    begin(hands, handle)
    act(hands, data.draw(glide(handle)))
    act(hands, data.draw(deeds(handle)))
    hands.finish()
    (session,) = hands.sessions
    for log in hands.logs[0]:  # what was written on the way is the beginning of what came
        assert log.end <= session.finished
        assert log.commands == session.log().commands[: len(log.commands)]
    assert_replayed(session, session.log())


@pytest.mark.parametrize("scene", SCENES)
@BOUNDED
@given(data=st.data())
def test_whatever_is_done_a_replay_gives_the_same(scene: str, data: st.DataObject) -> None:
    check_replay(scene, data)


@pytest.mark.parametrize("scene", ["intruder", "hopper"])
@BOUNDED
@given(data=st.data())
def test_pictures_of_an_increment_under_way_change_nothing(
    scene: str, data: st.DataObject, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solver_thread, "PICTURE", 0.0)
    check_replay(scene, data)


@pytest.mark.parametrize("scene", ["intruder", "hopper"])
@BOUNDED
@given(data=st.data())
def test_it_is_as_without_working_ahead(
    scene: str, data: st.DataObject, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no command waits for what is ready, all is as in a session that waits for every picture."""
    monkeypatch.setattr(ahead, "DETOUR", -math.inf)
    monkeypatch.setattr(Pace, "count", lambda self, ready, most: min(ready, 1))
    handle = SCENES[scene][0]
    steps: list[tuple[Command, int]] = [
        (Grab(handle), 0),
        (Move(handle, 6.0, -40.0), data.draw(st.integers(0, 9))),
        *data.draw(st.lists(st.tuples(commands(handle), st.integers(0, 9)), max_size=10)),
    ]

    def done(depth: int) -> Session:
        hands = by_hand(scene, depth)
        session: Session = hands.sessions[0]

        def seen() -> int:
            shown = hands.solvers[0]._member.shown
            assert shown is not None
            return shown.mark.finished if shown.mark is not None else session.finished

        for command, increments in steps:
            hands.conductor.submit(command)
            if not increments:
                continue
            hands.conductor.pause(False)
            end = (seen() if depth else session.finished) + increments
            if depth:
                hands.work()
                while seen() < end and hands.conductor.show():
                    hands.work()
            else:
                while session.finished < end and hands.slice():
                    pass
        hands.finish()
        return session

    without, with_it = done(0), done(DEPTH)
    assert with_it.log() == without.log()
    assert rows(with_it) == rows(without)
    assert with_it.run.checkpoints.increments == without.run.checkpoints.increments


@settings(BOUNDED, max_examples=3)
@given(data=st.data())
def test_packings_side_by_side_stay_in_step(data: st.DataObject) -> None:
    hands = by_hand("intruder", kinds=("regular", "mixed", "auxetic"))
    begin(hands, "intruder")
    for _ in range(2):
        act(hands, data.draw(deeds("intruder", 3)))
        lazy = data.draw(st.integers(0, 2))
        for _ in range(data.draw(st.integers(0, 20))):
            hands.slice(lazy)  # one is quicker than the others
        hands.conductor.show()
        turns = {solver._member.shown.turn for solver in hands.solvers if solver._member.shown}
        assert max(turns) - min(turns) <= 1  # one that was seen as it was made may be at work still
    hands.conductor.pause(True)
    hands.settle()
    logs = [session.log() for session in hands.sessions]
    assert len({(log.end, log.commands) for log in logs}) == 1
    for session, log in zip(hands.sessions, logs, strict=True):
        assert_replayed(session, log)

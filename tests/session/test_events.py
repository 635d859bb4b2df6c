"""What begins is announced once, is seen in the plot where it happened, and comes back with the time."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.session.commands import Change, Grab, Move, Protocol, Recall, Reset, Undo
from sandbox.session.session import Session
from tests.session.test_time import built, do, go


@pytest.fixture(scope="module")
def clogged() -> Session:
    """A narrow hopper after its stroke."""
    session = Session("hopper", "regular", 1, {"grains": 120, "width": 16.0, "orifice": 2.0})
    session.build()
    do(session, Protocol(True))
    go(session, 200)
    return session


def test_an_arch_then_a_clog_are_announced_once_until_a_grain_leaves(clogged: Session) -> None:
    events = clogged.frame().events
    out = clogged.history.column("grains_out")
    told = [event for event in events if event.kind != "avalanche"]
    assert {event.kind for event in told} == {"arch", "clog"}
    at = [(event.kind, int(out[event.increment])) for event in told]
    assert len(set(at)) == len(at)
    assert [event.increment for event in events] == sorted(event.increment for event in events)


def test_an_event_stands_on_the_curve(clogged: Session) -> None:
    frame = clogged.frame()
    for event in frame.events:
        assert event.stroke == frame.curve_stroke[event.increment]
        assert event.force == frame.curve_force[event.increment]
        assert event.text


def test_events_go_and_come_back_with_time(clogged: Session) -> None:
    frame = clogged.frame()
    first = frame.events[0]
    do(clogged, Protocol(False), Recall(first.increment - 1))
    early = clogged.frame()
    assert early.events == ()
    assert early.ahead is not None
    assert early.ahead.events == frame.events
    do(clogged, Recall(first.increment))
    now = clogged.frame()
    assert now.events == (first,)
    assert now.ahead is not None
    assert now.ahead.events == frame.events[1:]
    for there, later, whole in (
        (now.curve_stroke, now.ahead.stroke, frame.curve_stroke),
        (now.curve_force, now.ahead.force, frame.curve_force),
    ):
        assert np.array_equal(np.concatenate([there, later]), whole)
    assert now.highlight is not None
    assert now.highlight.any()
    do(clogged, Undo())
    assert clogged.frame().events == frame.events
    assert clogged.frame().ahead is None
    do(clogged, Reset())
    assert clogged.frame().events == ()


def test_frames_share_the_tuple_of_events() -> None:
    session = built()
    do(session, Protocol(True))
    go(session, 60)
    events = session.frame().events
    assert events
    assert session.frame().events is events


@pytest.mark.parametrize("scene", ["intruder", "couette", "avalanches"])
def test_avalanches_are_falls_of_the_force_and_rare(scene: str) -> None:
    session = Session(scene, "regular", 1, {"grains": 160} if scene != "intruder" else None)
    session.build()
    do(session, Protocol(True))
    increments = len(go(session, 120))
    events, force = session.frame().events, session.history.column("resisting")
    assert events
    assert len(events) < 0.15 * increments
    for event in events:
        assert event.kind == "avalanche"
        assert force[event.increment] < force[event.increment - 1]
        assert "fell" in event.text


def test_a_hand_that_turns_back_and_a_change_are_no_avalanche() -> None:
    session = built("hopper")
    x, y = session.run.setup.world["piston"].position
    do(session, Grab("piston"), Move("piston", x, y - 10.0))
    go(session, 25)
    before = session.frame().events
    do(session, Move("piston", x, y + 2.0))
    go(session, 25)
    for value in (0.0, 0.8):
        do(session, Change("regular_poisson_ratio", value))
        go(session, 1)
    assert session.frame().events == before


def test_a_hopper_under_gravity_clogs_and_flows_again() -> None:
    kinds: list[str] = []
    for seed in (1, 2):
        settings = {"grains": 60, "width": 16.0, "orifice": 2.0 + 0.5 * (seed - 1)}
        session = Session("gravity_hopper", "regular", seed, settings)
        session.build()
        do(session, Protocol(True))
        go(session, 450)
        kinds += [event.kind for event in session.frame().events]
        assert kinds[0] == "clog"
    assert set(kinds) == {"clog", "avalanche"}

"""What begins is announced once, is seen in the plot where it happened, and comes back with the time."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.session.commands import Change, Grab, Move, Protocol, Recall, Reset, Undo
from sandbox.session.session import Session
from scenes.scene import STRONGEST
from tests.session.test_time import built, do, go


@pytest.fixture(scope="module")
def clogged() -> Session:
    """A narrow hopper after its stroke."""
    settings = {"grains": 120, "width": 16.0, "orifice": 2.0, "hand_strength": STRONGEST}
    session = Session("hopper", "regular", 1, settings)
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
    settings = {"hand_strength": STRONGEST} if scene == "intruder" else {"grains": 160}
    session = Session(scene, "regular", 1, settings)
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


def test_a_locked_hand_is_announced_with_what_holds_and_can_be_drawn_back() -> None:
    session = Session("hopper", "regular", 1, {"grains": 120, "width": 16.0, "orifice": 2.0})
    session.build()
    do(session, Protocol(True))
    go(session, 200)
    assert session.idle
    assert not session.frame().protocol
    frame = session.frame()
    event = frame.events[-1]
    assert event.kind == "locked"
    assert event.text == frame.notices[0]
    assert "locked at 8 k R: an arch of" in event.text
    assert 0.9 * 8.0 < event.force <= 8.0 * 1.02
    assert frame.highlight is not None
    assert f"{int(frame.highlight.sum())} grains" in event.text
    handle = frame.handles[0]
    assert (handle.fx, handle.fy) == pytest.approx((0.0, -event.force))
    do(session, Grab("piston"), Move("piston", handle.x, handle.y + 0.5))
    go(session, 20)
    assert not session.run.locked
    assert session.frame().handles[0].y == pytest.approx(handle.y + 0.5)
    do(session, Move("piston", handle.x, handle.y - 9.0))
    go(session, 100)
    kinds = [each.kind for each in session.frame().events]
    assert kinds.count("locked") == 2, "pushed anew and locked anew"


def test_forces_are_felt_along_the_pull_also_while_the_body_stands_still() -> None:
    """A disc that is locked: what is plotted is what the hand gives, to the end, and no more than it has."""
    session = Session("intruder", "regular", 1, {"grains": 200, "intruder_radius": 3.0})
    session.build()
    do(session, Protocol(True))
    go(session, 400)
    assert session.run.locked
    force = session.history.column("resisting")
    assert force[-1] == pytest.approx(session.run.hand_force)
    assert 0.9 * 0.6 < force[-1] <= 0.6 * 1.02
    assert force[1:].max() <= 0.6 * 1.02
    assert session.history.column("stroke")[-3:] == pytest.approx(session.run.way, abs=1e-6)


def test_a_stronger_hand_goes_on_where_a_weaker_one_was_locked() -> None:
    settings = {"hand_strength": 2.0, "grains": 120, "width": 16.0, "orifice": 2.0}
    session = Session("hopper", "regular", 1, settings)
    session.build()
    x, y = session.run.setup.world["piston"].position
    do(session, Grab("piston"), Move("piston", x, y - 9.0))
    go(session, 300)
    assert session.run.locked
    stroke = session.history[-1].stroke
    do(session, Change("hand_strength", 20.0))
    go(session, 40)
    assert session.history[-1].stroke > stroke + 0.2
    assert session.history[-1].hand_strength == 20.0


def test_a_hopper_under_gravity_clogs_and_flows_again() -> None:
    settings = {"grains": 60, "width": 16.0, "orifice": 2.0}
    session = Session("gravity_hopper", "regular", 6, settings)
    session.build()
    do(session, Protocol(True))
    go(session, 450)
    kinds = [event.kind for event in session.frame().events]
    assert kinds == ["clog", "avalanche", "clog"]

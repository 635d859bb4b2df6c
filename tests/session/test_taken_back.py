"""An increment that is taken back, and one in which nothing moves, show what was there before."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from core.quasistatic import Quasistatic
from sandbox.session.commands import Grab, Move, Protocol, Recall
from sandbox.session.session import Session

SAME = ("stroke", "fx", "fy", "resisting", "energy", "beyond_cone", "on_solids")


def go(session: Session, rows: int) -> None:
    """So many more increments."""
    assert len(list(islice(session.increments(1000), rows))) == rows


def pull(session: Session) -> None:
    """A hand takes over from the script, and wants to go on."""
    name = session.run.setup.handles[0].body
    body = session.run.setup.world[name]
    dx, dy = session.run.course.direction
    session.submit(Grab(name))
    session.submit(Move(name, body.position[0] + dx, body.position[1] + dy))


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("scene", ["intruder", "hopper"])
def test_what_an_increment_that_is_taken_back_shows_is_what_was_before(
    scene: str, friction: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = {"grains": 100, "hand_strength": "machine", "friction": friction}
    settings |= {"intruder_radius": 2.0} if scene == "intruder" else {}
    session = Session(scene, "mixed", 1, settings)
    session.build()
    session.submit(Protocol(True))
    go(session, 12)
    before, row, state = session.run.last, session.history[-1], session.state_hash()
    forces = before.friction
    assert row.energy > 0.0
    assert abs(row.resisting) > 0.0
    with monkeypatch.context() as patch:
        patch.setattr(Quasistatic, "_sunk", lambda *_: True)
        for _ in range(2):
            pull(session)
            go(session, 1)
    for failed in (session.history[-2], session.history[-1]):
        assert failed.stop_reason == "sunk"
        for name in SAME:
            assert getattr(failed, name) == pytest.approx(getattr(row, name), rel=1e-12), name
    now = session.run.last
    assert np.allclose(now.reactions, before.reactions, rtol=1e-12, atol=1e-15)
    if forces is not None:
        assert now.friction is not None
        assert np.array_equal(now.friction.fx, forces.fx)
    assert session.state_hash() == state
    assert session.run.way == pytest.approx(row.stroke)
    pull(session)
    go(session, 1)
    assert session.history[-1].stop_reason == "converged"
    assert session.history[-1].stroke > row.stroke


def failing(session: Session) -> float:
    """Energy in the row of an increment that fails [k R²]."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Quasistatic, "_sunk", lambda *_: True)
        pull(session)
        go(session, 1)
    assert session.history[-1].stop_reason == "sunk"
    return session.history[-1].energy


def test_so_it_is_after_going_back_and_after_a_file() -> None:
    session = Session(
        "hopper", "mixed", 1, {"grains": 100, "friction": 0.3, "hand_strength": "machine"}
    )
    session.build()
    session.submit(Protocol(True))
    go(session, 12)
    energy = [row.energy for row in session.history.rows()]
    assert energy[5] != energy[12]
    again = Session.from_file(session.made().to_file("x"))
    again.build()
    assert failing(again) == failing(session) == energy[12]
    session.submit(Recall(5))
    session.settle()
    assert failing(session) == energy[5]


def test_a_pull_another_way_that_fails_shows_what_was_felt() -> None:
    session = Session(
        "intruder",
        "regular",
        1,
        {"grains": 100, "intruder_radius": 2.0, "hand_strength": "machine"},
    )
    session.build()
    session.submit(Protocol(True))
    go(session, 8)
    row, body = session.history[-1], session.run.setup.world["intruder"]
    session.submit(Grab("intruder"))
    session.submit(Move("intruder", body.position[0], body.position[1] + 1.0))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Quasistatic, "_sunk", lambda *_: True)
        go(session, 1)
    assert session.history[-1].stop_reason == "sunk"
    assert session.history[-1].resisting == pytest.approx(row.resisting, rel=1e-12)


def test_contacts_beyond_the_cone_are_counted_while_nothing_moves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Half a cone: what slides is beyond it.
    monkeypatch.setattr("core.frictional_contacts.BEYOND", 0.5)
    session = Session("hopper", "mixed", 1, {"grains": 100, "friction": 0.3})
    session.build()
    session.submit(Protocol(True))
    go(session, 30)
    row, forces = session.history[-1], session.run.last.friction
    assert row.beyond_cone > 0.0
    monkeypatch.setattr(Quasistatic, "_creeps", lambda *_: True)
    go(session, 1)
    now = session.history[-1]
    assert now.stroke == row.stroke
    assert now.beyond_cone == row.beyond_cone
    assert session.run.last.friction is forces

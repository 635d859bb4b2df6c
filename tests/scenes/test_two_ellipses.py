"""Two ellipses in a person's hands: nothing is relaxed, and the contact law is measured against the exact contact."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.session.commands import Grab, Move, Protocol, Release, Reset
from sandbox.session.session import Session


def ellipses(kind: str = "mixed", **settings: object) -> Session:
    session = Session("two_ellipses", kind, 1, settings)
    session.build()
    return session


def finish(session: Session) -> None:
    """Until nothing is left to do; it must come to that."""
    session.advance(1_000)
    for _ in range(2_000):
        if session.idle:
            return
        session.advance(1_000)
    pytest.fail("the hand never arrived")


def drag(session: Session, handle: str, x: float, y: float) -> None:
    session.submit(Grab(handle))
    session.submit(Move(handle, x, y))
    finish(session)
    session.submit(Release(handle))
    session.settle()


def tilts(session: Session) -> np.ndarray:
    """Of both longer axes [deg], in [0, 180)."""
    frame = session.frame()
    return np.degrees(0.5 * np.arctan2(frame.q2, frame.q1)) % 180.0


def test_the_script_turns_both_by_half_a_turn() -> None:
    """Equal ellipses: early by b ε² sin² 2θ to second order, here to 3 b ε³; 0 along the axes; most near 45°."""
    session = ellipses(aspect=1.1)
    session.submit(Protocol(True))
    finish(session)
    tilt, early = session.history.curve
    assert len(tilt) == 73
    b = 1.0 / math.sqrt(1.1)
    expansion = 50.0 * b * 0.1**2 * np.sin(2.0 * np.radians(tilt)) ** 2
    assert early == pytest.approx(expansion, abs=50.0 * 3.0 * b * 0.1**3)
    assert early[0] == pytest.approx(0.0, abs=1e-9)
    assert early[36] == pytest.approx(0.0, abs=1e-3)
    assert abs(tilt[int(np.argmax(early[:37]))] - 45.0) < 5.0
    assert all(check.holds is not False for check in session.checks())


def test_mirror_images_are_exact_all_the_way() -> None:
    session = ellipses(mirror=True, tilt=20.0)
    session.submit(Protocol(True))
    finish(session)
    assert np.max(np.abs(session.history.curve[1])) < 1e-9
    assert [c.holds for c in session.checks() if "mirror" in c.name] == [True]


def test_a_hand_drags_the_right_grain_anywhere() -> None:
    """Shapes and tilts stay; the contact line and the force follow the contact law."""
    session = ellipses(tilt=30.0)
    drag(session, "right grain", 1.2, 1.1)
    frame = session.frame()
    assert (frame.x[1], frame.y[1]) == pytest.approx((1.2, 1.1), abs=1e-6)
    assert tilts(session) == pytest.approx([30.0, 30.0], abs=1e-9)
    assert (frame.p + np.hypot(frame.q1, frame.q2)) == pytest.approx(math.sqrt(1.4), abs=1e-12)
    distance, toward = math.hypot(1.2, 1.1), math.atan2(1.1, 1.2)
    reach = 2.0 * math.hypot(
        math.sqrt(1.4) * math.cos(toward - math.radians(30.0)),
        math.sin(toward - math.radians(30.0)) / math.sqrt(1.4),
    )
    assert frame.contacts.force == pytest.approx([50.0 * (reach - distance)], rel=1e-5)
    assert frame.stop_reason == "converged"
    drag(session, "right grain", 3.0, 0.0)
    assert len(session.frame().contacts) == 0
    assert any("gap" in notice for notice in session.frame().notices)


@pytest.mark.parametrize("angle", [10.0, 80.0, 135.0, 260.0])
@pytest.mark.parametrize(("handle", "grain"), [("left tip", 0), ("right tip", 1)])
def test_a_hand_turns_a_grain_by_its_tip(handle: str, grain: int, angle: float) -> None:
    """However far away the hand is: the tip points at it, and the hand arrives."""
    session = ellipses()
    centre = session.frame().x[grain], session.frame().y[grain]
    toward = math.radians(angle)
    drag(session, handle, centre[0] + 9.0 * math.cos(toward), centre[1] + 9.0 * math.sin(toward))
    assert tilts(session)[grain] == pytest.approx(angle % 180.0, abs=1e-3)
    assert tilts(session)[1 - grain] == pytest.approx(0.0, abs=1e-9)


def test_tips_go_with_their_grain() -> None:
    session = ellipses(tilt=40.0)
    before = {handle.name: (handle.x, handle.y) for handle in session.frame().handles}
    drag(session, "right grain", 2.5, 0.7)
    after = {handle.name: (handle.x, handle.y) for handle in session.frame().handles}
    moved = np.subtract(after["right tip"], before["right tip"])
    assert moved == pytest.approx([2.5 - 1.9, 0.7], abs=1e-6)
    assert after["left tip"] == pytest.approx(before["left tip"], abs=1e-12)


def test_through_the_other_grain_and_back_to_the_start() -> None:
    """Straight over the other's centre, where there is no line of centres; then a reset, and tips that still turn."""
    session = ellipses()
    start = session.state_hash()
    drag(session, "right grain", -1.5, 0.0)
    assert session.frame().x[1] == pytest.approx(-1.5, abs=1e-6)
    assert np.all(np.isfinite(session.history.curve))
    drag(session, "right grain", 0.0, 0.0)  # as near as it may
    assert math.hypot(session.frame().x[1], session.frame().y[1]) == pytest.approx(0.2, abs=1e-3)
    drag(session, "left tip", 0.0, 5.0)
    session.submit(Reset())
    session.settle()
    assert session.state_hash() == start
    drag(session, "left tip", -5.0, 5.0)
    assert tilts(session)[0] == pytest.approx(135.0, abs=1e-3)

"""What is said about one grain agrees with the frame, and with what is said about its neighbours."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.session.frame import Contacts, Frame
from sandbox.session.session import Session
from sandbox.window.canvas.inspection import grain_at, inspect
from tests.draw.frames import empty_frame, intruder_frame, periodic_frame


@pytest.fixture(scope="module")
def squeezed() -> Frame:
    """A real packing with the intruder pressed into it."""
    session = Session("intruder", "mixed", 3, {"grains": 50, "intruder_radius": 2.0})
    session.build()
    session.run.hands.follow_script(True)
    for _ in range(4):
        while not session.advance():
            pass
    return session.frame()


def test_shape_is_that_of_the_frame() -> None:
    frame = intruder_frame(6)
    for index, label in enumerate(frame.label):
        found = inspect(frame, int(label))
        assert found is not None
        assert found.a >= found.b > 0.0
        assert found.a * found.b == pytest.approx(
            frame.p[index] ** 2 - frame.q1[index] ** 2 - frame.q2[index] ** 2
        )
        long_way = 2.0 * math.radians(found.angle)
        q = math.hypot(frame.q1[index], frame.q2[index])
        assert q * math.cos(long_way) == pytest.approx(frame.q1[index], abs=1e-12)
        assert q * math.sin(long_way) == pytest.approx(frame.q2[index], abs=1e-12)
        area = found.a * found.b / frame.rest_radius[index] ** 2
        assert found.area_change == pytest.approx(area - 1.0)
        assert found.auxetic == (found.poisson_ratio < 0.0)


def test_every_contact_is_felt_alike_by_both_grains(squeezed: Frame) -> None:
    felt: dict[tuple[int, int], list[float]] = {}
    rigid, total = [], 0.0
    for label in squeezed.label.tolist():
        found = inspect(squeezed, label)
        assert found is not None
        total += found.total_force
        for touch in found.touches:
            if touch.label is None:
                rigid.append(touch.force)
            else:
                pair = min(label, touch.label), max(label, touch.label)
                felt.setdefault(pair, []).append(touch.force)
    assert felt
    assert rigid
    assert all(len(forces) == 2 and forces[0] == forces[1] for forces in felt.values())
    force, body = squeezed.contacts.force, squeezed.contacts.rigid
    assert total == pytest.approx(2.0 * force[~body].sum() + force[body].sum())
    assert sum(rigid) == pytest.approx(force[body].sum())


def test_forces_balance_to_the_tolerance(squeezed: Frame) -> None:
    mean = float(squeezed.contacts.force.mean())
    for label in squeezed.label.tolist():
        found = inspect(squeezed, label)
        assert found is not None
        assert found.unbalanced <= 2.0 * squeezed.tolerance * mean


def test_touches_end_at_the_neighbour(squeezed: Frame) -> None:
    for label in squeezed.label.tolist():
        found = inspect(squeezed, label)
        assert found is not None
        assert list(found.touches) == sorted(found.touches, key=lambda touch: -touch.force)
        for touch in found.touches:
            if touch.label is not None:
                other = inspect(squeezed, touch.label)
                assert other is not None
                assert (touch.x, touch.y) == pytest.approx((other.x, other.y), abs=1e-9)


def test_nothing_known_of_contacts_is_no_contact() -> None:
    found = inspect(intruder_frame(6), 0)
    assert found is not None
    assert found.touches == ()
    assert math.isnan(found.unbalanced)


def test_no_such_grain() -> None:
    assert inspect(intruder_frame(6), 10_000) is None
    assert inspect(empty_frame(), 0) is None
    assert grain_at(empty_frame(), 0.0, 0.0) is None


def test_label_is_followed_when_grains_leave() -> None:
    frame = intruder_frame(6)
    before = inspect(frame, 9)
    kept = np.arange(frame.grains) != 4
    names = ("x", "y", "p", "q1", "q2", "rest_radius", "poisson_ratio", "label", "pressure")
    fewer = replace(
        frame,
        contacts=Contacts.none(),
        **{name: getattr(frame, name)[kept] for name in names},
    )
    after = inspect(fewer, 9)
    assert before is not None
    assert after is not None
    assert after.index == before.index - 1
    assert (after.x, after.y, after.a) == (before.x, before.y, before.a)


@given(index=st.integers(0, 20), turn=st.floats(0.0, 6.28), out=st.sampled_from((0.97, 1.03)))
def test_grain_is_found_within_its_outline(index: int, turn: float, out: float) -> None:
    frame = intruder_frame(6)
    # One grain alone, stretched a good deal, so that its neighbours cannot be meant.
    names = ("x", "y", "p", "rest_radius", "poisson_ratio", "label", "pressure")
    alone = replace(
        frame,
        contacts=Contacts.none(),
        q1=np.array([0.3]),
        q2=np.array([-0.2]),
        **{name: getattr(frame, name)[index : index + 1] for name in names},
    )
    found = inspect(alone, int(alone.label[0]))
    assert found is not None
    tilt = math.radians(found.angle)
    u, v = out * found.a * math.cos(turn), out * found.b * math.sin(turn)
    x = found.x + u * math.cos(tilt) - v * math.sin(tilt)
    y = found.y + u * math.sin(tilt) + v * math.cos(tilt)
    assert grain_at(alone, x, y) == (found.label if out < 1.0 else None)


def test_images_in_a_periodic_cell_are_found() -> None:
    frame = periodic_frame(shift=3.0)
    assert frame.box is not None
    width, height, shift = frame.box
    here = grain_at(frame, float(frame.x[5]), float(frame.y[5]))
    for x, y in ((width, 0.0), (-width, 0.0), (shift, height), (-shift, -height)):
        assert grain_at(frame, float(frame.x[5]) + x, float(frame.y[5]) + y) == here

"""What the measuring tools read: closed forms, and the force through a cut against what balances it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sandbox.session.commands import Protocol
from sandbox.session.frame import Contacts, Frame
from sandbox.session.session import Session
from sandbox.window.measure.gauges import (
    SHAPES,
    angle,
    between,
    force_through,
    forces_over_mean,
    length_over_width,
    spread,
)
from scenes.couette import plate_stresses
from tests.draw.frames import intruder_frame


def run(scene: str, increments: int, settings: dict[str, object]) -> Session:
    session = Session(scene, "mixed", 2, settings)
    session.build()
    session.submit(Protocol(True))
    done = 0
    while done < increments:
        done += session.advance(2000)
    return session


def two_contacts(box: tuple[float, float, float] | None = None) -> Frame:
    """Grain 0 at the origin presses on grain 1 above it, and on grain 2 at its right, with friction."""
    zero, one = np.zeros(2), np.array([0.0, 2.0])
    contacts = Contacts(
        x0=zero, y0=zero, x1=one, y1=one[::-1], force=np.array([3.0, 5.0]), rigid=zero.astype(bool),
        i=np.array([0, 0]), j=np.array([1, 2]), fx=np.array([0.5, -5.0]), fy=np.array([-3.0, 0.25]),
    )  # fmt: skip
    return replace(intruder_frame(3), contacts=contacts, box=box)


def test_a_cut_adds_up_what_crosses_it() -> None:
    found = force_through(two_contacts(), (-1.0, 1.0), (1.0, 1.0))
    assert found is not None
    # What is above, left of the line, presses down with 3 and to the right with 0.5.
    assert (found.pressing, found.sliding, found.contacts) == (3.0, 0.5, 1)
    assert (found.x.tolist(), found.y.tolist()) == ([0.0], [1.0])
    both = force_through(two_contacts(), (-1.0, 2.0), (2.0, -1.0))
    assert both is not None
    assert both.contacts == 2
    assert both.pressing == pytest.approx((3.0 - 0.5 + 5.0 - 0.25) / math.sqrt(2.0))
    beside = force_through(two_contacts(), (0.5, 1.0), (3.0, 1.0))
    assert beside is not None
    assert (beside.pressing, beside.contacts) == (0.0, 0)


def test_a_cut_the_other_way_round_reads_the_same() -> None:
    there = force_through(two_contacts(), (-1.0, 2.0), (2.0, -1.0))
    back = force_through(two_contacts(), (2.0, -1.0), (-1.0, 2.0))
    assert there is not None
    assert back is not None
    assert (back.pressing, back.sliding) == pytest.approx((there.pressing, there.sliding))


def test_images_of_a_contact_count_in_a_periodic_cell() -> None:
    frame = two_contacts((10.0, 10.0, 1.0))
    found = force_through(
        frame, (-9.5, -9.0), (-8.5, -9.0)
    )  # one cell below, shifted, and one to the left
    assert found is not None
    assert (found.contacts, found.pressing) == (0, 0.0)
    found = force_through(frame, (-1.5, -9.0), (-0.5, -9.0))
    assert found is not None
    assert (found.contacts, found.pressing) == (1, 3.0)


def test_where_forces_are_not_known_nothing_is_read() -> None:
    assert force_through(intruder_frame(6), (0.0, 0.0), (1.0, 1.0)) is None
    assert force_through(two_contacts(), (1.0, 1.0), (1.0, 1.0)) is None


def unbalanced(frame: Frame) -> float:
    """Most that the forces on all grains may be off by [k R]."""
    return float(frame.residual_force.sum()) + 1e-9


def test_a_cut_through_a_channel_carries_what_the_piston_presses() -> None:
    """Without friction vertical walls push sideways only: each cut from wall to wall has the force on the piston."""
    frame = run("hopper", 12, {"friction": 0.0, "grains": 120}).frame()
    (piston,) = frame.handles
    assert abs(piston.fy) > 1e-3
    for depth in (2.0, 3.5, 5.0):
        y = piston.y - depth
        found = force_through(frame, (-50.0, y), (50.0, y))
        assert found is not None
        assert found.contacts > 3
        assert found.pressing == pytest.approx(-piston.fy, abs=unbalanced(frame))


def test_with_friction_what_is_above_a_cut_balances() -> None:
    """Walls carry a part of it then: bodies on all grains above, and the cut below them, come to nothing."""
    frame = run("hopper", 12, {"friction": 0.5, "grains": 120}).frame()
    y = frame.handles[0].y - 5.0
    contacts = frame.contacts
    from_bodies = contacts.rigid & (frame.y[contacts.i] > y)
    pushed = np.array([contacts.fx[from_bodies].sum(), contacts.fy[from_bodies].sum()])
    found = force_through(frame, (-50.0, y), (50.0, y))
    assert found is not None
    crossing = [found.sliding, -found.pressing]  # from above on what is below
    assert pushed == pytest.approx(crossing, abs=unbalanced(frame))
    assert found.pressing < abs(frame.handles[0].fy)


def test_a_cut_through_a_sheared_cell_carries_the_plates_stress() -> None:
    session = run("couette", 10, {"grains": 160})
    frame, latest = session.frame(), session.run.engine.latest
    assert frame.box is not None
    assert latest is not None
    width = frame.box[0]
    shear, normal = plate_stresses(session.run.setup.world, width, latest)
    middle = 0.5 * (frame.y.min() + frame.y.max())
    found = force_through(frame, (0.0, middle), (width, middle))
    assert found is not None
    error = unbalanced(frame)
    assert found.pressing == pytest.approx(normal * width, abs=error)
    assert abs(found.sliding) == pytest.approx(abs(shear) * width, abs=error)


def test_angles() -> None:
    assert angle((2.0, 0.0), (0.0, 0.0), (0.0, 3.0)) == pytest.approx(90.0)
    assert angle((-1.0, -0.01), (0.0, 0.0), (-1.0, 0.01)) == pytest.approx(1.1459, abs=1e-3)
    assert angle((1.0, 1.0), (1.0, 1.0), (2.0, 1.0)) == 0.0


def test_how_values_are_spread() -> None:
    found = spread(np.array([1.0, 1.1, 1.9, 7.0, np.nan]), SHAPES)
    assert (found.shares[0], found.shares[-1], found.shares.sum()) == (0.25, 0.25, 1.0)
    assert (found.mean, found.count) == (2.75, 4)
    assert spread(np.zeros(0), SHAPES).count == 0
    contacts = two_contacts().contacts
    assert forces_over_mean(contacts).tolist() == [0.75, 1.25]
    frame = replace(
        intruder_frame(2), p=np.array([1.0, 1.0]), q1=np.array([0.2, 0.0]), q2=np.zeros(2)
    )
    assert length_over_width(frame) == pytest.approx([1.5, 1.0])


def test_between_two_marks_in_any_order() -> None:
    stroke, force = np.array([0.0, 1.0, 2.0, 3.0]), np.array([9.0, 1.0, 3.0, 9.0])
    for marks in ((0.5, 2.5), (2.5, 0.5)):
        found = between(stroke, force, marks)
        assert (found.mean, found.deviation, found.count) == (2.0, 1.0, 2)
    assert between(stroke, force, (5.0, 6.0)).count == 0

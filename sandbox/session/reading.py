"""What is read off a finished increment: how far the drive went, what it felt, what stopped it."""

from __future__ import annotations

import math

import numpy as np

from core.quasistatic import Increment
from core.relaxation import FAILED, StopReason
from sandbox.session.course import Course
from sandbox.session.history import Row
from scenes.accuracy import Accuracy
from scenes.scene import Setup
from scenes.text import Text

BOX = "box"  # the handle that is no body: the periodic cell
STUCK = 1e-3  # of a step: a body that moves less than that is stopped
PRESSED_IN = (
    "a grain was pressed into a wall: back to the state before this step. Draw back, or reset"
)
SQUEEZED_FLAT = "a grain was squeezed flat: back to the state before this step. Draw back, or reset"
BLEW_UP = "the numbers blew up: back to the state before this step. Draw back, or reset"
_WHAT_FAILED = {
    StopReason.COLLAPSED: SQUEEZED_FLAT,
    StopReason.NOT_FINITE: BLEW_UP,
    StopReason.SUNK: PRESSED_IN,
}


def follow_drive(course: Course, setup: Setup, increment: Increment) -> None:
    """Stroke and direction of the drive: along its axis for a body that slides, along its path for one that is dragged."""
    drive = setup.handles[0].body
    if drive == BOX:
        return
    body = setup.world[drive]
    if body.axis is not None:
        course.stroke = float(np.dot(np.array(body.position) - body.home, body.axis))
        return
    x, y = increment.moved.get(drive, (0.0, 0.0))
    length = math.hypot(x, y)
    course.stroke += length
    if length > 0.0:
        course.direction = (x / length, y / length)


def read_off(
    course: Course, setup: Setup, increment: Increment, number: int, accuracy: Accuracy
) -> Row:
    """The row of the history for an increment, the ``number``-th.

    ``accuracy`` is that of the scene; the error of the force on the handle is estimated by it.
    """
    fx = fy = 0.0
    drive = setup.handles[0].body
    if drive != BOX:
        fx, fy = map(float, increment.reactions[setup.world.index(drive), :2])
    resisting = -(fx * course.direction[0] + fy * course.direction[1]) + 0.0
    curve = setup.curve
    if curve is not None:
        course.stroke = number if curve.stroke is None else curve.stroke(setup.packing, increment)
        force = curve.force
        resisting = course.out if force is None else force(setup.packing, increment)
    report = increment.report
    return Row(
        increment=number,
        stroke=course.stroke,
        fx=fx,
        fy=fy,
        grains_out=course.out,
        energy=report.energy,
        residual=report.residual,
        iterations=report.iterations,
        stop_reason=str(report.reason),
        resisting=float(resisting),
        force_error=accuracy.force_error(report.residual, report.mean_contact_force),
    )


def tell_what_stopped(course: Course, setup: Setup, increment: Increment) -> None:
    """Notices of what held the hand back; what is stuck tries again only when the hand moves."""
    course.notices.clear()
    labels = {handle.body: handle.label for handle in setup.handles}
    for name, why in increment.stopped.items():
        label = labels[name]
        stuck = math.hypot(*increment.moved[name]) < STUCK * setup.solver.step
        if stuck:
            course.blocked.add(name)
        if why == "force limit":
            limit = setup.world[name].force_limit
            text = "the hand is not stronger than {limit:g} k R: {label} stopped"
            course.notices.append(Text(text, limit=limit, label=label))
        elif why == "end of travel":
            course.notices.append(Text("{label}: end of travel", label=label))
        elif stuck:
            course.notices.append(Text("{label}: stopped by the wall", label=label))
    reason = increment.report.reason
    if reason in FAILED:
        course.blocked.update(increment.moved, {BOX})
        course.script = None
        course.notices.append(_WHAT_FAILED[reason])

"""What is read off a finished increment: how far the drive went, what it felt, what stopped it."""

from __future__ import annotations

import math

import numpy as np

from core.hand import CELL
from core.quasistatic import Increment
from core.relaxation import FAILED, StopReason
from sandbox.session.course import Course
from sandbox.session.history import Row
from scenes.accuracy import Accuracy
from scenes.scene import Holding, Remarks, Setup
from scenes.text import Text

LOCKED_AFTER = 3  # increments in a row that all the strength of the hand could not make
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
    """Stroke and direction of the drive: along its axis for a body that slides, as the hand pulls for one that is dragged."""
    drive = setup.handles[0].body
    if drive == CELL:
        return
    body = setup.world[drive]
    if body.axis is not None:
        course.stroke = float(np.dot(np.array(body.position) - body.home, body.axis))
        return
    course.stroke += math.hypot(*increment.moved.get(drive, (0.0, 0.0)))
    pull = increment.pulled.get(drive, (0.0, 0.0))
    if pull != (0.0, 0.0):
        course.direction = pull


def read_off(
    course: Course, setup: Setup, increment: Increment, number: int, accuracy: Accuracy
) -> Row:
    """The row of the history for an increment, the ``number``-th.

    ``accuracy`` is that of the scene; the error of the force on the handle is estimated by it.
    """
    fx = fy = 0.0
    drive = setup.handles[0].body
    if drive != CELL:
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
        hand_strength=setup.solver.hand_strength,
    )


def tell_what_stopped(course: Course, setup: Setup, increment: Increment) -> None:
    """Notices of what held the hand back; what is stuck tries again only when the hand moves.

    A hand that is not strong enough tries ``LOCKED_AFTER`` times, as friction may yield meanwhile; so does the script.
    """
    course.notices.clear()
    limited = any(why == "force limit" for why in increment.stopped.values())
    still = all(
        math.hypot(*moved) < STUCK * setup.solver.step for moved in increment.moved.values()
    )
    if increment.moved or CELL in increment.stopped:
        course.stuck = course.stuck + 1 if limited and still and increment.share == 0.0 else 0
    if limited and course.script is not None:
        course.script = course.script - 1 if course.stuck < LOCKED_AFTER else None
    labels = {handle.body: handle.label for handle in setup.handles}
    for name, why in increment.stopped.items():
        label = labels[name]
        if why == "force limit":
            if course.stuck >= LOCKED_AFTER:
                course.blocked.add(name)
            else:
                limit = setup.solver.hand_strength
                text = "all the hand has: {limit:g} k R on the {label}"
                course.notices.append(Text(text, limit=limit, label=label))
            continue
        stuck = math.hypot(*increment.moved[name]) < STUCK * setup.solver.step
        if stuck:
            course.blocked.add(name)
        if why == "end of travel":
            course.notices.append(Text("{label}: end of travel", label=label))
        elif stuck:
            course.notices.append(Text("{label}: stopped by the wall", label=label))
    reason = increment.report.reason
    if reason in FAILED:
        course.blocked.update(increment.moved, {CELL})
        course.script = None
        course.notices.append(_WHAT_FAILED[reason])


def locked(remarks: Remarks, holding: Holding, strength: float) -> Remarks:
    """What the scene has said, and that all the ``strength`` of the hand [k R] moves nothing, because of what holds."""
    text = Text("locked at {strength:g} k R: {holding}", strength=strength, holding=holding.text)
    grains = remarks.highlight if holding.grains is None else holding.grains
    return Remarks((text,), grains, {**remarks.happening, "locked": text})

"""Bodies that a hand moves: ``core.rigid.RigidWorld.advance`` and ``core.tries.Tries.move_bodies`` as kernels.

Bodies that a person has drawn are not there. A disc that is dragged anywhere, which pymunk moves on the desk, goes straight to
where it is wanted here, and as far out of walls as it would be in them.
"""

from __future__ import annotations

import math

import numpy as np

from core.hand import SLACK
from core.jit import kernel
from core.rigid import SAME_POINT
from core.rigid_contacts import EDGE
from sandbox.web.increment.systems import (
    ASKED,
    AXIS_X,
    AXIS_Y,
    HOME_X,
    HOME_Y,
    LEAST,
    MOST,
    RADIUS,
    TO_X,
    TO_Y,
    X,
    Y,
)

# What stopped a body.
NOTHING, FORCE_LIMIT, END_OF_TRAVEL, WALL = range(4)
PASSES = 4  # over all walls: in a corner a disc is in two of them


@kernel(fastmath=False)
def square(x):
    """x² as two numbers whose sum is exact (Veltkamp, Dekker)."""
    high = x * 134217729.0
    high -= high - x
    low = x - high
    whole = x * x
    return whole, ((high * high - whole) + 2.0 * high * low) + low * low


@kernel(fastmath=False)
def hypotenuse(x, y):
    """√(x² + y²), rounded once: what ``math.hypot`` gives."""
    a, b = square(x)
    c, d = square(y)
    whole = a + c
    part = whole - a
    rest = (a - (whole - part)) + (c - part) + b + d
    root = math.sqrt(whole)
    e, f = square(root)
    return root + 0.5 * ((whole - e) - f + rest) / root


@kernel(allocates=True)
def rows_of(bodies):
    """The primitives (M, 8) where the bodies are, edges first made anew from their ends, as ``core.rigid`` does."""
    rows, joints = bodies.local.copy(), bodies.joints
    for m in range(rows.shape[0]):
        body = bodies.owner[m]
        x, y = bodies.places[body, X], bodies.places[body, Y]
        rows[m, 1] += x
        rows[m, 2] += y
        if rows[m, 0] == EDGE:
            rows[m, 5] += x
            rows[m, 6] += y
            dx, dy = rows[m, 5] - rows[m, 1], rows[m, 6] - rows[m, 2]
            length = hypotenuse(dx, dy)
            rows[m, 3] = dx / length
            rows[m, 4] = dy / length
    for m in range(rows.shape[0]):
        for side in range(2):
            edge = abs(joints[m, side]) - 1
            if edge >= 0:
                sign = 1.0 if joints[m, side] > 0 else -1.0
                rows[m, 3 + 2 * side] = sign * rows[edge, 3]
                rows[m, 4 + 2 * side] = sign * rows[edge, 4]
    return rows


@kernel
def slide(place, wanted, step):
    """Move a body (PLACES,) along its axis by ``wanted`` and at most ``step`` [R], within its travel.

    Returns dx, dy, and what stops it.
    """
    ax, ay = place[AXIS_X], place[AXIS_Y]
    stood = (place[X] - place[HOME_X]) * ax + (place[Y] - place[HOME_Y]) * ay
    asked = stood + min(max(wanted, -step), step)
    allowed = min(max(asked, place[LEAST]), place[MOST])
    amount = allowed - stood
    dx, dy = amount * ax, amount * ay
    place[X] += dx
    place[Y] += dy
    return dx, dy, END_OF_TRAVEL if allowed != asked else NOTHING


@kernel
def out_of_walls(bodies, body, x, y):
    """The place nearest to (x, y) [R] where a disc that is dragged touches the other bodies, if it is in one there."""
    rows, reach = bodies.local, bodies.places[body, RADIUS]
    for _ in range(PASSES):
        for m in range(rows.shape[0]):
            owner = bodies.owner[m]
            if owner == body:
                continue
            ax, ay = rows[m, 1] + bodies.places[owner, X], rows[m, 2] + bodies.places[owner, Y]
            if rows[m, 0] == EDGE:
                wx = rows[m, 5] + bodies.places[owner, X] - ax
                wy = rows[m, 6] + bodies.places[owner, Y] - ay
                along = ((x - ax) * wx + (y - ay) * wy) / (wx * wx + wy * wy)
                along = min(max(along, 0.0), 1.0)
                ax += along * wx
                ay += along * wy
            dx, dy = x - ax, y - ay
            distance = math.sqrt(dx * dx + dy * dy)
            apart = reach + rows[m, 7]
            if 0.0 < distance < apart:
                x = ax + apart / distance * dx
                y = ay + apart / distance * dy
    return x, y


@kernel
def drag(bodies, body, x, y, step):
    """Move a disc towards (x, y) by at most ``step`` [R], as ``slide``."""
    place = bodies.places[body]
    dx, dy = x - place[X], y - place[Y]
    distance = hypotenuse(dx, dy)
    if distance > step:
        share = step / distance
        dx *= share
        dy *= share
    to_x, to_y = out_of_walls(bodies, body, place[X] + dx, place[Y] + dy)
    moved_x, moved_y = to_x - place[X], to_y - place[Y]
    place[X] = to_x
    place[Y] = to_y
    asked = dx * dx + dy * dy
    short = asked > SAME_POINT * SAME_POINT and moved_x * dx + moved_y * dy < 0.5 * asked
    return moved_x, moved_y, WALL if short else NOTHING


@kernel
def advance(bodies, body, x, y, step):
    """Move a body towards (x, y) by at most ``step`` [R]."""
    place = bodies.places[body]
    if place[RADIUS] > 0.0:
        return drag(bodies, body, x, y, step)
    wanted = (x - place[X]) * place[AXIS_X] + (y - place[Y]) * place[AXIS_Y]
    return slide(place, wanted, step)


@kernel
def way_to(place, x, y):
    """How far a body is from where it is wanted [R], along its axis if it has one."""
    dx, dy = x - place[X], y - place[Y]
    if place[RADIUS] > 0.0:
        return hypotenuse(dx, dy) if dx != 0.0 or dy != 0.0 else 0.0
    return abs(dx * place[AXIS_X] + dy * place[AXIS_Y])


@kernel
def pull_on(place, x, y):
    """The way in which the hand pulls a body towards (x, y): a unit vector, 0 where the body is there."""
    if place[RADIUS] > 0.0:
        length = way_to(place, x, y)
        if 0.0 < length < np.inf:
            return (x - place[X]) / length, (y - place[Y]) / length
        return 0.0, 0.0
    along = np.sign((x - place[X]) * place[AXIS_X] + (y - place[Y]) * place[AXIS_Y])
    return along * place[AXIS_X], along * place[AXIS_Y]


@kernel
def force_on_body(reactions, body, pull_x, pull_y):
    """``core.hand.force_on_body``."""
    return -(reactions[body, 0] * pull_x + reactions[body, 1] * pull_y) + 0.0


@kernel
def too_much(force, strength):
    """True if that is more force [k R] than the hand has."""
    return force > strength * (1.0 + SLACK)


@kernel
def move_bodies(bodies, wanted, reactions, share, step, strength, moved, pulled, stopped):
    """Each body that is asked for towards its target, or back where the grains push harder than the hand.

    Fills ``moved`` (B, 2) [R], ``pulled`` (B, 2) and ``stopped`` (B,). Returns the hand's force before anything moved [k R].
    """
    before = -np.inf
    for body in range(wanted.shape[0]):
        moved[body, 0] = 0.0
        moved[body, 1] = 0.0
        stopped[body] = NOTHING
        if wanted[body, ASKED] == 0.0:
            continue
        place, x, y = bodies.places[body], wanted[body, TO_X], wanted[body, TO_Y]
        pull_x, pull_y = pull_on(place, x, y)
        pulled[body, 0] = pull_x
        pulled[body, 1] = pull_y
        force = force_on_body(reactions, body, pull_x, pull_y)
        before = max(before, force)
        if share != 0.0:
            if too_much(force, strength):
                back_x, back_y = place[X] - step * pull_x, place[Y] - step * pull_y
                dx, dy, _ = advance(bodies, body, back_x, back_y, step)
                stopped[body] = FORCE_LIMIT
            else:
                dx, dy, why = advance(bodies, body, x, y, share * step)
                stopped[body] = why
            moved[body, 0] = dx
            moved[body, 1] = dy
        if share < 1.0:
            stopped[body] = FORCE_LIMIT
    return before


@kernel
def hand_force(wanted, pulled, reactions):
    """The hand's force along its pull [k R], the largest of those on several bodies; nan where it pulls at nothing."""
    most, any_pull = -np.inf, False
    for body in range(wanted.shape[0]):
        if wanted[body, ASKED] != 0.0:
            any_pull = True
            most = max(most, force_on_body(reactions, body, pulled[body, 0], pulled[body, 1]))
    return most if any_pull else np.nan

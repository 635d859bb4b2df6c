"""A run under way: the hand or the script pulls, increments follow one another. What ``sandbox.session`` does, as kernels.

One driven body that slides or is dragged; what the session says to a person is in ``remarks``.
"""

from __future__ import annotations

import numpy as np

from core.jit import kernel
from sandbox.web.increment.bodies import FORCE_LIMIT, NOTHING, hypotenuse, way_to
from sandbox.web.increment.cell import CELL, box_of, nearest_image
from sandbox.web.increment.curve import plotted
from sandbox.web.increment.increment import failed, increment
from sandbox.web.increment.memory import (
    COUNTS,
    PART,
    ROW,
    SETTINGS,
    SIZES,
    clear,
    counts_of,
    floats_at,
    ints_at,
    row_of,
    system_in,
)
from sandbox.web.increment.outlet import remove_gone
from sandbox.web.increment.relaxation import ITERATION_LIMIT
from sandbox.web.increment.systems import (
    ASKED,
    AXIS_X,
    AXIS_Y,
    HOME_X,
    HOME_Y,
    PLACES,
    RADIUS,
    TO_X,
    TO_Y,
    X,
    Y,
)
from scenes.scene import AT_REST

ARRIVED = 1e-6  # [R] a body this near its target is there
LOCKED_AFTER = 3  # increments in a row that all the strength of the hand could not make
STUCK = 1e-3  # of a step: a body that moves less than that is stopped
MOST_RELAXATIONS = 5  # increments after a change, if it takes more than one to relax
# Commands.
GRAB, MOVE, RELEASE, SCRIPT_ON, SCRIPT_OFF = range(5)


@kernel(allocates=True)
def command(kept, kind, body, x, y):
    """What a hand does, or who starts the script. What goes round is moved to that image of a place which is nearest."""
    counts, bodies = counts_of(kept), kept.ints[SIZES.bodies]
    targets = floats_at(kept, PART.targets, 3 * bodies)
    blocked = ints_at(kept, PART.blocked, bodies)
    if kind == MOVE:
        targets[3 * body + ASKED] = 1.0
        here = floats_at(kept, PART.places, PLACES * bodies)[PLACES * body + X]
        box = box_of(floats_at(kept, PART.cell, CELL))
        targets[3 * body + TO_X] = nearest_image(box, here, x)
        targets[3 * body + TO_Y] = y
        blocked[body] = 0
    elif kind == RELEASE:
        targets[3 * body + ASKED] = 0.0
    else:
        clear(targets)
        counts[COUNTS.script] = 0 if kind == SCRIPT_ON else -1
        if kind != GRAB:
            clear(blocked)


@kernel(allocates=True)
def touched(kept):
    """Something was changed: what is stuck tries again, and grains relax where they stand."""
    counts = counts_of(kept)
    clear(ints_at(kept, PART.blocked, kept.ints[SIZES.bodies]))
    counts[COUNTS.stuck] = 0
    counts[COUNTS.touched] = MOST_RELAXATIONS if counts[COUNTS.rows] else 0


@kernel(allocates=True)
def set_strength(kept, strength):
    """The strength of the hand [k R]."""
    floats_at(kept, PART.settings, 7)[5] = strength
    touched(kept)


@kernel(allocates=True)
def set_friction(kept, coefficient):
    """Coulomb's coefficient; contacts forget where there was no friction, or is none now."""
    settings = floats_at(kept, PART.settings, 7)
    if settings[6] == 0.0 or coefficient == 0.0:
        ints_at(kept, PART.known, 1)[0] = 0
        clear(floats_at(kept, PART.spin, kept.ints[SIZES.grains]))
    settings[6] = coefficient
    touched(kept)


@kernel(allocates=True)
def set_ratio(kept, auxetic, ratio):
    """Poisson's ratio of the regular grains, or of the auxetic ones."""
    ratios = floats_at(kept, PART.poisson_ratio, kept.ints[SIZES.grains])
    for i in range(ratios.shape[0]):
        if (np.copysign(1.0, ratios[i]) < 0.0) == (auxetic != 0):
            ratios[i] = ratio
    touched(kept)


@kernel(allocates=True)
def set_ratios(kept, size):
    """Poisson's ratio of all grains, with the sign of their kinds."""
    set_ratio(kept, 0, size)
    set_ratio(kept, 1, -size)


@kernel(allocates=True)
def set_weight(kept, weight, fall):
    """Weight of a large grain [k/R], and how far one that nothing holds sinks in an increment [R], in an upright hopper."""
    settings, row = floats_at(kept, PART.settings, SETTINGS), row_of(kept)
    drag = weight / fall
    settings[7], settings[8], settings[9] = 0.0, -weight, drag
    row[ROW.rest] = AT_REST * weight / drag
    touched(kept)


@kernel(allocates=True)
def ask(kept, system):
    """Fill in where bodies are to go in the next increment; the script is one further then. True if anything is asked for."""
    counts, ints = counts_of(kept), kept.ints
    wanted, places = system.wanted, system.bodies.places
    clear(floats_at(kept, PART.wanted, 3 * ints[SIZES.bodies]))
    if counts[COUNTS.touched] or not counts[COUNTS.rows]:
        return True
    flat = floats_at(kept, PART.targets, 3 * ints[SIZES.bodies])
    if counts[COUNTS.script] >= 0:
        at, body = counts[COUNTS.script], counts[COUNTS.driven]
        clear(flat)
        steps = ints[SIZES.steps]
        if ints[SIZES.grains] > 0 if counts[COUNTS.repeats] else at < steps:
            at %= steps
            way = floats_at(kept, PART.script, 2 * steps)
            counts[COUNTS.script] += 1
            flat[3 * body + ASKED] = wanted[body, ASKED] = 1.0
            flat[3 * body + TO_X] = wanted[body, TO_X] = way[2 * at]
            flat[3 * body + TO_Y] = wanted[body, TO_Y] = way[2 * at + 1]
            return True
        counts[COUNTS.script] = -1
    blocked = ints_at(kept, PART.blocked, ints[SIZES.bodies])
    found = False
    for body in range(wanted.shape[0]):
        x, y = flat[3 * body + TO_X], flat[3 * body + TO_Y]
        far = way_to(places[body], x, y) > ARRIVED
        if flat[3 * body + ASKED] != 0.0 and not blocked[body] and far:
            wanted[body, ASKED] = 1.0
            wanted[body, TO_X] = x
            wanted[body, TO_Y] = y
            found = True
    return found or counts[COUNTS.moving] != 0


@kernel(allocates=True)
def tell_what_stopped(kept, wanted, made, step):
    """What is stuck tries again only when the hand moves; a hand that is not strong enough tries ``LOCKED_AFTER`` times."""
    counts = counts_of(kept)
    blocked = ints_at(kept, PART.blocked, kept.ints[SIZES.bodies])
    limited, still, asked = False, True, False
    for body in range(wanted.shape[0]):
        if wanted[body, ASKED] == 0.0:
            continue
        asked = True
        limited = limited or made.stopped[body] == FORCE_LIMIT
        dx, dy = made.moved[body, 0], made.moved[body, 1]
        still = still and np.sqrt(dx * dx + dy * dy) < STUCK * step
    if asked:
        counts[COUNTS.stuck] = counts[COUNTS.stuck] + 1 if limited and still else 0
    locked = counts[COUNTS.stuck] >= LOCKED_AFTER
    if limited and counts[COUNTS.script] >= 0:
        counts[COUNTS.script] = -1 if locked else counts[COUNTS.script] - 1
    fell = failed(made.reason)
    for body in range(wanted.shape[0]):
        if wanted[body, ASKED] == 0.0:
            continue
        dx, dy = made.moved[body, 0], made.moved[body, 1]
        stuck = np.sqrt(dx * dx + dy * dy) < STUCK * step
        why = made.stopped[body]
        if fell or (locked if why == FORCE_LIMIT else why != NOTHING and stuck):
            blocked[body] = 1
    if fell:
        counts[COUNTS.script] = -1


@kernel(allocates=True)
def follow(kept, system, made):
    """How far the driven body has come [R]; of one that is dragged, all its ways, and its drive goes as the hand pulls."""
    row, driven = row_of(kept), counts_of(kept)[COUNTS.driven]
    place = system.bodies.places[driven]
    if place[RADIUS] == 0.0:
        x, y = place[X] - place[HOME_X], place[Y] - place[HOME_Y]
        return x * place[AXIS_X] + y * place[AXIS_Y]
    if failed(made.reason):
        return row[ROW.stroke]
    if made.pulled[driven, 0] != 0.0 or made.pulled[driven, 1] != 0.0:
        row[ROW.direction_x], row[ROW.direction_y] = made.pulled[driven]
    dx, dy = made.moved[driven]
    return row[ROW.stroke] + np.sqrt(dx * dx + dy * dy)


@kernel(allocates=True)
def go_on(kept, reason, left, at_start):
    """With drag: whether the grains are still on their way; after the start they are."""
    row, n = row_of(kept), kept.ints[SIZES.grains]
    last, farthest = floats_at(kept, PART.last, 5 * n), 0.0
    for i in range(n):
        x, y = last[i], last[n + i]
        farthest = max(farthest, hypotenuse(x, y) if x != 0.0 or y != 0.0 else 0.0)
    falls = row[ROW.rest] < np.inf and not failed(reason)
    on_the_way = falls and (at_start or left > 0 or farthest > row[ROW.rest])
    counts_of(kept)[COUNTS.moving] = 1 if on_the_way else 0


@kernel(allocates=True)
def advance(kept):
    """One increment, if anything is to be done: 1 then, else 0."""
    system, counts, row = system_in(kept), counts_of(kept), row_of(kept)
    if not ask(kept, system):
        return 0
    rubs = system.settings.coefficient > 0.0
    made = increment(system, 0) if rubs else increment(system, None)
    at_start = not counts[COUNTS.rows]
    counts[COUNTS.changed] = 1 if counts[COUNTS.touched] else 0
    if counts[COUNTS.touched]:
        fewer = counts[COUNTS.touched] - 1
        counts[COUNTS.touched] = fewer if made.reason == ITERATION_LIMIT else 0
    if not at_start:
        tell_what_stopped(kept, system.wanted, made, system.settings.step)
    driven = counts[COUNTS.driven]
    push = system.past.reactions[driven]
    place = system.bodies.places[driven]
    left = 0 if at_start else remove_gone(kept)
    go_on(kept, made.reason, left, at_start)
    stroke = follow(kept, system, made)
    resisting = -(push[0] * row[ROW.direction_x] + push[1] * row[ROW.direction_y]) + 0.0
    row[ROW.stroke], row[ROW.resisting] = plotted(
        counts[COUNTS.curve],
        stroke,
        resisting,
        system.past.reactions,
        row[ROW.side],
        place[HOME_Y],
        counts[COUNTS.rows],
        counts[COUNTS.out] + left,
    )
    ax, ay = place[AXIS_X], place[AXIS_Y]
    if place[RADIUS] > 0.0:
        ax, ay = row[ROW.direction_x], row[ROW.direction_y]
    along = push[0] * ax + push[1] * ay
    row[ROW.hand_x] = -along * ax
    row[ROW.hand_y] = -along * ay
    row[ROW.residual] = made.residual
    row[ROW.scale] = made.scale
    if at_start or not failed(made.reason):
        row[ROW.energy] = made.energy
    row[ROW.share] = made.share
    squares = 0.0
    for i in range(made.unbalanced.shape[1]):
        x, y = made.unbalanced[0, i], made.unbalanced[1, i]
        squares += x * x + y * y
    row[ROW.unbalanced] = np.sqrt(squares)
    if left:
        row[ROW.waited] = row[ROW.stroke] - row[ROW.exit_stroke]
        row[ROW.exit_stroke] = row[ROW.stroke]
        row[ROW.exit_force] = row[ROW.resisting]
    counts[COUNTS.rows] += 1
    counts[COUNTS.out] += left
    counts[COUNTS.left] = left
    counts[COUNTS.reason] = made.reason
    counts[COUNTS.iterations] = made.iterations
    stopped = ints_at(kept, PART.stopped, kept.ints[SIZES.bodies])
    for body in range(stopped.shape[0]):
        stopped[body] = made.stopped[body]
    return 1

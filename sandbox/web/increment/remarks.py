"""What is said about an increment, as numbers: the notices of ``sandbox.session.course`` and the remarks of the scenes.

``sandbox.web.sentences`` has the words.
"""

from __future__ import annotations

import math

import numpy as np

from core.jit import kernel
from sandbox.web.increment.arches import arch, bearing
from sandbox.web.increment.bodies import END_OF_TRAVEL, FORCE_LIMIT, WALL
from sandbox.web.increment.contacts import AT_X
from sandbox.web.increment.course import LOCKED_AFTER, STUCK
from sandbox.web.increment.curve import LEFT, RIGHT
from sandbox.web.increment.falls import sudden_fall, who_took_part
from sandbox.web.increment.memory import (
    COLUMNS,
    COUNTS,
    KINDS,
    PART,
    ROW,
    SAID,
    SENTENCES,
    SIZES,
    clear,
    counts_of,
    floats_at,
    ints_at,
    row_of,
)
from sandbox.web.increment.relaxation import COLLAPSED, NOT_FINITE, SUNK
from sandbox.web.increment.systems import HOME_X, X
from scenes.gravity_hopper import PAUSE
from scenes.hopper import DIAMETER
from scenes.single_grain import NOISE

# Scenes that have something to say.
NOBODY, HOPPER, GRAVITY, DISC, ROW_OF_GRAINS, SINGLE, SHEAR = range(7)
# Kinds of events, as ``scenes.scene.Happening``.
LOCKED, CLOG, ARCH, AVALANCHE = range(KINDS)
NO_EVENT = -1
# Sentences, in the order of ``sandbox.web.sentences``.
HAND_LIMIT, TRAVEL_ENDS, STOPPED_BY_WALL, FLATTENED, BLEW_UP, PRESSED_IN = range(6)
FORCE_FELL, ARCH_HOLDS, CLOGGED, CLOGGED_BY_ARCH, EMPTY, FLOWING, FLOWS_AGAIN = range(6, 13)
AT_REST, NEVER_STARTED, CLOGGED_AT_REST, LOCKED_BY_ARCH, LOCKED_BY, LOCKED_BY_ALL = range(13, 19)
SIDEWAYS, SIDEWAYS_AND_ROOM = 19, 20
STRAINS, STRAINS_AND_RATIO, AUXETIC_STRAINS, AUXETIC_STRAINS_AND_RATIO = range(21, 25)
STRESSES, NO_HOLD, STRESS_FELL = range(25, 28)
FLOOR = 0  # of a row of grains


@kernel(allocates=True)
def said_of(kept):
    """The part ``said``."""
    return floats_at(kept, PART.said, SENTENCES * COLUMNS).reshape(SENTENCES, COLUMNS)


@kernel(allocates=True)
def say(kept, sentence, event, first, second, third, fourth):
    """One more sentence with its numbers, and the kind of event that goes on, or ``NO_EVENT``."""
    counts = counts_of(kept)
    at = counts[COUNTS.said]
    if at == SENTENCES:
        return
    row = said_of(kept)[at]
    row[SAID.sentence], row[SAID.shown], row[SAID.event] = sentence, 1.0, event
    row[SAID.values], row[SAID.values + 1] = first, second
    row[SAID.values + 2], row[SAID.values + 3] = third, fourth
    counts[COUNTS.said] = at + 1


@kernel(allocates=True)
def point(kept, grains):
    """At these of the grains (N,)."""
    pointed = ints_at(kept, PART.pointed, grains.shape[0])
    for i in range(grains.shape[0]):
        pointed[i] = grains[i]


@kernel(allocates=True)
def remark(kept, system, contacts):
    """All that is to be said about the newest increment."""
    counts, n = counts_of(kept), kept.ints[SIZES.grains]
    counts[COUNTS.said] = 0
    clear(ints_at(kept, PART.pointed, n))
    about_the_hand(kept, system)
    first, scene = counts[COUNTS.said], counts[COUNTS.scene]
    if scene in (HOPPER, DISC):
        about_a_drive(kept, system, contacts)
    elif scene == GRAVITY:
        about_gravity(kept, system, contacts)
    elif scene == ROW_OF_GRAINS:
        about_a_row(kept, system)
    elif scene == SHEAR:
        about_a_shear(kept, system, contacts)
    elif scene == SINGLE and contacts.grain.shape[0]:
        about_single_grains(kept, system)
    if counts[COUNTS.stuck] >= LOCKED_AFTER:
        said = said_of(kept)
        for k in range(first, counts[COUNTS.said]):
            said[k, SAID.shown] = 0.0
        about_a_lock(kept, system, contacts)
    announce(kept)


@kernel(allocates=True)
def about_the_hand(kept, system):
    """What held it back, and what was taken back (``Course.tell_what_stopped``)."""
    counts, settings = counts_of(kept), system.settings
    stopped = ints_at(kept, PART.stopped, kept.ints[SIZES.bodies])
    for body in range(stopped.shape[0]):
        dx, dy = system.past.moved[body]
        stuck = math.sqrt(dx * dx + dy * dy) < STUCK * settings.step
        if stopped[body] == FORCE_LIMIT:
            if counts[COUNTS.stuck] < LOCKED_AFTER:
                say(kept, HAND_LIMIT, NO_EVENT, settings.hand_strength, 0.0, 0.0, 0.0)
        elif stopped[body] == END_OF_TRAVEL:
            say(kept, TRAVEL_ENDS, NO_EVENT, 0.0, 0.0, 0.0, 0.0)
        elif stopped[body] == WALL and stuck:
            say(kept, STOPPED_BY_WALL, NO_EVENT, 0.0, 0.0, 0.0, 0.0)
    reason = counts[COUNTS.reason]
    if reason == COLLAPSED:
        say(kept, FLATTENED, NO_EVENT, 0.0, 0.0, 0.0, 0.0)
    elif reason == NOT_FINITE:
        say(kept, BLEW_UP, NO_EVENT, 0.0, 0.0, 0.0, 0.0)
    elif reason == SUNK:
        say(kept, PRESSED_IN, NO_EVENT, 0.0, 0.0, 0.0, 0.0)


@kernel(allocates=True)
def standing_arch(kept, system, contacts):
    """``arch`` over the orifice of the scene."""
    owner, side = system.bodies.owner, ints_at(kept, PART.side, kept.ints[SIZES.bodies])
    where = np.zeros(contacts.grain.shape[0], np.int64)
    by_place = counts_of(kept)[COUNTS.scene] == GRAVITY  # one body has both sides
    for k in range(contacts.grain.shape[0]):
        body = owner[contacts.primitive[k]]
        where[k] = side[body]
        if by_place:
            place = system.bodies.places[body]
            where[k] = -1 if contacts.body[AT_X, k] < place[X] - place[HOME_X] else 1
    return arch(system.grains.state, contacts, where, row_of(kept)[ROW.base])


@kernel(allocates=True)
def about_a_drive(kept, system, contacts):
    """``scenes.hopper.Hopper.remarks`` and that of the intruder."""
    row = row_of(kept)
    fall = sudden_fall(kept, system)
    if fall > 0.0:
        say(kept, FORCE_FELL, AVALANCHE, fall, 0.0, 0.0, 0.0)
        point(kept, who_took_part(kept, system, contacts))
        return
    since = row[ROW.stroke] - row[ROW.exit_stroke]
    held = since >= 0.5 * DIAMETER and row[ROW.resisting] > max(row[ROW.exit_force], 0.0)
    if counts_of(kept)[COUNTS.scene] != HOPPER or not held:
        return
    grains, count = standing_arch(kept, system, contacts)
    if count:
        point(kept, grains)
    if since < DIAMETER:
        if count:
            say(kept, ARCH_HOLDS, ARCH, count, 0.0, 0.0, 0.0)
        return
    sentence = CLOGGED_BY_ARCH if count else CLOGGED
    say(kept, sentence, CLOG, since / DIAMETER, count, 0.0, 0.0)


@kernel(allocates=True)
def about_gravity(kept, system, contacts):
    """``scenes.gravity_hopper.GravityHopper.remarks``."""
    counts, row, n = counts_of(kept), row_of(kept), kept.ints[SIZES.grains]
    left, at_start = counts[COUNTS.left], kept.ints[SIZES.capacity]
    if not n:
        say(kept, EMPTY, NO_EVENT, 0.0, 0.0, 0.0, 0.0)
        return
    if left and row[ROW.waited] > PAUSE and n + left < at_start:
        say(kept, FLOWS_AGAIN, AVALANCHE, n, 0.0, 0.0, 0.0)
        if not counts[COUNTS.changed]:
            point(kept, who_took_part(kept, system, contacts))
        return
    if counts[COUNTS.moving] or system.settings.drag == 0.0:
        if left:
            say(kept, FLOWING, NO_EVENT, 0.0, 0.0, 0.0, 0.0)
        return
    grains, count = standing_arch(kept, system, contacts)
    if not count:
        say(kept, AT_REST, NO_EVENT, n, 0.0, 0.0, 0.0)
        return
    point(kept, grains)
    if n == at_start:
        say(kept, NEVER_STARTED, ARCH, count, n, 0.0, 0.0)
    else:
        say(kept, CLOGGED_AT_REST, CLOG, count, n, 0.0, 0.0)


@kernel(allocates=True)
def about_a_row(kept, system):
    """``scenes.grain_row.GrainRow.remarks``."""
    reactions, state = system.past.reactions, system.grains.state
    down, n = -reactions[FLOOR, 1], state.shape[1]
    if down <= 0.0:
        return
    sideways = 0.5 * (reactions[RIGHT, 0] - reactions[LEFT, 0])
    share = 100.0 * sideways / (down / n)
    wide = 0.0
    for i in range(n):
        wide += state[2, i] + state[3, i]
    room = row_of(kept)[ROW.side] - 2.0 * wide
    sentence = SIDEWAYS_AND_ROOM if room > 1e-6 else SIDEWAYS
    say(kept, sentence, NO_EVENT, share, room, 0.0, 0.0)


@kernel(allocates=True)
def about_a_shear(kept, system, contacts):
    """``scenes.couette.Couette.remarks``."""
    push = system.past.reactions[counts_of(kept)[COUNTS.driven]]
    wide = row_of(kept)[ROW.side]
    shear, normal = -push[0] / wide + 0.0, push[1] / wide + 0.0
    if normal <= 0.0:
        say(kept, NO_HOLD, NO_EVENT, 0.0, 0.0, 0.0, 0.0)
        return
    say(kept, STRESSES, NO_EVENT, normal, shear / normal, 0.0, 0.0)
    fall = sudden_fall(kept, system)
    if fall > 0.0:
        say(kept, STRESS_FELL, AVALANCHE, fall, 0.0, 0.0, 0.0)
        point(kept, who_took_part(kept, system, contacts))


@kernel(allocates=True)
def about_single_grains(kept, system):
    """``scenes.single_grain.SingleGrain.remarks``."""
    grains = system.grains
    for i in range(grains.label.shape[0]):
        p, q1, rest = grains.state[2, i], grains.state[3, i], grains.rest_radius[i]
        nu = grains.poisson_ratio[i]
        tall, wide = (p - q1) / rest - 1.0, (p + q1) / rest - 1.0
        sentence = AUXETIC_STRAINS if nu < 0.0 else STRAINS
        if tall < -NOISE:
            say(kept, sentence + 1, NO_EVENT, 100.0 * tall, 100.0 * wide, -wide / tall, nu)
        else:
            say(kept, sentence, NO_EVENT, 100.0 * tall, 100.0 * wide, 0.0, 0.0)


@kernel(allocates=True)
def about_a_lock(kept, system, contacts):
    """What all the strength of the hand cannot overcome (``Scene.what_holds``)."""
    counts, strength = counts_of(kept), system.settings.hand_strength
    count = 0
    if counts[COUNTS.scene] == HOPPER:
        grains, count = standing_arch(kept, system, contacts)
        if count:
            point(kept, grains)
            say(kept, LOCKED_BY_ARCH, LOCKED, strength, count, 0.0, 0.0)
            return
    n, owner = kept.ints[SIZES.grains], system.bodies.owner
    grains, count = bearing(n, contacts, owner, counts[COUNTS.driven])
    if count < 0:
        say(kept, LOCKED_BY_ALL, LOCKED, strength, 0.0, 0.0, 0.0)
        return
    point(kept, grains)
    say(kept, LOCKED_BY, LOCKED, strength, count, 0.0, 0.0)


@kernel(allocates=True)
def announce(kept):
    """Leave the kinds of those events alone that begin; a clog or an arch remains the same one until a grain has left."""
    counts, said = counts_of(kept), said_of(kept)
    going_on = ints_at(kept, PART.going_on, KINDS)
    announced, before = ints_at(kept, PART.announced, KINDS), going_on.copy()
    clear(going_on)
    out = counts[COUNTS.out]
    for k in range(counts[COUNTS.said]):
        kind = int(said[k, SAID.event])
        if kind == NO_EVENT:
            continue
        going_on[kind] = 1
        same = kind in (CLOG, ARCH) and announced[kind] == out
        if before[kind] or same:
            said[k, SAID.event] = NO_EVENT
        else:
            announced[kind] = out

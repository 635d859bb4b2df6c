"""One load increment from beginning to end: ``core.quasistatic.Quasistatic`` as one kernel, in a cell that stays as it is.

Bodies slide by at most a step; the grains are predicted, relaxed and observed; a hand that has overpowered itself goes back and
tries a shorter way; what has failed is taken back. A scene without friction has coefficient 0, and runs code that knows of none.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from core import fire
from core.arrays import Floats
from core.frictional_contacts import Origin, Pulls, before_lists
from core.hand import MOST_TRIES, SHORTEST, SLACK
from core.jit import kernel
from core.passage import deep_grains, pass_faces
from core.prediction import carry_on
from sandbox.web.increment.bodies import hand_force, move_bodies, rows_of, too_much
from sandbox.web.increment.contacts import IMAGE_X, IMAGE_Y, OVERLAP, Touching, reactions, touching
from sandbox.web.increment.relaxation import (
    BUDGET,
    COLLAPSED,
    ITERATION_LIMIT,
    NOT_FINITE,
    SUNK,
    no_pulls,
    relax,
)
from sandbox.web.increment.systems import ASKED, TURN, X, Y


class Increment(NamedTuple):
    """What one increment came to."""

    reason: int  # why its relaxation ended
    iterations: int  # force evaluations, all tries together
    energy: float  # [k R²]
    residual: float
    scale: float  # mean contact force [k R]
    share: float  # of a step that the hand's strength was enough for
    force: float  # of the hand [k R]; nan where it pulls at nothing
    stood: bool  # nothing has changed
    moved: Floats  # (B, 2) [R]
    pulled: Floats  # (B, 2) unit vectors, or 0
    stopped: np.ndarray  # (B,) see ``bodies``
    unbalanced: Floats  # (2, N) [k R]; 0 if it failed
    contacts: Touching
    pulls: Pulls


@kernel
def failed(reason):
    """True for what is taken back."""
    return reason in (NOT_FINITE, COLLAPSED, SUNK)


@kernel(allocates=True)
def origin_of(system, rows, before):
    """Where slips are counted from; bodies turn from ``before`` (B,) [rad]."""
    memory, bodies = system.memory, system.bodies
    count = memory.known[0]
    turn = np.empty(rows.shape[0])
    for m in range(turn.shape[0]):
        body = bodies.owner[m]
        turn[m] = bodies.places[body, TURN] - before[body, 2]
    return Origin(
        system.settings.coefficient,
        system.grains.state.copy(),
        system.box,
        rows,
        turn,
        system.grains.label,
        memory.keys[:count].copy(),
        memory.slips[:count].copy(),
    )


@kernel(allocates=True)
def remember(memory, relaxed):
    """Take up what contacts hold, and how far grains have turned."""
    count = relaxed.known.shape[0]
    if count > memory.keys.shape[0]:
        raise MemoryError
    memory.known[0] = count
    memory.keys[:count] = relaxed.known
    memory.slips[:count] = relaxed.slips
    memory.spin[:] += relaxed.turned


@kernel(allocates=True)
def predict(grains, past, moved, contacts):
    """Start from the displacement of the increment before, as far as the bodies go on as they went."""
    before, now, along = 0.0, 0.0, 0.0
    for body in range(moved.shape[0]):
        old_x, old_y = past.moved[body, 0], past.moved[body, 1]
        x, y = moved[body, 0], moved[body, 1]
        before += old_x * old_x + old_y * old_y
        now += x * x + y * y
        along += x * old_x + y * old_y
    if along <= 0.0:
        return
    share = min(along / before, 1.0)
    held = np.zeros(grains.label.shape[0])
    held[contacts.i] = 1.0
    held[contacts.j] = 1.0
    held[contacts.grain] = 1.0
    carry_on(grains.state, past.last, held, share, np.sqrt(now))


@kernel
def shorter(share, tries, force, before, strength):
    """``core.hand.Push.shorten``: the share of a way that is tried next, after ``tries`` of them."""
    if force < np.inf and force > before:
        aim = strength * (1.0 + 0.5 * SLACK)
        share *= min(max((aim - before) / (force - before), 0.0), 0.7)
    else:
        share *= 0.25
    return 0.0 if share < SHORTEST or tries > MOST_TRIES else share


@kernel(allocates=True, forceinline=False)
def attempt(system, origin, contacts, rows_now, first, moved, rows_then, max_iterations, crossed):
    """Predict and relax after the bodies have moved. Returns how it ended; the grains are as they were predicted."""
    grains, settings = system.grains, system.settings
    start = grains.state.copy()
    if settings.drag == 0.0:
        predict(grains, system.past, moved, first)
    image_x, image_y = first.body[IMAGE_X], first.body[IMAGE_Y]
    pass_faces(
        first.grain,
        first.primitive,
        image_x,
        image_y,
        start,
        grains.state,
        rows_then,
        rows_now,
        crossed,
    )
    # Without gravity and drag it adds 0 to each force and to the energy, which changes no bit, and saves code of its own.
    weight = fire.Weight(
        settings.gravity_x, settings.gravity_y, settings.drag, grains.state[:2].copy()
    )
    return relax(
        grains, system.box, rows_now, origin, contacts, weight, settings, max_iterations, crossed
    )


@kernel(allocates=True, forceinline=False)
def increment(system, rubs):
    """Move the bodies that are asked for one step towards their targets, and relax; with none: relax where things stand.

    ``rubs`` is None where there is no friction, and 0 where there is some: it decides which code is made. Everything in
    ``system`` is then as it is after the increment.
    """
    grains, bodies, settings = system.grains, system.bodies, system.settings
    memory, past, wanted, box = system.memory, system.past, system.wanted, system.box
    many = bodies.places.shape[0]
    moved, pulled = np.zeros((many, 2)), np.zeros((many, 2))
    stopped = np.zeros(many, np.int64)
    asked = False
    for body in range(many):
        asked = asked or wanted[body, ASKED] != 0.0
    limited = asked and settings.hand_strength < np.inf
    share, tries, spent, still = 1.0, 1, 0, False
    start, rows_then = grains.state.copy(), rows_of(bodies)
    places = bodies.places.copy()
    placed = np.empty((many, 3))
    placed[:, 0], placed[:, 1], placed[:, 2] = places[:, X], places[:, Y], places[:, TURN]
    first = touching(grains, rows_then, box)
    deep = deep_grains(grains.state, first.grain, first.body[OVERLAP], settings.step)
    told, told_stopped = moved.copy(), stopped.copy()
    while True:
        crossed = np.zeros((grains.label.shape[0], rows_then.shape[0]), np.bool_)
        before = -np.inf
        if still:
            moved[:] = 0.0
        else:
            before = move_bodies(
                bodies,
                wanted,
                past.reactions,
                share,
                settings.step,
                settings.hand_strength,
                moved,
                pulled,
                stopped,
            )
        most = 1 if still else settings.max_iterations
        relaxed = started(system, first, moved, rows_then, placed, most, crossed, rubs)
        reason = relaxed.reason
        if still:
            break
        contacts, pulls = first, relaxed.pulls
        if not failed(reason):
            grains.state[:] = relaxed.state
            rows = rows_of(bodies)
            contacts = touching(grains, rows, box)
            now = deep_grains(grains.state, contacts.grain, contacts.body[OVERLAP], settings.step)
            if np.any(crossed) or np.any(now & ~deep):
                reason = SUNK
        good = not failed(reason)
        force = np.inf
        if good:
            force = hand_force(wanted, pulled, reactions(bodies, contacts, pulls))
        if limited:
            way = False
            for body in range(many):
                way = way or moved[body, 0] != 0.0 or moved[body, 1] != 0.0
            given_way = too_much(before, settings.hand_strength)
            if way and not given_way and share > 0.0 and too_much(force, settings.hand_strength):
                tries += 1
                share = shorter(share, tries, force, before, settings.hand_strength)
                spent += relaxed.iterations
                grains.state[:] = start
                bodies.places[:] = places
                continue
            creeps = good and share == 0.0 and settings.drag == 0.0
            if creeps and too_much(force, settings.hand_strength):
                # At rest the force is right to the tolerance only, and friction creeps: what was within the strength stays.
                spent += relaxed.iterations
                grains.state[:] = start
                bodies.places[:] = places
                told[:], told_stopped[:] = moved, stopped
                still = True
                continue
        if not good:
            grains.state[:] = start
            bodies.places[:] = places
            contacts, pulls = touching(grains, rows_then, box), no_pulls()
            relaxed.unbalanced[:] = 0.0
        elif rubs is not None:
            remember(memory, relaxed)
        past.last[:] = grains.state - start
        past.moved[:] = moved
        if good or rubs is None:  # else they are as they were, with what friction had in them
            past.reactions[:] = reactions(bodies, contacts, pulls)
        break
    if still:
        grains.state[:] = start
        bodies.places[:] = places
        past.last[:] = 0.0
        moved[:], stopped[:] = told, told_stopped
        past.moved[:] = moved
        contacts, pulls = touching(grains, rows_then, box), no_pulls()
        reason = ITERATION_LIMIT if reason == BUDGET else reason
    return Increment(
        reason,
        spent + relaxed.iterations,
        relaxed.energy,
        relaxed.residual,
        relaxed.scale,
        share,
        hand_force(wanted, pulled, past.reactions),
        still,
        moved,
        pulled,
        stopped,
        relaxed.unbalanced,
        contacts,
        pulls,
    )


@kernel(allocates=True)
def started(system, first, moved, rows_then, placed, most, crossed, rubs):
    """``attempt`` with friction, or without."""
    rows_now = rows_of(system.bodies)
    if rubs is None:
        return attempt(system, None, None, rows_now, first, moved, rows_then, most, crossed)
    origin = origin_of(system, rows_then, placed)
    contacts = before_lists(origin, rows_now)
    return attempt(system, origin, contacts, rows_now, first, moved, rows_then, most, crossed)

"""Contacts as they stand, and what they do to bodies: ``core.observables`` as kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core import neighbors, observables, rigid_contacts
from core.arrays import Floats
from core.jit import kernel
from sandbox.web.increment.relaxation import lists_for, room_for
from sandbox.web.increment.systems import X, Y

Indices = NDArray[np.int64]
# Rows of ``Touching.pair`` and of ``Touching.body``.
FX, FY, FORCE, OVERLAP, DX, DY = range(6)
AT_X, AT_Y, IMAGE_X, IMAGE_Y = range(4, 8)


class Touching(NamedTuple):
    """All contacts that carry force, K between grains and L with bodies."""

    pairs: int  # K; the arrays have room for more
    i: Indices
    j: Indices
    pair: Floats  # (6, …)
    bodies: int  # L
    grain: Indices
    primitive: Indices
    body: Floats  # (8, …)


@kernel(allocates=True)
def support_coefficients(state):
    """``core.observables.support_coefficients``."""
    support = np.empty((3, state.shape[1]))
    for i in range(state.shape[1]):
        p, q1, q2 = state[2, i], state[3, i], state[4, i]
        support[0, i] = p * p + q1 * q1 + q2 * q2
        support[1, i] = 2.0 * p * q1
        support[2, i] = 2.0 * p * q2
    return support


@kernel(allocates=True, forceinline=False)
def touching(grains, primitives, box):
    """All contacts of the grains, with each other and with bodies."""
    state, stiffness = grains.state, grains.contact_stiffness
    count = state.shape[1]
    support = support_coefficients(state)
    room = 4 * count
    lists = lists_for(count, room, 0, False)
    pairs = neighbors.find_pairs(state, 0.0, lists, box) if count else 0
    while pairs < 0:
        room *= 2
        lists = lists_for(count, room, 0, False)
        pairs = neighbors.find_pairs(state, 0.0, lists, box)
    values = np.empty((6, pairs))
    first, second = lists.first, lists.second
    pairs = observables._measure_pairs(state, support, stiffness, pairs, first, second, box, values)
    rigid = room_for(primitives, 64 + 2 * max(count, 1))
    while not rigid_contacts.find_rigid_pairs(state, rigid, 0.0, box):
        rigid = room_for(primitives, 2 * rigid.grain.shape[0])
    by_bodies = np.empty((8, rigid.used[0]))
    bodies = observables._measure_rigid(state, support, stiffness, rigid, box, by_bodies)
    return Touching(pairs, first, second, values, bodies, rigid.grain, rigid.primitive, by_bodies)


@kernel(allocates=True)
def reactions(bodies, contacts, pulls):
    """Force and torque of the grains on each body (B, 3) [k R, k R²], friction included."""
    places, owner = bodies.places, bodies.owner
    total, rubbed = np.zeros((places.shape[0], 3)), np.zeros((places.shape[0], 3))
    values = contacts.body
    for k in range(contacts.bodies):
        body = owner[contacts.primitive[k]]
        x = values[AT_X, k] + values[IMAGE_X, k] - places[body, X]
        y = values[AT_Y, k] + values[IMAGE_Y, k] - places[body, Y]
        total[body, 0] += -values[FX, k]
        total[body, 1] += -values[FY, k]
        total[body, 2] += -(x * values[FY, k] - y * values[FX, k])
    who, pull = pulls.who, pulls.values
    for k in range(pulls.used):
        if who[1, k] >= 0:
            continue
        body = owner[who[2, k]]
        fx, fy = -pull[0, k], -pull[1, k]
        rubbed[body, 0] += fx
        rubbed[body, 1] += fy
        rubbed[body, 2] += (pull[2, k] - places[body, X]) * fy - (pull[3, k] - places[body, Y]) * fx
    if pulls.used:
        total += rubbed
    return total


@kernel(allocates=True)
def deep_grains(grains, contacts, step):
    """True for the grains (N,) so deep in a body that one more step [R] could take its face past their centre."""
    state = grains.state
    deep = np.zeros(state.shape[1], np.bool_)
    for k in range(contacts.bodies):
        i = contacts.grain[k]
        shorter = state[2, i] - np.sqrt(state[3, i] * state[3, i] + state[4, i] * state[4, i])
        if contacts.body[OVERLAP, k] + step >= shorter:
            deep[i] = True
    return deep


@kernel
def pass_faces(contacts, start, state, rows_then, rows_now, crossed):
    """Mark in ``crossed`` (N, M) the grains of ``contacts`` that have crossed a face that they touched, on a straight way."""
    for k in range(contacts.bodies):
        i, m = contacts.grain[k], contacts.primitive[k]
        if rows_now[m, 0] != rigid_contacts.EDGE:
            continue
        image_x, image_y = contacts.body[IMAGE_X, k], contacts.body[IMAGE_Y, k]
        ux, uy = rows_then[m, 3], rows_then[m, 4]
        dx, dy = start[0, i] + image_x - rows_then[m, 1], start[1, i] + image_y - rows_then[m, 2]
        along, beyond = dx * ux + dy * uy, ux * dy - uy * dx
        ux, uy = rows_now[m, 3], rows_now[m, 4]
        dx, dy = state[0, i] + image_x - rows_now[m, 1], state[1, i] + image_y - rows_now[m, 2]
        along_now, beyond_now = dx * ux + dy * uy, ux * dy - uy * dx
        length = (rows_now[m, 5] - rows_now[m, 1]) * ux + (rows_now[m, 6] - rows_now[m, 2]) * uy
        if (beyond >= 0.0) != (beyond_now >= 0.0):
            crossing = along + (along_now - along) * beyond / (beyond - beyond_now)
            if crossing >= 0.0 and crossing <= length:
                crossed[i, m] = True

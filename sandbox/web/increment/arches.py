"""``core.arches`` and ``scenes.bearing`` as kernels: which grains hold what is above, or what a body presses on."""

from __future__ import annotations

import math

import numpy as np

from core.arches import LENGTH_COST, WEAK
from core.jit import kernel
from sandbox.web.increment.contacts import AT_X, AT_Y, FORCE
from scenes.bearing import SHARE


@kernel
def cost(x0, y0, x1, y1, base):
    """Of a link: the area between it and the base [R²], and a little for its length."""
    height = max(0.5 * (y0 + y1) - base, 0.0)
    dx, dy = x1 - x0, y1 - y0
    return abs(dx) * height + LENGTH_COST * math.sqrt(dx * dx + dy * dy)


@kernel(allocates=True)
def arch(state, contacts, side, base):
    """1 for the grains (N,) of ``core.arches.arch``, and how many they are.

    ``side`` (L,) says where each contact with a body supports: −1 left of the orifice, 1 right of it, 0 neither.
    """
    n = state.shape[1]
    member = np.zeros(n, np.int64)
    total = 0.0
    for k in range(contacts.i.shape[0]):
        total += contacts.pair[FORCE, k]
    for k in range(contacts.grain.shape[0]):
        total += contacts.body[FORCE, k]
    weak = WEAK * total / max(contacts.i.shape[0] + contacts.grain.shape[0], 1)
    best, end = np.full(n, np.inf), np.full(n, np.inf)
    for k in range(contacts.grain.shape[0]):
        i = contacts.grain[k]
        if side[k] != 0 and contacts.body[FORCE, k] > weak:
            way = cost(
                state[0, i], state[1, i], contacts.body[AT_X, k], contacts.body[AT_Y, k], base
            )
            if side[k] < 0:
                best[i] = min(best[i], way)
            else:
                end[i] = min(end[i], way)
    came, done = np.full(n, -1), np.zeros(n, np.bool_)
    while True:
        here = -1
        for i in range(n):
            if not done[i] and best[i] < np.inf and (here < 0 or best[i] < best[here]):
                here = i
        if here < 0:
            break
        done[here] = True
        for k in range(contacts.i.shape[0]):
            i, j = contacts.i[k], contacts.j[k]
            if contacts.pair[FORCE, k] <= weak or (i != here and j != here):
                continue
            other = j if i == here else i
            there = best[here] + cost(state[0, i], state[1, i], state[0, j], state[1, j], base)
            if there < best[other]:
                best[other] = there
                came[other] = here
    last = -1
    for i in range(n):
        if best[i] + end[i] < np.inf and (last < 0 or best[i] + end[i] < best[last] + end[last]):
            last = i
    count = 0
    while last >= 0:
        member[last] = 1
        count += 1
        last = came[last]
    return member, count


@kernel(allocates=True)
def bearing(grains, contacts, owner, body):
    """1 for the grains (N,) of ``scenes.bearing.bearing``, and how many they are; −1 where nothing touches the body."""
    reached = np.zeros(grains, np.int64)
    most, touched = 0.0, False
    for k in range(contacts.grain.shape[0]):
        if owner[contacts.primitive[k]] == body:
            touched = True
            most = max(most, contacts.body[FORCE, k])
    if not touched:
        return reached, -1
    least, count = SHARE * most, 0
    for k in range(contacts.grain.shape[0]):
        i = contacts.grain[k]
        if owner[contacts.primitive[k]] == body and contacts.body[FORCE, k] >= least:
            count += 1 - reached[i]
            reached[i] = 1
    further = True
    while further:
        further = False
        for k in range(contacts.i.shape[0]):
            i, j = contacts.i[k], contacts.j[k]
            if contacts.pair[FORCE, k] >= least and reached[i] != reached[j]:
                reached[i] = reached[j] = 1
                count += 1
                further = True
    return reached, count

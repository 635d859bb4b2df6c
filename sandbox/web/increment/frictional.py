"""The frictional contacts of one relaxation: ``core.frictional_contacts`` as kernels, step by step as it is told there.

What is None where a scene has no friction is None here too, and no code for it exists then.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.frictional_contacts import BODY, GRAIN
from core.jit import kernel
from core.marks import lay_out, measure, slips
from core.neighbors import SLOT_PADDING
from core.rigid_contacts import EDGE, VERTEX
from core.slip import TANGENTIAL_STIFFNESS, FrictionTerms, prepare_friction

Indices = NDArray[np.int64]
SAME_POINT = 1e-9  # [R]


class Origin(NamedTuple):
    """``core.frictional_contacts.Origin``, with its box as kernels have it."""

    coefficient: float
    state: Floats  # (5, N) in the packing's order
    primitives: Floats  # (M, 8) before the bodies moved
    turn: Floats  # (M,) [rad]
    label: Indices  # (N,)
    keys: Indices  # (K,) ascending
    slips: Floats  # (K,) [R]


class Contacts(NamedTuple):
    """What ``core.frictional_contacts.FrictionalContacts`` knows, from one list to the next."""

    listed: bool  # have there been lists yet?
    keys: Indices  # of the listed pairs, first those of two grains
    known: Indices  # of the contacts that remember a slip, ascending
    slips: Floats  # and those [R]
    corners: Indices  # (M, 2)
    at_i: NDArray[np.uint32]
    at_j: NDArray[np.uint32]
    primitive: Indices
    marks: Floats  # (4, K)
    terms: FrictionTerms


class Pulls(NamedTuple):
    """Tangential forces at the end of an increment, (K,) each: what is needed of ``core.frictional_contacts.FrictionForces``."""

    i: Indices
    j: Indices  # -1: a rigid body
    primitive: Indices  # of a rigid body; -1 between grains
    fx: Floats  # on grain i [k R]
    fy: Floats
    x: Floats  # where it acts [R]
    y: Floats


@kernel(allocates=True)
def corners(primitives):
    """For each primitive (M, 2): the edges that a vertex lies between; -1 where there is none."""
    many = primitives.shape[0]
    found = np.full((many, 2), -1, np.int64)
    for v in range(many):
        if primitives[v, 0] != VERTEX:
            continue
        for side in range(2):
            ux, uy = primitives[v, 3 + 2 * side], primitives[v, 4 + 2 * side]
            for e in range(many):
                if primitives[e, 0] != EDGE:
                    continue
                radius = abs(primitives[e, 7] - primitives[v, 7])
                start = max(
                    abs(primitives[e, 1] - primitives[v, 1]),
                    abs(primitives[e, 2] - primitives[v, 2]),
                    abs(-primitives[e, 3] - ux),
                    abs(-primitives[e, 4] - uy),
                    radius,
                )
                end = max(
                    abs(primitives[e, 5] - primitives[v, 1]),
                    abs(primitives[e, 6] - primitives[v, 2]),
                    abs(primitives[e, 3] - ux),
                    abs(primitives[e, 4] - uy),
                    radius,
                )
                if min(start, end) < SAME_POINT:
                    found[v, side] = e
                    break
    return found


@kernel(allocates=True)
def first_contacts(origin, primitives):
    """Before the first lists; None without friction."""
    if origin is None:
        return None
    grains = origin.label.shape[0]
    return Contacts(
        False,
        np.zeros(0, np.int64),
        origin.keys,
        origin.slips,
        corners(primitives),
        np.zeros(0, np.uint32),
        np.zeros(0, np.uint32),
        np.zeros(0, np.int64),
        np.zeros((4, 0)),
        FrictionTerms(
            origin.coefficient,
            np.zeros((4, grains)),
            np.zeros((4, grains)),
            np.zeros((2, grains)),
            np.zeros((4, 0)),
            np.zeros((8, 0)),
            np.zeros((grains, 8)),
            np.zeros((4, 0)),
            origin.turn,
        ),
    )


@kernel(allocates=True, forceinline=False)
def held_now(m, contacts, primitives, box):
    """Geometry (7, K) and slips with their limits (2, K) of all pairs as they stand now."""
    many = contacts.at_i.shape[0]
    place, held = np.empty((7, many)), np.empty((2, many))
    at_i, at_j, primitive = contacts.at_i, contacts.at_j, contacts.primitive
    measure(at_i, at_j, primitive, m.state, primitives, box, place)
    prepare_friction(0, m.state.shape[1], m.state, contacts.terms)
    slips(
        at_i, at_j, primitive, contacts.marks, m.state, contacts.terms, primitives, box, place, held
    )
    return place, held


@kernel(allocates=True)
def remembered(listed, held):
    """Keys, ascending, and slips [R] of the contacts that touch."""
    count = 0
    for k in range(listed.shape[0]):
        count += 1 if held[1, k] > 0.0 else 0
    keys, found = np.empty(count, np.int64), np.empty(count)
    count = 0
    for k in range(listed.shape[0]):
        if held[1, k] > 0.0:
            keys[count] = listed[k]
            found[count] = held[0, k]
            count += 1
    order = np.argsort(keys, kind="mergesort")
    return keys[order], found[order]


@kernel(allocates=True)
def commit(m, contacts, primitives, box):
    """Remember what every contact holds now. Before new lists, while ``m`` stands in the order of the old ones."""
    if contacts is None:
        return None
    if not contacts.listed:
        return contacts
    _, held = held_now(m, contacts, primitives, box)
    known, kept = remembered(contacts.keys, held)
    old = contacts.terms
    terms = FrictionTerms(
        old.coefficient,
        old.origin,
        old.change,
        old.sums,
        old.marks,
        old.reactions,
        old.received,
        old.body_marks,
        np.zeros_like(old.turn),
    )
    return Contacts(
        True,
        contacts.keys,
        known,
        kept,
        contacts.corners,
        contacts.at_i,
        contacts.at_j,
        contacts.primitive,
        contacts.marks,
        terms,
    )


@kernel
def place_of(keys, key):
    """Where a key stands among ascending ones; -1 if it does not."""
    low, high = 0, keys.shape[0]
    while low < high:
        middle = (low + high) // 2
        if keys[middle] < key:
            low = middle + 1
        else:
            high = middle
    return low if low < keys.shape[0] and keys[low] == key else -1


@kernel(allocates=True)
def round_corners(grains, pairs, grain, primitive, corner, slip, gap, known):
    """An edge and the vertex at its end share, for each grain, the slip of the one that has any, and the gap."""
    at = np.full((grains, corner.shape[0]), -1, np.int64)
    for k in range(grain.shape[0]):
        at[grain[k], primitive[k]] = pairs + k
    for side in range(2):
        for k in range(grain.shape[0]):
            edge = corner[primitive[k], side]
            e = at[grain[k], edge] if edge >= 0 else -1
            if e < 0:
                continue
            v = pairs + k
            if known[e] and not known[v]:
                slip[v] = slip[e]
            if known[v] and not known[e]:
                slip[e] = slip[v]
            gap[v] = min(gap[v], gap[e])


@kernel(allocates=True, forceinline=False)
def candidates(m, origin, contacts, rigid, box):
    """Take every pair of new lists as a candidate, with its slip counted from the origin, or from here if that is past."""
    if contacts is None:
        return None
    lists, identity, label = m.lists, m.identity, origin.label
    grains, pairs, used = label.shape[0], 0, rigid.used[0]
    width = lists.width
    entries = 0
    for t in range(width.shape[0]):
        pairs += width[t]
        entries += (width[t] + SLOT_PADDING - 1) // SLOT_PADDING * SLOT_PADDING
    many = pairs + used
    at_i, at_j = np.empty(many, np.uint32), np.empty(pairs, np.uint32)
    keys = np.empty(many, np.int64)
    place, first, second = lists.place, lists.first, lists.second
    for k in range(pairs):
        i, j = place[first[k]], place[second[k]]
        at_i[k] = i
        at_j[k] = j
        a, b = label[identity[i]], label[identity[j]]
        keys[k] = min(a, b) * GRAIN + max(a, b)
    grain, primitive = rigid.grain[:used], rigid.primitive[:used].copy()
    for k in range(used):
        at_i[pairs + k] = grain[k]
        keys[pairs + k] = label[identity[grain[k]]] * GRAIN + BODY + primitive[k]
    start, rows = m.state, rigid.primitives
    if not contacts.listed:
        start = np.zeros((6, grains))
        for row in range(5):
            for i in range(grains):
                start[row, i] = origin.state[row, identity[i]]
        rows = origin.primitives
    measured = np.empty((7, many))
    measure(at_i, at_j, primitive, start, rows, box, measured)
    marks, known = np.zeros((4, many)), np.zeros(many, np.bool_)
    for k in range(many):
        at = place_of(contacts.known, keys[k])
        if at >= 0:
            known[k] = True
            marks[0, k] = contacts.slips[at]
        marks[1, k] = max(measured[0, k], 0.0)
        marks[2, k] = measured[1, k]
        marks[3, k] = measured[2, k]
    round_corners(grains, pairs, grain, primitive, contacts.corners, marks[0], marks[1], known)
    slots = np.zeros((4, entries))
    lay_out(lists, at_i, at_j, marks, lists.filled, slots)
    old = contacts.terms
    terms = FrictionTerms(
        old.coefficient,
        start[2:].copy(),
        old.change,
        old.sums,
        slots,
        np.zeros((8, entries)),
        old.received,
        marks[:, pairs:].copy(),
        old.turn,
    )
    return Contacts(
        True,
        keys,
        contacts.known,
        contacts.slips,
        contacts.corners,
        at_i,
        at_j,
        primitive,
        marks,
        terms,
    )


@kernel(allocates=True)
def no_pulls(room):
    """``room`` forces, not filled in."""
    return Pulls(
        np.empty(room, np.int64),
        np.empty(room, np.int64),
        np.empty(room, np.int64),
        np.empty(room),
        np.empty(room),
        np.empty(room),
        np.empty(room),
    )


@kernel(allocates=True, forceinline=False)
def ended(m, contacts, primitives, box):
    """What the contacts remember, keys and slips [R], and the forces that they stand for, in the packing's order."""
    if contacts is None:
        return np.zeros(0, np.int64), np.zeros(0), no_pulls(0)
    place, held = held_now(m, contacts, primitives, box)
    at_i, at_j, pairs = contacts.at_i, contacts.at_j, contacts.at_j.shape[0]
    stiffness, identity = m.grains.contact_stiffness, m.identity
    count = 0
    for k in range(at_i.shape[0]):
        count += 1 if held[1, k] > 0.0 else 0
    pulls = no_pulls(count)
    count = 0
    for k in range(at_i.shape[0]):
        if not held[1, k] > 0.0:
            continue
        i = at_i[k]
        reach = place[5, k]
        x, y = m.state[0, i], m.state[1, i]
        both = stiffness[i]
        pulls.j[count] = -1
        pulls.primitive[count] = -1
        if k < pairs:
            j = at_j[k]
            reach += 0.5 * place[0, k]
            both = 2.0 * stiffness[i] * stiffness[j] / (stiffness[i] + stiffness[j])
            pulls.j[count] = identity[j]
        else:
            row = contacts.primitive[k - pairs]
            x, y = primitives[row, 1] + place[1, k], primitives[row, 2] + place[2, k]
            pulls.primitive[count] = row
        pull = TANGENTIAL_STIFFNESS * both * held[0, k]
        nx, ny = place[3, k], place[4, k]
        pulls.i[count] = identity[i]
        pulls.fx[count] = pull * ny
        pulls.fy[count] = -pull * nx
        pulls.x[count] = x + reach * nx
        pulls.y[count] = y + reach * ny
        count += 1
    known, kept = remembered(contacts.keys, held)
    return known, kept, pulls

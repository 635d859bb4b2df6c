"""The frictional contacts of one relaxation: ``core.frictional_contacts`` as kernels, step by step as it is told there.

What is None where a scene has no friction is None here too, and no code for it exists then.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.candidates import count_listed, find_corners, list_candidates, recall, round_corners
from core.jit import kernel
from core.marks import lay_out, measure, slips, tangential_forces
from core.slip import FrictionTerms, prepare_friction

Indices = NDArray[np.int64]


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
    """Tangential forces at the end of an increment, as ``core.marks.tangential_forces`` packs them to the front."""

    used: int
    who: Indices  # (3, …) grain, other grain or -1, primitive or -1
    values: Floats  # (6, …) force on the grain x, y [k R], where it acts x, y [R], and the branch vector x, y [R]


@kernel(allocates=True)
def first_contacts(origin, primitives):
    """Before the first lists; None without friction."""
    if origin is None:
        return None
    grains = origin.label.shape[0]
    corners = np.empty((primitives.shape[0], 2), np.int64)
    find_corners(primitives, corners)
    return Contacts(
        False,
        np.zeros(0, np.int64),
        origin.keys,
        origin.slips,
        corners,
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


@kernel(allocates=True, forceinline=False)
def candidates(m, origin, contacts, rigid, box):
    """Take every pair of new lists as a candidate, with its slip counted from the origin, or from here if that is past."""
    if contacts is None:
        return None
    lists, used = m.lists, rigid.used[0]
    pairs, entries = count_listed(lists.width)
    grains, many = origin.label.shape[0], pairs + used
    grain, primitive = rigid.grain[:used], rigid.primitive[:used].copy()
    at_i, at_j = np.empty(many, np.uint32), np.empty(pairs, np.uint32)
    keys = np.empty(many, np.int64)
    list_candidates(pairs, lists, m.identity, origin.label, grain, primitive, at_i, at_j, keys)
    start, rows = m.state, rigid.primitives
    if not contacts.listed:
        start = np.zeros((6, grains))
        for row in range(5):
            for i in range(grains):
                start[row, i] = origin.state[row, m.identity[i]]
        rows = origin.primitives
    place = np.empty((7, many))
    measure(at_i, at_j, primitive, start, rows, box, place)
    marks, known = np.empty((4, many)), np.empty(many, np.bool_)
    recall(keys, contacts.known, contacts.slips, marks[0], known)
    for k in range(many):
        marks[1, k] = max(place[0, k], 0.0)
        marks[2, k] = place[1, k]
        marks[3, k] = place[2, k]
    room = np.empty((grains, rows.shape[0]), np.int64)
    round_corners(pairs, at_i, primitive, contacts.corners, room, marks[0], marks[1], known)
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
    """Room for so many forces, none of which is there."""
    return Pulls(0, np.empty((3, room), np.int64), np.empty((6, room)))


@kernel(allocates=True, forceinline=False)
def ended(m, contacts, primitives, box):
    """What the contacts remember, keys and slips [R], and the forces that they stand for, in the packing's order."""
    if contacts is None:
        return np.zeros(0, np.int64), np.zeros(0), no_pulls(0)
    place, held = held_now(m, contacts, primitives, box)
    many = contacts.at_i.shape[0]
    who, values, sliding = (
        np.empty((3, many), np.int64),
        np.empty((6, many)),
        np.empty(many, np.bool_),
    )
    used = tangential_forces(
        contacts.at_i,
        contacts.at_j,
        contacts.primitive,
        m.state,
        m.grains.contact_stiffness,
        m.identity,
        primitives,
        place,
        held,
        who,
        values,
        sliding,
    )
    known, kept = remembered(contacts.keys, held)
    return known, kept, Pulls(used, who, values)

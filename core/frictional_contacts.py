"""The frictional contacts of one relaxation: which pairs may touch, where their slips are counted from, and what they hold.

Order of operations. An increment stores where grains and bodies are (``Origin``); then bodies move, and grains are sent where
they will probably go. When the first neighbour lists are made, every listed pair becomes a candidate with its gap, branch vector
and remembered slip at the origin. At each later list what every contact holds is *committed*: the clipped slip is remembered, and
counted anew from here. Without that a contact that slides far would pull towards where it was at the start, and drive the
minimiser round. When the relaxation has ended, contacts that touch remember their clipped slips.

A contact that goes over from an edge to the vertex at its end, or back, is the same contact: it keeps slip and gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.arrays import Box, Floats, Indices, aligned_zeros
from core.candidates import (
    begin_marks,
    count_listed,
    find_corners,
    list_candidates,
    round_corners,
)
from core.fire import Minimizer
from core.jit import shared
from core.marks import count_beyond, lay_out, measure, slips, tangential_forces
from core.observables import GrainContacts, RigidContacts, push_bodies
from core.rigid_contacts import RigidTerms
from core.slip import FrictionTerms, prepare_friction

BEYOND = 1.05  # times the Coulomb cap: a contact that pulls harder counts as beyond the cone


class Origin(NamedTuple):
    """Where an increment begins, from which slips are counted."""

    coefficient: float
    state: Floats  # (5, N) in the packing's order
    box: Box | None  # as kernels have it
    primitives: Floats  # (M, 8) before the bodies moved
    turn: Floats  # (M,) how far the body of each primitive turns in the increment [rad]
    label: Indices  # (N,)
    keys: Indices  # (K,) of the contacts that remember a slip, ascending
    slips: Floats  # (K,) ξ [R]


@dataclass(frozen=True)
class FrictionForces:
    """Tangential forces at the end of an increment, (K,) each."""

    i: Indices
    j: Indices  # -1: a rigid body
    primitive: Indices  # of a rigid body; -1 between grains
    fx: Floats  # on grain i [k R]; on the other the opposite
    fy: Floats
    x: Floats  # where it acts [R]; with a body: in the body's own image
    y: Floats
    dx: Floats  # branch vector from grain i to grain j, or to where it touches the body [R]
    dy: Floats
    sliding: NDArray[np.bool_]  # at the Coulomb cap

    @classmethod
    def of(cls, pulls: Pulls) -> FrictionForces:
        """The same forces."""
        parts: tuple[Any, ...] = (*pulls.who, *pulls.values, pulls.sliding)
        return cls(*parts)

    def beyond_cone(
        self, coefficient: float, grains: int, pairs: GrainContacts, bodies: RigidContacts
    ) -> float:
        """Share of these contacts that pull harder than ``BEYOND`` times μ times the normal force they have by another measure.

        ``pairs`` and ``bodies``: all contacts of the packing of so many ``grains`` as it stands. 0 where no contact pulls.
        """
        if not len(self.i):
            return 0.0
        beyond = count_beyond(
            BEYOND * coefficient,
            np.array([self.i, self.j, self.primitive]),
            self.fx,
            self.fy,
            pairs.i,
            pairs.j,
            pairs.normal_force,
            bodies.grain,
            bodies.primitive,
            bodies.normal_force,
            np.empty(2 * grains, dtype=np.int64),
            np.empty(len(pairs.i) + len(bodies.grain), dtype=np.int64),
        )
        return float(beyond) / len(self.i)

    def reactions(self, owner: Indices, placement: Floats) -> Floats:
        """Force and torque on each body (B, 3) [k R, k R²]; arguments as for ``observables.reactions``."""
        total = np.zeros((len(placement), 3))
        if not len(placement):
            return total
        at = np.flatnonzero(self.j < 0)
        forces = self.fx[at], self.fy[at], self.x[at], self.y[at]
        push_bodies(owner[self.primitive[at]], *forces, placement, total)
        return total

    def stress(self, area: float, *, bodies: bool = False) -> Floats:
        """What friction adds to ``observables.stress``: (1/area) Σ_c F_i d_j (2, 2) [k], with or without contacts with bodies."""
        counts = (self.j >= 0) | bodies
        fx, fy, dx, dy = (v[counts] for v in (self.fx, self.fy, self.dx, self.dy))
        tensor = [[np.sum(fx * dx), np.sum(fx * dy)], [np.sum(fy * dx), np.sum(fy * dy)]]
        return -np.array(tensor) / area


class FrictionalContacts(NamedTuple):
    """What a relaxation with friction knows of its contacts, from one list to the next; K pairs, first P of two grains."""

    listed: bool  # have there been lists yet?
    keys: Indices  # (K,) of the listed pairs
    known: Indices  # of the contacts that remember a slip, ascending
    slips: Floats  # and those ξ [R]
    primitives: Floats  # (M, 8) as they stand
    corners: Indices  # (M, 2)
    at_i: NDArray[np.uint32]  # (K,) places in the minimiser's order
    at_j: NDArray[np.uint32]  # (P,)
    primitive: Indices  # (K − P,)
    marks: Floats  # (4, K)
    terms: FrictionTerms


class Pulls(NamedTuple):
    """Tangential forces as ``marks.tangential_forces`` finds them, (L,) each."""

    who: Indices  # (3, L) grain, other grain or -1, primitive or -1
    values: Floats  # (6, L) force on the grain x, y [k R], where it acts x, y [R], and the branch vector x, y [R]
    sliding: NDArray[np.bool_]


@shared
def before_lists(origin: Origin, primitives: Floats) -> FrictionalContacts:
    """Contacts before the first lists, among ``primitives`` (M, 8) as they stand now."""
    count = origin.label.shape[0]
    corners = np.empty((primitives.shape[0], 2), np.int64)
    find_corners(primitives, corners)
    terms = FrictionTerms(
        origin.coefficient,
        np.zeros((4, count)),
        np.zeros((4, count)),
        np.zeros((2, count)),
        np.zeros((4, 0)),
        np.zeros((8, 0)),
        aligned_zeros(count, 8),
        np.zeros((4, 0)),
        origin.turn,
    )
    return FrictionalContacts(
        False,
        np.zeros(0, np.int64),
        origin.keys,
        origin.slips,
        primitives,
        corners,
        np.zeros(0, np.uint32),
        np.zeros(0, np.uint32),
        np.zeros(0, np.int64),
        np.zeros((4, 0)),
        terms,
    )


@shared
def committed(
    m: Minimizer, contacts: FrictionalContacts | None, box: Box | None
) -> FrictionalContacts | None:
    """They remember what every one holds now. Before new lists, while ``m`` stands in the order of the old ones.

    None, where there is no friction, stays None.
    """
    if contacts is None:
        return contacts  # not None: in a kernel both ways must come to one type
    if not contacts.listed:
        return contacts
    _, held = _measured(m, contacts, box)
    known, slips_now = _held(contacts.keys, held)
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
    return FrictionalContacts(
        True,
        contacts.keys,
        known,
        slips_now,
        contacts.primitives,
        contacts.corners,
        contacts.at_i,
        contacts.at_j,
        contacts.primitive,
        contacts.marks,
        terms,
    )


@shared
def relisted(
    m: Minimizer,
    origin: Origin | None,
    contacts: FrictionalContacts | None,
    rigid: RigidTerms | None,
    box: Box | None,
) -> FrictionalContacts | None:
    """Every pair of new lists is a candidate, with its slip counted from the origin, or from here if that is past.

    None, where there is no friction, stays None.
    """
    if contacts is None or origin is None:
        return contacts
    pairs, entries = count_listed(m.lists.width)
    grain, primitive = _near_bodies(rigid)
    count, many = origin.label.shape[0], pairs + grain.shape[0]
    keys, at_i, at_j = (
        np.empty(many, np.int64),
        np.empty(many, np.uint32),
        np.empty(pairs, np.uint32),
    )
    list_candidates(pairs, m.lists, m.identity, origin.label, grain, primitive, at_i, at_j, keys)
    place = np.empty((7, many))
    start, rows = m.state, contacts.primitives
    if contacts.listed:
        measure(at_i, at_j, primitive, start, rows, box, place)
    else:
        start, rows = np.zeros((6, count)), origin.primitives
        start[:5] = origin.state[:, m.identity]
        measure(at_i, at_j, primitive, start, rows, origin.box, place)
    marks, known = np.empty((4, many)), np.empty(many, np.bool_)
    begin_marks(place, keys, contacts.known, contacts.slips, marks, known)
    room = np.empty((count, rows.shape[0]), np.int64)
    round_corners(pairs, at_i, primitive, contacts.corners, room, marks[0], marks[1], known)
    slots = np.zeros((4, entries))
    lay_out(m.lists, at_i, at_j, marks, m.lists.filled, slots)
    old = contacts.terms
    terms = FrictionTerms(
        old.coefficient,
        start[2:].copy(),
        old.change,
        old.sums,
        slots,
        aligned_zeros(8, entries),
        old.received,
        marks[:, pairs:].copy(),
        old.turn,
    )
    return FrictionalContacts(
        True,
        keys,
        contacts.known,
        contacts.slips,
        contacts.primitives,
        contacts.corners,
        at_i,
        at_j,
        primitive,
        marks,
        terms,
    )


@shared
def ended(
    m: Minimizer, contacts: FrictionalContacts, box: Box | None
) -> tuple[Indices, Floats, Pulls]:
    """What the contacts remember, keys and slips [R], and the forces that they stand for, in the packing's order."""
    place, held = _measured(m, contacts, box)
    many = contacts.at_i.shape[0]
    who, values = np.empty((3, many), np.int64), np.empty((6, many))
    sliding = np.empty(many, np.bool_)
    used = tangential_forces(
        contacts.at_i,
        contacts.at_j,
        contacts.primitive,
        m.state,
        m.grains.contact_stiffness,
        m.identity,
        contacts.primitives,
        place,
        held,
        who,
        values,
        sliding,
    )
    keys, slips_now = _held(contacts.keys, held)
    return keys, slips_now, Pulls(who[:, :used].copy(), values[:, :used].copy(), sliding[:used])


@shared
def _near_bodies(rigid: RigidTerms | None) -> tuple[Indices, Indices]:
    """Grain and primitive of the listed pairs of both."""
    if rigid is None:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    used = rigid.used[0]
    return rigid.grain[:used], rigid.primitive[:used].copy()


@shared
def _measured(m: Minimizer, contacts: FrictionalContacts, box: Box | None) -> tuple[Floats, Floats]:
    """Geometry (7, K) and slips with their limits (2, K) of all pairs as they stand now."""
    at_i, at_j, primitive = contacts.at_i, contacts.at_j, contacts.primitive
    place, held = np.empty((7, at_i.shape[0])), np.empty((2, at_i.shape[0]))
    rows = contacts.primitives
    measure(at_i, at_j, primitive, m.state, rows, box, place)
    prepare_friction(0, m.state.shape[1], m.state, contacts.terms)
    slips(at_i, at_j, primitive, contacts.marks, m.state, contacts.terms, rows, box, place, held)
    return place, held


@shared
def _held(keys: Indices, held: Floats) -> tuple[Indices, Floats]:
    """Keys, ascending, and slips [R] of the contacts that touch; ``keys`` (K,) and ``held`` (2, K) are of all."""
    touching = held[1] > 0.0
    found, slips_now = keys[touching], held[0][touching]
    order = np.argsort(found, kind="mergesort")
    return found[order], slips_now[order]

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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats, aligned_zeros
from core.candidates import (
    count_listed,
    find_corners,
    list_candidates,
    recall,
    round_corners,
)
from core.fire import Minimizer
from core.marks import count_beyond, lay_out, measure, slips, tangential_forces
from core.observables import GrainContacts, RigidContacts
from core.packing import PeriodicBox
from core.rigid_contacts import RigidTerms
from core.slip import FrictionTerms, prepare_friction

Indices = NDArray[np.int64]
Box = tuple[float, ...]

BEYOND = 1.05  # times the Coulomb cap: a contact that pulls harder counts as beyond the cone


@dataclass(frozen=True)
class Origin:
    """Where an increment begins, from which slips are counted."""

    coefficient: float
    state: Floats  # (5, N) in the packing's order
    box: PeriodicBox | None
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

    def beyond_cone(self, coefficient: float, pairs: GrainContacts, bodies: RigidContacts) -> float:
        """Share of these contacts that pull harder than ``BEYOND`` times μ times the normal force they have by another measure.

        ``pairs`` and ``bodies``: all contacts of the packing as it stands. 0 where no contact pulls.
        """
        if not len(self.i):
            return 0.0
        highest = max(
            int(v.max(initial=-1)) for v in (self.i, self.j, pairs.i, pairs.j, bodies.grain)
        )
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
            np.empty(2 * (highest + 1), dtype=np.int64),
            np.empty(len(pairs.i) + len(bodies.grain), dtype=np.int64),
        )
        return float(beyond) / len(self.i)

    def reactions(self, owner: Indices, placement: Floats) -> Floats:
        """Force and torque on each body (B, 3) [k R, k R²]; arguments as for ``observables.reactions``."""
        on_body = self.j < 0
        body = owner[self.primitive[on_body]]
        fx, fy = -self.fx[on_body], -self.fy[on_body]
        total = np.zeros((len(placement), 3))
        np.add.at(total[:, 0], body, fx)
        np.add.at(total[:, 1], body, fy)
        lever_x = self.x[on_body] - placement[body, 0]
        lever_y = self.y[on_body] - placement[body, 1]
        np.add.at(total[:, 2], body, lever_x * fy - lever_y * fx)
        return total

    def stress(self, area: float, *, bodies: bool = False) -> Floats:
        """What friction adds to ``observables.stress``: (1/area) Σ_c F_i d_j (2, 2) [k], with or without contacts with bodies."""
        counts = (self.j >= 0) | bodies
        fx, fy, dx, dy = (v[counts] for v in (self.fx, self.fy, self.dx, self.dy))
        tensor = [[np.sum(fx * dx), np.sum(fx * dy)], [np.sum(fy * dx), np.sum(fy * dy)]]
        return -np.array(tensor) / area


class FrictionalContacts:
    """Held by a relaxation with friction, which tells it of every new neighbour list."""

    def __init__(self, origin: Origin, rigid: RigidTerms | None) -> None:
        self._origin = origin
        self._keys, self._slips = origin.keys, origin.slips
        self._turn = origin.turn
        self._primitives = np.zeros((0, 8)) if rigid is None else rigid.primitives
        self._corners = np.empty((len(self._primitives), 2), dtype=np.int64)
        find_corners(self._primitives, self._corners)
        self._listed: Indices | None = None  # keys of the pairs, first those of two grains
        count = len(origin.label)
        self._at_i = self._at_j = np.zeros(0, dtype=np.uint32)
        self._primitive = np.zeros(0, dtype=np.int64)
        self._marks = np.zeros((4, 0))
        self.terms = FrictionTerms(
            coefficient=origin.coefficient,
            origin=np.zeros((4, count)),
            change=np.zeros((4, count)),
            sums=np.zeros((2, count)),
            marks=np.zeros((4, 0)),
            reactions=aligned_zeros(8, 0),
            received=aligned_zeros(count, 8),
            body_marks=np.zeros((4, 0)),
            turn=origin.turn,
        )

    def commit(self, m: Minimizer, box: Box | None) -> None:
        """Remember what every contact holds now. Before new lists, while ``m`` stands in the order of the old ones."""
        if self._listed is None:
            return
        _, held = self._measure(m, box)
        self._keys, self._slips = self._hold(held)
        self._turn = np.zeros_like(self._turn)

    def relist(self, m: Minimizer, rigid: RigidTerms | None, box: Box | None) -> None:
        """Take every pair of new lists as a candidate, with its slip counted from the origin, or from here if that is past."""
        pairs, entries = count_listed(m.lists.width)
        grain = primitive = np.zeros(0, dtype=np.int64)
        if rigid is not None:
            used = int(rigid.used[0])
            grain, primitive = rigid.grain[:used], rigid.primitive[:used].copy()
        count, many = len(self._origin.label), pairs + len(grain)
        keys = np.empty(many, dtype=np.int64)
        self._at_i, self._at_j = np.empty(many, dtype=np.uint32), np.empty(pairs, dtype=np.uint32)
        self._primitive = primitive
        list_candidates(
            pairs,
            m.lists,
            m.identity,
            self._origin.label,
            grain,
            primitive,
            self._at_i,
            self._at_j,
            keys,
        )
        start, primitives, cell = m.state, self._primitives, box
        if self._listed is None:
            start = np.zeros((6, count))
            start[:5] = self._origin.state[:, m.identity]
            primitives = self._origin.primitives
            cell = None if self._origin.box is None else self._origin.box.kernel_form()
        place = np.empty((7, many))
        measure(self._at_i, self._at_j, primitive, start, primitives, cell, place)
        marks, known = np.empty((4, many)), np.empty(many, dtype=np.bool_)
        slip, gap = marks[0], marks[1]
        recall(keys, self._keys, self._slips, slip, known)
        np.maximum(place[0], 0.0, out=gap)
        marks[2:] = place[1:3]
        room = np.empty((count, len(primitives)), dtype=np.int64)
        round_corners(pairs, self._at_i, primitive, self._corners, room, slip, gap, known)
        slots = np.zeros((4, entries))
        lay_out(m.lists, self._at_i, self._at_j, marks, m.lists.filled, slots)
        self.terms = self.terms._replace(
            origin=start[2:].copy(),
            marks=slots,
            reactions=aligned_zeros(8, entries),
            body_marks=marks[:, pairs:].copy(),
            turn=self._turn,
        )
        self._marks, self._listed = marks, keys

    def end(self, m: Minimizer, box: Box | None) -> tuple[Indices, Floats, FrictionForces]:
        """What the contacts remember, keys and slips [R], and the forces that they stand for, in the packing's order."""
        place, held = self._measure(m, box)
        many = len(self._at_i)
        who, values = np.empty((3, many), dtype=np.int64), np.empty((6, many))
        sliding = np.empty(many, dtype=np.bool_)
        used = tangential_forces(
            self._at_i,
            self._at_j,
            self._primitive,
            m.state,
            m.grains.contact_stiffness,
            m.identity,
            self._primitives,
            place,
            held,
            who,
            values,
            sliding,
        )
        found: tuple[Any, ...] = (*who[:, :used], *values[:, :used], sliding[:used])
        return *self._hold(held), FrictionForces(*found)

    def _measure(self, m: Minimizer, box: Box | None) -> tuple[Floats, Floats]:
        """Geometry (7, K) and slips with their limits (2, K) of all pairs as they stand now."""
        place, held = np.empty((7, len(self._at_i))), np.empty((2, len(self._at_i)))
        pairs = self._at_i, self._at_j, self._primitive
        measure(*pairs, m.state, self._primitives, box, place)
        prepare_friction(0, m.state.shape[1], m.state, self.terms)
        slips(*pairs, self._marks, m.state, self.terms, self._primitives, box, place, held)
        return place, held

    def _hold(self, held: Floats) -> tuple[Indices, Floats]:
        """Keys, ascending, and slips [R] of the contacts that touch."""
        listed = np.zeros(0, dtype=np.int64) if self._listed is None else self._listed
        touching = held[1] > 0.0
        keys = listed[touching]
        order = np.argsort(keys, kind="stable")
        return keys[order], held[0, touching][order]

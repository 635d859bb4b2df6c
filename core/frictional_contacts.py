"""The frictional contacts of one relaxation: which pairs may touch, where their slips are counted from, and what they hold.

Order of operations. An increment stores where grains and bodies are (``Origin``); then bodies move, and grains are sent where they
will probably go. When the first neighbour lists are made, every listed pair becomes a candidate with its gap, branch vector and
remembered slip at the origin. At each later list what every contact holds is *committed*: the clipped slip is remembered, and
counted anew from here. Without that a contact that slides far would pull towards where it was at the start, and drive the
minimiser round. When the relaxation has ended, contacts that touch remember their clipped slips.

A contact that goes over from an edge to the vertex at its end, or back, is the same contact: it keeps slip and gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.fire import Minimizer
from core.observables import GrainContacts, RigidContacts
from core.packing import MAX_LABEL, PeriodicBox
from core.rigid_contacts import EDGE, VERTEX, RigidTerms
from core.slip import (
    OUTPUTS,
    TANGENTIAL_STIFFNESS,
    FrictionTerms,
    look_at_bodies,
    measure,
    pulls,
)

Indices = NDArray[np.int64]
Box = tuple[float, ...]

BODY = MAX_LABEL  # keys of primitives begin here; labels of grains stay below
GRAIN = 2 * MAX_LABEL
BEYOND = 1.05  # times the Coulomb cap: a contact that pulls harder counts as beyond the cone
_SAME_POINT = 1e-9  # [R]


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
        many = 1 + max(int(v.max(initial=0)) for v in (self.i, self.j, pairs.j, bodies.primitive))
        pressed = np.concatenate(
            [
                np.minimum(pairs.i, pairs.j) * many + np.maximum(pairs.i, pairs.j),
                (-1 - bodies.grain) * many - bodies.primitive,
            ]
        )
        normal = np.concatenate([pairs.normal_force, bodies.normal_force])
        pulling = np.where(
            self.j >= 0,
            np.minimum(self.i, self.j) * many + np.maximum(self.i, self.j),
            (-1 - self.i) * many - self.primitive,
        )
        order = np.argsort(pressed, kind="stable")
        place = np.minimum(np.searchsorted(pressed, pulling, sorter=order), len(pressed) - 1)
        at = order[place] if len(pressed) else np.zeros(0, dtype=np.int64)
        known = np.zeros(len(pulling))
        if len(at):
            known = np.where(pressed[at] == pulling, normal[at], 0.0)
        return float(np.mean(np.hypot(self.fx, self.fy) > BEYOND * coefficient * known))

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
        self._corners = None if rigid is None else _corners(rigid.primitives)  # (M, 2)
        self._listed: Indices | None = None  # keys of the candidates
        none, empty = np.zeros(0), np.zeros(0, dtype=np.int64)
        self.terms = FrictionTerms(
            coefficient=origin.coefficient,
            at_i=np.zeros(0, dtype=np.uint32),
            at_j=np.zeros(0, dtype=np.uint32),
            primitive=empty,
            turn=origin.turn,
            origin=np.zeros((4, 0)),
            stiffness=none,
            slip=none,
            gap=none,
            start_x=none,
            start_y=none,
            touch=np.zeros((4, 0)),
            out=np.zeros((OUTPUTS, 0)),
        )

    def commit(self, m: Minimizer, rigid: RigidTerms | None, box: Box | None) -> None:
        """Remember what every contact holds now. Before new lists, while ``m`` stands in the order of the old ones."""
        if self._listed is None:
            return
        self._evaluate(m, rigid, box)
        self._keys, self._slips = self._held()
        self._turn = np.zeros_like(self._turn)

    def relist(self, m: Minimizer, rigid: RigidTerms | None, box: Box | None) -> None:
        """Take every pair of new lists as a candidate, with its slip counted from the origin, or from here if that is past."""
        lists = m.lists
        pairs = int(lists.width.sum()) // 2
        at_i, at_j = lists.place[lists.first[:pairs]], lists.place[lists.second[:pairs]]
        used = 0 if rigid is None else int(rigid.used[0])
        grain, primitive = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
        if rigid is not None:
            grain, primitive = rigid.grain[:used], rigid.primitive[:used].copy()
        label = self._origin.label[m.identity]
        a, b = label[at_i], label[at_j]
        keys = np.concatenate(
            [np.minimum(a, b) * GRAIN + np.maximum(a, b), label[grain] * GRAIN + BODY + primitive]
        )
        first = self._listed is None
        start = np.zeros((6, len(m.identity)))
        if first:
            start[:5] = self._origin.state[:, m.identity]
            primitives = self._origin.primitives
            cell = None if self._origin.box is None else self._origin.box.kernel_form()
        else:
            start[:] = m.state
            primitives = np.zeros((0, 8)) if rigid is None else rigid.primitives
            cell = box
        both = np.concatenate([at_i, grain]).astype(np.uint32)
        place = np.empty((6, len(both)))
        measure(both, at_j.astype(np.uint32), primitive, start, primitives, cell, place)
        gap = np.maximum(place[0], 0.0)
        slip, known = self._recall(keys)
        if self._corners is not None:
            self._round_corners(grain, primitive, slip[pairs:], gap[pairs:], known[pairs:])
        c = m.grains.contact_stiffness
        contact = np.concatenate([2.0 * c[at_i] * c[at_j] / (c[at_i] + c[at_j]), c[grain]])
        self.terms = self.terms._replace(
            at_i=both,
            at_j=at_j.astype(np.uint32),
            primitive=primitive,
            turn=self._turn,
            origin=np.ascontiguousarray(start[2:]),
            stiffness=TANGENTIAL_STIFFNESS * contact,
            slip=slip,
            gap=gap,
            start_x=place[1],
            start_y=place[2],
            touch=np.zeros((4, used)),
            out=np.zeros((OUTPUTS, len(both))),
        )
        self._listed = keys

    def end(
        self, m: Minimizer, rigid: RigidTerms | None, box: Box | None
    ) -> tuple[Indices, Floats, FrictionForces]:
        """What the contacts remember, keys and slips [R], and the forces that they stand for, in the packing's order."""
        if self._listed is None:
            none, empty = np.zeros(0), np.zeros(0, dtype=np.int64)
            return empty, none, FrictionForces(empty, empty, empty, *[none] * 6, none > 0.0)
        self._evaluate(m, rigid, box)
        terms, pairs = self.terms, len(self.terms.at_j)
        keys, slips = self._held()
        touching = terms.out[0] > 0.0
        place = np.empty((6, len(touching)))
        primitives = np.zeros((0, 8)) if rigid is None else rigid.primitives
        measure(terms.at_i, terms.at_j, terms.primitive, m.state, primitives, box, place)
        gap, dx, dy, nx, ny, h = place
        grain, other = m.identity[terms.at_i], np.full(len(touching), -1)
        other[:pairs] = m.identity[terms.at_j]
        primitive = np.full(len(touching), -1)
        primitive[pairs:] = terms.primitive
        reach = h.copy()
        reach[:pairs] += 0.5 * gap[:pairs]  # half way between the outlines
        x, y = m.state[0, terms.at_i] + reach * nx, m.state[1, terms.at_i] + reach * ny
        x[pairs:] = primitives[terms.primitive, 1] + dx[pairs:] + (h * nx)[pairs:]
        y[pairs:] = primitives[terms.primitive, 2] + dy[pairs:] + (h * ny)[pairs:]
        dx[pairs:], dy[pairs:] = (h * nx)[pairs:], (h * ny)[pairs:]
        found = (grain, other, primitive, terms.out[2], terms.out[3], x, y, dx, dy)
        sliding = np.abs(terms.out[1]) >= terms.out[0]
        forces = FrictionForces(*(v[touching] for v in (*found, sliding)))
        return keys, slips, forces

    def _evaluate(self, m: Minimizer, rigid: RigidTerms | None, box: Box | None) -> None:
        """Caps and pulls as things stand now."""
        if rigid is not None:
            look_at_bodies(m.state, self.terms, rigid, box)
        pulls(m.state, self.terms, rigid, box)

    def _held(self) -> tuple[Indices, Floats]:
        """Keys, ascending, and clipped slips [R] of the contacts that touch."""
        assert self._listed is not None
        touching = self.terms.out[0] > 0.0
        keys = self._listed[touching]
        order = np.argsort(keys, kind="stable")
        slips = (self.terms.out[1] / self.terms.stiffness)[touching]
        return keys[order], slips[order]

    def _recall(self, keys: Indices) -> tuple[Floats, NDArray[np.bool_]]:
        """What the contacts with these keys remember, 0 for new ones; and which do."""
        if not len(self._keys):
            return np.zeros(len(keys)), np.zeros(len(keys), dtype=np.bool_)
        at = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        known = self._keys[at] == keys
        return np.where(known, self._slips[at], 0.0), known

    def _round_corners(
        self,
        grain: Indices,
        primitive: Indices,
        slip: Floats,
        gap: Floats,
        known: NDArray[np.bool_],
    ) -> None:
        """An edge and the vertex at its end share, for each grain (B,), the slip of the one that has any, and the gap."""
        assert self._corners is not None
        many = len(self._corners)
        key = grain * many + primitive
        order = np.argsort(key, kind="stable")
        for edge in self._corners.T:
            vertex = np.flatnonzero(edge[primitive] >= 0)
            wanted = grain[vertex] * many + edge[primitive[vertex]]
            place = np.searchsorted(key, wanted, sorter=order)
            at = order[np.minimum(place, len(key) - 1)] if len(key) else order
            found = key[at] == wanted
            v, e = vertex[found], at[found]
            fresh, old = known[e] & ~known[v], known[v] & ~known[e]
            slip[v[fresh]] = slip[e[fresh]]
            slip[e[old]] = slip[v[old]]
            gap[v] = np.minimum(gap[v], gap[e])  # that of an edge knows its ends already


def _corners(primitives: Floats) -> Indices:
    """For each primitive (M, 2): the edges that a vertex is the end of; -1 where there is none."""
    edges = np.flatnonzero(primitives[:, 0] == EDGE)
    found = np.full((len(primitives), 2), -1)
    for v in np.flatnonzero(primitives[:, 0] == VERTEX):
        ends = primitives[edges][:, [[1, 2], [5, 6]]] - primitives[v, 1:3]
        meets = edges[(np.abs(ends).max(axis=2) < _SAME_POINT).any(axis=1)][:2]
        found[v, : len(meets)] = meets
    return found

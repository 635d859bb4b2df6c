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

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats, aligned_zeros
from core.fire import Minimizer
from core.marks import lay_out, measure, slips
from core.neighbors import SLOT_PADDING
from core.observables import GrainContacts, RigidContacts
from core.packing import MAX_LABEL, PeriodicBox
from core.rigid_contacts import EDGE, VERTEX, RigidTerms
from core.slip import TANGENTIAL_STIFFNESS, FrictionTerms, prepare_friction

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
        self._primitives = np.zeros((0, 8)) if rigid is None else rigid.primitives
        self._corners = _corners(self._primitives)
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
        lists = m.lists
        pairs = int(lists.width.sum())
        at_i, at_j = lists.place[lists.first[:pairs]], lists.place[lists.second[:pairs]]
        grain = primitive = np.zeros(0, dtype=np.int64)
        if rigid is not None:
            used = int(rigid.used[0])
            grain, primitive = rigid.grain[:used], rigid.primitive[:used].copy()
        label = self._origin.label[m.identity]
        a, b = label[at_i], label[at_j]
        keys = np.concatenate(
            [np.minimum(a, b) * GRAIN + np.maximum(a, b), label[grain] * GRAIN + BODY + primitive]
        )
        start, primitives, cell = m.state, self._primitives, box
        if self._listed is None:
            start = np.zeros((6, len(label)))
            start[:5] = self._origin.state[:, m.identity]
            primitives = self._origin.primitives
            cell = None if self._origin.box is None else self._origin.box.kernel_form()
        self._at_i = np.concatenate([at_i, grain]).astype(np.uint32)
        self._at_j = at_j.astype(np.uint32)
        place = np.empty((7, len(keys)))
        measure(self._at_i, self._at_j, primitive, start, primitives, cell, place)
        slip, known = self._recall(keys)
        gap = np.maximum(place[0], 0.0)
        self._round_corners(grain, primitive, slip[pairs:], gap[pairs:], known[pairs:])
        self._marks = np.array([slip, gap, place[1], place[2]])
        entries = int((-(-lists.width // SLOT_PADDING) * SLOT_PADDING).sum())
        slots = np.zeros((4, entries))
        lay_out(lists, self._at_i, self._at_j, self._marks, lists.filled, slots)
        self.terms = self.terms._replace(
            origin=start[2:].copy(),
            marks=slots,
            reactions=aligned_zeros(8, entries),
            body_marks=np.ascontiguousarray(self._marks[:, pairs:]),
            turn=self._turn,
        )
        self._primitive = primitive
        self._listed = keys

    def end(self, m: Minimizer, box: Box | None) -> tuple[Indices, Floats, FrictionForces]:
        """What the contacts remember, keys and slips [R], and the forces that they stand for, in the packing's order."""
        place, held = self._measure(m, box)
        pairs = len(self._at_j)
        gap, dx, dy, nx, ny, h, _ = place
        x, y = m.state[0, self._at_i], m.state[1, self._at_i]
        first = self._primitives[self._primitive]
        x[pairs:], y[pairs:] = first[:, 1] + dx[pairs:], first[:, 2] + dy[pairs:]
        dx[pairs:], dy[pairs:] = h[pairs:] * nx[pairs:], h[pairs:] * ny[pairs:]
        reach = h.copy()
        reach[:pairs] += 0.5 * gap[:pairs]  # half way between the outlines
        grain = m.identity[self._at_i]
        other, primitive = np.full(len(grain), -1), np.full(len(grain), -1)
        other[:pairs] = m.identity[self._at_j]
        primitive[pairs:] = self._primitive
        slip, limit = held
        pull = self._stiffness(m) * slip
        found = (grain, other, primitive, pull * ny, -pull * nx, x + reach * nx, y + reach * ny)
        touching = limit > 0.0
        forces = FrictionForces(*(v[touching] for v in (*found, dx, dy, np.abs(slip) >= limit)))
        return *self._hold(held), forces

    def _stiffness(self, m: Minimizer) -> Floats:
        """k_t of all pairs (K,) [k]."""
        c = m.grains.contact_stiffness
        i, j = self._at_i, self._at_j
        first, second = c[i[: len(j)]], c[j]
        both = np.concatenate([2.0 * first * second / (first + second), c[i[len(j) :]]])
        return TANGENTIAL_STIFFNESS * both

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
    """For each primitive (M, 2): the edges that a vertex lies between; -1 where there is none.

    Others may end in the same place: an edge and its vertex have radius and direction in common.
    """
    found = np.full((len(primitives), 2), -1)
    edges, vertices = (np.flatnonzero(primitives[:, 0] == kind) for kind in (EDGE, VERTEX))
    if not len(edges):
        return found
    rows, corners = primitives[edges], primitives[vertices, None]
    starts = np.column_stack([rows[:, 1:3], -rows[:, 3:5], rows[:, 7]])
    ends = np.column_stack([rows[:, 5:7], rows[:, 3:5], rows[:, 7]])
    for side, first in enumerate((3, 5)):
        corner = corners[..., [1, 2, first, first + 1, 7]]
        away = [np.abs(points - corner).max(axis=2) for points in (starts, ends)]
        meets = np.minimum(*away) < _SAME_POINT
        found[vertices, side] = np.where(meets.any(axis=1), edges[meets.argmax(axis=1)], -1)
    return found

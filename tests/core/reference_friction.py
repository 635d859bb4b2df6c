"""Slow, plain twins of friction and gravity, from equations (10) and (11) of MODEL.md, in the chart of semi-axes and angle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from core.arrays import Floats
from core.packing import Packing
from core.reference import (
    Contact,
    Ellipse,
    Vector,
    _facing_normal,
    _nearest_direction,
    _past,
    beside,
    ellipses,
    grain_contact,
    half_width,
    near_pairs,
    nearest_image,
    rigid_contact,
)
from core.rigid_contacts import DISC, EDGE, VERTEX


@dataclass(frozen=True)
class Before:
    """Where slips are counted from."""

    packing: Packing
    memory: dict[tuple[int, int], float]  # as ``Friction.remembered`` gives it
    coefficient: float
    primitives: Floats  # (M, 8)
    turn: Floats  # (M,) how far the body of each primitive has turned since [rad]


class Tangential(NamedTuple):
    """A frictional contact as it stands."""

    i: int
    j: int  # -1: a rigid body
    labels: tuple[int, int]
    n: Vector  # from grain i to the other
    stiffness: float  # k_t [k]
    cap: float  # μ f_n [k R]
    gap: float  # at the origin [R]
    slip: float  # u, not cut to the cap [R]
    lever_i: float  # l [R]
    lever_j: float  # the same of j; 0 for a body
    at: Vector  # where it acts [R]

    @property
    def pull(self) -> float:
        """f [k R]."""
        return min(max(self.stiffness * self.slip, -self.cap), self.cap)

    @property
    def sliding(self) -> bool:
        return self.stiffness * abs(self.slip) >= self.cap


def stretch(grain: Ellipse) -> Floats:
    """U = R(θ) diag(a, b) R(−θ), (2, 2) [R]."""
    c, s = math.cos(grain.theta), math.sin(grain.theta)
    turn = np.array([[c, -s], [s, c]])
    return turn @ np.diag([grain.a, grain.b]) @ turn.T


def touching_direction(grain: Ellipse, n: Vector) -> Floats:
    """e = U n / h: the material point that touches along n, as a unit vector of the undeformed grain (2,)."""
    along = stretch(grain) @ n
    return np.array(along / np.hypot(*along))


def frictional_contacts(
    packing: Packing, turned: Floats, primitives: Floats, before: Before
) -> list[Tangential]:
    """Every contact of ``packing`` that touches, with its slip since ``before``; grains have turned by ``turned`` (N,) [rad]."""
    now, then = ellipses(packing), ellipses(before.packing)
    label = packing.label

    def change(i: int, n: Vector, t: Vector) -> float:
        return float(t @ (stretch(now[i]) - stretch(then[i])) @ touching_direction(now[i], n))

    found = []
    for i, j in sorted(near_pairs(packing, 0.0)):
        contact = grain_contact(packing, now, i, j)
        if contact is None:
            continue
        n = (-contact.n[0], -contact.n[1])
        t = (-n[1], n[0])
        d = nearest_image(packing.box, now[j].x - now[i].x, now[j].y - now[i].y)
        d0 = nearest_image(before.packing.box, then[j].x - then[i].x, then[j].y - then[i].y)
        gap = max(0.0, math.hypot(*d0) - _reach(then[i], d0) - _reach(then[j], d0))
        labels = (int(min(label[i], label[j])), int(max(label[i], label[j])))
        levers = [now[k].a * now[k].b / _reach(now[k], n) - 0.5 * contact.overlap for k in (i, j)]
        u = before.memory.get(labels, 0.0) - t[0] * (d[0] - d0[0]) - t[1] * (d[1] - d0[1])
        u += levers[0] * turned[i] + levers[1] * turned[j]
        u += change(i, n, np.array(t)) + change(j, n, np.array(t))
        arm = contact.slopes.h - 0.5 * contact.overlap  # half way between the two outlines
        found.append(
            _tangential(i, j, labels, n, contact, gap, u, levers, arm, now[i], before.coefficient)
        )
    for m, row in enumerate(primitives):
        for i, grain in enumerate(now):
            image = beside(grain, row, packing.box)
            contact = rigid_contact(float(packing.contact_stiffness[i]), image, row)
            if contact is None:
                continue
            n = (-contact.n[0], -contact.n[1])
            t = (-n[1], n[0])
            old_row = before.primitives[m]
            old = beside(then[i], old_row, before.packing.box)
            gap, memory = _at_origin(int(label[i]), then[i], m, before)
            h = contact.slopes.h
            x, y = image.x - row[1], image.y - row[2]
            wx, wy = nearest_image(packing.box, x - (old.x - old_row[1]), y - (old.y - old_row[2]))
            # The body's own material, at the point where the force acts, goes with the first point of the primitive.
            carried = before.turn[m] * np.array([-(y + h * n[1]), x + h * n[0]])
            lever = grain.a * grain.b / h
            u = memory + t[0] * (wx - carried[0]) + t[1] * (wy - carried[1])
            u += lever * turned[i] + change(i, n, np.array(t))
            labels = (int(label[i]), -1 - m)
            found.append(
                _tangential(
                    i, -1, labels, n, contact, gap, u, [lever, 0.0], h, image, before.coefficient
                )
            )
    return found


def friction_energy_and_forces(
    packing: Packing, turned: Floats, primitives: Floats, before: Before
) -> tuple[float, Floats, Floats]:
    """Energy [k R²], forces as in ``reference.energy_and_forces`` (5, N) and on spins (N,) [k R²], all of friction alone.

    The force on a coordinate is −f ∂u/∂coordinate with n, e and λ held.
    """
    energy, forces, torque = 0.0, np.zeros((5, len(packing))), np.zeros(len(packing))
    grains = ellipses(packing)
    for contact in frictional_contacts(packing, turned, primitives, before):
        pull, t = contact.pull, np.array([-contact.n[1], contact.n[0]])
        energy += 0.5 * pull**2 / contact.stiffness
        for k, sign, lever in (
            (contact.i, 1.0, contact.lever_i),
            (contact.j, -1.0, contact.lever_j),
        ):
            if k < 0:
                continue
            forces[:2, k] -= sign * pull * t
            torque[k] -= pull * lever
            e = touching_direction(grains[k], contact.n)
            # U = a m m + b w w, and turning it by dθ adds (a − b)(m w + w m) dθ.
            theta = grains[k].theta
            m, w = np.array(
                [[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]]
            )
            by_theta = ((t @ m) * (w @ e) + (t @ w) * (m @ e)) / (grains[k].a + grains[k].b)
            forces[2:, k] -= pull * np.array([by_theta, (t @ m) * (m @ e), (t @ w) * (w @ e)])
    return energy, forces, torque


def weight(packing: Packing, gravity: Vector) -> tuple[float, Floats]:
    """Potential energy [k R²] and forces on x, y (2, N) [k R] of gravity [k/R]: a grain weighs g R0² (11)."""
    energy, forces = 0.0, np.zeros((2, len(packing)))
    for i in range(len(packing)):
        area = float(packing.rest_radius[i]) ** 2
        forces[:, i] = area * gravity[0], area * gravity[1]
        energy -= forces[0, i] * packing.x[i] + forces[1, i] * packing.y[i]
    return energy, forces


def _tangential(
    i: int,
    j: int,
    labels: tuple[int, int],
    n: Vector,
    contact: Contact,
    gap: float,
    slip: float,
    levers: list[float],
    arm: float,
    grain: Ellipse,
    coefficient: float,
) -> Tangential:
    share = contact.overlap / (contact.overlap + gap)
    return Tangential(
        i=i,
        j=j,
        labels=labels,
        n=n,
        stiffness=0.5 * contact.normal_force / contact.overlap,
        cap=coefficient * contact.normal_force,
        gap=gap,
        slip=share * slip,
        lever_i=levers[0],
        lever_j=levers[1],
        at=(grain.x + arm * n[0], grain.y + arm * n[1]),
    )


def _reach(grain: Ellipse, along: Vector) -> float:
    return half_width(grain, math.atan2(along[1], along[0])).h


def _at_origin(label: int, grain: Ellipse, m: int, before: Before) -> tuple[float, float]:
    """Gap [R] and memory [R] of a grain and primitive m; an edge and the vertices at its ends are one contact."""
    rows = before.primitives
    meets = [k for k in range(len(rows)) if _adjoin(rows[m], rows[k])]
    memory = before.memory.get((label, -1 - m))
    if memory is None:
        remembered = [
            before.memory[label, -1 - k] for k in meets if (label, -1 - k) in before.memory
        ]
        memory = remembered[-1] if remembered else 0.0
    box = before.packing.box
    gaps = [_distance(beside(grain, rows[k], box), rows[k]) for k in (m, *meets)]
    return max(0.0, gaps[0] if rows[m, 0] == EDGE else min(gaps)), memory


def _adjoin(row: Floats, other: Floats) -> bool:
    """True of an edge and the vertex between it and another, whichever is which."""
    if {row[0], other[0]} != {EDGE, VERTEX}:
        return False
    edge, vertex = (row, other) if row[0] == EDGE else (other, row)
    return any(
        math.dist(edge[at : at + 2], vertex[1:3]) + math.dist(sign * edge[3:5], vertex[to : to + 2])
        < 1e-8
        for at, sign in ((1, -1.0), (5, 1.0))
        for to in (3, 5)
    )


def _distance(grain: Ellipse, row: Floats) -> float:
    """From the outline of a grain to a primitive [R]; for an edge it may be an end that is nearest."""
    kind, x0, y0, ux, uy, wx, wy, radius = map(float, row)
    point = (x0, y0)
    if kind == DISC:
        return (
            math.dist((grain.x, grain.y), point)
            - radius
            - _reach(grain, (grain.x - x0, grain.y - y0))
        )
    if kind == EDGE:
        if _past(grain, (x0, y0), (-ux, -uy)) <= 0.0 and _past(grain, (wx, wy), (ux, uy)) <= 0.0:
            n = _facing_normal(grain, point, (ux, uy))
            return n[0] * (grain.x - x0) + n[1] * (grain.y - y0) - radius - _reach(grain, n)
        if _past(grain, (x0, y0), (-ux, -uy)) <= 0.0:
            point = (wx, wy)
    alpha = _nearest_direction(grain, point)
    n = (math.cos(alpha), math.sin(alpha))
    along = n[0] * (grain.x - point[0]) + n[1] * (grain.y - point[1])
    return along - radius - half_width(grain, alpha).h

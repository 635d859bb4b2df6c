"""What the contact law's approximation costs: the same increment relaxed with the exact contact of ellipses.

The law measures the overlap along the line of centres. Exact is the overlap at which the outlines would part if the grains
were moved along that line: D − r with D the least of (h_i(n) + h_j(n)) / (n·e) over all n, see ``core.exact``. With U the
stretch tensor of a grain, h(n) = |U n|; write n = (e + t e⊥)/|…|, then D = |U_i w| + |U_j w| at the t of least D, w = e + t
e⊥, and the law is the case t = 0. By the envelope theorem the derivatives of D are those at fixed t, so one formula gives the
forces of both.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from core import observables
from core.arrays import Floats, Indices
from core.jit import kernel
from core.observables import GrainContacts, RigidContacts, body_contacts, grain_contacts
from core.packing import Packing
from core.problem import Problem
from core.relaxation import Relaxation
from core.rigid_contacts import DISC
from sandbox.studies.accuracy.peers import minimize
from sandbox.studies.accuracy.walk import Look, Walker

BISECTIONS = 50
SKIN = 0.4  # [R] two grains that come nearer than that on the way to balance would be missed
TOLERANCE = 1e-5


@kernel
def reach(state, k, wx, wy):
    """|U w| of grain k, its derivatives by p, q1, q2, and U U w/|U w| turned along w⊥: (h, ∂p, ∂q1, ∂q2, ∂angle)."""
    p = state[2, k]
    q1 = state[3, k]
    q2 = state[4, k]
    ux = (p + q1) * wx + q2 * wy
    uy = q2 * wx + (p - q1) * wy
    h = math.sqrt(ux * ux + uy * uy)
    vx = -(p + q1) * wy + q2 * wx  # U w⊥ with w⊥ = (−wy, wx)
    vy = -q2 * wy + (p - q1) * wx
    return (
        h,
        (ux * wx + uy * wy) / h,
        (ux * wx - uy * wy) / h,
        (ux * wy + uy * wx) / h,
        (ux * vx + uy * vy) / h,
    )


@kernel
def quadratic(state, k, ex, ey):
    """A, B, C with |U (e + t e⊥)|² = A + 2 B t + C t²."""
    p = state[2, k]
    q1 = state[3, k]
    q2 = state[4, k]
    ax = (p + q1) * ex + q2 * ey
    ay = q2 * ex + (p - q1) * ey
    bx = -(p + q1) * ey + q2 * ex
    by = -q2 * ey + (p - q1) * ex
    return ax * ax + ay * ay, ax * bx + ay * by, bx * bx + by * by


@kernel
def tilt(a1, b1, c1, a2, b2, c2, halvings):
    """The t of least |U_i w| + |U_j w|: between the least of both, where the slope changes sign."""
    low = min(-b1 / c1, -b2 / c2)
    high = max(-b1 / c1, -b2 / c2)
    for _ in range(halvings):
        t = 0.5 * (low + high)
        slope = (b1 + c1 * t) / math.sqrt(a1 + 2.0 * b1 * t + c1 * t * t)
        slope += (b2 + c2 * t) / math.sqrt(a2 + 2.0 * b2 * t + c2 * t * t)
        if slope < 0.0:
            low = t
        else:
            high = t
    return 0.5 * (low + high)


@kernel
def contact(state, i, j, dx, dy, radius, exact):
    """Distance of contact D less r [R], with j < 0 a disc of that radius; and −∂Δ by x, y, p, q1, q2 of i, then p, q1, q2 of j.

    ``dx``, ``dy`` lead from i to j. The pull on j in x, y is the opposite of that on i.
    """
    r = math.sqrt(dx * dx + dy * dy)
    ex, ey = dx / r, dy / r
    t = 0.0
    if exact:
        a, b, c = quadratic(state, i, ex, ey)
        if j >= 0:
            a2, b2, c2 = quadratic(state, j, ex, ey)
        else:
            a2, b2, c2 = radius * radius, 0.0, radius * radius
        t = tilt(a, b, c, a2, b2, c2, BISECTIONS)
    wx, wy = ex - t * ey, ey + t * ex
    h, hp, h1, h2, turn = reach(state, i, wx, wy)
    gp, g1, g2 = 0.0, 0.0, 0.0
    if j >= 0:
        g, gp, g1, g2, more = reach(state, j, wx, wy)
        turn += more
    else:
        g = radius * math.sqrt(1.0 + t * t)
    turn /= r
    overlap = h + g - r
    return overlap, -(ex + turn * ey), -(ey - turn * ex), -hp, -h1, -h2, -gp, -g1, -g2


@kernel
def correct(state, force, near, stiffness, pulls):
    """Replace the law's contacts by exact ones in ``force`` (D, N); returns the change of energy [k R²].

    ``pulls`` (4, K) become the exact force on the first grain [k R] and the way from it to the other [R].
    """
    energy = 0.0
    for k in range(near.first.shape[0]):
        i = near.first[k]
        j = near.second[k]
        dx = near.shift[0, k] - state[0, i]
        dy = near.shift[1, k] - state[1, i]
        if j >= 0:
            dx += state[0, j]
            dy += state[1, j]
        pulls[0, k] = 0.0
        pulls[1, k] = 0.0
        pulls[2, k] = dx
        pulls[3, k] = dy
        for exact in (False, True):
            overlap, fx, fy, fp, f1, f2, gp, g1, g2 = contact(
                state, i, j, dx, dy, near.radius[k], exact
            )
            if overlap <= 0.0:
                break  # the law is never late: what it does not see does not touch
            f = stiffness[k] * overlap if exact else -stiffness[k] * overlap
            energy += 0.5 * f * overlap
            force[0, i] += f * fx
            force[1, i] += f * fy
            force[2, i] += f * fp
            force[3, i] += f * f1
            force[4, i] += f * f2
            if exact:
                pulls[0, k] = f * fx
                pulls[1, k] = f * fy
            if j >= 0:
                force[0, j] -= f * fx
                force[1, j] -= f * fy
                force[2, j] += f * gp
                force[3, j] += f * g1
                force[4, j] += f * g2
    return energy


class Near(NamedTuple):
    """Pairs of grains, and of a grain and a disc of a body, that may touch (K,)."""

    first: Indices
    second: Indices  # -1: a disc
    shift: Floats  # (2, K) from the first to the second grain beyond their coordinates' difference; of a disc its centre [R]
    radius: Floats  # of the disc [R]
    stiffness: Floats  # C_ij [k]
    primitive: Indices  # of the disc; -1 between grains


def near_contacts(packing: Packing, primitives: Floats, skin: float = SKIN) -> Near:
    """All that is nearer than ``skin`` to touching by the contact law."""
    grown = packing.copy()
    grown.state[2] += 0.5 * skin
    pairs = grain_contacts(grown)
    wide = primitives.copy()
    wide[:, 7] += 0.5 * skin
    bodies = body_contacts(grown, wide)
    disc = primitives[bodies.primitive, 0] == DISC
    grain, primitive = bodies.grain[disc], bodies.primitive[disc]
    c_i, c_j = packing.contact_stiffness[pairs.i], packing.contact_stiffness[pairs.j]
    own_x, own_y = packing.x[pairs.j] - packing.x[pairs.i], packing.y[pairs.j] - packing.y[pairs.i]
    return Near(
        first=np.concatenate([pairs.i, grain]),
        second=np.concatenate([pairs.j, np.full(len(grain), -1)]),
        shift=np.array(
            [
                np.concatenate([pairs.dx - own_x, bodies.x[disc]]),
                np.concatenate([pairs.dy - own_y, bodies.y[disc]]),
            ]
        ),
        radius=np.concatenate([np.zeros(len(pairs.i)), primitives[primitive, 7]]),
        stiffness=np.concatenate([2.0 * c_i * c_j / (c_i + c_j), packing.contact_stiffness[grain]]),
        primitive=np.concatenate([np.full(len(pairs.i), -1), primitive]),
    )


class ExactProblem(Problem):
    """The increment of ``relaxation`` with exact contacts instead of the law's."""

    def __init__(self, relaxation: Relaxation, tolerance: float, near: Near) -> None:
        self.near = near
        self.pulls = np.zeros((4, len(near.first)))
        super().__init__(relaxation, tolerance)

    def extra(self, state: Floats, force: Floats, identity: Indices) -> float:
        """What exact contacts change, in the minimiser's order."""
        place = np.argsort(identity)
        second = np.where(self.near.second < 0, -1, place[self.near.second])
        moved = self.near._replace(first=place[self.near.first], second=second)
        return float(correct(state, force, moved, self.near.stiffness, self.pulls))


def exact_increment(walker: Walker, tolerance: float = TOLERANCE) -> Look:
    """Relax where things stand, with exact contacts and without friction, and look: forces are the exact ones."""
    engine = walker.engine
    engine.begin({})
    relaxation = engine.relaxation
    assert relaxation is not None
    primitives, owner = walker.setup.world.primitives()
    near = near_contacts(engine.packing, primitives)
    problem = ExactProblem(relaxation, tolerance, near)
    minimize(problem)
    relaxation.max_iterations = 1
    done = engine.relax(1)
    assert done is not None
    pulls = problem.pulls
    grains = (near.second >= 0) & (np.hypot(pulls[0], pulls[1]) > 0.0)
    size = np.hypot(*pulls[:2, grains])
    pairs = GrainContacts(
        near.first[grains],
        near.second[grains],
        pulls[0, grains],
        pulls[1, grains],
        size,
        size / near.stiffness[grains],
        pulls[2, grains],
        pulls[3, grains],
    )
    bodies = _exact_discs(done.body_contacts, near, pulls, primitives)
    placement = walker.setup.world.placement()
    reactions = observables.reactions(bodies, owner, placement)
    exact = replace(done, grain_contacts=pairs, body_contacts=bodies, reactions=reactions)
    return replace(walker.look(exact), residual=problem.residual, converged=problem.solved)


def _exact_discs(
    law: RigidContacts, near: Near, pulls: Floats, primitives: Floats
) -> RigidContacts:
    """Contacts with bodies in which the forces of discs are the exact ones."""
    fx, fy = law.fx.copy(), law.fy.copy()
    found = {
        (int(grain), int(primitive)): k
        for k, (grain, primitive) in enumerate(zip(near.first, near.primitive, strict=True))
        if primitive >= 0
    }
    for k, (grain, primitive) in enumerate(zip(law.grain, law.primitive, strict=True)):
        if primitives[primitive, 0] == DISC:
            fx[k], fy[k] = pulls[:2, found[int(grain), int(primitive)]]
    return replace(law, fx=fx, fy=fy)

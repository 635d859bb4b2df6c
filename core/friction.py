"""Coulomb friction, as an incremental potential whose normal forces lag one increment behind.

At the start of a load increment every contact's tangent t, arms h and Coulomb cap μ f_n are frozen. During the relaxation
the tangential slip is u = ξ + t·(δx_i − δx_j) + h_i δφ_i + h_j δφ_j (for a rigid body: minus its prescribed motion), where φ
is a grain's spin and ξ what the contact remembers; each contact adds the convex Huber potential k_t u²/2 while k_t |u| ≤ cap,
beyond it cap (|u| − cap/2k_t). Its force never exceeds the cap, it is C¹, and FIRE minimises it like any other term.
Afterwards ξ becomes u, clipped to ± cap/k_t, and is remembered by the pair of grains, so that it survives new neighbour lists
and grains that leave. New contacts begin at 0. Smaller increments converge to Coulomb's law. The lag is that of Li et al.,
Incremental Potential Contact, doi:10.1145/3386569.3392425.

A scene without friction has none of this: no spin, no memory, and its kernels are compiled without the term.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.arrays import Floats
from core.errors import InputError
from core.jit import kernel
from core.observables import GrainContacts, RigidContacts
from core.packing import MAX_LABEL, Packing, PeriodicBox
from core.rigid_contacts import DISC

Indices = NDArray[np.int64]

TANGENTIAL_STIFFNESS = 0.5  # k_t over C
SPIN_MASS = 2.0  # inertia of a spin over R0², relative to x and y
_BODY = MAX_LABEL  # keys of primitives begin here; labels of grains stay below
_GRAIN = 2 * MAX_LABEL


class FrictionTerms(NamedTuple):
    """Frictional contacts of one increment, (K,) each: first those between grains, then those with bodies."""

    i: Indices  # grain, numbered as in the packing
    j: Indices  # the other grain, numbered as in the packing; -1: a rigid body
    tx: Floats
    ty: Floats
    arm_i: Floats  # h_i [R]
    arm_j: Floats  # h_j [R]; 0 for a rigid body
    stiffness: Floats  # k_t [k]
    cap: Floats  # μ f_n [k R]
    offset: Floats  # slip when all coordinates are 0 [R]
    pairs: Indices  # (1,) how many are between grains
    place: Indices  # (N,) where each grain of the packing stands in the minimiser
    at_i: NDArray[np.uint32]  # place of grain i
    at_j: NDArray[np.uint32]  # place of grain j; for a body anything
    pull: Floats  # work space: tangential force on i against t [k R]


@kernel
def settle_places(identity, terms):
    """Follow the grains to where they stand now in the minimiser; ``identity`` (N,) is the grain at each place."""
    place, i, j, at_i, at_j = terms.place, terms.i, terms.j, terms.at_i, terms.at_j
    for k in range(identity.shape[0]):
        place[identity[k]] = k
    for k in range(i.shape[0]):
        at_i[k] = place[i[k]]
        at_j[k] = place[max(j[k], 0)]


@kernel(noalias=True)
def pair_pulls(at_i, at_j, x, y, turned, tx, ty, arm_i, arm_j, stiffness, cap, offset, pull):
    """Tangential forces of contacts between grains into ``pull``; returns their energy [k R²]. Vectorises."""
    energy = 0.0
    for k in range(at_i.shape[0]):
        i = at_i[k]
        j = at_j[k]
        u = offset[k] + tx[k] * (x[i] - x[j]) + ty[k] * (y[i] - y[j])
        u += arm_i[k] * turned[i] + arm_j[k] * turned[j]
        f = stiffness[k] * u
        f = min(f, cap[k])
        f = max(f, -cap[k])
        energy += f * (u - 0.5 * f / stiffness[k])  # Huber: both branches in one
        pull[k] = f
    return energy


@kernel(noalias=True)
def body_pulls(at_i, x, y, turned, tx, ty, arm_i, stiffness, cap, offset, pull):
    """The same for contacts with bodies, whose motion is prescribed and stands in ``offset``."""
    energy = 0.0
    for k in range(at_i.shape[0]):
        i = at_i[k]
        u = offset[k] + tx[k] * x[i] + ty[k] * y[i] + arm_i[k] * turned[i]
        f = stiffness[k] * u
        f = min(f, cap[k])
        f = max(f, -cap[k])
        energy += f * (u - 0.5 * f / stiffness[k])
        pull[k] = f
    return energy


@kernel
def add_friction_forces(state, force, terms):
    """Add tangential forces to rows 0 and 1 and torques to row 5 of ``force``. Returns the energy [k R²].

    Forces first, without a store that could alias, then the scatter: six times as fast as both in one loop.
    """
    x, y, turned = state[0], state[1], state[5]
    fx, fy, torque = force[0], force[1], force[5]
    at_i, at_j, tx, ty = terms.at_i, terms.at_j, terms.tx, terms.ty
    arm_i, arm_j, pull = terms.arm_i, terms.arm_j, terms.pull
    stiffness, cap, offset = terms.stiffness, terms.cap, terms.offset
    n = terms.pairs[0]
    energy = pair_pulls(
        at_i[:n],
        at_j[:n],
        x,
        y,
        turned,
        tx[:n],
        ty[:n],
        arm_i[:n],
        arm_j[:n],
        stiffness[:n],
        cap[:n],
        offset[:n],
        pull[:n],
    )
    energy += body_pulls(
        at_i[n:],
        x,
        y,
        turned,
        tx[n:],
        ty[n:],
        arm_i[n:],
        stiffness[n:],
        cap[n:],
        offset[n:],
        pull[n:],
    )
    for k in range(at_i.shape[0]):
        i = at_i[k]
        f = pull[k]
        fx[i] -= f * tx[k]
        fy[i] -= f * ty[k]
        torque[i] -= f * arm_i[k]
    for k in range(n):
        j = at_j[k]
        f = pull[k]
        fx[j] += f * tx[k]
        fy[j] += f * ty[k]
        torque[j] -= f * arm_j[k]
    return energy


@dataclass(frozen=True)
class FrozenContacts:
    """The frictional contacts of one increment: terms for the kernels, and what is needed to remember them, (K,) each."""

    terms: FrictionTerms
    keys: Indices
    primitive: Indices  # of a rigid body; -1 between grains
    x: Floats  # where they touch [R]; with a body: in the body's own image
    y: Floats
    dx: Floats  # branch vector from grain i to grain j, or to where it touches the body [R]
    dy: Floats


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


class _Touching(NamedTuple):
    """Contacts of one sort before an increment, (K,) each; names as in ``FrictionTerms`` and ``FrozenContacts``.

    All tangents are n turned counter-clockwise, n from grain i to grain j, or to the body.
    """

    i: Indices
    j: Indices
    tx: Floats
    ty: Floats
    arm_i: Floats
    arm_j: Floats
    stiffness: Floats
    normal_force: Floats
    offset: Floats
    key: Indices
    primitive: Indices
    x: Floats
    y: Floats
    dx: Floats
    dy: Floats


def _between_grains(
    packing: Packing, support: Floats, pairs: GrainContacts, box: PeriodicBox | None
) -> _Touching:
    """As the packing stands, in a periodic cell that becomes ``box``."""
    r = np.hypot(pairs.dx, pairs.dy)
    nx, ny = pairs.dx / r, pairs.dy / r
    # Both arms reach to one point, half way between the outlines: then h_i + h_j is the distance of the centres, the
    # forces exert no torque on the pair, and a pair that turns as one rigid whole does not slip.
    arm_i = _arm(support, pairs.i, nx, ny) - 0.5 * pairs.overlap
    offset = ny * (packing.x[pairs.i] - packing.x[pairs.j]) - nx * (
        packing.y[pairs.i] - packing.y[pairs.j]
    )
    stretch_x, stretch_y = _stretch(
        packing.box,
        box,
        pairs.dx - packing.x[pairs.j] + packing.x[pairs.i],
        pairs.dy - packing.y[pairs.j] + packing.y[pairs.i],
    )
    offset += ny * stretch_x - nx * stretch_y
    return _Touching(
        i=pairs.i,
        j=pairs.j,
        tx=-ny,
        ty=nx,
        arm_i=arm_i,
        arm_j=r - arm_i,
        stiffness=TANGENTIAL_STIFFNESS * pairs.normal_force / pairs.overlap,
        normal_force=pairs.normal_force,
        offset=offset,
        key=_pair_keys(packing, pairs),
        primitive=np.full(len(pairs.i), -1),
        x=packing.x[pairs.i] + arm_i * nx,
        y=packing.y[pairs.i] + arm_i * ny,
        dx=pairs.dx,
        dy=pairs.dy,
    )


def _with_bodies(
    packing: Packing,
    support: Floats,
    bodies: RigidContacts,
    primitives: Floats,
    owner: Indices,
    before: Floats,
    after: Floats,
    box: PeriodicBox | None,
) -> _Touching:
    """The same with bodies, whose contact point moves as prescribed; arguments as for ``Friction.begin``."""
    g = bodies.grain
    rows = primitives[bodies.primitive]
    bx, by = bodies.x - packing.x[g], bodies.y - packing.y[g]
    mx, my = _body_normals(rows, packing, bodies)
    arm = np.where(rows[:, 0] == DISC, _arm(support, g, mx, my), np.abs(bx * mx + by * my))
    x = packing.x[g] + arm * mx + bodies.image_x
    y = packing.y[g] + arm * my + bodies.image_y
    body = owner[bodies.primitive]
    shift = after[body] - before[body]
    moved_x = shift[:, 0] - shift[:, 2] * (y - before[body, 1])
    moved_y = shift[:, 1] + shift[:, 2] * (x - before[body, 0])
    stretch_x, stretch_y = _stretch(packing.box, box, bodies.image_x, bodies.image_y)
    offset = my * packing.x[g] - mx * packing.y[g]
    offset += my * (moved_x - stretch_x) - mx * (moved_y - stretch_y)
    return _Touching(
        i=g,
        j=np.full(len(g), -1),
        tx=-my,
        ty=mx,
        arm_i=arm,
        arm_j=np.zeros(len(g)),
        stiffness=TANGENTIAL_STIFFNESS * packing.contact_stiffness[g],
        normal_force=bodies.normal_force,
        offset=offset,
        key=packing.label[g] * _GRAIN + _BODY + bodies.primitive,
        primitive=bodies.primitive,
        x=x,
        y=y,
        dx=arm * mx,
        dy=arm * my,
    )


class Friction:
    """Friction of one packing: the coefficient, every grain's spin, and what every contact remembers."""

    def __init__(self, coefficient: float, grains: int) -> None:
        """Raises InputError unless the coefficient is positive and finite: without friction, give None instead of this."""
        if not (coefficient > 0.0 and np.isfinite(coefficient)):
            raise InputError(
                "the friction coefficient must be greater than 0; for no friction leave it out"
            )
        self.coefficient = float(coefficient)
        self.spin: Floats = np.zeros(grains)
        self._keys: Indices = np.zeros(0, dtype=np.int64)
        self._slips: Floats = np.zeros(0)

    @classmethod
    def of(cls, coefficient: float, grains: int) -> Friction | None:
        """The same, and for a coefficient of 0 None."""
        return None if coefficient == 0.0 else cls(coefficient, grains)

    def copy(self) -> Friction:
        """An independent copy, equal to the last bit."""
        twin = Friction(self.coefficient, 0)
        for name, value in vars(self).items():
            setattr(twin, name, value.copy() if isinstance(value, np.ndarray) else value)
        return twin

    @property
    def size(self) -> int:
        """Bytes of spins and memories."""
        return self.spin.nbytes + self._keys.nbytes + self._slips.nbytes

    def hash(self) -> str:
        """SHA-256 of spins and memories."""
        digest = hashlib.sha256(np.float64(self.coefficient).tobytes())
        for array in (self.spin, self._keys, self._slips):
            digest.update(array.tobytes())
        return digest.hexdigest()

    def select(self, keep: NDArray[np.bool_]) -> None:
        """Forget the grains that are not kept; contacts with them end by themselves."""
        self.spin = self.spin[keep]

    def rearrange(self, source: Indices) -> None:
        """Go on with other grains: ``source`` (n,) is what each was before, −1 for a new one, which has not turned yet."""
        spin = np.append(self.spin, 0.0)
        self.spin = spin[source]

    def forget_primitives(self, first: int, count: int) -> None:
        """Forget contacts with the ``count`` primitives from ``first`` on, which are taken away; later ones move up."""
        primitive = self._keys % _GRAIN - _BODY
        gone = (primitive >= first) & (primitive < first + count)
        keys = np.where(primitive >= first + count, self._keys - count, self._keys)
        self._keys, self._slips = keys[~gone], self._slips[~gone]

    def memory(self) -> tuple[Indices, Floats]:
        """What the contacts remember, for a file: their keys and slips ξ [R], (K,) each."""
        return self._keys.copy(), self._slips.copy()

    def remember(self, spin: Floats, keys: Indices, slips: Floats) -> None:
        """Take up spins (N,) and what ``memory`` gave. Raises InputError unless the keys are in order and all is finite."""
        whole = keys.ndim == 1 and keys.shape == slips.shape and spin.shape == self.spin.shape
        if not whole or np.any(keys < 0) or np.any(np.diff(keys) <= 0):
            raise InputError("what the frictional contacts remember is out of order")
        if not (np.all(np.isfinite(spin)) and np.all(np.isfinite(slips))):
            raise InputError("spins and slips of frictional contacts must be finite")
        self.spin, self._keys, self._slips = spin.copy(), keys.copy(), slips.copy()

    def remembered(self) -> dict[tuple[int, int], float]:
        """Slip ξ [R] by (label, label) of two grains, or (label, −1 − primitive) of a grain and a body."""
        first, second = self._keys // _GRAIN, self._keys % _GRAIN
        second = np.where(second >= _BODY, _BODY - 1 - second, second)
        return {
            (int(a), int(b)): float(s) for a, b, s in zip(first, second, self._slips, strict=True)
        }

    def begin(
        self,
        packing: Packing,
        pairs: GrainContacts,
        bodies: RigidContacts,
        primitives: Floats,
        owner: Indices,
        before: Floats,
        after: Floats,
        box: PeriodicBox | None = None,
    ) -> FrozenContacts:
        """Freeze the contacts of a packing for an increment in which the bodies go from ``before`` to ``after`` (B, 3).

        ``pairs`` and ``bodies`` are its contacts before the bodies move, ``primitives`` and ``owner`` the bodies' shapes then.
        ``box`` is the periodic cell afterwards, if it changes.
        """
        support = observables.support_coefficients(packing)
        parts = (
            _between_grains(packing, support, pairs, box),
            _with_bodies(packing, support, bodies, primitives, owner, before, after, box),
        )
        both = _Touching._make(map(np.concatenate, zip(*parts, strict=True)))
        count = len(both.key)
        caps = self.coefficient * both.normal_force
        limit = caps / both.stiffness
        terms = FrictionTerms(
            i=both.i,
            j=both.j,
            tx=both.tx,
            ty=both.ty,
            arm_i=both.arm_i,
            arm_j=both.arm_j,
            stiffness=both.stiffness,
            cap=caps,
            offset=both.offset + np.clip(self._recall(both.key), -limit, limit),
            pairs=np.array([len(pairs.i)]),
            place=np.arange(len(packing)),
            at_i=np.zeros(count, dtype=np.uint32),
            at_j=np.zeros(count, dtype=np.uint32),
            pull=np.zeros(count),
        )
        return FrozenContacts(terms, both.key, both.primitive, both.x, both.y, both.dx, both.dy)

    def end(self, frozen: FrozenContacts, packing: Packing, turned: Floats) -> FrictionForces:
        """Remember the slips of a relaxed packing whose grains turned by ``turned`` (N,) [rad]; the forces they stand for."""
        terms = frozen.terms
        u = terms.offset + terms.tx * packing.x[terms.i] + terms.ty * packing.y[terms.i]
        u += terms.arm_i * turned[terms.i]
        pair = terms.j >= 0
        j = terms.j[pair]
        u[pair] += terms.arm_j[pair] * turned[j]
        u[pair] -= terms.tx[pair] * packing.x[j] + terms.ty[pair] * packing.y[j]
        limit = terms.cap / terms.stiffness
        sliding = np.abs(u) >= limit
        held = np.clip(u, -limit, limit)
        order = np.argsort(frozen.keys, kind="stable")
        self._keys, self._slips = frozen.keys[order], held[order]
        self.spin += turned
        pull = terms.stiffness * held
        return FrictionForces(
            i=terms.i,
            j=terms.j,
            primitive=frozen.primitive,
            fx=-pull * terms.tx,
            fy=-pull * terms.ty,
            x=frozen.x,
            y=frozen.y,
            dx=frozen.dx,
            dy=frozen.dy,
            sliding=sliding,
        )

    def _recall(self, keys: Indices) -> Floats:
        """What the contacts with these keys remember; 0 for new ones."""
        if not len(self._keys):
            return np.zeros(len(keys))
        at = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        known: Floats = np.where(self._keys[at] == keys, self._slips[at], 0.0)
        return known


def _stretch(
    old: PeriodicBox | None, new: PeriodicBox | None, x: Floats, y: Floats
) -> tuple[Floats, Floats]:
    """How much the distances x, y [R] from grains to images of theirs change with the periodic cell."""
    if old is None or new is None or new == old:
        return np.zeros_like(x), np.zeros_like(y)
    rows = np.rint(y / old.height)
    columns = np.rint((x - rows * old.shift) / old.width)
    wider = new.width - old.width if np.isfinite(old.width) else 0.0
    higher = new.height - old.height if np.isfinite(old.height) else 0.0
    return columns * wider + rows * (new.shift - old.shift), rows * higher


def _arm(support: Floats, grain: Indices, nx: Floats, ny: Floats) -> Floats:
    """h of the grains along n [R]."""
    s, u, v = support[:, grain]
    arm: Floats = np.sqrt(s + u * (nx * nx - ny * ny) + v * 2.0 * nx * ny)
    return arm


def _body_normals(rows: Floats, packing: Packing, bodies: RigidContacts) -> tuple[Floats, Floats]:
    """Unit normals from grains to bodies: along the force, or for a disc (whose law is not central) along the line of centres."""
    size = np.hypot(bodies.fx, bodies.fy)
    mx, my = -bodies.fx / size, -bodies.fy / size
    cx, cy = bodies.x - packing.x[bodies.grain], bodies.y - packing.y[bodies.grain]
    r = np.maximum(np.hypot(cx, cy), 1e-300)
    disc = rows[:, 0] == DISC
    return np.where(disc, cx / r, mx), np.where(disc, cy / r, my)


def _pair_keys(packing: Packing, pairs: GrainContacts) -> Indices:
    a, b = packing.label[pairs.i], packing.label[pairs.j]
    keys: Indices = np.minimum(a, b) * _GRAIN + np.maximum(a, b)
    return keys

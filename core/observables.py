"""What is measured on a packing. Each function says its definition, unit and source; none changes anything."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core import neighbors, rigid_contacts
from core.arrays import Box, Floats, Indices
from core.contacts import grain_overlap
from core.endless import endless
from core.jit import kernel, shared
from core.packing import Packing


@dataclass(frozen=True)
class GrainContacts:
    """Contacts between grains that carry force, (K,) each."""

    i: Indices
    j: Indices
    fx: Floats  # force on grain i [k R]; on j the opposite
    fy: Floats
    normal_force: Floats  # C_ij Δ [k R]
    overlap: Floats  # Δ [R]
    dx: Floats  # branch vector from i to j, nearest image [R]
    dy: Floats


@dataclass(frozen=True)
class RigidContacts:
    """Contacts between grains and rigid bodies that carry force, (K,) each."""

    grain: Indices
    primitive: Indices
    fx: Floats  # force on the grain [k R]; on the body the opposite
    fy: Floats
    normal_force: Floats  # C Δ [k R]
    overlap: Floats  # Δ [R]
    x: Floats  # a point on the line of action [R]: where they touch
    y: Floats  # in the image nearest to the grain
    image_x: Floats  # from there to the same point in the body's own image [R]; 0 in an open box
    image_y: Floats


@kernel
def _measure_pairs(state, support, stiffness, pairs, first, second, box, values):
    """Fill rows fx, fy, f, Δ, dx, dy of ``values`` (6, K) for pairs that touch, packed to the front; returns their number."""
    used = 0
    for k in range(pairs):
        i = first[k]
        j = second[k]
        overlap, dx, dy, c2, s2, hi, hj = grain_overlap(state, support, i, j, box)
        if overlap > 0.0:
            r2 = dx * dx + dy * dy
            f = 2.0 * stiffness[i] * stiffness[j] / (stiffness[i] + stiffness[j]) * overlap
            slope = (support[2, i] * c2 - support[1, i] * s2) / hi + (
                support[2, j] * c2 - support[1, j] * s2
            ) / hj
            along = f / np.sqrt(r2)
            turn = f * slope / r2
            values[0, used] = -along * dx - turn * dy
            values[1, used] = -along * dy + turn * dx
            values[2, used] = f
            values[3, used] = overlap
            values[4, used] = dx
            values[5, used] = dy
            first[used] = i
            second[used] = j
            used += 1
    return used


@kernel
def _measure_rigid(state, support, stiffness, rigid, box, values):
    """Fill rows fx, fy, f, Δ, x, y, image x, y of ``values`` (8, K) for grain–body contacts, packed to the front.

    Returns their number.
    """
    primitives, grain, primitive = rigid.primitives, rigid.grain, rigid.primitive
    used = 0
    for k in range(rigid.used[0]):
        i = grain[k]
        m = primitive[k]
        x, y = rigid_contacts.image(primitives, m, state[0, i], state[1, i], box)
        overlap, nx, ny, h, slope = rigid_contacts.touch(
            primitives, m, x, y, support[0, i], support[1, i], support[2, i]
        )
        if overlap > 0.0:
            f = stiffness[i] * overlap
            values[0, used] = f * (nx + slope * ny)
            values[1, used] = f * (ny - slope * nx)
            values[2, used] = f
            values[3, used] = overlap
            values[6, used] = x - state[0, i]
            values[7, used] = y - state[1, i]
            if primitives[m, 0] == rigid_contacts.DISC:
                # The tangential part of this law turns the grain, not the disc: on the body it acts at the centre.
                values[4, used] = primitives[m, 1] + state[0, i] - x
                values[5, used] = primitives[m, 2] + state[1, i] - y
            else:
                _, turn = rigid_contacts.support(
                    support[0, i], support[1, i], support[2, i], nx, ny
                )
                values[4, used] = state[0, i] - h * nx + turn * ny
                values[5, used] = state[1, i] - h * ny - turn * nx
            grain[used] = i
            primitive[used] = m
            used += 1
    return used


@shared
def support_coefficients(state: Floats) -> Floats:
    """s, u, v of every grain (3, N), its ``state`` (5, N): h(φ)² = s + u cos 2φ + v sin 2φ [R²]."""
    p, q1, q2 = state[2], state[3], state[4]
    support = np.empty((3, p.shape[0]))
    support[0] = p * p + q1 * q1 + q2 * q2
    support[1] = 2.0 * p * q1
    support[2] = 2.0 * p * q2
    return support


def grain_contacts(packing: Packing) -> GrainContacts:
    """All contacts between grains of a packing."""
    box = None if packing.box is None else packing.box.kernel_form()
    i, j, values = touching_grains(packing.state, packing.contact_stiffness, box)
    return GrainContacts(i, j, *values)


@shared
def touching_grains(
    state: Floats, stiffness: Floats, box: Box | None
) -> tuple[Indices, Indices, Floats]:
    """The same of grains in ``state`` (5, N) with contact stiffnesses (N,) [k]: i, j, and the rest as rows (6, K)."""
    count = state.shape[1]
    room = 4 * count
    lists = neighbors.allocate(count, room)
    pairs = neighbors.find_pairs(state, 0.0, lists, box) if count else 0
    while pairs < 0:
        room *= 2
        lists = neighbors.allocate(count, room)
        pairs = neighbors.find_pairs(state, 0.0, lists, box)
    values, first, second = np.empty((6, pairs)), lists.first, lists.second
    support = support_coefficients(state)
    used = _measure_pairs(state, support, stiffness, pairs, first, second, box, values)
    return first[:used].copy(), second[:used].copy(), values[:, :used]


def body_contacts(packing: Packing, primitives: Floats) -> RigidContacts:
    """All contacts of a packing with the primitives (M, 8) of rigid bodies."""
    if not len(primitives):
        none = np.zeros(0, dtype=np.int64)
        return RigidContacts(none, none, *np.zeros((8, 0)))
    box = None if packing.box is None else packing.box.kernel_form()
    rows = np.ascontiguousarray(endless(primitives, packing.box), dtype=np.float64)
    grain, primitive, values = touching_bodies(packing.state, packing.contact_stiffness, rows, box)
    return RigidContacts(grain, primitive, *values)


@shared
def touching_bodies(
    state: Floats, stiffness: Floats, primitives: Floats, box: Box | None
) -> tuple[Indices, Indices, Floats]:
    """The same of grains in ``state`` (5, N) with contact stiffnesses (N,) [k]: grain, primitive, and the rest as rows (8, K).

    ``primitives`` are as ``endless`` has them.
    """
    rigid = rigid_contacts.allocate(primitives, max(state.shape[1], 1))
    while not rigid_contacts.find_rigid_pairs(state, rigid, 0.0, box):
        rigid = rigid_contacts.doubled(rigid)
    values = np.empty((8, rigid.used[0]))
    used = _measure_rigid(state, support_coefficients(state), stiffness, rigid, box, values)
    return rigid.grain[:used].copy(), rigid.primitive[:used].copy(), values[:, :used]


def reactions(contacts: RigidContacts, owner: Indices, placement: Floats) -> Floats:
    """Force and torque of the grains on each body: (B, 3) of fx, fy [k R] and torque about the body's position [k R²].

    ``owner`` (M,) names the body of each primitive, ``placement`` (B, 3) where the bodies are.
    """
    total = np.zeros((len(placement), 3))
    if not len(placement):
        return total
    x, y = contacts.x + contacts.image_x, contacts.y + contacts.image_y
    push_bodies(owner[contacts.primitive], contacts.fx, contacts.fy, x, y, placement, total)
    return total


@kernel
def push_bodies(body, fx, fy, x, y, placement, total):
    """Add to ``total`` (B, 3) what the opposites of forces (L,) [k R] on grains, at (x, y) [R], do to the ``body`` of each."""
    for k in range(body.shape[0]):
        b = body[k]
        lever_x, lever_y = x[k] - placement[b, 0], y[k] - placement[b, 1]
        total[b, 0] += -fx[k]
        total[b, 1] += -fy[k]
        total[b, 2] += -(lever_x * fy[k] - lever_y * fx[k])


def stress(
    contacts: GrainContacts,
    area: float,
    rigid: RigidContacts | None = None,
    packing: Packing | None = None,
) -> Floats:
    """Stress tensor σ_ij = (1/area) Σ_c F_i d_j (2, 2) [k], compression positive.

    Haver et al., doi:10.1073/pnas.2317915121, appendix "Numerical biaxial setup". Contacts with bodies count with the branch from
    the grain's centre to the body; ``packing`` is then needed (else ValueError). σ_xy = σ_yx only in equilibrium: their
    difference tests that.
    """
    if rigid is not None and packing is None:
        raise ValueError("the branches of contacts with bodies need the packing")
    tensor = np.array(
        [
            [-np.sum(contacts.fx * contacts.dx), -np.sum(contacts.fx * contacts.dy)],
            [-np.sum(contacts.fy * contacts.dx), -np.sum(contacts.fy * contacts.dy)],
        ]
    )
    if rigid is not None and packing is not None:
        dx = rigid.x - packing.x[rigid.grain]
        dy = rigid.y - packing.y[rigid.grain]
        tensor -= np.array(
            [
                [np.sum(rigid.fx * dx), np.sum(rigid.fx * dy)],
                [np.sum(rigid.fy * dx), np.sum(rigid.fy * dy)],
            ]
        )
    return tensor / area


def grain_stress(
    packing: Packing, pairs: GrainContacts, bodies: RigidContacts, primitives: Floats
) -> Floats:
    """Mean stress inside each grain from its normal forces (3, N) [k]: pressure, and the deviator's two parts.

    Compression is positive. σ = (1/A) Σ_c f h n⊗n with the area A = π(p² − |q|²), normal force f, its direction n at angle φ
    and the support function h: the work of the contacts in a uniform strain of the grain, as f is conjugate to h. Hence
    p = Σ f h / 2A and the deviator is Σ f h (cos 2φ, sin 2φ) / 2A; the difference of the principal stresses is twice its
    length. One circle between two plates that push with F: p = F/(πR), difference 2F/(πR). ``primitives`` (M, 8) are those
    that ``bodies`` touch.
    """
    count = len(packing)
    grain = np.concatenate([pairs.i, pairs.j, bodies.grain])
    force = np.concatenate([pairs.normal_force, pairs.normal_force, bodies.normal_force])
    # A disc's force has a tangential part; its normal runs through both centres.
    disc = primitives[bodies.primitive, 0] == rigid_contacts.DISC
    nx = np.where(disc, packing.x[bodies.grain] - bodies.x, bodies.fx)
    ny = np.where(disc, packing.y[bodies.grain] - bodies.y, bodies.fy)
    dx = np.concatenate([pairs.dx, pairs.dx, nx])
    dy = np.concatenate([pairs.dy, pairs.dy, ny])
    square = np.maximum(dx * dx + dy * dy, 1e-290)
    c2, s2 = (dx * dx - dy * dy) / square, 2.0 * dx * dy / square
    s, u, v = support_coefficients(packing.state)[:, grain]
    work = force * np.sqrt(np.maximum(s + u * c2 + v * s2, 0.0))
    p, q1, q2 = packing.state[2:]
    area = np.pi * (p * p - q1 * q1 - q2 * q2)
    total = [np.bincount(grain, part, count) for part in (work, work * c2, work * s2)]
    stress: Floats = np.array(total) / np.maximum(2.0 * area, 1e-290)
    return stress


def pressure(tensor: Floats) -> float:
    """P = ½ tr σ [k]."""
    return 0.5 * float(np.trace(tensor))


def coordination(
    packing: Packing, contacts: GrainContacts, rigid: RigidContacts | None = None
) -> tuple[float, float]:
    """Coordination number Z, contacts a grain: (all grains counted, rattlers left out).

    A rattler has fewer than three contacts; they are taken out until none is left. Contacts with bodies hold a grain but are
    shared with no other. van Hecke, doi:10.1088/0953-8984/22/3/033101.
    """
    count = len(packing)
    if count == 0:
        return 0.0, 0.0
    held = (
        np.zeros(count, dtype=np.int64)
        if rigid is None
        else np.bincount(rigid.grain, minlength=count)
    )
    alive = np.ones(len(contacts.i), dtype=bool)
    frame = np.ones(count, dtype=bool)
    while True:
        degree = (
            np.bincount(contacts.i[alive], minlength=count)
            + np.bincount(contacts.j[alive], minlength=count)
            + held
        )
        loose = frame & (degree < 3)
        if not loose.any():
            break
        frame &= ~loose
        alive &= frame[contacts.i] & frame[contacts.j]
        held = np.where(frame, held, 0)
    outer = 0 if rigid is None else len(rigid.grain)
    everyone = (2.0 * len(contacts.i) + outer) / count
    backbone = (2.0 * int(alive.sum()) + int(held.sum())) / max(int(frame.sum()), 1)
    return everyone, backbone


def packing_fraction(packing: Packing, area: float) -> float:
    """φ = Σ π R0² / area, by rest areas."""
    return packing.rest_area / area


def force_drops(force: Floats) -> Floats:
    """Sizes of the falls of a force–displacement curve (n,) [k R]: each unbroken run of decreasing force is one drop."""
    curve = np.asarray(force, dtype=np.float64)
    falling = np.diff(curve) < 0.0
    if not falling.any():
        return np.zeros(0)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], falling, [False]]).astype(np.int8)))
    return curve[edges[::2]] - curve[edges[1::2]]

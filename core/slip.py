"""How far the surfaces of two grains, or of a grain and a body, have slipped, and the force of that. MODEL.md, section 7.

For each contact, with d = x_j − x_i, the unit normal n from grain i to grain j, t = n turned left, the support function h and the
overlap Δ as they are NOW, and a zero for where things were at the origin of slips (``frictional_contacts``):

    u = λ [ξ − t·(d − d⁰) + l_i δφ_i + l_j δφ_j + t·δU_i e_i + t·δU_j e_j],    pull = k_t u, cut to ± μ C Δ

e = U n / h is the material point that touches, as a unit vector of the undeformed grain, and l = det U / h − Δ/2 its lever for a
turn φ of the material inside its outline; λ = Δ / (Δ + g⁰) lets a contact that was open at the origin begin at nothing. Since
t·UJe = det U / h with J the turn by a right angle, all that grain i does is t·G_i e_i − δφ_i Δ/2 with G = δU + δφ UJ, and what is
done to its shape and spin follows from M = − Σ pull t⊗e and D = Σ pull Δ/2: a few numbers a grain, whatever it touches.

Nothing is frozen: cap, tangent, levers and the set of contacts are functions of the state. That makes a force field, and not the
gradient of a potential; the energy that is returned is what the tangential springs store.

All is summed in the same pass as the normal forces (``contacts.slot_forces``, ``rigid_contacts.add_rigid_forces``).
"""

from __future__ import annotations

from typing import NamedTuple

from core.arrays import Floats
from core.jit import kernel
from core.periodic import nearest

TANGENTIAL_STIFFNESS = 0.5  # k_t over C
TOUCHED = 1e-30  # [R] keeps Δ/(Δ + g⁰) finite where both are 0


class FrictionTerms(NamedTuple):
    """What the kernels know of friction. N grains in the minimiser's order, E entries of the slots, B pairs with M primitives.

    A mark is a row of: ξ, slip at the origin; g⁰, how far apart they were there, 0 if they touched; d⁰, to grain j, or from the
    primitive's first point to the grain. [R]
    """

    coefficient: float  # μ
    origin: Floats  # (4, N) p, q1, q2 and spin at the origin of slips [R, rad]
    change: Floats  # (5, N) G₁₁, G₁₂, G₂₁, G₂₂ [R] and δφ [rad] as things stand
    sums: Floats  # (5, N) M₁₁, M₁₂, M₂₁, M₂₂ and D [k R, k R²]
    marks: Floats  # (4, E)
    body_marks: Floats  # (4, B)
    turn: Floats  # (M,) how far the body of each primitive has turned since the origin [rad]


@kernel(noalias=True)
def find_changes(p, q1, q2, turned, p0, q10, q20, turned0, g11, g12, g21, g22, spun):
    """G and δφ of every grain."""
    for i in range(p.shape[0]):
        spin = turned[i] - turned0[i]
        wide = p[i] + q1[i]
        high = p[i] - q1[i]
        dp = p[i] - p0[i]
        d1 = q1[i] - q10[i]
        d2 = q2[i] - q20[i]
        g11[i] = dp + d1 + spin * q2[i]
        g12[i] = d2 - spin * wide
        g21[i] = d2 + spin * high
        g22[i] = dp - d1 - spin * q2[i]
        spun[i] = spin


@kernel
def prepare_friction(begin, end, state, friction):
    """``find_changes`` of the grains from ``begin`` to ``end``; their sums are set to 0."""
    origin, change = friction.origin, friction.change
    find_changes(
        state[2, begin:end],
        state[3, begin:end],
        state[4, begin:end],
        state[5, begin:end],
        origin[0, begin:end],
        origin[1, begin:end],
        origin[2, begin:end],
        origin[3, begin:end],
        change[0, begin:end],
        change[1, begin:end],
        change[2, begin:end],
        change[3, begin:end],
        change[4, begin:end],
    )
    for row in range(5):
        friction.sums[row, begin:end] = 0.0


@kernel(noalias=True)
def finish_friction(p, q1, q2, m11, m12, m21, m22, d, fp, fq1, fq2, torque):
    """Forces of friction on shapes, added to what is there, and on spins."""
    for i in range(p.shape[0]):
        fp[i] += m11[i] + m22[i]
        fq1[i] += m11[i] - m22[i]
        fq2[i] += m12[i] + m21[i]
        wide = p[i] + q1[i]
        high = p[i] - q1[i]
        torque[i] = q2[i] * (m11[i] - m22[i]) - wide * m12[i] + high * m21[i] + d[i]


@kernel
def share_touched(deep, gap):
    """λ, for a contact that overlaps by ``deep`` and was ``gap`` open at the origin of slips [R]."""
    return (deep + TOUCHED) / (deep + gap + TOUCHED)


@kernel
def pair_slip(
    nx,
    ny,
    wx,
    wy,
    overlap,
    touched,
    slip,
    exi,
    eyi,
    g11i,
    g12i,
    g21i,
    g22i,
    spuni,
    exj,
    eyj,
    g11j,
    g12j,
    g21j,
    g22j,
    spunj,
):
    """u [R] of two grains; w = d − d⁰, ``touched`` is λ."""
    vx = g11i * exi + g12i * eyi + g11j * exj + g12j * eyj - wx
    vy = g21i * exi + g22i * eyi + g21j * exj + g22j * eyj - wy
    u = slip - ny * vx + nx * vy - 0.5 * overlap * (spuni + spunj)
    return u * touched


@kernel
def body_slip(nx, ny, overlap, h, rx, ry, ex, ey, change, i, mark, b, turn, box):
    """u [R] of grain i and a body; n from the grain to the body, r from the primitive's first point to the grain."""
    # Across the edge of a periodic cell another image is the nearest.
    wx, wy = nearest(rx - mark[2, b], ry - mark[3, b], box)
    vx = change[0, i] * ex + change[1, i] * ey + wx
    vy = change[2, i] * ex + change[3, i] * ey + wy
    u = mark[0, b] - ny * vx + nx * vy - turn * (nx * rx + ny * ry + h)
    return u * share_touched(overlap, mark[1, b])

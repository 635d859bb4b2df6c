"""How far the surfaces of two grains, or of a grain and a body, have slipped, and the force of that. MODEL.md, section 7.

For each contact, with d = x_j − x_i, the unit normal n from grain i to grain j, t = n turned left, the support function h and the
overlap Δ as they are NOW, and a zero for where things were at the origin of slips (``frictional_contacts``):

    u = λ [ξ − t·(d − d⁰) + l_i δφ_i + l_j δφ_j + t·δU_i e_i + t·δU_j e_j],    pull = k_t u, cut to ± μ C Δ

e = U n / h is the material point that touches, as a unit vector of the undeformed grain, and l = det U / h − Δ/2 its lever for a
turn φ of the material inside its outline; λ = Δ / (Δ + g⁰) lets a contact that was open at the origin begin at nothing.

All that a grain does of itself is w/h − δφ Δ/2 with w = t·δU U n + det U δφ, and as t⊗n is made of cos 2φ and sin 2φ,

    w = w0 + wc cos 2φ + ws sin 2φ,    w0 = δq2 q1 − δq1 q2 + det U δφ,  wc = δq2 p + δp q2,  ws = − δq1 p − δp q1:

three numbers a grain, whatever it touches, as s, u, v are for h. What a contact does to a shape and a spin is − pull times what
stands at their change in u. So − Σ pull sin 2φ/h and Σ pull cos 2φ/h go with the sums B and D of the normal forces, and what is
left hangs on two sums of its own, P = Σ pull/h and Q = Σ pull Δ/2.

Nothing is frozen: cap, tangent, levers and the set of contacts are functions of the state. That makes a force field, and not the
gradient of a potential; the energy that is returned is what the tangential springs store.

All is summed together with the normal forces (``frictional_pairs``, ``rigid_contacts.add_rigid_forces``).
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
    change: Floats  # (4, N) w0, wc, ws [R²] and δφ [rad] as things stand
    sums: Floats  # (2, N) P [k] and Q [k R²]
    marks: Floats  # (4, E)
    reactions: (
        Floats  # (8, E) what each entry does to its neighbour: fx, fy, A, B, D, P, Q and nothing
    )
    received: Floats  # (N, 8) their sums
    body_marks: Floats  # (4, B)
    turn: Floats  # (M,) how far the body of each primitive has turned since the origin [rad]


@kernel(noalias=True)
def find_changes(p, q1, q2, turned, p0, q10, q20, turned0, w0, wc, ws, spun, pulls, deep):
    """w and δφ of every grain; sums set to zero."""
    for i in range(p.shape[0]):
        pi = p[i]
        q1i = q1[i]
        q2i = q2[i]
        dp = pi - p0[i]
        d1 = q1i - q10[i]
        d2 = q2i - q20[i]
        spin = turned[i] - turned0[i]
        w0[i] = d2 * q1i - d1 * q2i + (pi * pi - q1i * q1i - q2i * q2i) * spin
        wc[i] = d2 * pi + dp * q2i
        ws[i] = -d1 * pi - dp * q1i
        spun[i] = spin
        pulls[i] = 0.0
        deep[i] = 0.0


@kernel
def prepare_friction(begin, end, state, friction):
    """``find_changes`` of the grains from ``begin`` to ``end``."""
    origin, change, sums = friction.origin, friction.change, friction.sums
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
        sums[0, begin:end],
        sums[1, begin:end],
    )
    received = friction.received[begin:end].reshape(-1)
    for k in range(received.shape[0]):
        received[k] = 0.0


@kernel(noalias=True)
def finish_friction(p, q1, q2, pulls, deep, fq1, fq2, torque):
    """Forces of friction on shapes, as far as they are not in B and D, and on spins."""
    for i in range(p.shape[0]):
        fq1[i] += q2[i] * pulls[i]
        fq2[i] -= q1[i] * pulls[i]
        torque[i] = deep[i] - (p[i] * p[i] - q1[i] * q1[i] - q2[i] * q2[i]) * pulls[i]


@kernel
def share_touched(deep, gap):
    """λ, for a contact that overlaps by ``deep`` and was ``gap`` open at the origin of slips [R]."""
    return deep / (deep + gap + TOUCHED)


@kernel
def own_way(w0, wc, ws, c2, s2):
    """w [R²] of a grain that touches along the angle φ; c2 and s2 are cos 2φ and sin 2φ."""
    return w0 + wc * c2 + ws * s2


@kernel
def pair_slip(across, overlap, touched, slip, own_i, own_j, spun_i, spun_j):
    """u [R] of two grains: across = t·(d − d⁰), ``touched`` is λ, own = w/h."""
    return touched * (slip - across + own_i + own_j - 0.5 * overlap * (spun_i + spun_j))


@kernel
def body_slip(nx, ny, overlap, h, rx, ry, own, mark, b, turn, box):
    """u [R] of a grain and a body; n from the grain to the body, r from the primitive's first point to the grain, own = w/h."""
    # Across the edge of a periodic cell another image is the nearest.
    wx, wy = nearest(rx - mark[2, b], ry - mark[3, b], box)
    u = mark[0, b] - ny * wx + nx * wy + own - turn * (nx * rx + ny * ry + h)
    return u * share_touched(overlap, mark[1, b])


@kernel
def cut(slip, overlap, coefficient):
    """The slip [R] that is left within the Coulomb cap, and what the cap is over k_t [R]."""
    limit = coefficient / TANGENTIAL_STIFFNESS * overlap
    return max(min(slip, limit), -limit), limit

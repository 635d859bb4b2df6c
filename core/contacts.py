"""Contacts between grains: overlap, energy and generalised forces, in a form that the compiler can vectorise.

Two grains i and j, d = x_j − x_i, r = |d|, n = d/r at angle φ, overlap Δ = h_i(n) + h_j(n) − r, energy C_ij Δ²/2 where Δ > 0.
h is the support function, h² = s + u cos 2φ + v sin 2φ with s = p² + |q|², u = 2 p q1, v = 2 p q2 computed once a grain, and
cos 2φ = (dx² − dy²)/r², sin 2φ = 2 dx dy/r²: no trigonometric call anywhere. Equations: MODEL.md, "Contacts".

Layout ("jagged diagonals"): a FULL neighbour list, slot-major. Slot t holds the t-th neighbour of grains 0 … width[t]−1, so the
inner loop runs over grains, its loads and stores of grain i are contiguous, and only grain j is gathered. Every pair is computed
twice, once from each side: that costs arithmetic, which is cheap, and saves the scatter, which is not. It also makes the sum
over a grain's contacts independent of every other grain, hence of the number of threads.

While contacts are summed, rows 2–4 of ``force`` hold A = Σ f/h, B = Σ f cos 2φ/h, D = Σ f sin 2φ/h; ``elasticity.finish`` turns
them into the forces on (p, q1, q2).
"""

from __future__ import annotations

import math

from core.jit import kernel
from core.periodic import COINCIDENT, nearest


@kernel(noalias=True)
def prepare(p, q1, q2, s, u, v, fx, fy, a, b, d):
    """Support coefficients s, u, v of every grain; forces set to zero."""
    for i in range(p.shape[0]):
        pi = p[i]
        q1i = q1[i]
        q2i = q2[i]
        s[i] = pi * pi + q1i * q1i + q2i * q2i
        u[i] = 2.0 * pi * q1i
        v[i] = 2.0 * pi * q2i
        fx[i] = 0.0
        fy[i] = 0.0
        a[i] = 0.0
        b[i] = 0.0
        d[i] = 0.0


@kernel(noalias=True)
def slot_forces(
    neighbor,
    stiffness,
    xs,
    ys,
    ss,
    us,
    vs,
    x,
    y,
    s,
    u,
    v,
    fx,
    fy,
    a,
    b,
    d,
    box,
):
    """Add the contacts of n grains in one slot; return their energy.

    ``neighbor`` uint32 (n,), ``stiffness`` C_ij (n,). xs … vs and fx … d (n,) are of these grains, x … v (N,) of all.
    Where two centres coincide the direction is undefined: the pair then has an energy but no force, and nothing becomes nan.
    """
    energy = 0.0
    for i in range(neighbor.shape[0]):
        j = neighbor[i]
        dx, dy = nearest(x[j] - xs[i], y[j] - ys[i], box)
        ui = us[i]
        vi = vs[i]
        sj = s[j]
        uj = u[j]
        vj = v[j]
        # Roots and divisions set the pace: three of the one, two of the other, as few as possible after another.
        r2 = dx * dx + dy * dy + COINCIDENT
        r = math.sqrt(r2)
        inverse2 = 1.0 / r2
        inverse = r * inverse2
        c2 = (dx * dx - dy * dy) * inverse2
        s2 = 2.0 * dx * dy * inverse2
        hi = math.sqrt(ss[i] + ui * c2 + vi * s2)
        hj = math.sqrt(sj + uj * c2 + vj * s2)
        overlap = hi + hj - r
        # Not max(0, overlap): that is 0 for nan, and nan must go on meaning nan.
        overlap = 0.0 if overlap <= 0.0 else overlap  # noqa: FURB136
        both = 1.0 / (hi * hj)
        f = stiffness[i] * overlap
        energy += 0.25 * f * overlap  # each pair is met twice
        fi = f * (hj * both)
        fj = f * (hi * both)
        turn = (fi * (vi * c2 - ui * s2) + fj * (vj * c2 - uj * s2)) * inverse2
        f *= inverse
        fx[i] -= f * dx + turn * dy
        fy[i] += turn * dx - f * dy
        a[i] += fi
        b[i] += fi * c2
        d[i] += fi * s2
    return energy


@kernel(noalias=True)
def slot_force_sum(neighbor, stiffness, x, y, s, u, v, box):
    """Sum of the normal forces [k R] of one slot, and how many contacts carry one. Vectorises, as ``slot_forces`` does."""
    total = 0.0
    contacts = 0.0
    for i in range(neighbor.shape[0]):
        j = neighbor[i]
        dx, dy = nearest(x[j] - x[i], y[j] - y[i], box)
        r2 = dx * dx + dy * dy + COINCIDENT
        c2 = (dx * dx - dy * dy) / r2
        s2 = 2.0 * dx * dy / r2
        overlap = math.sqrt(s[i] + u[i] * c2 + v[i] * s2)
        overlap += math.sqrt(s[j] + u[j] * c2 + v[j] * s2) - math.sqrt(r2)
        total += stiffness[i] * overlap if overlap > 0.0 else 0.0
        contacts += 1.0 if overlap > 0.0 else 0.0
    return total, contacts


@kernel
def add_contact_forces(begin, end, state, support, force, width, offset, neighbor, stiffness, box):
    """Add to ``force`` all contacts of the grains from ``begin`` to ``end``; return their energy [k R²]."""
    energy = 0.0
    for t in range(width.shape[0]):
        last = min(width[t], end)
        if last <= begin:
            break
        first = offset[t]
        energy += slot_forces(
            neighbor[first + begin : first + last],
            stiffness[first + begin : first + last],
            state[0, begin:last],
            state[1, begin:last],
            support[0, begin:last],
            support[1, begin:last],
            support[2, begin:last],
            state[0],
            state[1],
            support[0],
            support[1],
            support[2],
            force[0, begin:last],
            force[1, begin:last],
            force[2, begin:last],
            force[3, begin:last],
            force[4, begin:last],
            box,
        )
    return energy


@kernel
def grain_overlap(state, support, i, j, box):
    """One pair by itself: (overlap, dx, dy, c2, s2, h_i, h_j), d from i to j. Not for the inner loop."""
    dx, dy = nearest(state[0, j] - state[0, i], state[1, j] - state[1, i], box)
    r2 = dx * dx + dy * dy + COINCIDENT
    c2 = (dx * dx - dy * dy) / r2
    s2 = 2.0 * dx * dy / r2
    hi = math.sqrt(support[0, i] + support[1, i] * c2 + support[2, i] * s2)
    hj = math.sqrt(support[0, j] + support[1, j] * c2 + support[2, j] * s2)
    return hi + hj - math.sqrt(r2), dx, dy, c2, s2, hi, hj

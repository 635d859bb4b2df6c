"""Kernels of friction: how far the surfaces of every contact have slipped, and the forces that come of it. MODEL.md, section 7.

For each contact, with d = x_j − x_i, the unit normal n from grain i to grain j, t = n turned left, the support function h and the
overlap Δ as they are NOW, and a zero for where things were at the origin of slips (``frictional_contacts``):

    u = λ [ξ − t·(d − d⁰) + l_i δφ_i + l_j δφ_j + t·δU_i e_i + t·δU_j e_j],    f = k_t u, cut to ± μ C Δ

e = U n / h is the material point that touches, as a unit vector of the undeformed grain, and l = det U / h − Δ/2 its lever for a
turn φ of the material inside its outline; λ = Δ / (Δ + g⁰) lets a contact that was open at the origin begin at nothing.

Nothing is frozen: cap, tangent, levers and the set of contacts are functions of the state. That makes a force field, and not the
gradient of a potential; the energy that is returned is what the tangential springs store.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.contacts import COINCIDENT
from core.jit import kernel
from core.periodic import nearest
from core.rigid_contacts import EDGE, VERTEX, image, nearest_direction, past_end, touch

TANGENTIAL_STIFFNESS = 0.5  # k_t over C
OUTPUTS = 12
_LEAST = 1e-300  # [R] keeps Δ/(Δ + g⁰) finite where both are 0


class FrictionTerms(NamedTuple):
    """All K pairs that may touch, in the minimiser's order: first P of two grains, then those of a grain and a primitive."""

    coefficient: float  # μ
    at_i: NDArray[np.uint32]  # (K,) place of grain i
    at_j: NDArray[np.uint32]  # (P,) place of grain j
    primitive: NDArray[np.int64]  # (K − P,) as listed in ``RigidTerms``
    turn: Floats  # (M,) how far the body of each primitive has turned since the origin [rad]
    origin: Floats  # (4, N) p, q1, q2 [R] and spin [rad] at the origin of slips
    stiffness: Floats  # (K,) k_t [k]
    slip: Floats  # (K,) ξ, slip at the origin [R]
    gap: Floats  # (K,) g⁰, how far apart they were at the origin; 0 if they touched [R]
    start_x: Floats  # (K,) d⁰: to grain j, or to grain i from the primitive's first point [R]
    start_y: Floats
    touch: Floats  # (4, K − P) overlap, normal x, y and h of contacts with bodies, left there by ``add_rigid_forces``
    out: Floats  # (OUTPUTS, K) what the kernels leave, in the order of ``pair_pulls``


@kernel(noalias=True)
def pair_pulls(
    at_i,
    at_j,
    x,
    y,
    p,
    q1,
    q2,
    turned,
    p0,
    q10,
    q20,
    turned0,
    stiffness,
    slip,
    gap,
    start_x,
    start_y,
    coefficient,
    box,
    cap,
    pull,
    fx,
    fy,
    p_i,
    q1_i,
    q2_i,
    torque_i,
    p_j,
    q1_j,
    q2_j,
    torque_j,
):
    """Contacts between grains: caps μ C Δ and pulls f [k R]; force on x, y of grain i; what acts on p, q1, q2 and spin of each.

    Without a store that could alias and without a branch, so that it vectorises. Returns the energy of the springs [k R²].
    """
    energy = 0.0
    for k in range(at_i.shape[0]):
        i = at_i[k]
        j = at_j[k]
        dx, dy = nearest(x[j] - x[i], y[j] - y[i], box)
        r = math.sqrt(dx * dx + dy * dy + COINCIDENT)
        inverse = 1.0 / r
        nx = dx * inverse
        ny = dy * inverse
        pi = p[i]
        ui = q1[i]
        vi = q2[i]
        pj = p[j]
        uj = q1[j]
        vj = q2[j]
        # e = U n / h, and h = |U n|
        ix = (pi + ui) * nx + vi * ny
        iy = vi * nx + (pi - ui) * ny
        jx = (pj + uj) * nx + vj * ny
        jy = vj * nx + (pj - uj) * ny
        hi = math.sqrt(ix * ix + iy * iy)
        hj = math.sqrt(jx * jx + jy * jy)
        both = 1.0 / (hi * hj)
        inverse_hi = hj * both
        inverse_hj = hi * both
        ix *= inverse_hi
        iy *= inverse_hi
        jx *= inverse_hj
        jy *= inverse_hj
        overlap = hi + hj - r
        half = 0.5 * overlap
        deep = max(overlap, 0.0)
        lever_i = (pi * pi - ui * ui - vi * vi) * inverse_hi - half
        lever_j = (pj * pj - uj * uj - vj * vj) * inverse_hj - half
        # du/dp, du/dq1, du/dq2 = t·e, t_x e_x − t_y e_y, t_x e_y + t_y e_x with t = (−n_y, n_x)
        ai = nx * iy - ny * ix
        bi = -ny * ix - nx * iy
        ci = nx * ix - ny * iy
        aj = nx * jy - ny * jx
        bj = -ny * jx - nx * jy
        cj = nx * jx - ny * jy
        u = slip[k] + ny * (dx - start_x[k]) - nx * (dy - start_y[k])
        u += lever_i * (turned[i] - turned0[i]) + lever_j * (turned[j] - turned0[j])
        u += ai * (pi - p0[i]) + bi * (ui - q10[i]) + ci * (vi - q20[i])
        u += aj * (pj - p0[j]) + bj * (uj - q10[j]) + cj * (vj - q20[j])
        u *= (deep + _LEAST) / (deep + gap[k] + _LEAST)
        c = 2.0 * coefficient * stiffness[k] * deep
        f = max(min(stiffness[k] * u, c), -c)
        energy += 0.5 * f * f / stiffness[k]
        cap[k] = c
        pull[k] = f
        fx[k] = f * ny
        fy[k] = -f * nx
        p_i[k] = -f * ai
        q1_i[k] = -f * bi
        q2_i[k] = -f * ci
        torque_i[k] = -f * lever_i
        p_j[k] = -f * aj
        q1_j[k] = -f * bj
        q2_j[k] = -f * cj
        torque_j[k] = -f * lever_j
    return energy


@kernel
def body_pulls(state, terms, primitives, box):
    """The same of contacts with bodies, whose overlaps and normals stand in ``terms.touch``."""
    x, y, p, q1, q2, turned = state[0], state[1], state[2], state[3], state[4], state[5]
    p0, q10, q20, turned0 = terms.origin[0], terms.origin[1], terms.origin[2], terms.origin[3]
    at, primitive, turn, seen = terms.at_i, terms.primitive, terms.turn, terms.touch
    stiffness, slip, gap = terms.stiffness, terms.slip, terms.gap
    start_x, start_y = terms.start_x, terms.start_y
    out = terms.out
    pairs = terms.at_j.shape[0]
    energy = 0.0
    for b in range(primitive.shape[0]):
        k = pairs + b
        overlap, nx, ny, h = seen[0, b], -seen[1, b], -seen[2, b], seen[3, b]
        deep = max(overlap, 0.0)
        kt = stiffness[k]
        c = 2.0 * terms.coefficient * kt * deep
        if c == 0.0:
            for row in range(8):
                out[row, k] = 0.0
            continue
        i = at[k]
        m = primitive[b]
        xi, yi = image(primitives, m, x[i], y[i], box)
        rx = xi - primitives[m, 1]
        ry = yi - primitives[m, 2]
        # Across the edge of a periodic cell another image is the nearest.
        wx, wy = nearest(rx - start_x[k], ry - start_y[k], box)
        ex = ((p[i] + q1[i]) * nx + q2[i] * ny) / h
        ey = (q2[i] * nx + (p[i] - q1[i]) * ny) / h
        lever = (p[i] * p[i] - q1[i] * q1[i] - q2[i] * q2[i]) / h
        a = nx * ey - ny * ex
        d = -ny * ex - nx * ey
        e = nx * ex - ny * ey
        u = slip[k] - ny * wx + nx * wy - turn[m] * (nx * rx + ny * ry + h)
        u += lever * (turned[i] - turned0[i])
        u += a * (p[i] - p0[i]) + d * (q1[i] - q10[i]) + e * (q2[i] - q20[i])
        u *= (deep + _LEAST) / (deep + gap[k] + _LEAST)
        f = max(min(kt * u, c), -c)
        energy += 0.5 * f * f / kt
        out[0, k] = c
        out[1, k] = f
        out[2, k] = f * ny
        out[3, k] = -f * nx
        out[4, k] = -f * a
        out[5, k] = -f * d
        out[6, k] = -f * e
        out[7, k] = -f * lever
    return energy


@kernel
def pulls(state, terms, rigid, box):
    """``pair_pulls`` and ``body_pulls``; returns their energy [k R²]."""
    n = terms.at_j.shape[0]
    origin, out = terms.origin, terms.out
    energy = pair_pulls(
        terms.at_i[:n],
        terms.at_j,
        state[0],
        state[1],
        state[2],
        state[3],
        state[4],
        state[5],
        origin[0],
        origin[1],
        origin[2],
        origin[3],
        terms.stiffness[:n],
        terms.slip[:n],
        terms.gap[:n],
        terms.start_x[:n],
        terms.start_y[:n],
        terms.coefficient,
        box,
        out[0, :n],
        out[1, :n],
        out[2, :n],
        out[3, :n],
        out[4, :n],
        out[5, :n],
        out[6, :n],
        out[7, :n],
        out[8, :n],
        out[9, :n],
        out[10, :n],
        out[11, :n],
    )
    if rigid is not None:
        energy += body_pulls(state, terms, rigid.primitives, box)
    return energy


@kernel
def add_friction_forces(state, force, terms, rigid, box):
    """Add forces to all rows of ``force`` (6, N), which holds forces already and no contact sums. Returns the energy [k R²].

    Forces first, without a store that could alias, then the scatter: several times as fast as both in one loop.
    """
    energy = pulls(state, terms, rigid, box)
    at_i, at_j, out = terms.at_i, terms.at_j, terms.out
    fx, fy, fp, f1, f2, torque = force[0], force[1], force[2], force[3], force[4], force[5]
    along_x, along_y = out[2], out[3]
    p_i, q1_i, q2_i, torque_i = out[4], out[5], out[6], out[7]
    p_j, q1_j, q2_j, torque_j = out[8], out[9], out[10], out[11]
    for k in range(at_i.shape[0]):
        i = at_i[k]
        fx[i] += along_x[k]
        fy[i] += along_y[k]
        fp[i] += p_i[k]
        f1[i] += q1_i[k]
        f2[i] += q2_i[k]
        torque[i] += torque_i[k]
    for k in range(at_j.shape[0]):
        j = at_j[k]
        fx[j] -= along_x[k]
        fy[j] -= along_y[k]
        fp[j] += p_j[k]
        f1[j] += q1_j[k]
        f2[j] += q2_j[k]
        torque[j] += torque_j[k]
    return energy


@kernel
def look_at_bodies(state, terms, rigid, box):
    """Fill ``terms.touch`` by itself, where no forces have been computed."""
    primitives, seen = rigid.primitives, terms.touch
    pairs = terms.at_j.shape[0]
    for b in range(terms.primitive.shape[0]):
        i = terms.at_i[pairs + b]
        m = terms.primitive[b]
        x, y = image(primitives, m, state[0, i], state[1, i], box)
        p, q1, q2 = state[2, i], state[3, i], state[4, i]
        s = p * p + q1 * q1 + q2 * q2
        overlap, nx, ny, h, _ = touch(primitives, m, x, y, s, 2.0 * p * q1, 2.0 * p * q2)
        seen[0, b] = overlap
        seen[1, b] = nx
        seen[2, b] = ny
        seen[3, b] = h


@kernel
def outline_gap(primitives, m, x, y, s, u, v):
    """Distance [R] from the outline of a grain to a primitive, also beyond the ends of an edge; negative where they overlap.

    Also (nx, ny), from the grain to the primitive, and h along it.
    """
    px = primitives[m, 1]
    py = primitives[m, 2]
    kind = primitives[m, 0]
    dx = x - px
    dy = y - py
    corner = kind == VERTEX
    if kind == EDGE:
        ux = primitives[m, 3]
        uy = primitives[m, 4]
        if past_end(s, u, v, dx, dy, -ux, -uy) > 0.0:
            corner = True
        elif past_end(s, u, v, x - primitives[m, 5], y - primitives[m, 6], ux, uy) > 0.0:
            corner = True
            dx = x - primitives[m, 5]
            dy = y - primitives[m, 6]
        else:
            side = 1.0 if ux * dy - uy * dx >= 0.0 else -1.0
            nx = -side * uy
            ny = side * ux
    if corner:
        nx, ny = nearest_direction(s, u, v, dx, dy)
    elif kind != EDGE:
        r = math.sqrt(dx * dx + dy * dy + COINCIDENT)
        nx = dx / r
        ny = dy / r
    h = math.sqrt(s + u * (nx * nx - ny * ny) + v * 2.0 * nx * ny)
    return nx * dx + ny * dy - h - primitives[m, 7], -nx, -ny, h


@kernel
def measure(at_i, at_j, primitive, state, primitives, box, values):
    """Fill rows gap, d_x, d_y, n_x, n_y, h_i of ``values`` (6, K) for all pairs as they stand; d as ``start_x`` is."""
    x, y, p, q1, q2 = state[0], state[1], state[2], state[3], state[4]
    pairs = at_j.shape[0]
    for k in range(at_i.shape[0]):
        i = at_i[k]
        s = p[i] * p[i] + q1[i] * q1[i] + q2[i] * q2[i]
        u = 2.0 * p[i] * q1[i]
        v = 2.0 * p[i] * q2[i]
        if k < pairs:
            j = at_j[k]
            dx, dy = nearest(x[j] - x[i], y[j] - y[i], box)
            r = math.sqrt(dx * dx + dy * dy + COINCIDENT)
            nx = dx / r
            ny = dy / r
            c2 = nx * nx - ny * ny
            s2 = 2.0 * nx * ny
            h = math.sqrt(s + u * c2 + v * s2)
            s = p[j] * p[j] + q1[j] * q1[j] + q2[j] * q2[j]
            gap = r - h - math.sqrt(s + 2.0 * p[j] * (q1[j] * c2 + q2[j] * s2))
        else:
            m = primitive[k - pairs]
            dx, dy = image(primitives, m, x[i], y[i], box)
            gap, nx, ny, h = outline_gap(primitives, m, dx, dy, s, u, v)
            dx -= primitives[m, 1]
            dy -= primitives[m, 2]
        values[0, k] = gap
        values[1, k] = dx
        values[2, k] = dy
        values[3, k] = nx
        values[4, k] = ny
        values[5, k] = h

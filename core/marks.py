"""What is done with frictional contacts once a list, and not in every evaluation: measure them, and lay out their marks.

K pairs, each once: first P of two grains, as long as ``at_j`` is, then those of a grain and a primitive.
"""

from __future__ import annotations

import math

from core.jit import kernel
from core.periodic import COINCIDENT, nearest
from core.rigid_contacts import EDGE, VERTEX, image, nearest_direction, past_end, touch
from core.slip import (
    TANGENTIAL_STIFFNESS,
    body_slip,
    cut,
    own_way,
    pair_slip,
    share_touched,
)


@kernel
def outline_gap(primitives, m, x, y, s, u, v):
    """(distance [R] from the outline of a grain to a primitive, n to the primitive, h); beyond an edge's end to that end.

    Negative where they overlap.
    """
    kind = primitives[m, 0]
    dx = x - primitives[m, 1]
    dy = y - primitives[m, 2]
    nx = 1.0
    ny = 0.0
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
    elif not corner:
        r = math.sqrt(dx * dx + dy * dy + COINCIDENT)
        nx = dx / r
        ny = dy / r
    if corner:
        nx, ny = nearest_direction(s, u, v, dx, dy)
    h = math.sqrt(s + u * (nx * nx - ny * ny) + v * 2.0 * nx * ny)
    return nx * dx + ny * dy - h - primitives[m, 7], -nx, -ny, h


@kernel
def measure(at_i, at_j, primitive, state, primitives, box, values):
    """Fill rows gap, d_x, d_y, n_x, n_y, h_i, h_j of ``values`` (7, K) for all pairs as they stand; d as in a mark."""
    x, y, p, q1, q2 = state[0], state[1], state[2], state[3], state[4]
    pairs = at_j.shape[0]
    for k in range(at_i.shape[0]):
        i = at_i[k]
        s = p[i] * p[i] + q1[i] * q1[i] + q2[i] * q2[i]
        u = 2.0 * p[i] * q1[i]
        v = 2.0 * p[i] * q2[i]
        other = 0.0
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
            other = math.sqrt(s + 2.0 * p[j] * (q1[j] * c2 + q2[j] * s2))
            gap = r - h - other
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
        values[6, k] = other


@kernel
def slips(at_i, at_j, primitive, marks, state, friction, primitives, box, place, held):
    """Slips within their caps, and the caps over k_t, into ``held`` (2, K) [R]; both 0 where nothing touches.

    ``marks`` (4, K), and ``place`` (7, K) as ``measure`` fills it; ``friction.change`` must be that of the state.
    """
    change, turn = friction.change, friction.turn
    p, q1, q2 = state[2], state[3], state[4]
    pairs = at_j.shape[0]
    for k in range(at_i.shape[0]):
        held[0, k] = 0.0
        held[1, k] = 0.0
        i = at_i[k]
        if k < pairs:
            overlap = -place[0, k]
            if overlap <= 0.0:
                continue
            j = at_j[k]
            nx, ny, hi, hj = place[3, k], place[4, k], place[5, k], place[6, k]
            c2 = nx * nx - ny * ny
            s2 = 2.0 * nx * ny
            u = pair_slip(
                nx * (place[2, k] - marks[3, k]) - ny * (place[1, k] - marks[2, k]),
                overlap,
                share_touched(overlap, marks[1, k]),
                marks[0, k],
                own_way(change[0, i], change[1, i], change[2, i], c2, s2) / hi,
                own_way(change[0, j], change[1, j], change[2, j], c2, s2) / hj,
                change[3, i],
                change[3, j],
            )
        else:
            m = primitive[k - pairs]
            x, y = image(primitives, m, state[0, i], state[1, i], box)
            s = p[i] * p[i] + q1[i] * q1[i] + q2[i] * q2[i]
            overlap, nx, ny, h, _ = touch(
                primitives, m, x, y, s, 2.0 * p[i] * q1[i], 2.0 * p[i] * q2[i]
            )
            if overlap <= 0.0:
                continue
            c2 = nx * nx - ny * ny
            s2 = 2.0 * nx * ny
            u = body_slip(
                -nx,
                -ny,
                overlap,
                h,
                x - primitives[m, 1],
                y - primitives[m, 2],
                own_way(change[0, i], change[1, i], change[2, i], c2, s2) / h,
                marks,
                k,
                turn[m],
                box,
            )
        held[0, k], held[1, k] = cut(u, overlap, friction.coefficient)


@kernel
def lay_out(lists, at_i, at_j, marks, filled, slots):
    """Put the marks (4, P) of each pair of grains where its entry stands in the slots (4, E)."""
    offset = lists.offset
    for i in range(filled.shape[0]):
        filled[i] = 0
    for k in range(at_j.shape[0]):
        i = at_i[k]
        at = offset[filled[i]] + i
        filled[i] += 1
        for row in range(4):
            slots[row, at] = marks[row, k]


@kernel(fastmath=False)
def tangential_forces(
    at_i, at_j, primitive, state, stiffness, identity, primitives, place, held, who, values, sliding
):
    """Forces of the pairs that touch, packed to the front; returns their number.

    ``who`` (3, K): grain, other grain or -1, primitive or -1, in the packing's order; ``values`` (6, K): force on the grain x, y
    [k R], where it acts x, y, and the branch vector x, y [R]; ``sliding`` (K,): at the Coulomb cap. ``place`` and ``held`` as
    ``measure`` and ``slips`` fill them. Without fast math: the same bits wherever it is compiled.
    """
    pairs = at_j.shape[0]
    used = 0
    for k in range(at_i.shape[0]):
        slip, limit = held[0, k], held[1, k]
        if not limit > 0.0:
            continue
        i = at_i[k]
        nx, ny, h = place[3, k], place[4, k], place[5, k]
        c = stiffness[i]
        who[0, used] = identity[i]
        if k < pairs:
            j = at_j[k]
            c = 2.0 * c * stiffness[j] / (c + stiffness[j])
            who[1, used] = identity[j]
            who[2, used] = -1
            x, y = state[0, i], state[1, i]
            reach = h + 0.5 * place[0, k]  # half way between the outlines
            values[4, used] = place[1, k]
            values[5, used] = place[2, k]
        else:
            m = primitive[k - pairs]
            who[1, used] = -1
            who[2, used] = m
            x, y = primitives[m, 1] + place[1, k], primitives[m, 2] + place[2, k]
            reach = h
            values[4, used] = h * nx
            values[5, used] = h * ny
        pull = TANGENTIAL_STIFFNESS * c * slip
        values[0, used] = pull * ny
        values[1, used] = -pull * nx
        values[2, used] = x + reach * nx
        values[3, used] = y + reach * ny
        sliding[used] = abs(slip) >= limit
        used += 1
    return used


@kernel
def count_beyond(
    coefficient, who, fx, fy, i, j, pressed, grain, primitive, borne, first, following
):
    """How many of the contacts ``who`` (3, K), with forces fx, fy (K,) [k R], pull harder than μ times their normal force.

    That is ``pressed`` between grains i and j (P,), ``borne`` between grain and primitive (B,) [k R], each pair once; 0 where it
    is not among them. ``first`` (2 N,) and ``following`` (P + B,) are room for chains of the contacts of each grain.
    """
    pairs, grains = i.shape[0], first.shape[0] // 2
    for n in range(first.shape[0]):
        first[n] = -1
    for k in range(pairs + grain.shape[0]):
        n = min(i[k], j[k]) if k < pairs else grains + grain[k - pairs]
        following[k] = first[n]
        first[n] = k
    beyond = 0
    for c in range(fx.shape[0]):
        normal = 0.0
        if who[1, c] >= 0:
            low, high = min(who[0, c], who[1, c]), max(who[0, c], who[1, c])
            k = first[low]
            while k >= 0 and max(i[k], j[k]) != high:
                k = following[k]
            if k >= 0:
                normal = pressed[k]
        else:
            k = first[grains + who[0, c]]
            while k >= 0 and primitive[k - pairs] != who[2, c]:
                k = following[k]
            if k >= 0:
                normal = borne[k - pairs]
        if math.sqrt(fx[c] * fx[c] + fy[c] * fy[c]) > coefficient * normal:
            beyond += 1
    return beyond

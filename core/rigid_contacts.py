"""Contacts between grains and rigid bodies, which are made of edges, vertices and discs.

A primitive is one row of ``primitives`` float64 (M, 8): kind, x0, y0, ux, uy, then x1, y1 (edge) or wx, wy (vertex), and radius:

- EDGE: from (x0, y0) along the unit vector u to (x1, y1), thickened by ``radius``. n is the normal on the grain's side,
  Δ = h(n) + radius − distance: exact for an ellipse against a plane. Active while the point of contact, which for a tilted
  ellipse is not the foot of the perpendicular, lies on the edge.
- VERTEX: the point (x0, y0), thickened by ``radius``. Δ = min over n of h(n) + radius − n·d, which is the exact contact of an
  ellipse with a point or a disc. u and w point along the adjoining edges towards the vertex (w = 0: only one); it is
  active only where the contact has left those edges, so exactly one of edge and vertex acts and the force is continuous
  when a grain slides around a corner. (With the centre line
  in place of the minimum the tangential force jumps there by f h'/r: see MODEL.md.)
- DISC: as another grain that cannot deform: n along the line of centres.

A contact with a rigid body has the stiffness C of its grain.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.jit import kernel, shared
from core.slip import TANGENTIAL_STIFFNESS, body_slip, cut, own_way

EDGE, VERTEX, DISC = 0, 1, 2
COLUMNS = 8
NEWTON_STEPS = 12


class RigidTerms(NamedTuple):
    """What the kernels know of the rigid bodies during one relaxation, and the list of near (grain, primitive) pairs."""

    primitives: NDArray[np.float64]  # (M, 8)
    grain: NDArray[np.int64]  # (capacity,)
    primitive: NDArray[np.int64]  # (capacity,)
    used: NDArray[np.int64]  # (1,) length of the list


@shared
def allocate(primitives: NDArray[np.float64], grains: int) -> RigidTerms:
    """Terms for ``grains`` grains near ``primitives`` (M, 8)."""
    return _with_room(primitives, 64 + 2 * grains)


@shared
def doubled(rigid: RigidTerms) -> RigidTerms:
    """The same with room for twice as many pairs, none of which is listed."""
    return _with_room(rigid.primitives, 2 * rigid.grain.shape[0])


@shared
def _with_room(primitives: NDArray[np.float64], pairs: int) -> RigidTerms:
    return RigidTerms(
        primitives, np.zeros(pairs, np.int64), np.zeros(pairs, np.int64), np.zeros(1, np.int64)
    )


@kernel
def support(s, u, v, nx, ny):
    """h and dh/dφ of a grain with coefficients s, u, v along the unit vector n."""
    c2 = nx * nx - ny * ny
    s2 = 2.0 * nx * ny
    h = math.sqrt(s + u * c2 + v * s2)
    return h, (v * c2 - u * s2) / h


@kernel(fastmath=False)
def beyond(s, u, v, dx, dy, ux, uy):
    """How far the contact point of a grain at d from the end of an edge lies beyond that end; u points along the edge to it. [R]

    Edge and vertex decide by this one expression, so that never both or neither of them acts. That needs the same rounding
    in both places, hence no fast math: the compiler would be free to fuse or reorder each copy in its own way.
    """
    side = 1.0 if ux * dy - uy * dx >= 0.0 else -1.0
    nx = -side * uy
    ny = side * ux
    c2 = nx * nx - ny * ny
    s2 = 2.0 * nx * ny
    slope = (v * c2 - u * s2) / math.sqrt(s + u * c2 + v * s2)
    return dx * ux + dy * uy + side * slope


@kernel
def far_inside(along, s, u, v):
    """True only if a grain whose centre is ``along`` [R] inside the end of an edge cannot have its contact beyond it.

    The contact lies no further from the centre than the longer semi-axis, whose square s + √(u² + v²) is no more than
    s + |u| + |v|: no root and no division for the many grains that no end concerns.
    """
    return along > 0.0 and along * along > s + abs(u) + abs(v)


@kernel
def past_end(s, u, v, dx, dy, ux, uy):
    """What edge and vertex ask: the sign of ``beyond`` (nan where that is nan), for less where the end is far."""
    return -1.0 if far_inside(-dx * ux - dy * uy, s, u, v) else beyond(s, u, v, dx, dy, ux, uy)


@kernel
def nearest_direction(s, u, v, dx, dy):
    """Unit vector n that minimises h(n) − n·d, by Newton from the centre line. Returns (nx, ny)."""
    r = math.sqrt(dx * dx + dy * dy)
    if r == 0.0:
        return 1.0, 0.0
    nx = dx / r
    ny = dy / r
    for _ in range(NEWTON_STEPS):
        c2 = nx * nx - ny * ny
        s2 = 2.0 * nx * ny
        h2 = s + u * c2 + v * s2
        h = math.sqrt(h2)
        slope = (v * c2 - u * s2) / h
        curvature = (-2.0 * (u * c2 + v * s2) - slope * slope) / h
        gradient = slope - (dy * nx - dx * ny)
        second = curvature + dx * nx + dy * ny
        # Deep inside an eccentric grain the expression is not convex; a step bounded downhill still finds its way.
        turn = -gradient / max(abs(second), 0.1 * h)
        turn = min(max(turn, -0.5), 0.5)
        # Half-angle form of a rotation: no trigonometry, and n stays a unit vector.
        half = 0.5 * turn
        scale = 1.0 / (1.0 + half * half)
        cosine = (1.0 - half * half) * scale
        sine = 2.0 * half * scale
        nx, ny = cosine * nx - sine * ny, cosine * ny + sine * nx
        if abs(turn) < 1e-9:
            break
    return nx, ny


@kernel
def touch(primitives, m, x, y, s, u, v):
    """Contact of one grain with primitive m: (overlap, nx, ny, h, slope), overlap < 0 where they do not touch.

    n points from the body to the grain. ``slope`` is dh/dφ for a disc, whose n turns as the grain moves, and 0 otherwise.
    """
    kind = primitives[m, 0]
    dx = x - primitives[m, 1]
    dy = y - primitives[m, 2]
    radius = primitives[m, 7]
    if kind == EDGE:
        ux = primitives[m, 3]
        uy = primitives[m, 4]
        distance = ux * dy - uy * dx
        side = 1.0 if distance >= 0.0 else -1.0
        nx = -side * uy
        ny = side * ux
        h, _ = support(s, u, v, nx, ny)
        overlap = h + radius - side * distance
        if overlap <= 0.0:
            return -1.0, 0.0, 0.0, 1.0, 0.0
        if past_end(s, u, v, dx, dy, -ux, -uy) > 0.0:
            return -1.0, 0.0, 0.0, 1.0, 0.0
        if past_end(s, u, v, x - primitives[m, 5], y - primitives[m, 6], ux, uy) > 0.0:
            return -1.0, 0.0, 0.0, 1.0, 0.0
        return overlap, nx, ny, h, 0.0
    if kind == DISC:
        r = math.sqrt(dx * dx + dy * dy)
        if r == 0.0:  # any direction is as good as any other
            h, _ = support(s, u, v, 1.0, 0.0)
            return h + radius, 1.0, 0.0, h, 0.0
        nx = dx / r
        ny = dy / r
        h, slope = support(s, u, v, nx, ny)
        return h + radius - r, nx, ny, h, slope / r
    if past_end(s, u, v, dx, dy, primitives[m, 3], primitives[m, 4]) <= 0.0:
        return -1.0, 0.0, 0.0, 1.0, 0.0
    wx = primitives[m, 5]
    wy = primitives[m, 6]
    if (wx != 0.0 or wy != 0.0) and past_end(s, u, v, dx, dy, wx, wy) <= 0.0:
        return -1.0, 0.0, 0.0, 1.0, 0.0
    nx, ny = nearest_direction(s, u, v, dx, dy)
    h, _ = support(s, u, v, nx, ny)
    return h + radius - nx * dx - ny * dy, nx, ny, h, 0.0


@kernel
def image(primitives, m, x, y, box):
    """The periodic image of a grain at (x, y) that is nearest to primitive m (for an edge: to its middle) [R].

    Of walls that run around the cell ``endless`` makes what lies beside that image.
    """
    if box is None:
        return x, y
    x0 = primitives[m, 1]
    y0 = primitives[m, 2]
    if primitives[m, 0] == EDGE:
        x0 = 0.5 * (x0 + primitives[m, 5])
        y0 = 0.5 * (y0 + primitives[m, 6])
    rows = np.rint((y - y0) * box[3])
    x -= rows * box[4]
    return x - box[0] * np.rint((x - x0) * box[1]), y - rows * box[2]


@kernel
def find_rigid_pairs(state, rigid, reach, box):
    """List the grains that may touch a primitive before they have moved or grown by ``reach`` [R]. Returns False if too many."""
    primitives, grain, primitive = rigid.primitives, rigid.grain, rigid.primitive
    x, y, p, q1, q2 = state[0], state[1], state[2], state[3], state[4]
    used = 0
    capacity = grain.shape[0]
    widest = 0.0
    for i in range(state.shape[1]):
        widest = max(widest, p[i] + math.sqrt(q1[i] ** 2 + q2[i] ** 2))
    for m in range(primitives.shape[0]):
        kind = primitives[m, 0]
        x0 = primitives[m, 1]
        y0 = primitives[m, 2]
        ux = primitives[m, 3]
        uy = primitives[m, 4]
        length = 0.0
        if kind == EDGE:
            length = (primitives[m, 5] - x0) * ux + (primitives[m, 6] - y0) * uy
        # Nearly all are further away than any could reach, and need no root.
        far = 1.001 * (widest + primitives[m, 7] + reach)
        for i in range(state.shape[1]):
            dx, dy = image(primitives, m, x[i], y[i], box)
            dx -= x0
            dy -= y0
            if kind == EDGE:
                along = min(max(dx * ux + dy * uy, 0.0), length)
                dx -= along * ux
                dy -= along * uy
            square = dx * dx + dy * dy
            if square > far * far:
                continue
            extent = p[i] + math.sqrt(q1[i] ** 2 + q2[i] ** 2) + primitives[m, 7] + reach
            if square < extent * extent:
                if used == capacity:
                    return False
                grain[used] = i
                primitive[used] = m
                used += 1
    rigid.used[0] = used
    return True


@kernel(allocates=True)
def changed_sides(before, after, rigid, box):
    """True for the listed pairs of which the grain, on the straight way from before to after, has crossed an edge.

    ``before`` and ``after`` (5 or 6, N), nearer together than the list's reach: over so little any way is straight.
    """
    primitives, grain, primitive = rigid.primitives, rigid.grain, rigid.primitive
    used = rigid.used[0]
    changed = np.zeros(used, dtype=np.bool_)
    for k in range(used):
        i, m = grain[k], primitive[k]
        if primitives[m, 0] != EDGE:
            continue
        ux, uy = primitives[m, 3], primitives[m, 4]
        x0, y0 = primitives[m, 1], primitives[m, 2]
        length = (primitives[m, 5] - x0) * ux + (primitives[m, 6] - y0) * uy
        x, y = image(primitives, m, before[0, i], before[1, i], box)
        dx, dy = x - x0, y - y0
        later_x = dx + after[0, i] - before[0, i]
        later_y = dy + after[1, i] - before[1, i]
        along = dx * ux + dy * uy
        later = later_x * ux + later_y * uy
        then, now = ux * dy - uy * dx, ux * later_y - uy * later_x
        if (then >= 0.0) != (now >= 0.0):
            crossing = along + (later - along) * then / (then - now)
            changed[k] = crossing >= 0.0 and crossing <= length
    return changed


@kernel
def add_rigid_forces(state, support_coefficients, contact_stiffness, force, rigid, box, friction):
    """Add all grain–rigid contacts to ``force`` (rows 2–4: contact sums, see ``contacts``). Returns their energy [k R²].

    ``friction`` is None where there is none, and no code for it exists then.
    """
    # Every array is fetched once: inside the loop each look into the tuple would cost two atomic reference counts.
    primitives, grain, primitive = rigid.primitives, rigid.grain, rigid.primitive
    x, y = state[0], state[1]
    s, u, v = support_coefficients[0], support_coefficients[1], support_coefficients[2]
    fx, fy, a, b, d = force[0], force[1], force[2], force[3], force[4]
    if friction is not None:
        coefficient, turn = friction.coefficient, friction.turn
        change, sums, marks = friction.change, friction.sums, friction.body_marks
    energy = 0.0
    for k in range(rigid.used[0]):
        i = grain[k]
        m = primitive[k]
        xi, yi = image(primitives, m, x[i], y[i], box)
        overlap, nx, ny, h, slope = touch(primitives, m, xi, yi, s[i], u[i], v[i])
        if overlap <= 0.0:  # written so that nan passes, and is found
            continue
        f = contact_stiffness[i] * overlap
        energy += 0.5 * f * overlap
        fx[i] += f * (nx + slope * ny)
        fy[i] += f * (ny - slope * nx)
        g = f / h
        a[i] += g
        b[i] += g * (nx * nx - ny * ny)
        d[i] += g * 2.0 * nx * ny
        if friction is not None:
            c2 = nx * nx - ny * ny
            s2 = 2.0 * nx * ny
            slip = body_slip(
                -nx,
                -ny,
                overlap,
                h,
                xi - primitives[m, 1],
                yi - primitives[m, 2],
                own_way(change[0, i], change[1, i], change[2, i], c2, s2) / h,
                marks,
                k,
                turn[m],
                box,
            )
            slip, _ = cut(slip, overlap, coefficient)
            pull = TANGENTIAL_STIFFNESS * contact_stiffness[i] * slip
            energy += 0.5 * pull * slip
            fx[i] -= pull * ny  # along − t
            fy[i] += pull * nx
            g = pull / h
            b[i] -= g * s2
            d[i] += g * c2
            sums[0, i] += g
    return energy

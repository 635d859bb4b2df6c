"""How much room there is between grains and bodies, and which line a hand has drawn: geometry for the making of things."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.arrays import Floats
from core.endless import endless
from core.generate import inside
from core.packing import Packing, PeriodicBox
from core.rigid import Point
from core.rigid_contacts import EDGE
from scenes.scene import Setup

NEAR = 4.0  # of the largest grain's reach: what is further away takes no room


def images(dx: Floats, dy: Floats, box: PeriodicBox | None) -> tuple[Floats, Floats]:
    """Distances [R] to the nearest images in the periodic cell."""
    if box is None:
        return dx, dy
    width, inverse_width, height, inverse_height, shift = box.kernel_form()
    turns = np.rint(dy * inverse_height)
    dx = dx - turns * shift
    return dx - width * np.rint(dx * inverse_width), dy - turns * height


def within(packing: Packing, at: Point, radius: float) -> NDArray[np.bool_]:
    """Grains whose centre is within ``radius`` [R] of a point, and the one that covers the point, (N,)."""
    dx, dy = images(at[0] - packing.x, at[1] - packing.y, packing.box)
    distance = np.hypot(dx, dy)
    return (distance <= radius) | (distance <= _reach(packing, dx, dy, distance))


def room(setup: Setup, points: Floats) -> Floats:
    """Radius of the largest circle about each of ``points`` (n, 2) that touches no grain and no body, (n,) [R].

    Negative where the point lies in a grain or body, −inf outside the scene.
    """
    free = np.minimum(from_grains(setup.packing, points), from_bodies(setup, points))
    x, y = points.T
    box = setup.packing.box
    if box is not None:
        x, y = folded(points, box)
    return np.where(inside(setup.outline, x, y), free, -np.inf)


def from_grains(packing: Packing, points: Floats) -> Floats:
    """How far each of ``points`` (n, 2) is from the nearest grain (n,) [R]; inf where there is none near."""
    if not len(packing):
        return np.full(len(points), np.inf)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    spread = 0.5 * float(np.ptp(points, axis=0).max()) + NEAR * float(packing.semi_axes[0].max())
    dx, dy = images(middle[0] - packing.x, middle[1] - packing.y, packing.box)
    near = packing.select((np.abs(dx) < spread) & (np.abs(dy) < spread))
    dx, dy = images(
        points[:, :1] - near.x[np.newaxis], points[:, 1:] - near.y[np.newaxis], packing.box
    )
    distance = np.hypot(dx, dy)
    free: Floats = np.min(distance - _reach(near, dx, dy, distance), axis=1, initial=np.inf)
    return free


def from_bodies(setup: Setup, points: Floats) -> Floats:
    """How far each of ``points`` (n, 2) is from the nearest body (n,) [R], negative inside; inf where there is no body."""
    x, y = points.T
    free = np.full(len(points), np.inf)
    for row in endless(setup.world.primitives()[0], setup.packing.box):
        middle = 0.5 * (row[1:3] + row[5:7]) if row[0] == EDGE else row[1:3]
        dx, dy = images(x - middle[0], y - middle[1], setup.packing.box)
        if row[0] == EDGE:
            length = (row[5] - row[1]) * row[3] + (row[6] - row[2]) * row[4]
            along = np.clip(dx * row[3] + dy * row[4], -0.5 * length, 0.5 * length)
            dx, dy = dx - along * row[3], dy - along * row[4]
        free = np.minimum(free, np.hypot(dx, dy) - row[7])
    for body in setup.world.bodies:
        for corners, _ in body.polygons:
            hidden = inside([(cx, cy) for cx, cy in body.to_world(corners)], x, y)
            free = np.where(hidden, -np.abs(free), free)
    return free


def folded(points: Floats, box: PeriodicBox) -> tuple[Floats, Floats]:
    """Points (n, 2) folded into the periodic cell [R], as ``Packing.folded`` does it."""
    return Packing(points[:, 0], points[:, 1], box=box).folded()


def from_line(x: Floats, y: Floats, line: Sequence[Point]) -> tuple[Floats, Floats, Floats]:
    """Distance (n,) [R] of points to a chain of straight pieces, and the unit vector (nx, ny) from there, (n,) each.

    On the line itself it points to the left of the way along it.
    """
    best = np.full(len(x), np.inf)
    nx, ny = np.zeros(len(x)), np.ones(len(x))
    corners = np.asarray(line, dtype=np.float64)
    for (x0, y0), (x1, y1) in pairwise(corners):
        ux, uy = x1 - x0, y1 - y0
        length = float(np.hypot(ux, uy))
        ux, uy = ux / length, uy / length
        along = np.clip((x - x0) * ux + (y - y0) * uy, 0.0, length)
        dx, dy = x - x0 - along * ux, y - y0 - along * uy
        distance = np.hypot(dx, dy)
        apart = distance > 1e-9
        size = np.where(apart, distance, 1.0)
        nearer = distance < best
        nx = np.where(nearer, np.where(apart, dx / size, -uy), nx)
        ny = np.where(nearer, np.where(apart, dy / size, ux), ny)
        best = np.minimum(best, distance)
    return best, nx, ny


def simplified(points: Sequence[Point], tolerance: float) -> list[Point]:
    """The corners that a hand-drawn line needs so that none of its points is further off than ``tolerance`` [R].

    Douglas and Peucker, doi:10.3138/FM57-6770-U75U-7727. Both ends stay.
    """
    path = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    keep = np.zeros(len(path), dtype=bool)
    keep[[0, -1]] = True
    pieces = [(0, len(path) - 1)]
    while pieces:
        first, last = pieces.pop()
        if last - first < 2:
            continue
        off = _off(path[first + 1 : last], path[first], path[last])
        worst = int(np.argmax(off))
        if off[worst] > tolerance:
            corner = first + 1 + worst
            keep[corner] = True
            pieces += [(first, corner), (corner, last)]
    return [(float(x), float(y)) for x, y in path[keep]]


def _off(points: Floats, start: Floats, end: Floats) -> Floats:
    """Distance of ``points`` (n, 2) from the straight piece between two others (n,) [R]."""
    way = end - start
    square = float(way @ way)
    along = np.clip((points - start) @ way / square, 0.0, 1.0) if square > 0.0 else 0.0
    rest = points - start - np.multiply.outer(along, way)
    return np.hypot(rest[:, 0], rest[:, 1])


def _reach(packing: Packing, dx: Floats, dy: Floats, distance: Floats) -> Floats:
    """How far grains reach from their centre along (dx, dy) [R]; the last axis is that of the grains."""
    s, u, v = observables.support_coefficients(packing.state)
    square = np.maximum(distance * distance, 1e-290)
    c2, s2 = (dx * dx - dy * dy) / square, 2.0 * dx * dy / square
    reach: Floats = np.sqrt(np.maximum(s + u * c2 + v * s2, 0.0))
    return reach

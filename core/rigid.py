"""Rigid bodies: walls, pistons, intruders.

What slides goes exactly as far as it is told; what a hand drags anywhere is moved by pymunk (``spaces``), among the rest. The
grains see the same shapes as primitives (``rigid_contacts``) and answer with a reaction on each body.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from operator import is_
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.errors import InputError
from core.rigid_contacts import COLUMNS, DISC, EDGE, VERTEX

Point = tuple[float, float]
Role = Literal["wall", "piston", "intruder", "body"]

CLEAR = 1.0  # [R] what is further away is not touched in one increment
SAME_POINT = 1e-9  # [R] what is closer than this is at the same place
SAME_DIRECTION = 1e-12  # [rad] what turns by less goes straight on: that is rounding


@dataclass
class RigidBody:
    """One body. Shapes are in the body's own frame [R]; ``position`` [R] and ``angle`` [rad] place them.

    role: wall, piston, intruder or body. Static unless ``held`` (a hand can drag it anywhere) or ``axis`` (unit vector:
    it slides along that line, and ``travel`` bounds how far from where it stood first [R]). ``drawn``: a person has drawn
    this wall; what slides stops at it, and it can be erased.
    """

    name: str
    role: Role = "wall"
    position: Point = (0.0, 0.0)
    angle: float = 0.0
    discs: list[tuple[float, float, float]] = field(default_factory=list)  # x, y, radius
    segments: list[tuple[float, float, float, float, float]] = field(
        default_factory=list
    )  # x0, y0, x1, y1, radius
    polygons: list[tuple[tuple[Point, ...], float]] = field(
        default_factory=list
    )  # corners counter-clockwise, radius
    held: bool = False
    axis: Point | None = None
    travel: tuple[float, float] = (-math.inf, math.inf)
    drawn: bool = False
    home: Point = field(init=False)
    _made: tuple[Point, float, Floats] | None = field(
        init=False, repr=False, compare=False, default=None
    )

    def __post_init__(self) -> None:
        self.home = self.position
        numbers = [
            *self.position,
            self.angle,
            *(v for row in (*self.discs, *self.segments) for v in row),
        ]
        numbers += [
            v
            for corners, radius in self.polygons
            for v in (*(c for corner in corners for c in corner), radius)
        ]
        if not all(map(math.isfinite, numbers)):
            raise InputError(f"body {self.name!r}: positions and sizes must be finite numbers")
        self.polygons = [(_convex(corners, self.name), radius) for corners, radius in self.polygons]

    @property
    def movable(self) -> bool:
        """True if a hand can move it."""
        return self.held or self.axis is not None

    def to_world(self, points: Sequence[Point] | Floats) -> Floats:
        """Body frame → world, (n, 2) [R]."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        p = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        return np.column_stack(
            [
                self.position[0] + c * p[:, 0] - s * p[:, 1],
                self.position[1] + s * p[:, 0] + c * p[:, 1],
            ]
        )

    def primitives(self) -> Floats:
        """The body's shapes as rows for the kernels, (M, 8); see ``rigid_contacts``. Read only: they are made once a place."""
        if self._made is not None and self._made[:2] == (self.position, self.angle):
            return self._made[2]
        rows = self._rows()
        rows.flags.writeable = False
        self._made = (self.position, self.angle, rows)
        return rows

    def _rows(self) -> Floats:
        discs = np.array(self.discs, dtype=np.float64).reshape(-1, 3)
        round_ones = np.zeros((len(discs), COLUMNS))
        round_ones[:, 0], round_ones[:, 1:3] = DISC, self.to_world(discs[:, :2])
        round_ones[:, 7] = discs[:, 2]
        rows: list[list[float]] = []
        edges: list[tuple[Point, Point, float]] = []
        for x0, y0, x1, y1, radius in self.segments:
            a, b = self.to_world([(x0, y0), (x1, y1)])
            edges.append(((a[0], a[1]), (b[0], b[1]), radius))
        rows += _edges_and_vertices(_straight(edges))
        for corners, radius in self.polygons:
            p = [(float(x), float(y)) for x, y in self.to_world(corners)]
            rows += _edges_and_vertices(
                [(p[k], p[(k + 1) % len(p)], radius) for k in range(len(p))]
            )
        return np.concatenate([round_ones, np.array(rows).reshape(-1, COLUMNS)])

    def area(self) -> float:
        """Area of discs and polygons, thickness included [R²]; thin segments count as nothing."""
        area = sum(math.pi * r * r for _, _, r in self.discs)
        for corners, radius in self.polygons:
            p = np.asarray(corners)
            around = float(np.sum(np.hypot(*(np.roll(p, -1, axis=0) - p).T)))
            area += polygon_area(p) + around * radius + math.pi * radius**2
        return area


class RigidWorld:
    """All rigid bodies of a scene."""

    def __init__(self, bodies: Sequence[RigidBody] = ()) -> None:
        """Raises InputError if two bodies share a name."""
        self.bodies = list(bodies)
        if len({body.name for body in self.bodies}) != len(self.bodies):
            raise InputError("rigid bodies must have different names")
        self._made: tuple[list[Floats], Floats, NDArray[np.int64]] | None = None

    def __getitem__(self, name: str) -> RigidBody:
        return self.bodies[self.index(name)]

    def index(self, name: str) -> int:
        """Place of a body in ``bodies`` and in arrays of reactions."""
        for place, body in enumerate(self.bodies):
            if body.name == name:
                return place
        raise InputError(
            f"no rigid body is called {name!r}; there are: {', '.join(b.name for b in self.bodies)}"
        )

    def remove(self, name: str) -> None:
        """Take a body away."""
        self.bodies.remove(self[name])

    @property
    def drawn(self) -> tuple[RigidBody, ...]:
        """The walls that a person has drawn: the last of the bodies, which never move."""
        return tuple(body for body in self.bodies if body.drawn)

    def redraw(self, walls: Sequence[RigidBody]) -> None:
        """Let ``walls`` be the drawn ones, in place of those that are."""
        self.bodies = [*(body for body in self.bodies if not body.drawn), *walls]

    def primitives(self) -> tuple[Floats, NDArray[np.int64]]:
        """All primitives (M, 8) and the index of the body that each belongs to (M,). Read only: they are made once a place."""
        parts = [body.primitives() for body in self.bodies]
        made = self._made
        if made is None or len(made[0]) != len(parts) or not all(map(is_, made[0], parts)):
            rows = np.concatenate([np.zeros((0, COLUMNS)), *parts])
            owner = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
            self._made = made = parts, rows, owner.astype(np.int64)
        return made[1:]

    def placement(self) -> Floats:
        """x, y [R] and angle [rad] of every body, (B, 3)."""
        return np.array(
            [[*body.position, body.angle] for body in self.bodies], dtype=np.float64
        ).reshape(-1, 3)

    def place(self, placement: Floats) -> None:
        """Put every body where ``placement`` (B, 3) says."""
        for body, (x, y, angle) in zip(self.bodies, placement, strict=True):
            body.position, body.angle = (float(x), float(y)), float(angle)

    def advance(self, name: str, target: Point, step: float) -> tuple[Point, str | None]:
        """Move a body towards ``target`` [R] by at most ``step`` [R].

        Returns the displacement [R] and, where something stops it, what: "end of travel" or "wall". Raises InputError for a
        body that cannot be moved, and for a target that is not finite.
        """
        body = self[name]
        if not body.movable:
            raise InputError(f"{name!r} cannot be moved")
        if not all(map(math.isfinite, target)):
            raise InputError(f"{name!r} cannot be moved to {target}: give finite numbers")
        wanted = np.array(target) - body.position
        if body.axis is not None:
            return self._slide(body, float(np.dot(wanted, body.axis)), step)
        distance = float(np.hypot(*wanted))
        if distance > step:
            wanted *= step / distance
        return self._pull(body, wanted, step)

    def give_way(self, name: str, pull: Point, step: float) -> Point:
        """Let a body that is pushed harder than its hand pulls, along the unit vector ``pull``, go back by ``step`` [R]."""
        x, y = self[name].position
        return self.advance(name, (x - step * pull[0], y - step * pull[1]), step)[0]

    def _slide(self, body: RigidBody, wanted: float, step: float) -> tuple[Point, str | None]:
        """A kinematic piston: exactly as far as it is told, within its travel.

        Where it would go into a drawn wall, or further into one, it stays.
        """
        assert body.axis is not None
        axis = np.array(body.axis)
        stood = float(np.dot(np.array(body.position) - body.home, axis))
        asked = stood + min(max(wanted, -step), step)
        allowed = min(max(asked, body.travel[0]), body.travel[1])
        amount = allowed - stood
        dx, dy = amount * float(axis[0]), amount * float(axis[1])
        there = (body.position[0] + dx, body.position[1] + dy)
        walls = near(self.drawn, body)
        if walls and depth(body, there, walls) > depth(body, body.position, walls):
            return (0.0, 0.0), "wall"
        body.position = there
        return (dx, dy), ("end of travel" if allowed != asked else None)

    def _pull(self, body: RigidBody, wanted: Floats, step: float) -> tuple[Point, str | None]:
        """A held body: dynamic, on a PivotJoint from the kinematic hand, among the static rest."""
        from core import spaces  # which no other scene needs

        others = [
            *(b for b in self.bodies if not b.drawn and b is not body),
            *near(self.drawn, body),
        ]
        reached = spaces.pulled(body, others, (float(wanted[0]), float(wanted[1])), step)
        moved = np.array(reached) - body.position
        body.position = reached
        stopped = None
        asked = float(np.hypot(*wanted))
        if asked > SAME_POINT and float(np.dot(moved, wanted)) < 0.5 * asked**2:
            stopped = "wall"
        return (float(moved[0]), float(moved[1])), stopped


def near(walls: Sequence[RigidBody], body: RigidBody) -> list[RigidBody]:
    """Those drawn walls that a body may come to touch in one increment."""
    if not walls or not len(body.primitives()):
        return []
    low, high = _extent(body)
    extents = [_extent(wall) for wall in walls]
    return [
        wall
        for wall, (left, right) in zip(walls, extents, strict=True)
        if np.all(left < high + CLEAR) and np.all(right > low - CLEAR)
    ]


def _extent(body: RigidBody) -> tuple[Floats, Floats]:
    """The lower left and the upper right corner of the rectangle around a body, (2,) each [R]."""
    rows = body.primitives()
    ends, radius = rows[:, 1:3], rows[:, 7:8]
    return (ends - radius).min(axis=0), (ends + radius).max(axis=0)


def depth(body: RigidBody, position: Point, others: Sequence[RigidBody]) -> float:
    """How deep ``body``, put at ``position``, would sink into one of the others [R]; 0 if it touches none."""
    from core import spaces  # which no other scene needs

    return spaces.depth(body, position, others)


def _straight(pieces: list[tuple[Point, Point, float]]) -> list[tuple[Point, Point, float]]:
    """The same edges, with one in place of two that go straight on: right where these meet, a grain would be felt by both."""
    edges = pieces[:1]
    for start, end, radius in pieces[1:]:
        begin, middle, same = edges[-1]
        before, after = np.subtract(middle, begin), np.subtract(end, start)
        aside = abs(before[0] * after[1] - before[1] * after[0])
        if (
            radius == same
            and math.dist(middle, start) < SAME_POINT
            and aside <= SAME_DIRECTION * float(np.dot(before, after))
        ):
            edges[-1] = begin, end, radius
        else:
            edges.append((start, end, radius))
    return edges


def _edges_and_vertices(edges: list[tuple[Point, Point, float]]) -> list[list[float]]:
    """Rows for straight edges and for their ends; ends that two edges share become one vertex between them."""
    rows: list[list[float]] = []
    ends: list[tuple[Point, Point, float]] = []  # point, direction of its edge towards it, radius
    for (x0, y0), (x1, y1), radius in edges:
        length = math.hypot(x1 - x0, y1 - y0)
        if length < SAME_POINT:
            rows.append([DISC, x0, y0, 0.0, 0.0, 0.0, 0.0, radius])
            continue
        ux, uy = (x1 - x0) / length, (y1 - y0) / length
        rows.append([EDGE, x0, y0, ux, uy, x1, y1, radius])
        ends += [((x0, y0), (-ux, -uy), radius), ((x1, y1), (ux, uy), radius)]
    while ends:
        (x, y), (ux, uy), radius = ends.pop(0)
        wx = wy = 0.0
        for k, ((x2, y2), direction, radius2) in enumerate(ends):
            if math.hypot(x2 - x, y2 - y) < SAME_POINT and radius2 == radius:
                wx, wy = direction
                ends.pop(k)
                break
        rows.append([VERTEX, x, y, ux, uy, wx, wy, radius])
    return rows


def _convex(corners: Sequence[Point], name: str) -> tuple[Point, ...]:
    """The corners, counter-clockwise. Raises InputError unless they are those of a convex polygon."""
    p = np.asarray(corners, dtype=np.float64)
    if p.ndim != 2 or p.shape[0] < 3 or p.shape[1] != 2:
        raise InputError(f"body {name!r}: a polygon needs three corners or more")
    if polygon_area(p) < 0.0:
        p = p[::-1]
    sides = np.roll(p, -1, axis=0) - p
    following = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0]
    winding = float(np.sum(np.arctan2(turns, np.sum(sides * following, axis=1))))
    if np.any(turns <= 0.0) or abs(winding - 2.0 * math.pi) > 1e-6:
        raise InputError(
            f"body {name!r}: only convex polygons are supported; build other shapes from several"
        )
    return tuple((float(x), float(y)) for x, y in p)


def polygon_area(corners: Sequence[Point] | Floats) -> float:
    """Signed area of a polygon (V, 2), positive counter-clockwise [R²]."""
    p = np.asarray(corners, dtype=np.float64)
    q = np.roll(p, -1, axis=0)
    return 0.5 * float(np.sum(p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]))


def offset_path(points: Sequence[Point], distance: float, *, closed: bool) -> list[Point]:
    """The path shifted right by ``distance`` [R], corners mitred: a wall's centre line from the face that grains see."""
    p = np.asarray(points, dtype=np.float64)
    count = len(p)
    sides = [(p[(k + 1) % count] - p[k]) for k in range(count if closed else count - 1)]
    normals = [np.array([s[1], -s[0]]) / np.hypot(*s) for s in sides]
    shifted: list[Point] = []
    for k in range(count):
        before = normals[k - 1] if (closed or k > 0) else normals[0]
        after = normals[k % len(normals)] if (closed or k < count - 1) else normals[-1]
        mitre = (before + after) / (1.0 + float(np.dot(before, after)))
        corner = p[k] + distance * mitre
        shifted.append((float(corner[0]), float(corner[1])))
    return shifted


def wall(name: str, path: Sequence[Point], thickness: float, *, closed: bool = False) -> RigidBody:
    """A wall whose face is ``path``, with the grains on its left; ``thickness`` [R] lies on its right."""
    line = offset_path(path, 0.5 * thickness, closed=closed)
    pairs = list(zip(line, line[1:] + line[:1] if closed else line[1:], strict=False))
    return RigidBody(name, "wall", segments=[(*a, *b, 0.5 * thickness) for a, b in pairs])

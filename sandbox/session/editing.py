"""Grains that are placed, erased and made another kind, and walls that are drawn: what a person makes between two increments.

Nothing here pushes. A grain for which there is not room enough is put there squeezed, as small as the room is, and so is a grain
that a new wall cuts into; the increment that follows lets them swell against their neighbours, like any other grain
that was squeezed. Where the room is less than ``LEAST`` of a grain, the edit is refused and nothing has changed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.generate import SIZE_RATIO, inside
from core.packing import MAX_LABEL, Packing
from core.rigid import Point, RigidBody, depth
from sandbox.session import free_room as room
from sandbox.session.commands import DrawWall, Edit, Erase, EraseWall, Place, Retype
from scenes.grains import material
from scenes.scene import Setup, Values
from scenes.text import Text

MOST_GRAINS = 100_000
FARTHEST = 1e6  # [R] no scene has places further off
MOST_WALLS = 100
MOST_PIECES = 400  # straight pieces of all drawn walls together
WALL = 0.3  # radius of a drawn wall, half its thickness [R]
HAND = 0.12  # [R] so much a hand trembles: a drawn line is simplified to that
PEG = 0.25  # [R] a drawn line no longer than that is a peg
LEAST = 0.3  # of a grain's radius: what room it needs at least, to swell from there
ASIDE = 1.0  # of a grain's radius: how far it makes way for a wall
AIM = 0.5  # of a grain's radius: how far from the pointer the room is looked for
MISSED = 0.5  # [R] how far from a drawn wall a press still means it


@dataclass(frozen=True)
class Edited:
    """What an edit makes of the grains and of the drawn walls."""

    packing: Packing
    source: NDArray[np.int64]  # (N,) which grain it was before, −1: it is new
    walls: tuple[RigidBody, ...]
    forgotten: tuple[int, int] = (0, 0)  # primitives that go: the first, and how many


def edited(setup: Setup, settings: Values, command: Edit, next_label: int) -> Edited:
    """What ``command`` makes of a scene at rest, which is left as it is. Raises InputError where it cannot be done."""
    if not setup.relaxes or setup.follow is not None:
        raise InputError("nothing can be made in this scene: its grains and plates move together")
    places = command.points if isinstance(command, DrawWall) else ((command.x, command.y),)
    if np.max(np.abs(places)) > FARTHEST:
        raise InputError("this is far outside the scene")
    match command:
        case Place(x, y, kind):
            return _place(setup, settings, (x, y), kind, next_label)
        case Erase(x, y, radius):
            return _erase(setup, (x, y), radius)
        case Retype(x, y, radius, kind):
            return _retype(setup, settings, (x, y), radius, kind)
        case DrawWall(points):
            return _draw(setup, points)
        case EraseWall(x, y):
            return _erase_wall(setup, (x, y))


def radii(settings: Values) -> tuple[float, float]:
    """Radius of a large and of a small grain [R] that are placed in a scene with these settings: of sizes that it has."""
    middle = 1.0 - 0.5 * float(settings.get("size_width", 0.0))
    small_fraction = float(settings.get("small_fraction", 0.5))
    large, small = middle, middle / float(settings.get("size_ratio", SIZE_RATIO))
    return large if small_fraction < 1.0 else small, small if small_fraction > 0.0 else large


# Grains


def _place(setup: Setup, settings: Values, at: Point, kind: str, label: int) -> Edited:
    packing = setup.packing
    if len(packing) >= MOST_GRAINS:
        raise InputError(
            Text("there are {most} {most:grain|grains}, and no more fit", most=MOST_GRAINS)
        )
    if label >= MAX_LABEL:
        label = int(np.setdiff1d(np.arange(len(packing) + 1), packing.label)[0])
    here = np.array([at])
    x, y = here.T if packing.box is None else room.folded(here, packing.box)
    if not inside(setup.outline, x, y)[0]:
        raise InputError("grains can be placed only inside the scene")
    if room.from_bodies(setup, here)[0] <= 0.0:
        raise InputError("there is a wall or another body here: no room for a grain")
    # Large and small ones in turn; where only the other size fits, that one.
    large, small = radii(settings)
    for radius in (large, small) if label % 2 == 0 else (small, large):
        place, free = _best_place(setup, at, radius)
        if free >= LEAST * radius:
            break
    else:
        raise InputError("no room for a grain here: erase one first")
    nu, stiffness = material(settings, kind)
    new = Packing([place[0]], [place[1]], radius, nu, stiffness, label=[label])
    new.state[2] = min(radius, free)
    joined = packing.copy()
    joined.state = np.concatenate([packing.state, new.state], axis=1)
    for name in ("rest_radius", "poisson_ratio", "contact_stiffness", "label"):
        setattr(joined, name, np.concatenate([getattr(packing, name), getattr(new, name)]))
    return Edited(joined, np.append(np.arange(len(packing)), -1), setup.world.drawn)


def _best_place(setup: Setup, at: Point, radius: float) -> tuple[Point, float]:
    """Where near ``at`` [R] a grain has room, the nearest place that is enough or else the widest, and how much."""
    turns = np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False)
    rings = AIM * radius * np.array([0.25, 0.5, 0.75, 1.0])
    around = np.multiply.outer(rings, np.column_stack([np.cos(turns), np.sin(turns)]))
    points = np.concatenate([[at], np.array(at) + around.reshape(-1, 2)])
    free = np.minimum(room.room(setup, points), radius)
    best = int(np.argmax(free))
    return (float(points[best, 0]), float(points[best, 1])), float(free[best])


def _erase(setup: Setup, at: Point, radius: float) -> Edited:
    packing = setup.packing
    gone = room.within(packing, at, radius)
    if not gone.any():
        raise InputError("there is no grain here to erase")
    return Edited(packing.select(~gone), np.flatnonzero(~gone), setup.world.drawn)


def _retype(setup: Setup, settings: Values, at: Point, radius: float, kind: str) -> Edited:
    packing = setup.packing.copy()
    nu, stiffness = material(settings, kind)
    other = room.within(packing, at, radius) & (packing.poisson_ratio != nu)
    if not other.any():
        raise InputError("there is no grain of another kind here")
    packing.poisson_ratio[other], packing.contact_stiffness[other] = nu, stiffness
    return Edited(packing, np.arange(len(packing)), setup.world.drawn)


# Walls


def drawn_wall(number: int, line: tuple[Point, ...]) -> RigidBody:
    """A wall along ``line`` [R], round at its ends and corners; a single point is a peg."""
    name = f"drawn wall {number}"
    if len(line) == 1:
        return RigidBody(name, discs=[(*line[0], WALL)], drawn=True)
    pieces = [(*a, *b, WALL) for a, b in pairwise(line)]
    return RigidBody(name, segments=pieces, drawn=True)


def line_of(wall: RigidBody) -> tuple[Point, ...]:
    """The line that a drawn wall was made along."""
    if wall.discs:
        return (wall.discs[0][:2],)
    ends = [(x1, y1) for _, _, x1, y1, _ in wall.segments]
    return (wall.segments[0][:2], *ends)


def check_walls(walls: tuple[RigidBody, ...]) -> None:
    """Raises InputError if these are more than the program draws."""
    if len(walls) > MOST_WALLS or sum(len(wall.segments) for wall in walls) > MOST_PIECES:
        raise InputError(
            Text("more walls than {most}, or too many corners: erase some first", most=MOST_WALLS)
        )


def _draw(setup: Setup, points: tuple[Point, ...]) -> Edited:
    if setup.packing.box is not None:
        raise InputError("walls cannot be drawn in a cell that repeats itself")
    path = np.array(points, dtype=np.float64)
    if float(np.ptp(path, axis=0).max()) <= PEG:
        line: list[Point] = [points[0]]
    else:
        line = room.simplified(points, HAND)
    x0, y0, x1, y1 = setup.bounds
    low, high = path.min(axis=0), path.max(axis=0)
    if low[0] > x1 or low[1] > y1 or high[0] < x0 or high[1] < y0:
        raise InputError("walls can be drawn only inside the scene")
    taken = {wall.name for wall in setup.world.drawn}
    number = next(n for n in range(1, len(taken) + 2) if f"drawn wall {n}" not in taken)
    wall = drawn_wall(number, tuple(line))
    walls = (*setup.world.drawn, wall)
    check_walls(walls)
    movable = [body for body in setup.world.bodies if body.movable]
    if depth(wall, wall.position, movable) > 0.0:
        raise InputError("a wall cannot be drawn through a body that moves")
    packing = _make_way(setup, line)
    return Edited(packing, np.arange(len(packing)), walls)


def _make_way(setup: Setup, line: list[Point]) -> Packing:
    """The grains beside a new wall: put aside and squeezed, as far as they must."""
    packing = setup.packing.copy()
    if not len(packing):
        return packing
    path = line if len(line) > 1 else [line[0], (line[0][0] + 1e-6, line[0][1])]
    least = LEAST * packing.rest_radius
    start = packing.state[:2].copy()
    for _ in range(8):
        # In a corner of the line a grain that leaves one piece may come upon another.
        distance, nx, ny = room.from_line(packing.x, packing.y, path)
        missing = WALL + 1.05 * least - distance
        close = (missing > 0.0).astype(float)
        packing.state[0] += close * missing * nx
        packing.state[1] += close * missing * ny
    free = room.from_line(packing.x, packing.y, path)[0] - WALL
    moved = np.hypot(*(packing.state[:2] - start))
    aside = moved > 0.0
    standing = np.column_stack([packing.x[aside], packing.y[aside]])
    fits = np.all(free >= least) and np.all(moved <= ASIDE * packing.rest_radius)
    if np.any(aside):
        free[aside] = np.minimum(free[aside], room.from_bodies(setup, standing))
        fits &= np.all(free[aside] >= 0.5 * least[aside])
        fits &= np.all(inside(setup.outline, standing[:, 0], standing[:, 1]))
    if not fits:
        raise InputError(
            "the wall would crush grains that cannot make way: erase some, or draw it elsewhere"
        )
    _, _, p, q1, q2 = packing.state
    tight = p + np.hypot(q1, q2) > free
    p[tight] = free[tight]
    q1[tight] = q2[tight] = 0.0
    return packing


def _erase_wall(setup: Setup, at: Point) -> Edited:
    walls = setup.world.drawn
    distances = []
    for wall in walls:
        line = line_of(wall)
        path = line if len(line) > 1 else (line[0], (line[0][0] + 1e-6, line[0][1]))
        distances.append(float(room.from_line(np.array([at[0]]), np.array([at[1]]), path)[0][0]))
    if not walls or min(distances) > WALL + MISSED:
        raise InputError("there is no drawn wall here to erase")
    gone = int(np.argmin(distances))
    standing = [body for body in setup.world.bodies if not body.drawn]
    first = sum(len(body.primitives()) for body in (*standing, *walls[:gone]))
    count = len(walls[gone].primitives())
    return Edited(
        setup.packing.copy(),
        np.arange(len(setup.packing)),
        (*walls[:gone], *walls[gone + 1 :]),
        (first, count),
    )

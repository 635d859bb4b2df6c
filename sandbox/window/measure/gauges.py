"""What the measuring tools read off a frame or a curve. Each function says its definition and unit; none changes anything."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from core.arrays import Floats
from sandbox.session.frame import Contacts, Frame

Point = tuple[float, float]

FORCES = np.linspace(
    0.0, 4.0, 17
)  # edges of bins: contact force over the mean; what is beyond counts in the last
SHAPES = np.linspace(1.0, 2.0, 17)  # the same for length over width of a grain


@dataclass(frozen=True, slots=True)
class Through:
    """The force that what is left of a line, seen from its first end, exerts on what is right of it."""

    pressing: float  # across the line, positive where both sides press on each other [k R]
    sliding: float  # along the line, positive towards its second end [k R]
    x: Floats  # (K,) where contacts cross the line [R]
    y: Floats

    @property
    def contacts(self) -> int:
        """How many contacts cross it."""
        return int(self.x.size)


def force_through(frame: Frame, start: Point, end: Point) -> Through | None:
    """The sum over all contacts whose line, from centre to centre or to where a body is touched, crosses the cut.

    Between two grains that a cut separates the whole contact force counts, friction and all; so for a cut from wall to wall what
    is above balances, to the residual. In a periodic cell images count too. None where forces are not known.
    """
    contacts = frame.contacts
    length = math.dist(start, end)
    if contacts.fx.shape[0] != len(contacts) or length == 0.0:
        return None
    along = np.array([(end[0] - start[0]) / length, (end[1] - start[1]) / length])
    left = np.array([-along[1], along[0]])
    forces = np.stack([contacts.fx, contacts.fy])
    total, places = np.zeros(2), [np.zeros((2, 0))]
    for shift in _shifts(frame):
        first = np.stack([contacts.x0, contacts.y0]) + shift[:, None] - np.reshape(start, (2, 1))
        second = np.stack([contacts.x1, contacts.y1]) + shift[:, None] - np.reshape(start, (2, 1))
        side, other = left @ first, left @ second
        across = side * other < 0.0
        share = side[across] / (side[across] - other[across])
        at = first[:, across] + share * (second - first)[:, across]
        within = (along @ at >= 0.0) & (along @ at <= length)
        # On the side that is right of the line: grain i, or what it touches.
        sign = np.where(side[across] < 0.0, 1.0, -1.0)
        total += (sign * forces[:, across])[:, within].sum(axis=1)
        places.append(at[:, within] + np.reshape(start, (2, 1)))
    x, y = np.concatenate(places, axis=1)
    return Through(-float(left @ total), float(along @ total), x, y)


def _shifts(frame: Frame) -> list[Floats]:
    """By how much images of a contact are shifted that can cross a line near the cell [R]."""
    if frame.box is None:
        return [np.zeros(2)]
    width, height, shift = frame.box
    columns = (-1, 0, 1) if math.isfinite(width) else (0,)
    rows = (-1, 0, 1) if math.isfinite(height) else (0,)
    return [
        np.array(
            [
                (column * width if column else 0.0) + (row * shift if row else 0.0),
                row * height if row else 0.0,
            ]
        )
        for column, row in product(columns, rows)
    ]


def angle(arm: Point, vertex: Point, other: Point) -> float:
    """Between two arms, 0 to 180 [deg]."""
    first = math.atan2(arm[1] - vertex[1], arm[0] - vertex[0])
    second = math.atan2(other[1] - vertex[1], other[0] - vertex[0])
    turn = abs(math.degrees(first - second)) % 360.0
    return min(turn, 360.0 - turn)


@dataclass(frozen=True, slots=True)
class Spread:
    """How values are spread: the share in each bin, mean and standard deviation, and of how many."""

    shares: Floats
    mean: float
    deviation: float
    count: int


def spread(values: Floats, edges: Floats) -> Spread:
    """Of values, in bins; what is beyond the last edge counts in the last bin."""
    values = values[np.isfinite(values)]
    if not values.size:
        return Spread(np.zeros(edges.size - 1), math.nan, math.nan, 0)
    counts, _ = np.histogram(np.clip(values, edges[0], edges[-1]), edges)
    return Spread(counts / values.size, float(values.mean()), float(values.std()), values.size)


def forces_over_mean(contacts: Contacts) -> Floats:
    """Normal forces of all contacts that carry any, over their mean (C,)."""
    carrying = contacts.force[contacts.force > 0.0]
    return carrying / carrying.mean() if carrying.size else carrying


def length_over_width(frame: Frame) -> Floats:
    """a/b of all grains (N,)."""
    q = np.hypot(frame.q1, frame.q2)
    with np.errstate(all="ignore"):
        return (frame.p + q) / (frame.p - q)


def between(stroke: Floats, force: Floats, marks: tuple[float, float]) -> Spread:
    """Mean and standard deviation of a curve between two marks along it, each increment counted once."""
    low, high = min(marks), max(marks)
    count = min(stroke.size, force.size)
    inside = (stroke[:count] >= low) & (stroke[:count] <= high)
    values = force[:count][inside]
    if not values.size:
        return Spread(np.zeros(0), math.nan, math.nan, 0)
    return Spread(np.zeros(0), float(values.mean()), float(values.std()), values.size)

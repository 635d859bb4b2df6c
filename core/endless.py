"""Walls that run around a periodic cell have no ends.

A grain meets the image of a wall that is nearest to it, one for each primitive. Where a wall that is as long as the cell begins,
its last image ends: there the side of one image and the corner of the other would both be felt.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.packing import PeriodicBox
from core.rigid_contacts import EDGE, VERTEX

SAME_PLACE = 1e-9  # [R]
START, ALONG, END = slice(1, 3), slice(3, 5), slice(5, 7)  # of an edge; of a vertex: place, u and w


def endless(primitives: Floats, box: PeriodicBox | None) -> Floats:
    """The primitives (M, 8), as many in the same order, as a periodic cell has them; the same array where nothing changes.

    An edge that runs along a periodic direction and is at least as long as the cell is made longer at both ends by the length
    of the cell, so that the image of a grain that is nearest to its middle lies beside it; the vertices at its ends are silent.
    Ends of other edges that meet around the cell become one vertex between them, as ends do that meet inside it.
    """
    if box is None or not np.any(primitives[:, 0] == EDGE):
        return primitives
    rows = primitives.copy()
    for around in periods(box):
        _close(rows, around)
        _lengthen(rows, around)
    return rows


def periods(box: PeriodicBox) -> list[Floats]:
    """The ways (2,) [R] from the cell to its images: along x, and to the one above that is nearest."""
    ways = []
    shift = box.shift
    if np.isfinite(box.width):
        ways.append(np.array([box.width, 0.0]))
        shift -= box.width * round(shift / box.width)
    if np.isfinite(box.height):
        ways.append(np.array([shift, box.height]))
    return ways


def _lengthen(rows: Floats, around: Floats) -> None:
    length = np.hypot(*around)
    u = rows[:, ALONG]
    aside = u[:, 0] * around[1] - u[:, 1] * around[0]
    long = np.hypot(*(rows[:, END] - rows[:, START]).T) > length - SAME_PLACE
    for m in np.flatnonzero((rows[:, 0] == EDGE) & (np.abs(aside) < SAME_PLACE) & long):
        for end in (START, END):
            here = (rows[:, 0] == VERTEX) & _same(rows[:, START], rows[m, end])
            _silence(rows, np.flatnonzero(here & (rows[:, 7] == rows[m, 7])))
        rows[m, START] -= length * rows[m, ALONG]
        rows[m, END] += length * rows[m, ALONG]


def _close(rows: Floats, around: Floats) -> None:
    """Join each free end of an edge with another that lies one period further."""
    free = np.flatnonzero((rows[:, 0] == VERTEX) & np.all(rows[:, END] == 0.0, axis=1))
    for m in free:
        meets = _same(rows[free, START], rows[m, START] + around) & (rows[free, 7] == rows[m, 7])
        for n in free[meets][:1]:
            rows[m, END] = rows[n, ALONG]
            _silence(rows, np.array([n]))


def _same(places: Floats, place: Floats) -> NDArray[np.bool_]:
    same: NDArray[np.bool_] = np.hypot(*(places - place).T) < SAME_PLACE
    return same


def _silence(rows: Floats, vertices: NDArray[np.int64]) -> None:
    """A vertex where the wall goes straight on is never beyond both of its edges."""
    rows[vertices, END] = -rows[vertices, ALONG]

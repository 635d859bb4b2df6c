"""Kinds of arrays: their names, and one that lies well in memory."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

CACHE_LINE = 64  # [bytes]


def aligned_zeros(rows: int, columns: int) -> Floats:
    """Zeros (rows, columns) that begin with a cache line: eight numbers at a time then never cross from one into the next."""
    size = 8 * rows * columns
    room = np.zeros(size + CACHE_LINE, dtype=np.uint8)
    start = -room.__array_interface__["data"][0] % CACHE_LINE
    return room[start : start + size].view(np.float64).reshape(rows, columns)

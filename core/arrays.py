"""Kinds of arrays: their names, one that lies well in memory, and copies of what holds some."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Box = tuple[float, ...]  # a periodic cell as kernels want it, see ``PeriodicBox.kernel_form``
Thing = TypeVar("Thing")

CACHE_LINE = 64  # [bytes]


def aligned_zeros(rows: int, columns: int) -> Floats:
    """Zeros (rows, columns) that begin with a cache line: eight numbers at a time then never cross from one into the next."""
    size = 8 * rows * columns
    room = np.zeros(size + CACHE_LINE, dtype=np.uint8)
    start = -room.__array_interface__["data"][0] % CACHE_LINE
    return room[start : start + size].view(np.float64).reshape(rows, columns)


def twin(thing: Thing) -> Thing:
    """A copy with arrays of its own, equal to the last bit; all else is shared."""
    copy = object.__new__(type(thing))
    for name, value in vars(thing).items():
        setattr(copy, name, value.copy() if isinstance(value, np.ndarray) else value)
    return copy

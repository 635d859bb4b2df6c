"""Numbers to few bytes and back: rounded, differences from moment to moment, bytes of equal weight together, deflated.

A block holds whole numbers (T, N), values over its step. Differences along T are folded (0, −1, 1, −2, … to 0, 1, 2, 3, …), laid
out column by column, and cut into bytes: all lowest bytes, then all second ones. The higher ones are nearly all zero, and what
stands still costs nothing. ``unpack.js`` does the same backwards.
"""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Block = tuple[int, int, int, int, float]  # first byte, bytes a number, T, N, step
LENGTH = 4  # bytes that say how long the head is


@dataclass
class Writer:
    """Blocks one after the other."""

    parts: list[bytes] = field(default_factory=list)
    size: int = 0

    def block(self, values: ArrayLike, step: float) -> Block:
        """Write (T, N) values, rounded to the step; what is not finite stays as it was before, or is 0. Says where it is."""
        numbers = np.rint(carried(np.atleast_2d(np.asarray(values, dtype=np.float64))) / step)
        whole = np.clip(numbers, -(2**29), 2**29).astype(np.int64)
        change = np.diff(whole, axis=0, prepend=0)
        folded = np.where(change < 0, -2 * change - 1, 2 * change).T.ravel()
        count = 1
        while folded.max(initial=0) >> (8 * count):
            count += 1
        planes = [(folded >> (8 * k)).astype(np.uint8).tobytes() for k in range(count)]
        at = self.size
        self.parts += planes
        self.size += count * folded.size
        return at, count, *whole.shape, float(step)

    def packed(self, head: dict[str, Any]) -> bytes:
        """All of it, deflated: the length of the head, the head as JSON, the blocks."""
        text = json.dumps(head, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
        return zlib.compress(b"".join([len(text).to_bytes(LENGTH, "little"), text, *self.parts]), 9)


def unpacked(data: bytes) -> tuple[dict[str, Any], bytes]:
    """Head and blocks of what ``Writer.packed`` made."""
    whole = zlib.decompress(data)
    end = LENGTH + int.from_bytes(whole[:LENGTH], "little")
    head: dict[str, Any] = json.loads(whole[LENGTH:end])
    return head, whole[end:]


def read(blocks: bytes, block: Block) -> NDArray[np.float64]:
    """The values (T, N) of a block."""
    at, count, rows, columns, step = block
    size = rows * columns
    folded = np.zeros(size, dtype=np.int64)
    for k in range(count):
        folded |= np.frombuffer(blocks, np.uint8, size, at + k * size).astype(np.int64) << (8 * k)
    change = (folded >> 1) ^ -(folded & 1)
    values: NDArray[np.float64] = np.cumsum(change.reshape(columns, rows), axis=1).T * step
    return values


def carried(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (T, N) with what is not finite replaced by what was there before, or 0."""
    finite = np.isfinite(values)
    if finite.all():
        return values
    rows = np.arange(values.shape[0])[:, None]
    latest = np.maximum.accumulate(np.where(finite, rows, -1), axis=0)
    found = np.take_along_axis(values, np.maximum(latest, 0), axis=0)
    return np.where(latest < 0, 0.0, found)

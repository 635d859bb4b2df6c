"""What every shape is made of: a canvas, colours that are mixed, pixels and spans of pixels."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.jit import kernel

Pixels = NDArray[np.uint32]
Colours = NDArray[np.uint32]
Flags = NDArray[np.bool_]
Clip = tuple[int, int, int, int]
ToScreen = tuple[float, float, float]
Canvas = tuple[Pixels, Clip, ToScreen]
Grains = tuple[Floats, Floats, Floats, Floats, Floats]  # x, y, p, q1, q2: (N,) [R]

SURELY = 0.501  # [px] inside an outline: a pixel that is covered, however it was rounded


@kernel
def first_pixel(place: float, low: int, high: int) -> int:
    """Index of the first pixel whose centre is at or after a finite place, within [low, high]."""
    return int(min(max(math.ceil(place - 0.5), float(low)), float(high)))


@kernel
def ring_in_row(
    dy: float,
    cx: float,
    metric: tuple[float, float, float],
    outer: float,
    inner: float,
    edges: tuple[int, int],
) -> tuple[int, int, int, int]:
    """Pixels of a row between two concentric ellipses: from the first to the third, and from the fourth to the second.

    dy: of the row from the centre [px]; cx: the centre's column; metric: a11, a12 of the ellipse a11 x² + 2 a12 x y + a22 y² = 1,
    and half its height; outer, inner: in its radii; edges: of the clip.
    """
    a11, a12, half_height = metric
    left, right = edges
    ratio = (dy / half_height) ** 2
    middle = cx - a12 / a11 * dy
    half = math.sqrt(max(outer * outer - ratio, 0.0) / a11)
    first = first_pixel(middle - half, left, right)
    last = first_pixel(middle + half, left, right)
    inner0 = last
    inner1 = last
    if inner * inner > ratio:
        half = math.sqrt((inner * inner - ratio) / a11)
        inner0 = first_pixel(middle - half, first, last)
        inner1 = first_pixel(middle + half, inner0, last)
    return first, last, inner0, inner1


@kernel
def strip_in_row(
    dy: float, cx: float, direction: tuple[float, float], length: float, half: float
) -> tuple[float, float]:
    """From where to where a row lies within ``half`` of a straight line, not beyond its ends [px]; from > to: nowhere.

    dy: of the row from where the line begins; cx: the column there; direction: (2,), a unit vector.
    """
    tx, ty = direction
    low, high = -math.inf, math.inf
    if half < 0.0:
        return high, low
    if abs(ty) > 1e-6:
        middle, aside = dy * tx / ty, half / abs(ty)
        low, high = middle - aside, middle + aside
    elif abs(dy) > half:
        return high, low
    if abs(tx) > 1e-6:
        begin, end = -dy * ty / tx, (length - dy * ty) / tx
        low, high = max(low, min(begin, end)), min(high, max(begin, end))
    elif not 0.0 <= dy * ty <= length:
        return high, low
    return cx + low, cx + high


@kernel
def sane(size: float) -> bool:
    """Is a sum of magnitudes a number that can be drawn with?

    Not isfinite: that is compiled to v - v == 0, which the flags that let the compiler reorder
    sums make true for any sum, nan or not. A comparison stays what it is.
    """
    return size < 1e12


@kernel
def mix(under: int, over: int, share: int) -> int:
    """``share`` of 256 parts of colour ``over`` on colour ``under``."""
    rest = 256 - share
    red_blue = ((under & 0xFF00FF) * rest + (over & 0xFF00FF) * share + 0x800080) >> 8
    green = ((under & 0x00FF00) * rest + (over & 0x00FF00) * share + 0x008000) >> 8
    return (red_blue & 0xFF00FF) | (green & 0x00FF00)


@kernel
def coverage(distance: float) -> float:
    return min(max(0.5 - distance, 0.0), 1.0)


@kernel
def put(pixels: Pixels, row: int, column: int, colour: int, share: float) -> None:
    """Blend ``share`` in 0..1 of a colour into one pixel."""
    parts = int(share * 256.0 + 0.5)
    if parts >= 256:
        pixels[row, column] = colour
    elif parts > 0:
        pixels[row, column] = mix(np.int64(pixels[row, column]), colour, parts)


@kernel
def span(pixels: Pixels, row: int, first: int, last: int, colour: int, alpha: float) -> None:
    """Fill ``first <= column < last`` of a row."""
    if alpha >= 1.0:
        for column in range(first, last):
            pixels[row, column] = colour
    else:
        for column in range(first, last):
            put(pixels, row, column, colour, alpha)

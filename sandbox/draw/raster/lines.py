"""Lines and rings."""

from __future__ import annotations

import math

import numpy as np

from core.arrays import Floats
from core.jit import kernel
from sandbox.draw.raster.pixels import (
    SURELY,
    Canvas,
    Colours,
    Pixels,
    coverage,
    first_pixel,
    put,
    sane,
    span,
    strip_in_row,
)


@kernel
def _line_pixel(
    pixels: Pixels,
    row: int,
    column: int,
    start: tuple[float, float],
    direction: tuple[float, float],
    length: float,
    thick: float,
    colour: int,
    strength: float,
) -> None:
    """A pixel at or near the edge of a line."""
    tx, ty = direction
    dx = column + 0.5 - start[0]
    dy = row + 0.5 - start[1]
    along = dx * tx + dy * ty
    away = abs(dx * ty - dy * tx)
    if along < 0.0:
        away = math.sqrt(dx * dx + dy * dy)
    elif along > length:
        away = math.sqrt(away * away + (along - length) * (along - length))
    distance = away - thick
    if distance < 0.5:
        put(pixels, row, column, colour, coverage(distance) * strength)


@kernel
def draw_lines(
    canvas: Canvas,
    ends: tuple[Floats, Floats, Floats, Floats],
    half_width: Floats,
    colour: Colours,
    alpha: Floats,
    hidden: Floats | None = None,
) -> None:
    """Straight lines with round ends. half_width: float64 (N,) [px]; colour: uint32 (N,);
    alpha: float64 (N,) in 0..1. A line thinner than a pixel is drawn a pixel wide and fainter.

    hidden: float64 (N,) [px], half the width of what will be drawn over a line and cannot be seen through: that part is left out.
    """
    pixels, clip, to_screen = canvas
    left, top, right, bottom = clip
    scale, offset_x, offset_y = to_screen
    x0, y0, x1, y1 = ends
    for i in range(x0.shape[0]):
        ax = offset_x + scale * x0[i]
        ay = offset_y - scale * y0[i]
        tx = scale * (x1[i] - x0[i])
        ty = -scale * (y1[i] - y0[i])
        length = math.hypot(tx, ty)
        thick = half_width[i]
        strength = alpha[i]
        if not (sane(abs(ax) + abs(ay) + length + abs(thick) + abs(strength)) and thick > 0.0):
            continue
        if thick < 0.5:
            strength *= 2.0 * thick
            thick = 0.5
        if strength * 256.0 < 0.5:
            continue
        if length > 1e-9:
            tx /= length
            ty /= length
        else:
            tx = 1.0
            ty = 0.0
        bx = ax + length * tx
        by = ay + length * ty
        reach = thick + 0.5
        over = np.int64(colour[i])
        row0 = first_pixel(min(ay, by) - reach, top, bottom)
        row1 = first_pixel(max(ay, by) + reach, top, bottom)
        for row in range(row0, row1):
            dy = row + 0.5 - ay
            low = min(ax, bx) - reach
            high = max(ax, bx) + reach
            if abs(ty) > 1e-6:  # cut the row where it leaves the strip along the line
                middle = ax + dy * tx / ty
                low = max(low, middle - reach / abs(ty))
                high = min(high, middle + reach / abs(ty))
            first = first_pixel(low, left, right)
            last = first_pixel(high, first, right)
            plain0, plain1, hidden0, hidden1 = last, last, last, last
            begin, end = strip_in_row(dy, ax, (tx, ty), length, thick - SURELY)
            if begin < end:
                plain0 = first_pixel(begin, first, last)
                plain1 = first_pixel(end, plain0, last)
                hidden0, hidden1 = plain1, plain1
                if hidden is not None:
                    begin, end = strip_in_row(dy, ax, (tx, ty), length, hidden[i] - SURELY)
                    if begin < end:
                        hidden0 = first_pixel(begin, plain0, plain1)
                        hidden1 = first_pixel(end, hidden0, plain1)
            for column in range(first, plain0):
                _line_pixel(pixels, row, column, (ax, ay), (tx, ty), length, thick, over, strength)
            span(pixels, row, plain0, hidden0, over, strength)
            span(pixels, row, hidden1, plain1, over, strength)
            for column in range(plain1, last):
                _line_pixel(pixels, row, column, (ax, ay), (tx, ty), length, thick, over, strength)


@kernel(nogil=False)
def draw_few_lines(
    canvas: Canvas,
    ends: tuple[Floats, Floats, Floats, Floats],
    half_width: Floats,
    colour: Colours,
    alpha: Floats,
) -> None:
    """The same as ``draw_lines`` for lines that take microseconds: keeps the interpreter's lock."""
    draw_lines(canvas, ends, half_width, colour, alpha)


@kernel(nogil=False)
def draw_ring(
    canvas: Canvas,
    x: float,
    y: float,
    radius: float,
    half_width: float,
    colour: int,
    alpha: float,
) -> None:
    """A circle's outline; radius and half_width [px]."""
    pixels, clip, to_screen = canvas
    left, top, right, bottom = clip
    scale, offset_x, offset_y = to_screen
    cx = offset_x + scale * x
    cy = offset_y - scale * y
    if not (sane(abs(cx) + abs(cy) + radius + half_width + alpha) and radius > 0.0):
        return
    reach = radius + half_width + 0.5
    hole = max(radius - half_width - 0.5, 0.0)
    over = np.int64(colour)
    for row in range(first_pixel(cy - reach, top, bottom), first_pixel(cy + reach, top, bottom)):
        dy = row + 0.5 - cy
        half = math.sqrt(max(reach * reach - dy * dy, 0.0))
        skip = math.sqrt(max(hole * hole - dy * dy, 0.0))
        first = first_pixel(cx - half, left, right)
        last = first_pixel(cx + half, left, right)
        empty0 = first_pixel(cx - skip, first, last)
        empty1 = first_pixel(cx + skip, empty0, last)
        for step in range(first, last - (empty1 - empty0)):
            column = step if step < empty0 else step + empty1 - empty0
            dx = column + 0.5 - cx
            distance = abs(math.sqrt(dx * dx + dy * dy) - radius) - half_width
            put(pixels, row, column, over, coverage(distance) * alpha)

"""Grains as plain ellipses."""

from __future__ import annotations

import math

import numpy as np

from core.jit import kernel
from sandbox.draw.raster.pixels import (
    Canvas,
    Colours,
    Grains,
    Pixels,
    coverage,
    first_pixel,
    mix,
    put,
    ring_in_row,
    sane,
    span,
)


@kernel
def _ellipse_pixel(
    pixels: Pixels,
    row: int,
    column: int,
    cx: float,
    cy: float,
    inverse: tuple[float, float, float],
    smallest: float,
    fill: int,
    edge: int,
    edge_width: float,
    alpha: float,
) -> None:
    i11, i12, i22 = inverse
    dx = column + 0.5 - cx
    dy = row + 0.5 - cy
    u = i11 * dx + i12 * dy
    v = i12 * dx + i22 * dy
    # Distance to first order: (|u| - 1) over its gradient. Exact on the outline and for circles.
    reach = math.sqrt(u * u + v * v)
    gx = i11 * u + i12 * v
    gy = i12 * u + i22 * v
    slope = math.sqrt(gx * gx + gy * gy)
    distance = -smallest
    if slope > 1e-12:
        distance = reach * (reach - 1.0) / slope
    share = coverage(distance)
    if share > 0.0:
        inside = int(coverage(distance + edge_width) * 256.0 + 0.5)
        put(pixels, row, column, mix(edge, fill, inside), share * alpha)


@kernel
def draw_ellipses(
    canvas: Canvas,
    grains: Grains,
    fill: Colours,
    edge: Colours,
    edge_width: float,
    alpha: float,
) -> None:
    """Grains: ellipses with stretch tensor [[p + q1, q2], [q2, p - q1]] [R], filled and outlined.

    x, y, p, q1, q2: float64 (N,) [R]; fill, edge: uint32 (N,); edge_width [px]; alpha in 0..1.
    """
    pixels, clip, to_screen = canvas
    left, top, right, bottom = clip
    scale, offset_x, offset_y = to_screen
    x, y, p, q1, q2 = grains
    for i in range(x.shape[0]):
        stretch = math.hypot(q1[i], q2[i])
        smallest = scale * (p[i] - stretch)
        if not (sane(abs(x[i]) + abs(y[i]) + abs(p[i]) + stretch) and smallest > 1e-3):
            continue
        cx = offset_x + scale * x[i]
        cy = offset_y - scale * y[i]
        s11 = scale * (p[i] + q1[i])
        s22 = scale * (p[i] - q1[i])
        s12 = -scale * q2[i]  # the screen's y runs down
        determinant = s11 * s22 - s12 * s12
        inverse = (s22 / determinant, -s12 / determinant, s11 / determinant)
        i11, i12, i22 = inverse
        a11 = i11 * i11 + i12 * i12
        a12 = i12 * (i11 + i22)
        half_height = math.hypot(s12, s22)
        # Concentric ellipses that surely hold all of the outline's pixels between them.
        outer = 1.0 + 0.5 / smallest
        inner = max(1.0 - (edge_width + 0.5) / smallest, 0.0)
        row0 = first_pixel(cy - outer * half_height, top, bottom)
        row1 = first_pixel(cy + outer * half_height, top, bottom)
        colour = np.int64(fill[i])
        rim = np.int64(edge[i])
        for row in range(row0, row1):
            dy = row + 0.5 - cy
            first, last, solid0, solid1 = ring_in_row(
                dy, cx, (a11, a12, half_height), outer, inner, (left, right)
            )
            for column in range(first, solid0):
                _ellipse_pixel(
                    pixels, row, column, cx, cy, inverse, smallest, colour, rim, edge_width, alpha
                )
            span(pixels, row, solid0, solid1, colour, alpha)
            for column in range(solid1, last):
                _ellipse_pixel(
                    pixels, row, column, cx, cy, inverse, smallest, colour, rim, edge_width, alpha
                )

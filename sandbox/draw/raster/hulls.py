"""Rigid bodies: inflated convex outlines."""

from __future__ import annotations

import math

import numpy as np

from core.arrays import Floats
from core.jit import kernel
from sandbox.draw.raster.pixels import (
    SURELY,
    Canvas,
    ToScreen,
    coverage,
    first_pixel,
    mix,
    put,
    sane,
    span,
    strip_in_row,
)


@kernel
def _hull_distance(
    corners: Floats, to_screen: ToScreen, turn: float, px: float, py: float
) -> float:
    """Exact signed distance [px] from a point to the convex hull of corners in order."""
    scale, offset_x, offset_y = to_screen
    count = corners.shape[0]
    inside = -math.inf if turn != 0.0 else math.inf
    nearest = math.inf
    for k in range(count):
        following = (k + 1) % count
        dx = px - offset_x - scale * corners[k, 0]
        dy = py - offset_y + scale * corners[k, 1]
        ex = scale * (corners[following, 0] - corners[k, 0])
        ey = -scale * (corners[following, 1] - corners[k, 1])
        square = ex * ex + ey * ey
        along = 0.0
        if square > 1e-18:
            inside = max(inside, turn * (dy * ex - dx * ey) / math.sqrt(square))
            along = min(max((dx * ex + dy * ey) / square, 0.0), 1.0)
        nearest = min(nearest, math.hypot(dx - along * ex, dy - along * ey))
    return inside if inside <= 0.0 else nearest


@kernel(nogil=False)
def draw_hull(
    canvas: Canvas,
    corners: Floats,
    radius: float,
    fill: int,
    edge: int,
    edge_width: float,
    alpha: float,
) -> None:
    """A convex outline inflated by a radius: one corner makes a disc, two a capsule, more a
    polygon with rounded corners. corners: float64 (m, 2), in order; radius, edge_width [px].
    """
    pixels, clip, to_screen = canvas
    left, top, right, bottom = clip
    scale, offset_x, offset_y = to_screen
    count = corners.shape[0]
    area = 0.0
    x_low = y_low = math.inf
    x_high = y_high = -math.inf
    total = abs(radius) + alpha
    for k in range(count):
        following = (k + 1) % count
        area += corners[k, 0] * corners[following, 1] - corners[following, 0] * corners[k, 1]
        sx = offset_x + scale * corners[k, 0]
        sy = offset_y - scale * corners[k, 1]
        total += abs(sx) + abs(sy)
        x_low = min(x_low, sx)
        x_high = max(x_high, sx)
        y_low = min(y_low, sy)
        y_high = max(y_high, sy)
    if count == 0 or not sane(total):
        return
    # Below three corners the area is zero but for rounding.
    flat = count < 3 or abs(scale * scale * area) < 1e-9
    turn = 0.0 if flat else math.copysign(1.0, area)
    body = np.int64(fill)
    rim = np.int64(edge)
    reach = radius + 0.5
    for row in range(
        first_pixel(y_low - reach, top, bottom), first_pixel(y_high + reach, top, bottom)
    ):
        low = x_low - reach
        high = x_high + reach
        # Where the row is deeper inside every edge than outline and blur: no distance needed.
        plain_low = -math.inf if turn != 0.0 else math.inf
        plain_high = math.inf
        for k in range(count):
            following = (k + 1) % count
            ax = offset_x + scale * corners[k, 0]
            ay = offset_y - scale * corners[k, 1]
            ex = scale * (corners[following, 0] - corners[k, 0])
            ey = -scale * (corners[following, 1] - corners[k, 1])
            size = math.hypot(ex, ey)
            if size < 1e-9 or turn == 0.0:
                continue
            nx = -turn * ey / size  # outward; the screen's y runs down, hence the sign
            below = turn * ex / size * (row + 0.5 - ay)
            room = reach - below
            plain = min(radius - edge_width - 0.5, 0.0) - below
            if nx > 1e-9:
                high = min(high, ax + room / nx)
                plain_high = min(plain_high, ax + plain / nx)
            elif nx < -1e-9:
                low = max(low, ax + room / nx)
                plain_low = max(plain_low, ax + plain / nx)
            elif plain < 0.0:
                plain_low = math.inf
        solid = radius - edge_width - 0.5
        if count == 1 and solid > abs(row + 0.5 - y_low):
            half = math.sqrt(solid * solid - (row + 0.5 - y_low) ** 2)
            plain_low = x_low - half
            plain_high = x_low + half
        if count == 2:
            ax = offset_x + scale * corners[0, 0]
            ay = offset_y - scale * corners[0, 1]
            ex = scale * (corners[1, 0] - corners[0, 0])
            ey = -scale * (corners[1, 1] - corners[0, 1])
            size = math.hypot(ex, ey)
            if size > 1e-9:
                along = (ex / size, ey / size)
                deep = radius - edge_width - SURELY
                plain_low, plain_high = strip_in_row(row + 0.5 - ay, ax, along, size, deep)
        first = first_pixel(low, left, right)
        last = first_pixel(high, first, right)
        plain0 = last
        plain1 = last
        if plain_high > plain_low:
            plain0 = first_pixel(plain_low, first, last)
            plain1 = first_pixel(plain_high, plain0, last)
        for step in range(first, last - (plain1 - plain0)):
            column = step if step < plain0 else step + plain1 - plain0
            distance = _hull_distance(corners, to_screen, turn, column + 0.5, row + 0.5) - radius
            share = coverage(distance)
            if share > 0.0:
                inside = int(coverage(distance + edge_width) * 256.0 + 0.5)
                put(pixels, row, column, mix(rim, body, inside), share * alpha)
        span(pixels, row, plain0, plain1, body, alpha)

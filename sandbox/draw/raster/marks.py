"""The mark of auxetic grains."""

from __future__ import annotations

import math

from core.arrays import Floats
from core.jit import kernel
from sandbox.draw.raster.pixels import Canvas, Flags, Grains, coverage, first_pixel, put, sane
from sandbox.draw.raster.unit_disc import to_unit_disc


@kernel
def draw_bow_ties(
    canvas: Canvas,
    grains: Grains,
    turn: Floats,
    openness: Floats,
    chosen: Flags,
    colour: int,
    alpha: float,
) -> None:
    """The re-entrant mark of auxetic grains: a bow-tie cut out of the grain and stretched with it.

    In the grain's own frame (a unit disc) the bow-tie is |v| < h and |u| < w(|v|), w growing from
    the waist to the end; ``openness`` in 0..1 scales w, so that at 0 only a slit is left. An affine
    map keeps straight edges straight, so the distances stay exact on a squeezed grain.

    turn: float64 (N,) angle of the mark [rad]; chosen: bool (N,), True where there is a mark.
    """
    pixels, clip, to_screen = canvas
    left, top, right, bottom = clip
    scale, offset_x, offset_y = to_screen
    x, y, p, q1, q2 = grains
    height = 0.52
    for i in range(x.shape[0]):
        stretch = math.hypot(q1[i], q2[i])
        smallest = scale * (p[i] - stretch)
        total = abs(x[i]) + abs(y[i]) + abs(p[i]) + stretch
        known = sane(total + abs(turn[i]) + abs(openness[i]))
        if not (chosen[i] and known and smallest > 1.5):
            continue
        cx = offset_x + scale * x[i]
        cy = offset_y - scale * y[i]
        m11, m12, m21, m22 = to_unit_disc(p[i], q1[i], q2[i], scale, turn[i])
        slit = 0.55 / smallest  # never thinner than about a pixel
        opened = min(max(openness[i], 0.0), 1.0)
        waist = max(0.10 * opened, slit)
        end = max(0.46 * opened, slit)
        # Slanted edge |u| - lean |v| = waist, its normal (1, -lean) in each of the two folds.
        lean = (end - waist) / height
        slope_v = math.hypot(m21, m22)
        slope_even = math.hypot(m11 - lean * m21, m12 - lean * m22)
        slope_odd = math.hypot(m11 + lean * m21, m12 + lean * m22)
        reach = 0.75 * (smallest + 2.0 * scale * stretch) + 1.0
        row0 = first_pixel(cy - reach, top, bottom)
        row1 = first_pixel(cy + reach, top, bottom)
        column0 = first_pixel(cx - reach, left, right)
        column1 = first_pixel(cx + reach, left, right)
        fade = min((smallest - 1.5) / 3.0, 1.0) * alpha
        for row in range(row0, row1):
            dy = row + 0.5 - cy
            for column in range(column0, column1):
                dx = column + 0.5 - cx
                v = m21 * dx + m22 * dy
                end_distance = (abs(v) - height) / slope_v
                if end_distance >= 0.5:
                    continue
                u = m11 * dx + m12 * dy
                slope = slope_even if u * v >= 0.0 else slope_odd
                side_distance = (abs(u) - lean * abs(v) - waist) / slope
                share = coverage(max(end_distance, side_distance))
                if share > 0.0:
                    put(pixels, row, column, colour, share * fade)

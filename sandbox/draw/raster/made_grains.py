"""Grains as they are made."""

from __future__ import annotations

import math

import numpy as np

from core.arrays import Floats
from core.jit import kernel
from sandbox.draw.raster.pixels import (
    Canvas,
    Colours,
    Flags,
    Grains,
    coverage,
    first_pixel,
    mix,
    put,
    ring_in_row,
    sane,
)
from sandbox.draw.raster.unit_disc import to_unit_disc

# A grain as it is made, in radii; see draw_made_grains.
WALL = 0.30  # of the ring
TIP = 0.84  # corners of the hole: tip, wings, and the notch in the open and in the closed hole
WING_U, WING_V = 0.70, -0.44
NOTCH_OPEN, NOTCH_CLOSED = -0.06, 0.58
HINGE = 0.14  # between the notch and the wedge
MOUTH = 0.30  # half width of the wedge at the rim
TOOTH_LONG, TOOTH_THICK, POCKET_GAP = 0.52, 0.13, 0.05


@kernel
def _normal(x0: float, y0: float, x1: float, y1: float) -> tuple[float, float]:
    """Unit normal of a line, to the right of the way from the first point to the second."""
    dx = x1 - x0
    dy = y1 - y0
    length = math.sqrt(dx * dx + dy * dy)
    return dy / length, -dx / length


@kernel
def draw_made_grains(
    canvas: Canvas,
    grains: Grains,
    rest_radius: Floats,
    turn: Floats,
    openness: Floats,
    auxetic: Flags,
    colours: tuple[Colours, Colours],
    edge_width: float,
    tooth_from: float,
) -> None:
    """Grains as they are made, as parts of an ellipse: a ring, or a disc with a re-entrant hole.

    The ring's wall is a constant part of the rest radius. The hole is an arrowhead, its four corners
    hinges: tip and wings near the rim, and the notch, made flexible by a wedge cut from the rim
    nearly to it. A tooth on one side of the wedge bars the mouth and slides into a pocket on the
    other. As ``openness`` in 0..1 falls, notch and wedge move up and the hole closes to slits.

    In the grain's own frame, a unit disc turned by ``turn`` [rad], (u, v) has the tip at v > 0 and
    a = |u|; each straight edge is a line in (a, v). An affine map keeps edges straight, so distances
    to them stay exact on a squeezed grain. rest_radius [R], turn, openness: float64 (N,); auxetic:
    bool (N,); colours: fill and edge, uint32 (N,); edge_width [px]. Below a radius of ``tooth_from``
    [px] the tooth is left out.
    """
    pixels, clip, to_screen = canvas
    left, top, right, bottom = clip
    scale, offset_x, offset_y = to_screen
    x, y, p, q1, q2 = grains
    fill, edge = colours
    for i in range(x.shape[0]):
        stretch = math.hypot(q1[i], q2[i])
        smallest = scale * (p[i] - stretch)
        total = abs(x[i]) + abs(y[i]) + abs(p[i]) + stretch + abs(rest_radius[i])
        if not (sane(total + abs(turn[i]) + abs(openness[i])) and smallest > 1e-3):
            continue
        cx = offset_x + scale * x[i]
        cy = offset_y - scale * y[i]
        rest = scale * rest_radius[i]
        wall = WALL * rest
        i11, i12, i21, i22 = to_unit_disc(p[i], q1[i], q2[i], scale, 0.0)
        m11, m12, m21, m22 = to_unit_disc(p[i], q1[i], q2[i], scale, turn[i])
        # Edges in (a, v): unit normals (na, nv), offset c; slopes of each where u > 0 and u < 0.
        opened = min(max(openness[i], 0.0), 1.0)
        slit = 0.45 / smallest  # never thinner than about a pixel
        notch = NOTCH_CLOSED + (NOTCH_OPEN - NOTCH_CLOSED) * opened
        notch = min(notch, TIP - 3.0 * slit)
        apex = notch - HINGE
        mouth = MOUTH * opened
        n1a, n1v = _normal(WING_U, WING_V, 0.0, TIP)
        c1 = n1v * TIP
        n2a, n2v = _normal(0.0, notch, WING_U, WING_V)
        c2 = n2v * notch
        n3a, n3v = _normal(mouth, -1.0, 0.0, apex)
        c3 = n3v * apex + slit
        k1p = math.hypot(n1a * m11 + n1v * m21, n1a * m12 + n1v * m22)
        k1m = math.hypot(n1v * m21 - n1a * m11, n1v * m22 - n1a * m12)
        k2p = math.hypot(n2a * m11 + n2v * m21, n2a * m12 + n2v * m22)
        k2m = math.hypot(n2v * m21 - n2a * m11, n2v * m22 - n2a * m12)
        k3p = math.hypot(n3a * m11 + n3v * m21, n3a * m12 + n3v * m22)
        k3m = math.hypot(n3v * m21 - n3a * m11, n3v * m22 - n3a * m12)
        kv = math.hypot(m21, m22)
        ku = math.hypot(m11, m12)
        toothed = smallest >= tooth_from
        tooth = TOOTH_THICK * rest
        pocket = tooth + max(POCKET_GAP * rest, 0.8)
        tooth_tip = mouth - TOOTH_LONG
        pocket_end = -TOOTH_LONG - 0.08
        a11 = i11 * i11 + i21 * i21
        a12 = i11 * i12 + i21 * i22
        half_height = math.sqrt(a11) / abs(i11 * i22 - i12 * i21)
        outer = 1.0 + 0.5 / smallest
        # A concentric ellipse that is surely within the ring's hole.
        empty = max(1.0 - (wall + 0.5) / smallest, 0.0) if not auxetic[i] else 0.0
        colour = np.int64(fill[i])
        rim = np.int64(edge[i])
        row0 = first_pixel(cy - outer * half_height, top, bottom)
        row1 = first_pixel(cy + outer * half_height, top, bottom)
        for row in range(row0, row1):
            dy = row + 0.5 - cy
            first, last, empty0, empty1 = ring_in_row(
                dy, cx, (a11, a12, half_height), outer, empty, (left, right)
            )
            for step in range(first, last - (empty1 - empty0)):
                column = step if step < empty0 else step + empty1 - empty0
                dx = column + 0.5 - cx
                u = i11 * dx + i12 * dy
                v = i21 * dx + i22 * dy
                reach = math.sqrt(u * u + v * v)
                gx = i11 * u + i21 * v
                gy = i12 * u + i22 * v
                slope = math.sqrt(gx * gx + gy * gy)
                outside = -smallest
                if slope > 1e-12:
                    outside = reach * (reach - 1.0) / slope
                if not auxetic[i]:
                    distance = max(outside, -outside - wall)
                else:
                    u = m11 * dx + m12 * dy
                    v = m21 * dx + m22 * dy
                    a = abs(u)
                    plus = u >= 0.0
                    hole = max(
                        (n1a * a + n1v * v - c1) / (k1p if plus else k1m),
                        (n2a * a + n2v * v - c2) / (k2p if plus else k2m),
                    )
                    wedge = (n3a * a + n3v * v - c3) / (k3p if plus else k3m)
                    hole = min(hole, max(wedge, (v - apex) / kv))
                    if toothed and v < -0.5:
                        # Both lie along the rim: their inner edges are at a depth below it.
                        hollow = max(-outside - pocket, max(pocket_end - u, u) / ku)
                        hole = min(hole, hollow)
                        bar = max(-outside - tooth, max(tooth_tip - u, u - mouth - 0.15) / ku)
                        hole = max(hole, -bar)
                    distance = max(outside, -hole)
                share = coverage(distance)
                if share > 0.0:
                    inside = int(coverage(distance + edge_width) * 256.0 + 0.5)
                    put(pixels, row, column, mix(rim, colour, inside), share)

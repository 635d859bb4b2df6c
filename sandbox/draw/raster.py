"""Anti-aliased shapes written straight into a pixel array by compiled kernels.

Every shape is a signed distance in pixels (negative inside); the coverage of a pixel is
``clip(1/2 - distance, 0, 1)``. Rows are cut into spans first, so that the distance is evaluated
near an outline only and the inside is a plain fill. Nothing is allocated per shape, the order of
drawing is the order of the arrays, and a shape with a number that is not finite is left out.

A canvas is ``(pixels, clip, to_screen)``: pixels ``uint32 (height, width)`` holding ``0xRRGGBB``,
the centre of pixel ``(row, column)`` being at ``(column + 1/2, row + 1/2)``; the clip
``(left, top, right, bottom)`` in pixels, right and bottom excluded; and ``to_screen = (scale,
x offset, y offset)`` with ``screen x = offset + scale x``, ``screen y = offset - scale y``.

All kernels live in this one file on purpose: the disk cache notices an edited callee only there.
Those for one small shape keep the interpreter's lock: they take microseconds, and getting the lock
back from a busy solver can take milliseconds.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.jit import kernel

Pixels = NDArray[np.uint32]
Colours = NDArray[np.uint32]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Clip = tuple[int, int, int, int]
ToScreen = tuple[float, float, float]
Canvas = tuple[Pixels, Clip, ToScreen]
Grains = tuple[Floats, Floats, Floats, Floats, Floats]  # x, y, p, q1, q2: (N,) [R]

# A grain as it is made, in radii; see draw_made_grains.
WALL = 0.30  # of the ring
TIP = 0.84  # corners of the hole: tip, wings, and the notch in the open and in the closed hole
WING_U, WING_V = 0.70, -0.44
NOTCH_OPEN, NOTCH_CLOSED = -0.06, 0.58
HINGE = 0.14  # between the notch and the wedge
MOUTH = 0.30  # half width of the wedge at the rim
TOOTH_LONG, TOOTH_THICK, POCKET_GAP = 0.52, 0.13, 0.05


@kernel
def _first(place: float, low: int, high: int) -> int:
    """Index of the first pixel whose centre is at or after a finite place, within [low, high]."""
    return int(min(max(math.ceil(place - 0.5), float(low)), float(high)))


@kernel
def _sane(size: float) -> bool:
    """Is a sum of magnitudes a number that can be drawn with?

    Not isfinite: that is compiled to v - v == 0, which the flags that let the compiler reorder
    sums make true for any sum, nan or not. A comparison stays what it is.
    """
    return size < 1e12


@kernel
def _mix(under: int, over: int, share: int) -> int:
    """``share`` of 256 parts of colour ``over`` on colour ``under``."""
    rest = 256 - share
    red_blue = ((under & 0xFF00FF) * rest + (over & 0xFF00FF) * share + 0x800080) >> 8
    green = ((under & 0x00FF00) * rest + (over & 0x00FF00) * share + 0x008000) >> 8
    return (red_blue & 0xFF00FF) | (green & 0x00FF00)


@kernel
def _coverage(distance: float) -> float:
    return min(max(0.5 - distance, 0.0), 1.0)


@kernel
def _put(pixels: Pixels, row: int, column: int, colour: int, share: float) -> None:
    """Blend ``share`` in 0..1 of a colour into one pixel."""
    parts = int(share * 256.0 + 0.5)
    if parts >= 256:
        pixels[row, column] = colour
    elif parts > 0:
        pixels[row, column] = _mix(np.int64(pixels[row, column]), colour, parts)


@kernel
def _span(pixels: Pixels, row: int, first: int, last: int, colour: int, alpha: float) -> None:
    """Fill ``first <= column < last`` of a row."""
    if alpha >= 1.0:
        for column in range(first, last):
            pixels[row, column] = colour
    else:
        for column in range(first, last):
            _put(pixels, row, column, colour, alpha)


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
    share = _coverage(distance)
    if share > 0.0:
        inside = int(_coverage(distance + edge_width) * 256.0 + 0.5)
        _put(pixels, row, column, _mix(edge, fill, inside), share * alpha)


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
        if not (_sane(abs(x[i]) + abs(y[i]) + abs(p[i]) + stretch) and smallest > 1e-3):
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
        row0 = _first(cy - outer * half_height, top, bottom)
        row1 = _first(cy + outer * half_height, top, bottom)
        colour = np.int64(fill[i])
        rim = np.int64(edge[i])
        for row in range(row0, row1):
            dy = row + 0.5 - cy
            ratio = (dy / half_height) ** 2
            middle = cx - a12 / a11 * dy
            half = math.sqrt(max(outer * outer - ratio, 0.0) / a11)
            first = _first(middle - half, left, right)
            last = _first(middle + half, left, right)
            solid0 = last
            solid1 = last
            if inner * inner > ratio:
                half = math.sqrt((inner * inner - ratio) / a11)
                solid0 = _first(middle - half, first, last)
                solid1 = _first(middle + half, solid0, last)
            for column in range(first, solid0):
                _ellipse_pixel(
                    pixels, row, column, cx, cy, inverse, smallest, colour, rim, edge_width, alpha
                )
            _span(pixels, row, solid0, solid1, colour, alpha)
            for column in range(solid1, last):
                _ellipse_pixel(
                    pixels, row, column, cx, cy, inverse, smallest, colour, rim, edge_width, alpha
                )


@kernel
def _inverse(p: float, q1: float, q2: float, scale: float, turn: float) -> tuple[float, ...]:
    """Pixel offset -> unit disc -> turned: the four entries of (u, v) = m (dx, dy), row by row."""
    s11 = scale * (p + q1)
    s22 = scale * (p - q1)
    s12 = -scale * q2  # the screen's y runs down
    determinant = s11 * s22 - s12 * s12
    cosine = math.cos(turn)
    sine = math.sin(turn)
    return (
        (cosine * s22 + sine * s12) / determinant,
        (-cosine * s12 - sine * s11) / determinant,
        (sine * s22 - cosine * s12) / determinant,
        (-sine * s12 + cosine * s11) / determinant,
    )


@kernel
def _normal(x0: float, y0: float, x1: float, y1: float) -> tuple[float, float]:
    """Unit normal of a line, to the right of the way from the first point to the second."""
    dx = x1 - x0
    dy = y1 - y0
    length = math.sqrt(dx * dx + dy * dy)
    return dy / length, -dx / length


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
        sane = _sane(abs(x[i]) + abs(y[i]) + abs(p[i]) + stretch + abs(turn[i]) + abs(openness[i]))
        if not (chosen[i] and sane and smallest > 1.5):
            continue
        cx = offset_x + scale * x[i]
        cy = offset_y - scale * y[i]
        m11, m12, m21, m22 = _inverse(p[i], q1[i], q2[i], scale, turn[i])
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
        row0 = _first(cy - reach, top, bottom)
        row1 = _first(cy + reach, top, bottom)
        column0 = _first(cx - reach, left, right)
        column1 = _first(cx + reach, left, right)
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
                share = _coverage(max(end_distance, side_distance))
                if share > 0.0:
                    _put(pixels, row, column, colour, share * fade)


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
        if not (_sane(total + abs(turn[i]) + abs(openness[i])) and smallest > 1e-3):
            continue
        cx = offset_x + scale * x[i]
        cy = offset_y - scale * y[i]
        rest = scale * rest_radius[i]
        wall = WALL * rest
        i11, i12, i21, i22 = _inverse(p[i], q1[i], q2[i], scale, 0.0)
        m11, m12, m21, m22 = _inverse(p[i], q1[i], q2[i], scale, turn[i])
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
        row0 = _first(cy - outer * half_height, top, bottom)
        row1 = _first(cy + outer * half_height, top, bottom)
        for row in range(row0, row1):
            dy = row + 0.5 - cy
            ratio = (dy / half_height) ** 2
            middle = cx - a12 / a11 * dy
            half = math.sqrt(max(outer * outer - ratio, 0.0) / a11)
            first = _first(middle - half, left, right)
            last = _first(middle + half, left, right)
            empty0 = last
            empty1 = last
            if empty * empty > ratio:
                half = math.sqrt((empty * empty - ratio) / a11)
                empty0 = _first(middle - half, first, last)
                empty1 = _first(middle + half, empty0, last)
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
                share = _coverage(distance)
                if share > 0.0:
                    inside = int(_coverage(distance + edge_width) * 256.0 + 0.5)
                    _put(pixels, row, column, _mix(rim, colour, inside), share)


@kernel
def draw_lines(
    canvas: Canvas,
    ends: tuple[Floats, Floats, Floats, Floats],
    half_width: Floats,
    colour: Colours,
    alpha: Floats,
) -> None:
    """Straight lines with round ends. half_width: float64 (N,) [px]; colour: uint32 (N,);
    alpha: float64 (N,) in 0..1. A line thinner than a pixel is drawn a pixel wide and fainter.
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
        if not (_sane(abs(ax) + abs(ay) + length + abs(thick) + abs(strength)) and thick > 0.0):
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
        row0 = _first(min(ay, by) - reach, top, bottom)
        row1 = _first(max(ay, by) + reach, top, bottom)
        for row in range(row0, row1):
            dy = row + 0.5 - ay
            low = min(ax, bx) - reach
            high = max(ax, bx) + reach
            if abs(ty) > 1e-6:  # cut the row where it leaves the strip along the line
                middle = ax + dy * tx / ty
                low = max(low, middle - reach / abs(ty))
                high = min(high, middle + reach / abs(ty))
            for column in range(_first(low, left, right), _first(high, left, right)):
                dx = column + 0.5 - ax
                along = min(max(dx * tx + dy * ty, 0.0), length)
                away_x = dx - along * tx
                away_y = dy - along * ty
                distance = math.sqrt(away_x * away_x + away_y * away_y) - thick
                if distance < 0.5:
                    _put(pixels, row, column, over, _coverage(distance) * strength)


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
    if not (_sane(abs(cx) + abs(cy) + radius + half_width + alpha) and radius > 0.0):
        return
    reach = radius + half_width + 0.5
    hole = max(radius - half_width - 0.5, 0.0)
    over = np.int64(colour)
    for row in range(_first(cy - reach, top, bottom), _first(cy + reach, top, bottom)):
        dy = row + 0.5 - cy
        half = math.sqrt(max(reach * reach - dy * dy, 0.0))
        skip = math.sqrt(max(hole * hole - dy * dy, 0.0))
        first = _first(cx - half, left, right)
        last = _first(cx + half, left, right)
        empty0 = _first(cx - skip, first, last)
        empty1 = _first(cx + skip, empty0, last)
        for step in range(first, last - (empty1 - empty0)):
            column = step if step < empty0 else step + empty1 - empty0
            dx = column + 0.5 - cx
            distance = abs(math.sqrt(dx * dx + dy * dy) - radius) - half_width
            _put(pixels, row, column, over, _coverage(distance) * alpha)


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
    if count == 0 or not _sane(total):
        return
    # Below three corners the area is zero but for rounding.
    flat = count < 3 or abs(scale * scale * area) < 1e-9
    turn = 0.0 if flat else math.copysign(1.0, area)
    body = np.int64(fill)
    rim = np.int64(edge)
    reach = radius + 0.5
    for row in range(_first(y_low - reach, top, bottom), _first(y_high + reach, top, bottom)):
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
        first = _first(low, left, right)
        last = _first(high, first, right)
        plain0 = last
        plain1 = last
        if plain_high > plain_low:
            plain0 = _first(plain_low, first, last)
            plain1 = _first(plain_high, plain0, last)
        for step in range(first, last - (plain1 - plain0)):
            column = step if step < plain0 else step + plain1 - plain0
            distance = _hull_distance(corners, to_screen, turn, column + 0.5, row + 0.5) - radius
            share = _coverage(distance)
            if share > 0.0:
                inside = int(_coverage(distance + edge_width) * 256.0 + 0.5)
                _put(pixels, row, column, _mix(rim, body, inside), share * alpha)
        _span(pixels, row, plain0, plain1, body, alpha)

"""The rasteriser again, slow and plain: whole images in NumPy, one distance formula a shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.raster import made_grains

Floats = NDArray[np.float64]
Image = NDArray[np.float64]  # (height, width, 3), 0 to 255


def unpacked(pixels: NDArray[np.uint32]) -> Image:
    """0xRRGGBB -> channels."""
    return np.stack([(pixels >> shift) & 255 for shift in (16, 8, 0)], axis=-1).astype(float)


def channels(colour: int) -> Floats:
    """0xRRGGBB -> three levels."""
    return np.array([colour >> 16 & 255, colour >> 8 & 255, colour & 255], dtype=float)


def places(shape: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Coordinates of all pixel centres."""
    y, x = np.mgrid[0 : shape[0], 0 : shape[1]] + 0.5
    return x, y


def coverage(distance: Floats) -> Floats:
    """Share of a pixel at this distance from an edge."""
    return np.clip(0.5 - distance, 0.0, 1.0)


def blend(image: Image, colour: Floats, share: Floats) -> Image:
    """Colour over image."""
    return image + share[..., None] * (colour - image)


def filled(
    image: Image, distance: Floats, fill: int, edge: int, edge_width: float, alpha: float
) -> Image:
    """A shape with an outline."""
    inside = coverage(distance + edge_width)[..., None]
    colour = channels(edge) + inside * (channels(fill) - channels(edge))
    return blend(image, colour, coverage(distance) * alpha)


def ellipse_distance(
    shape: tuple[int, ...], x: float, y: float, p: float, q1: float, q2: float
) -> Floats:
    """In pixels, y down; the stretch tensor is given in world axes (y up)."""
    stretch = np.array([[p + q1, -q2], [-q2, p - q1]])
    inverse = np.linalg.inv(stretch)
    px, py = places(shape)
    offset = np.stack([px - x, py - y], axis=-1)
    u = offset @ inverse.T
    slope = np.linalg.norm(u @ inverse, axis=-1)
    reach = np.linalg.norm(u, axis=-1)
    safe = np.maximum(slope, 1e-12)
    distance: Floats = np.where(
        slope > 1e-12, reach * (reach - 1.0) / safe, -(p - np.hypot(q1, q2))
    )
    return distance


def bow_tie_distance(
    shape: tuple[int, ...],
    grain: tuple[float, float, float, float, float],
    turn: float,
    openness: float,
) -> Floats:
    """Largest distance from the four sides of each half, each measured in pixels."""
    x, y, p, q1, q2 = grain
    inverse = np.linalg.inv(np.array([[p + q1, -q2], [-q2, p - q1]]))
    cosine, sine = np.cos(turn), np.sin(turn)
    rotate = np.array([[cosine, -sine], [sine, cosine]])
    matrix = rotate @ inverse
    px, py = places(shape)
    u, v = np.moveaxis(np.stack([px - x, py - y], axis=-1) @ matrix.T, -1, 0)
    height, slit = 0.52, 0.55 / (p - np.hypot(q1, q2))
    waist, end = max(0.10 * openness, slit), max(0.46 * openness, slit)
    lean = (end - waist) / height
    worst: Floats = (np.abs(v) - height) / np.linalg.norm(matrix[1])
    for sign in (1.0, -1.0):
        normal = np.linalg.norm(matrix[0] - sign * lean * matrix[1])
        side = (np.abs(u) - lean * np.abs(v) - waist) / normal
        worst = np.where(u * v * sign > 0, np.maximum(worst, side), worst)
    return worst


def segment_distance(shape: tuple[int, ...], ax: float, ay: float, bx: float, by: float) -> Floats:
    """To the straight line from a to b."""
    px, py = places(shape)
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    along = 0.0 if square == 0 else np.clip(((px - ax) * dx + (py - ay) * dy) / square, 0, 1)
    distance: Floats = np.hypot(px - ax - along * dx, py - ay - along * dy)
    return distance


def hull_distance(shape: tuple[int, ...], corners: Floats) -> Floats:
    """Signed, to a convex polygon (or a point, or a line) given in pixels, y down."""
    px, py = places(shape)
    following = np.roll(corners, -1, axis=0)
    nearest: Floats = np.min(
        [segment_distance(shape, *a, *b) for a, b in zip(corners, following, strict=True)], axis=0
    )
    if len(corners) < 3:
        return nearest
    sides = [
        (b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0])
        for a, b in zip(corners, following, strict=True)
    ]
    inside = np.all(np.array(sides) >= 0, axis=0) | np.all(np.array(sides) <= 0, axis=0)
    signed: Floats = np.where(inside, -nearest, nearest)
    return signed


def made_share(
    shape: tuple[int, ...],
    grain: tuple[float, float, float, float, float],
    rest: float,
    turn: float,
    openness: float | None,
    fine: int = 5,
) -> Floats:
    """Share of every pixel that a made grain without a tooth covers, counted at fine x fine places.

    A ring for ``openness`` None: what a disc of the wall's thickness on the outline reaches.
    """
    x, y, p, q1, q2 = grain
    height, width = shape
    steps = (np.arange(fine) + 0.5) / fine
    py, px = (
        axis.ravel()
        for axis in np.meshgrid(
            (np.arange(height)[:, None] + steps).ravel(),
            (np.arange(width)[:, None] + steps).ravel(),
            indexing="ij",
        )
    )
    stretch = np.array([[p + q1, -q2], [-q2, p - q1]])
    offset = np.stack([px - x, py - y])
    disc = np.linalg.inv(stretch) @ offset
    covered = np.hypot(*disc) < 1.0
    if openness is None:
        around = np.linspace(0.0, 2.0 * np.pi, 361)
        outline = stretch @ np.stack([np.cos(around), np.sin(around)])
        away = np.full(px.shape, np.inf)
        for place in outline.T:
            away = np.minimum(away, np.hypot(offset[0] - place[0], offset[1] - place[1]))
        covered &= away < made_grains.WALL * rest
    else:
        cosine, sine = np.cos(turn), np.sin(turn)
        u, v = np.array([[cosine, -sine], [sine, cosine]]) @ disc
        notch = (
            made_grains.NOTCH_CLOSED
            + (made_grains.NOTCH_OPEN - made_grains.NOTCH_CLOSED) * openness
        )
        apex, mouth = notch - made_grains.HINGE, made_grains.MOUTH * openness
        a = np.abs(u) / made_grains.WING_U
        below = v < made_grains.TIP + (made_grains.WING_V - made_grains.TIP) * a
        above = v > notch + (made_grains.WING_V - notch) * a
        wedge = (v < apex) & (np.abs(u) < mouth * (apex - v) / (apex + 1.0))
        covered &= ~(below & above) & ~wedge
    counted = covered.reshape(height, fine, width, fine).mean(axis=(1, 3))
    return np.asarray(counted, dtype=np.float64)

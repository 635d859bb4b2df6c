"""Signs on buttons: drawn, not written, since no font has all of them."""

from __future__ import annotations

import numpy as np
import pygame

from sandbox.draw.painter import Painter

# Strokes through points of a square from −1 to 1, y down; four points close an area. Nothing: round.
SIGNS = {
    "−": (((-1.0, 0.0), (1.0, 0.0)),),
    "+": (((-1.0, 0.0), (1.0, 0.0)), ((0.0, -1.0), (0.0, 1.0))),
    "‹": (((0.5, -1.0), (-0.5, 0.0), (0.5, 1.0)),),
    "›": (((-0.5, -1.0), (0.5, 0.0), (-0.5, 1.0)),),
    "⌄": (((-1.0, -0.5), (0.0, 0.5), (1.0, -0.5)),),
    "×": (((-0.8, -0.8), (0.8, 0.8)), ((-0.8, 0.8), (0.8, -0.8))),
    "▶": (((-0.6, -0.9), (0.9, 0.0), (-0.6, 0.9), (-0.6, -0.9)),),
    "⏸": (((-0.5, -0.9), (-0.5, 0.9)), ((0.5, -0.9), (0.5, 0.9))),
    "⏭": (((-0.8, -0.9), (0.5, 0.0), (-0.8, 0.9), (-0.8, -0.9)), ((0.8, -0.9), (0.8, 0.9))),
    "●": (),
    "◉": (),
    "○": (),
}


def draw_sign(painter: Painter, sign: str, rect: pygame.Rect, colour: int | None = None) -> None:
    """One of the signs in the middle of a rectangle."""
    scale = painter.scale
    size = min(6.5 * scale, 0.4 * min(rect.width, rect.height))
    colour = painter.theme.text if colour is None else colour
    if not SIGNS[sign]:  # round
        if sign != "●":
            painter.ring(*rect.center, size, 2.4 * scale, colour)
        if sign != "○":
            painter.disc(*rect.center, size if sign == "●" else 0.45 * size, colour)
        return
    for strokes in SIGNS[sign]:
        points = np.array(strokes) * size + np.array(rect.center, dtype=np.float64)
        if len(strokes) == 4:  # an area
            corners = points[:3] * np.array([1.0, -1.0])
            painter.hull(corners[::-1].copy(), 0.6 * scale, colour)
        else:
            painter.polyline(points[:, 0], points[:, 1], 2.4 * scale, colour)

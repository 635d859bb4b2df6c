"""A cross on every grain that is squeezed further than a real one could be."""

from __future__ import annotations

import numpy as np
import pygame

from sandbox.draw import raster
from sandbox.draw.camera import Camera
from sandbox.draw.painter import Painter
from sandbox.draw.periodic import cell_rect
from sandbox.draw.world import places
from sandbox.session.frame import Frame

# At scale 1 [px].
LEAST, MOST = 3.5, 9.0  # half a stroke across and up: seen from the back row
SHARE = 0.4  # of the grain's mean radius, in between: hardly ever beyond the grain
WIDTH = 2.2  # of a stroke
HALO = 1.4  # of the ground around it, so that it stands out from every colour and from the chains


def draw_squeezed(painter: Painter, rect: pygame.Rect, camera: Camera, frame: Frame) -> None:
    """In the colour of the text, above the chains, which are thickest just there. Costs next to nothing where there is none."""
    squeezed = frame.squeezed
    if not squeezed.any():
        return
    index, x, y = places(frame)
    shown = squeezed[index]
    index, x, y = index[shown], x[shown], y[shown]
    arm = np.clip(
        SHARE * frame.p[index],
        LEAST * painter.scale / camera.scale,
        MOST * painter.scale / camera.scale,
    )
    ends = (
        np.concatenate([x - arm, x - arm]),
        np.concatenate([y - arm, y + arm]),
        np.concatenate([x + arm, x + arm]),
        np.concatenate([y + arm, y - arm]),
    )
    canvas = painter.canvas(cell_rect(rect, camera, frame.box), camera.transform)
    strokes = len(ends[0])
    theme, half = painter.theme, 0.5 * WIDTH * painter.scale
    for width, colour in ((half + HALO * painter.scale, theme.ground), (half, theme.text)):
        raster.draw_lines(
            canvas,
            ends,
            np.full(strokes, width),
            np.full(strokes, colour, dtype=np.uint32),
            np.ones(strokes),
        )

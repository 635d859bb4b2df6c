"""Grains and rigid bodies on the canvas."""

from __future__ import annotations

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.draw import raster
from sandbox.draw.camera import Camera
from sandbox.draw.painter import Painter, floats
from sandbox.draw.theme import AUXETIC, REGULAR, Theme, mix
from sandbox.frame import BodyShape, Frame

Floats = NDArray[np.float64]

OUTLINE = 1.5  # width on screen at scale 1 [px]
FADED = 0.35  # how far grains recede into the ground when force chains are shown
CLOSED_AREA = 0.60  # the mark has closed when a grain has shrunk to this share of its area
SPIN_FROM = 11.0  # below this mean radius on screen a radius line would only be noise [px]


def mark_openness(p: Floats, q1: Floats, q2: Floats, rest_radius: Floats) -> Floats:
    """How far the mark of an auxetic grain is open: 1 at rest or larger, 0 when well squeezed."""
    with np.errstate(divide="ignore", invalid="ignore"):
        area = (p * p - q1 * q1 - q2 * q2) / (rest_radius * rest_radius)
    return np.clip((area - CLOSED_AREA) / (1.0 - CLOSED_AREA), 0.0, 1.0)


def outline_width(painter: Painter, camera: Camera) -> float:
    """Constant on screen [px], but never so wide that it eats small grains."""
    return min(OUTLINE * painter.scale, 0.14 * camera.scale)


def grain_colours(theme: Theme, faded: bool) -> tuple[int, int, int, int]:
    """Fill and outline of regular grains, then of auxetic ones."""
    recede = FADED if faded else 0.0
    fills = [mix(kind, theme.ground, recede) for kind in (REGULAR, AUXETIC)]
    rims = [mix(mix(kind, 0x000000, 0.38), theme.ground, recede) for kind in (REGULAR, AUXETIC)]
    return fills[0], rims[0], fills[1], rims[1]


def draw_grains(
    painter: Painter, rect: pygame.Rect, camera: Camera, frame: Frame, faded: bool
) -> None:
    """All grains by kind, auxetic ones with their mark."""
    canvas = painter.canvas(rect, camera.transform)
    grains = tuple(floats(part) for part in (frame.x, frame.y, frame.p, frame.q1, frame.q2))
    auxetic = frame.auxetic
    regular_fill, regular_rim, auxetic_fill, auxetic_rim = grain_colours(painter.theme, faded)
    fill = np.where(auxetic, np.uint32(auxetic_fill), np.uint32(regular_fill))
    rim = np.where(auxetic, np.uint32(auxetic_rim), np.uint32(regular_rim))
    raster.draw_ellipses(canvas, grains, fill, rim, outline_width(painter, camera), 1.0)
    turn = np.zeros(frame.grains) if frame.spin is None else frame.spin
    if bool(auxetic.any()):
        raster.draw_bow_ties(
            canvas,
            grains,
            floats(turn),
            mark_openness(frame.p, frame.q1, frame.q2, frame.rest_radius),
            auxetic,
            painter.theme.ground,
            1.0,
        )
    if frame.spin is not None and frame.grains:
        _draw_radius_lines(painter, canvas, frame, frame.spin, rim)


def _draw_radius_lines(
    painter: Painter,
    canvas: raster.Canvas,
    frame: Frame,
    spin: Floats,
    colour: NDArray[np.uint32],
) -> None:
    """One radius a grain, turned with it; on auxetic grains only the part beside the mark."""
    cosine, sine = np.cos(spin), np.sin(spin)
    outward_x = (frame.p + frame.q1) * cosine + frame.q2 * sine
    outward_y = frame.q2 * cosine + (frame.p - frame.q1) * sine
    start = np.where(frame.auxetic, 0.55, 0.0)
    ends = (
        frame.x + start * outward_x,
        frame.y + start * outward_y,
        frame.x + 0.9 * outward_x,
        frame.y + 0.9 * outward_y,
    )
    radius = canvas[2][0] * frame.p
    shown = np.where(radius >= SPIN_FROM * 0.5, np.clip(radius / SPIN_FROM, 0.0, 1.0), 0.0)
    half_width = np.full(frame.grains, 0.8 * painter.scale)
    raster.draw_lines(canvas, ends, half_width, colour, shown)


def draw_bodies(painter: Painter, rect: pygame.Rect, camera: Camera, frame: Frame) -> None:
    """Walls first, then what moves."""
    for body in sorted(frame.bodies, key=lambda body: body.role != "wall"):
        _draw_body(painter, rect, camera, body)


def _draw_body(painter: Painter, rect: pygame.Rect, camera: Camera, body: BodyShape) -> None:
    theme = painter.theme
    colour = {"wall": theme.wall, "piston": theme.piston}.get(body.role, theme.intruder)
    edge = mix(colour, theme.text if theme.name == "dark" else 0x000000, 0.25)
    # A union of shapes: all outlines first, then all insides, so that none cuts through another.
    width = 0.0 if body.role == "wall" else outline_width(painter, camera)
    for outline in (edge, colour) if width else (colour,):
        less = width if width and outline == colour else 0.0
        for disc in body.discs:
            corners = np.array([[disc[0], disc[1]]])
            _hull(painter, rect, camera, corners, camera.scale * disc[2] - less, outline)
        for x0, y0, x1, y1, radius in body.segments:
            corners = np.array([[x0, y0], [x1, y1]])
            # A wall without thickness must still be seen.
            thick = max(camera.scale * radius, painter.scale) - less
            _hull(painter, rect, camera, corners, thick, outline)
        for polygon in body.polygons:
            painter.hull(
                polygon,
                0.0,
                colour,
                edge=edge if width else None,
                edge_width=width,
                clip=rect,
                to_screen=camera.transform,
            )


def _hull(
    painter: Painter,
    rect: pygame.Rect,
    camera: Camera,
    corners: Floats,
    radius: float,
    colour: int,
) -> None:
    if radius > 0.0:
        painter.hull(corners, radius, colour, clip=rect, to_screen=camera.transform)

"""Grains and rigid bodies on the canvas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from core.arrays import Floats
from core.squeezed import AUXETIC_AREA
from sandbox.draw import raster
from sandbox.draw.camera import Camera
from sandbox.draw.painter import Painter, floats
from sandbox.draw.periodic import cell_rect, images
from sandbox.draw.theme import EVENT, Theme, mix
from sandbox.draw.views import KIND, View
from sandbox.session.frame import BodyShape, Frame

OUTLINE = 1.5  # width on screen at scale 1 [px]
SHADOW = 0.85  # how far grains recede into the ground where the chains are all that is shown
TOOTH_FROM = 9.0  # below this radius on screen a made grain has no tooth [px]
GOLDEN = 0.6180339887498949  # multiples of it, whole parts left out, never repeat and never cluster
SPIN_FROM = 11.0  # below this mean radius on screen a radius line would only be noise [px]


@dataclass(frozen=True, slots=True)
class Look:
    """How the grains are shown: the view, its values (N,) and the top of their scale, if any."""

    view: View = KIND
    chains: bool = False  # are force chains drawn over the grains?
    values: Floats | None = None
    top: float = 1.0

    @property
    def recede(self) -> float:
        """How far the grains recede into the ground."""
        return SHADOW if self.view.only_chains else 0.0


def mark_openness(p: Floats, q1: Floats, q2: Floats, rest_radius: Floats) -> Floats:
    """How far the hole and the mark of an auxetic grain are open: 1 at rest or larger, 0 from where a real one has closed."""
    with np.errstate(all="ignore"):
        area = (p * p - q1 * q1 - q2 * q2) / (rest_radius * rest_radius)
    return np.clip((area - AUXETIC_AREA) / (1.0 - AUXETIC_AREA), 0.0, 1.0)


def outline_width(painter: Painter, camera: Camera) -> float:
    """Constant on screen [px], but never so wide that it eats small grains."""
    return min(OUTLINE * painter.scale, 0.14 * camera.scale)


def grain_colours(theme: Theme, recede: float) -> tuple[int, int, int, int]:
    """Fill and outline of regular grains, then of auxetic ones; ``recede`` in 0..1."""
    kinds = theme.regular, theme.auxetic
    fills = [mix(kind, theme.ground, recede) for kind in kinds]
    rims = [mix(mix(kind, 0x000000, 0.38), theme.ground, recede) for kind in kinds]
    return fills[0], rims[0], fills[1], rims[1]


def draw_grains(
    painter: Painter,
    rect: pygame.Rect,
    camera: Camera,
    frame: Frame,
    look: Look,
) -> None:
    """All grains, auxetic ones with their mark, and those pointed at with a bright rim."""
    index, x, y = places(frame)
    if not index.size:
        return
    canvas = painter.canvas(cell_rect(rect, camera, frame.box), camera.transform)
    p, q1, q2, rest = (
        floats(part[index]) for part in (frame.p, frame.q1, frame.q2, frame.rest_radius)
    )
    grains = (x, y, p, q1, q2)
    auxetic = frame.auxetic[index]
    fill, rim = (part[index] for part in _colours(painter.theme, frame, look))
    width = outline_width(painter, camera)
    turn = np.zeros(index.size) if frame.spin is None else floats(frame.spin[index])
    openness = mark_openness(p, q1, q2, rest)
    made = look.view.made

    def draw(some: NDArray[np.intp] | slice, edge: NDArray[np.uint32], edge_width: float) -> None:
        x, y, p, q1, q2 = (part[some] for part in grains)
        chosen = (x, y, p, q1, q2)
        if made:
            raster.draw_made_grains(
                canvas,
                chosen,
                rest[some],
                (turn + made_angle(frame.label[index]))[some],
                openness[some],
                auxetic[some],
                (fill[some], edge),
                edge_width,
                TOOTH_FROM * painter.scale,
            )
        else:
            raster.draw_ellipses(canvas, chosen, fill[some], edge, edge_width, 1.0)

    draw(slice(None), rim, 0.5 * width if made else width)
    if frame.highlight is not None:
        pointed_at = np.flatnonzero(frame.highlight[index])
        draw(pointed_at, np.full(pointed_at.size, EVENT, dtype=np.uint32), 2.2 * width)
    if not made and bool(auxetic.any()):
        ground = painter.theme.ground
        raster.draw_bow_ties(canvas, grains, turn, openness, auxetic, ground, 1.0)
    if frame.spin is not None:
        inner = 1.0 - 0.8 * raster.WALL
        start: Floats = np.full(index.size, inner) if made else np.where(auxetic, 0.55, 0.0)
        # The hole of an auxetic grain turns with it.
        visible = ~auxetic if made else np.ones(index.size, dtype=np.bool_)
        _draw_radius_lines(painter, canvas, grains, start, visible, turn, rim)


def _colours(
    theme: Theme, frame: Frame, look: Look
) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
    """Fill and rim of every grain, uint32 (N,)."""
    if look.values is not None:
        fill = look.view.colours(theme, look.values, look.top)
        return fill, np.full(frame.grains, mix(theme.hairline, theme.text, 0.25), dtype=np.uint32)
    regular_fill, regular_rim, auxetic_fill, auxetic_rim = grain_colours(theme, look.recede)
    auxetic = frame.auxetic
    return (
        np.where(auxetic, np.uint32(auxetic_fill), np.uint32(regular_fill)),
        np.where(auxetic, np.uint32(auxetic_rim), np.uint32(regular_rim)),
    )


def made_angle(label: NDArray[np.int64]) -> Floats:
    """The direction in which each made grain lies: fixed by its label, and without an order [rad]."""
    angle: Floats = 2.0 * np.pi * np.modf(GOLDEN * label)[0]
    return angle


def places(frame: Frame) -> tuple[NDArray[np.intp], Floats, Floats]:
    """Which grains are drawn where: each once, and in a periodic cell their images too."""
    if frame.box is None:
        return np.arange(frame.grains), floats(frame.x), floats(frame.y)
    reach = frame.p + np.hypot(frame.q1, frame.q2)
    x, y = frame.x, frame.y
    index, move_x, move_y = images(frame.box, x - reach, y - reach, x + reach, y + reach)
    return index, x[index] + move_x, y[index] + move_y


def _draw_radius_lines(
    painter: Painter,
    canvas: raster.Canvas,
    grains: raster.Grains,
    start: Floats,
    visible: NDArray[np.bool_],
    turn: Floats,
    colour: NDArray[np.uint32],
) -> None:
    """One radius a grain, turned with it; from ``start`` radii, beside the mark, outwards."""
    x, y, p, q1, q2 = grains
    cosine, sine = np.cos(turn), np.sin(turn)
    outward_x = (p + q1) * cosine + q2 * sine
    outward_y = q2 * cosine + (p - q1) * sine
    ends = (
        x + start * outward_x,
        y + start * outward_y,
        x + 0.9 * outward_x,
        y + 0.9 * outward_y,
    )
    radius = canvas[2][0] * p
    large = visible & (radius >= SPIN_FROM * 0.5)
    shown = np.where(large, np.clip(radius / SPIN_FROM, 0.0, 1.0), 0.0)
    raster.draw_lines(canvas, ends, np.full(x.size, 0.8 * painter.scale), colour, shown)


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

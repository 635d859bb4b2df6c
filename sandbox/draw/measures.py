"""Measuring tools on the canvas and on the plot: a line with its length, an angle, a cut with its force, marks on the curve."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pygame

from core.arrays import Floats
from sandbox.draw.camera import Camera
from sandbox.draw.painter import Painter
from sandbox.draw.plot import PlotBox
from sandbox.draw.text import BODY, SMALL
from sandbox.draw.widgets.look import ring_colour

Point = tuple[float, float]

KNOB = 7.0  # radius of an end that can be dragged, at scale 1 [px]
ARC = 34.0  # radius of the arc of an angle, at scale 1 [px]
CUT_DASH = (9.0, 5.0)  # at scale 1 [px]


def draw_line(
    painter: Painter,
    rect: pygame.Rect,
    camera: Camera,
    ends: Sequence[Point],
    label: str,
    *,
    dashed: bool = False,
) -> None:
    """Straight from end to end with words beside its middle."""
    places = [camera.to_screen(*end) for end in ends]
    _stroke(painter, rect, places, dashed)
    (x0, y0), (x1, y1) = places
    length = math.hypot(x1 - x0, y1 - y0) or 1.0
    # Beside the line, on its upper side.
    away = 16.0 * painter.scale
    up = math.copysign(1.0, x1 - x0) if x1 != x0 else 1.0
    _plate(
        painter,
        rect,
        0.5 * (x0 + x1) + up * (y1 - y0) / length * away,
        0.5 * (y0 + y1) - up * (x1 - x0) / length * away,
        label,
    )


def draw_angle(
    painter: Painter, rect: pygame.Rect, camera: Camera, points: Sequence[Point], label: str
) -> None:
    """Two arms from the middle one of three points, an arc between them, and words beside it."""
    places = [camera.to_screen(*point) for point in points]
    _stroke(painter, rect, places)
    (ax, ay), (x, y), (bx, by) = places
    first, second = math.atan2(ay - y, ax - x), math.atan2(by - y, bx - x)
    turn = (second - first + math.pi) % (2.0 * math.pi) - math.pi
    radius = ARC * painter.scale
    way = first + np.linspace(0.0, turn, 25)
    painter.polyline(
        x + radius * np.cos(way),
        y + radius * np.sin(way),
        2.5 * painter.scale,
        painter.theme.text,
        rect,
    )
    middle = first + 0.5 * turn
    _plate(
        painter,
        rect,
        x + 1.9 * radius * math.cos(middle),
        y + 1.9 * radius * math.sin(middle),
        label,
    )


def draw_knobs(
    painter: Painter, rect: pygame.Rect, camera: Camera, points: Sequence[Point], chosen: int | None
) -> None:
    """Ends that can be dragged; the one that the keyboard moves is ringed."""
    for index, point in enumerate(points):
        x, y = camera.to_screen(*point)
        radius = KNOB * painter.scale
        painter.disc(
            x,
            y,
            radius,
            painter.theme.text,
            edge=painter.theme.ground,
            edge_width=2.0 * painter.scale,
            clip=rect,
        )
        if chosen in (index, len(points)):
            painter.ring(
                x,
                y,
                radius + 5.0 * painter.scale,
                2.5 * painter.scale,
                ring_colour(painter.theme),
                clip=rect,
            )


def draw_crossings(
    painter: Painter, rect: pygame.Rect, camera: Camera, x: Floats, y: Floats
) -> None:
    """Where contacts cross a cut."""
    for place in zip(x.tolist(), y.tolist(), strict=True):
        painter.disc(*camera.to_screen(*place), 3.5 * painter.scale, painter.theme.text, clip=rect)


def draw_marks(
    painter: Painter,
    box: PlotBox,
    marks: tuple[float, float],
    means: Sequence[tuple[float, int]],
    chosen: int | None,
) -> None:
    """Two lines across the plot, and between them the mean of each curve, in its colour."""
    scale = painter.scale
    rect = box.rect
    for index, mark in enumerate(marks):
        x = float(box.x(mark))
        if not rect.left - 1 <= x <= rect.right + 1:
            continue
        painter.line((x, rect.top), (x, rect.bottom), 2.0 * scale, painter.theme.text, clip=rect)
        painter.disc(
            x,
            rect.top + KNOB * scale,
            KNOB * scale,
            painter.theme.text,
            edge=painter.theme.panel,
            edge_width=2.0 * scale,
        )
        if index == chosen:
            painter.ring(
                x,
                rect.top + KNOB * scale,
                (KNOB + 5.0) * scale,
                2.5 * scale,
                ring_colour(painter.theme),
            )
    ends = np.clip(box.x(np.sort(np.array(marks))), rect.left, rect.right)
    for mean, colour in means:
        if math.isfinite(mean):
            painter.polyline(ends, np.full(2, float(box.y(mean))), 2.0 * scale, colour, rect)


def _stroke(
    painter: Painter, rect: pygame.Rect, places: Sequence[Point], dashed: bool = False
) -> None:
    """A line through some places on a rim of ground colour."""
    scale = painter.scale
    x, y = (np.array(part, dtype=np.float64) for part in zip(*places, strict=True))
    painter.polyline(x, y, 6.0 * scale, painter.theme.ground, rect)
    dash = [length * scale for length in CUT_DASH] if dashed else []
    painter.polyline(x, y, 2.5 * scale, painter.theme.text, rect, dash)


def _plate(painter: Painter, rect: pygame.Rect, x: float, y: float, text: str) -> None:
    """Words on a plate, kept inside."""
    scale, type_ = painter.scale, painter.type
    size = BODY if type_.width(text, BODY, bold=True) < 0.9 * rect.width else SMALL
    plate = pygame.Rect(
        0,
        0,
        type_.width(text, size, bold=True) + round(14 * scale),
        type_.height(size) + round(6 * scale),
    )
    plate.center = (round(x), round(y))
    plate.clamp_ip(rect.inflate(-4, -4))
    painter.box(
        plate,
        painter.theme.panel,
        radius=6.0 * scale,
        edge=painter.theme.soft_text,
        edge_width=1.5 * scale,
        alpha=0.92,
    )
    painter.text(
        type_.shortened(text, size, plate.width, bold=True),
        *plate.center,
        size=size,
        bold=True,
        anchor="centre",
    )

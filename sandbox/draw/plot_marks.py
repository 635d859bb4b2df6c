"""What stands on and beside the curves: names at their ends, marks where something happened."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pygame

from sandbox.draw.event_shapes import SHAPES
from sandbox.draw.painter import Painter
from sandbox.draw.text import SMALL
from sandbox.draw.theme import EVENT, mix
from sandbox.words import words

MARK = 6.0  # half the size of an event's mark at scale 1 [px]
SWATCH = 31.0  # length of the line before a name at scale 1 [px]
LEADER = 18.0  # room for the thread from a curve's end to its name at scale 1 [px]

Label = tuple[str, bool]  # what stands at a curve's end, and is it an earlier one?
End = tuple[float, float, int, tuple[float, ...]]  # of a curve: place [px], colour and dash


def draw_mark(
    painter: Painter, x: float, y: float, kind: str, clip: pygame.Rect | None = None
) -> None:
    """The mark of an event, its middle there [px]."""
    if not math.isfinite(x + y):
        return
    size = MARK * painter.scale
    corners = np.array(SHAPES.get(kind, SHAPES["clog"])) * size + np.array([x, -y])
    dark = painter.theme.name == "dark"
    edge = painter.theme.panel if dark else mix(EVENT, 0x000000, 0.45)
    painter.hull(
        corners, 1.2 * painter.scale, EVENT, edge=edge, edge_width=1.2 * painter.scale, clip=clip
    )


def draw_events(
    painter: Painter, clip: pygame.Rect, events: Sequence[tuple[float, float, str]]
) -> None:
    """Marks on a curve at (x, y) [px]; of those that would lie on one another the latest."""
    kept: list[float] = []
    for x, y, kind in reversed(events):
        if all(abs(x - other) >= 1.6 * MARK * painter.scale for other in kept):
            kept.append(x)
            draw_mark(painter, x, y, kind, clip)


def draw_event_key(
    painter: Painter, right: float, y: float, kinds: Sequence[str], room: float
) -> float:
    """What the marks mean, at most ``room`` wide [px]; returns where it begins."""
    scale, type_ = painter.scale, painter.type
    x = right
    for kind in reversed([kind for kind in SHAPES if kind in kinds]):
        name = words.EVENTS.get(kind, kind)
        width = type_.width(name, SMALL) + round(26 * scale)
        if right - (x - width) > room:
            break
        x -= width
        draw_mark(painter, x + MARK * scale, y, kind)
        place = x + (2.0 * MARK + 6.0) * scale
        painter.text(name, place, y, size=SMALL, colour=painter.theme.soft_text)
    return x


def names_width(painter: Painter, labels: Sequence[Label], most: float) -> int:
    """Room for the names beside the curves [px]."""
    if not labels:
        return 0
    scale = painter.scale
    widest = max(_width(painter, label) for label in labels)
    extra = (LEADER + SWATCH + 8.0) * scale
    return round(min(widest + extra, most))


def draw_names(
    painter: Painter,
    box: pygame.Rect,
    right: float,
    labels: Sequence[Label],
    ends: Sequence[End],
) -> None:
    """A name beside each curve's end, moved up or down so that none lies on another.

    Where there is no room for all, those that come first are named.
    """
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    line = type_.height(SMALL) + round(scale)
    top = box.top + 0.3 * line  # clear of the headline
    fitting = max(min(len(labels), int((box.bottom - top) // line) + 1), 0)
    order = sorted(range(fitting), key=lambda k: ends[k][1])
    heights = spread([ends[k][1] for k in order], line, top, box.bottom)
    for k, y in zip(order, heights, strict=True):
        text, earlier = labels[k]
        end_x, end_y, colour, dash = ends[k]
        x = box.right + LEADER * scale
        thread = theme.hairline
        painter.line((end_x, end_y), (box.right, end_y), 1.0 * scale, thread)
        painter.line((box.right, end_y), (x - 4.0 * scale, y), 1.0 * scale, thread)
        ends_x = np.array([x, x + SWATCH * scale])
        pattern = [length * scale for length in dash]
        width = (1.6 if earlier else 2.6) * scale
        painter.polyline(ends_x, np.array([y, y]), width, colour, dash=pattern)
        x += (SWATCH + 8.0) * scale
        shown = type_.elided(text, SMALL, right - x, bold=not earlier)
        tint = theme.soft_text if earlier else theme.text
        painter.text(shown, x, y, size=SMALL, colour=tint, bold=not earlier)


def spread(wanted: Sequence[float], least: float, low: float, high: float) -> list[float]:
    """Heights near the wanted ones (ascending), at least so far apart and within [low, high] as far as they fit."""
    places: list[float] = []
    for y in wanted:
        bound = places[-1] + least if places else low
        places.append(max(y, bound))
    limit = high
    for k in reversed(range(len(places))):
        places[k] = min(places[k], limit)
        limit = places[k] - least
    return places


def _width(painter: Painter, label: Label) -> int:
    return painter.type.width(label[0], SMALL, bold=not label[1])

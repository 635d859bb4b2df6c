"""A curve that a person expects, over the plot: drawn before it is measured, compared with it after."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import pygame

from core.arrays import Floats
from sandbox.draw.painter import Painter
from sandbox.draw.plot import Axes, PlotBox
from sandbox.draw.text import SMALL
from sandbox.draw.theme import HAND
from sandbox.draw.widgets.look import draw_ring, ring_colour
from sandbox.words import words

COLUMNS = 65  # values along the axis
DASH = (9.0, 5.0)  # at scale 1 [px]
SWATCH = 31.0  # length of a line in the legend at scale 1 [px]


@dataclass
class Sketch:
    """One value a column, nan where nothing was drawn. The cursor is where the keyboard is."""

    axes: Axes  # along low, high; up bottom, top
    up: Floats = field(default_factory=lambda: np.full(COLUMNS, np.nan))
    cursor: tuple[float, float] | None = None

    @property
    def along(self) -> Floats:
        """Where the columns are (COLUMNS,)."""
        return np.linspace(self.axes[0], self.axes[1], COLUMNS)

    @property
    def there(self) -> bool:
        """Has more than a point been drawn?"""
        return int(np.isfinite(self.up).sum()) > 1

    def draw_to(self, start: tuple[float, float] | None, end: tuple[float, float]) -> None:
        """A stroke from one place to the next; what was in its columns before is gone. Without a start, a point."""
        first, last = self._column(end[0] if start is None else start[0]), self._column(end[0])
        values = np.linspace(end[1] if start is None else start[1], end[1], abs(last - first) + 1)
        columns = np.linspace(first, last, abs(last - first) + 1).round().astype(int)
        self.up[columns] = values

    def runs(self) -> Iterator[tuple[Floats, Floats]]:
        """The pieces that were drawn in one."""
        drawn = np.flatnonzero(np.isfinite(self.up))
        if drawn.size:
            for piece in np.split(drawn, np.flatnonzero(np.diff(drawn) > 1) + 1):
                yield self.along[piece], self.up[piece]

    def _column(self, along: float) -> int:
        low, high = self.axes[:2]
        return round(min(max((along - low) / (high - low), 0.0), 1.0) * (COLUMNS - 1))


@dataclass(frozen=True, slots=True)
class Beside:
    """A measured curve in the legend of a sketch."""

    text: str
    colour: int
    dash: tuple[float, ...]  # at scale 1 [px]


def draw_sketch(
    painter: Painter,
    box: PlotBox,
    sketch: Sketch,
    *,
    asking: bool,
    ring: bool,
    measured: Sequence[Beside] = (),
) -> None:
    """The curve, dashed, with its name; while it is asked for a frame round the plot, and the cursor of the keyboard.

    With what was ``measured`` the names are in a legend.
    """
    scale, theme = painter.scale, painter.theme
    inside = box.rect.inflate(round(8 * scale), round(8 * scale))
    dash = [length * scale for length in DASH]
    named = False
    for along, up in sketch.runs():
        x, y = box.x(along), box.y(up)
        if along.size == 1:
            painter.disc(float(x[0]), float(y[0]), 2.5 * scale, theme.text, clip=inside)
            continue
        painter.polyline(x, y, 2.6 * scale, theme.text, inside, dash)
        if not named and not measured:
            named = True
            at = min(
                max(float(y[0]) - 11 * scale, box.rect.top + 8 * scale), box.rect.bottom - 8 * scale
            )
            painter.text(
                words.YOUR_SKETCH, float(x[0]) + 6 * scale, at, size=SMALL, colour=theme.text
            )
    if measured:
        own = Beside(words.YOUR_SKETCH, theme.text, DASH)
        _draw_legend(painter, box, [own, *measured], sketch)
    if not asking:
        return
    if ring:
        draw_ring(painter, inside)
    else:
        left, top, right, bottom = inside.left, inside.top, inside.right, inside.bottom
        x, y = np.array([left, right, right, left, left]), np.array([top, top, bottom, bottom, top])
        painter.polyline(x.astype(float), y.astype(float), 1.5 * scale, HAND)
    if sketch.cursor is not None:
        x0, y0 = float(box.x(sketch.cursor[0])), float(box.y(sketch.cursor[1]))
        colour, arm = ring_colour(theme), 9.0 * scale
        painter.line((x0 - arm, y0), (x0 + arm, y0), 2.0 * scale, colour)
        painter.line((x0, y0 - arm), (x0, y0 + arm), 2.0 * scale, colour)


def _draw_legend(painter: Painter, box: PlotBox, lines: Sequence[Beside], sketch: Sketch) -> None:
    """A line and a name each, in the upper corner where less has been drawn."""
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    pad, swatch = round(6 * scale), round(SWATCH * scale)
    line = type_.leading(SMALL)
    room = box.rect.width - 3 * pad - swatch
    texts = [type_.shortened(each.text, SMALL, room) for each in lines]
    width = max(type_.width(text, SMALL) for text in texts) + swatch + 3 * pad
    place = pygame.Rect(box.rect.left, box.rect.top, width, line * len(lines) + pad)
    drawn = np.isfinite(sketch.up)
    x, y = box.x(sketch.along[drawn]), box.y(sketch.up[drawn])
    high = y < place.bottom
    if (high & (x < place.right)).sum() > (high & (x > box.rect.right - width)).sum():
        place.right = box.rect.right
    painter.fill(place, theme.panel)
    for row, (each, text) in enumerate(zip(lines, texts, strict=True)):
        middle = place.top + pad // 2 + (row + 0.5) * line
        ends = np.array([place.left + pad, place.left + pad + swatch], dtype=np.float64)
        dash = [length * scale for length in each.dash]
        painter.polyline(ends, np.full(2, middle), 2.6 * scale, each.colour, dash=dash)
        painter.text(text, place.left + 2 * pad + swatch, middle, size=SMALL, colour=theme.text)

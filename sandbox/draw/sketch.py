"""A curve that a person expects, over the plot: drawn before it is measured, compared with it after."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from core.arrays import Floats
from sandbox.draw.painter import Painter
from sandbox.draw.plot import Axes, PlotBox
from sandbox.draw.text import SMALL
from sandbox.draw.theme import HAND
from sandbox.draw.widgets.look import draw_ring, ring_colour
from sandbox.words import words

COLUMNS = 65  # values along the axis
DASH = (9.0, 5.0)  # at scale 1 [px]


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


def draw_sketch(
    painter: Painter, box: PlotBox, sketch: Sketch, *, asking: bool, ring: bool
) -> None:
    """The curve, dashed, with its name; while it is asked for a frame round the plot, and the cursor of the keyboard."""
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
        if not named:
            named = True
            at = min(
                max(float(y[0]) - 11 * scale, box.rect.top + 8 * scale), box.rect.bottom - 8 * scale
            )
            painter.text(
                words.YOUR_SKETCH, float(x[0]) + 6 * scale, at, size=SMALL, colour=theme.text
            )
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

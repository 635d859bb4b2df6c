"""The strip under the canvases: force against stroke, one curve a packing, earlier ones faint behind them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame

from core.arrays import Floats
from sandbox.draw.numbers import FINER, are_counts, decimals_for, nice_ceiling, number, ticks
from sandbox.draw.painter import Painter
from sandbox.draw.plot_marks import draw_event_key, draw_events, draw_names, names_width
from sandbox.draw.text import BODY, SMALL
from sandbox.draw.theme import HAND, mix
from sandbox.draw.widgets.scale import shown
from sandbox.session.history import Event
from sandbox.words import words

LEAST_FORCE = 0.01  # the axis goes at least this far: it makes no show of rounding noise [k R]
WIDTH, FAINT_WIDTH = 2.2, 1.3  # of curves at scale 1 [px]
LIMIT_DASH = (2.0, 5.0)  # of the line at the strength of the hand, at scale 1 [px]
FAINT = 0.5  # how far earlier curves recede into the panel

Axes = tuple[float, float, float, float]  # along low, high; up bottom, top


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """One line of the plot."""

    stroke: Floats  # (M,) [R]
    force: Floats  # (M,) [k R]
    colour: int
    dash: tuple[float, ...] = ()  # lengths on, off at scale 1 [px]
    name: str = ""  # in the present language
    faint: bool = False  # of an earlier run
    events: tuple[Event, ...] = ()
    ahead: tuple[Floats, Floats] | None = None  # how it went on, from where it ends here


def thinned(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """The points that a curve needs on screen: of those in one pixel column the first, the lowest,
    the highest and the last, in their order. So a long curve keeps every peak."""
    if x.shape[0] < 5:
        return x, y
    column = np.floor(x)
    starts = np.flatnonzero(np.concatenate(([True], column[1:] != column[:-1])))
    if starts.shape[0] * 4 >= x.shape[0]:
        return x, y
    ends = np.concatenate((starts[1:], [x.shape[0]])) - 1
    run = np.repeat(np.arange(starts.shape[0]), ends - starts + 1)
    by_height = np.lexsort((y, run))  # within every run from the lowest to the highest
    kept = np.unique(np.concatenate((starts, by_height[starts], by_height[ends], ends)))
    return x[kept], y[kept]


def finite_part(curve: Curve) -> tuple[Floats, Floats]:
    """Stroke and force where both are numbers."""
    count = min(curve.stroke.shape[0], curve.force.shape[0])
    stroke, force = curve.stroke[:count], curve.force[:count]
    sound = np.isfinite(stroke) & np.isfinite(force)
    return stroke[sound], force[sound]


def limits(curves: Sequence[tuple[Floats, Floats]], least: Axes | None = None) -> Axes:
    """Axes that hold all curves, zero and ``least``: stroke low, high [R]; force low, high [k R]."""
    along, up = ((0.0,), (0.0,)) if least is None else ((0.0, *least[:2]), (0.0, *least[2:]))
    strokes = np.concatenate([along, *(stroke for stroke, _ in curves)])
    forces = np.concatenate([up, *(force for _, force in curves)])
    low, high = float(strokes.min()), float(strokes.max())
    if high - low <= 0.0:
        high = low + 1.0
    top = nice_ceiling(max(float(forces.max()), LEAST_FORCE), FINER)
    bottom = -nice_ceiling(float(-forces.min()), FINER) if forces.min() < -0.02 * top else 0.0
    return low, high, bottom, top


class PlotBox:
    """The inside of the axes and what maps onto it."""

    def __init__(self, rect: pygame.Rect, axes: Axes) -> None:
        self.rect = rect
        self.low, self.high, self.bottom, self.top = axes

    def x(self, stroke: Floats | float) -> Floats:
        """Pixels of strokes."""
        share = (np.asarray(stroke, dtype=np.float64) - self.low) / (self.high - self.low)
        return self.rect.left + share * self.rect.width

    def y(self, force: Floats | float) -> Floats:
        """Pixels of forces."""
        share = (np.asarray(force, dtype=np.float64) - self.bottom) / (self.top - self.bottom)
        return self.rect.bottom - share * self.rect.height

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Stroke and force at a pixel; outside, at the nearest edge."""
        along = min(max((x - self.rect.left) / self.rect.width, 0.0), 1.0)
        up = min(max((self.rect.bottom - y) / self.rect.height, 0.0), 1.0)
        return self.low + along * (self.high - self.low), self.bottom + up * (
            self.top - self.bottom
        )


def unit_of(label: str) -> str:
    """What stands in the brackets at the end of an axis' name; nothing for a pure number."""
    return label.rpartition("[")[2].removesuffix("]") if label.endswith("]") else ""


def value_digits(label: str, forces: Sequence[Floats], spread: float) -> int:
    """Decimals of a present value on an axis that long: none where things are counted."""
    return 0 if are_counts(unit_of(label), *forces) else decimals_for(spread) + 2


def draw_plot(
    painter: Painter,
    rect: pygame.Rect,
    curves: Sequence[Curve],
    label: str,
    stroke_label: str = "",
    limit: float | None = None,
    least: Axes | None = None,
) -> PlotBox | None:
    """Axes and curves. One alone has its present value in the headline; several are named at their ends.

    ``limit``: the strength of the hand, where its force is what is plotted: a line across, once the axis reaches so far.
    ``least``: axes that there are at least. Labels are in the present language already. The present curves come first,
    earlier ones after them. Returns the inside of the axes; None where there is no room for it.
    """
    if rect.height <= 0 or rect.width <= 0:
        return None
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    painter.fill(rect, theme.panel)
    painter.fill(pygame.Rect(rect.left, rect.top, rect.width, max(round(scale), 1)), theme.hairline)
    parts = [finite_part(curve) for curve in curves]
    axes = limits([*parts, *(curve.ahead for curve in curves if curve.ahead is not None)], least)
    text = type_.height(SMALL)
    pad = round(8 * scale)
    counts = are_counts(unit_of(label), *(force for _, force in parts))
    most = max(int((rect.height - 3 * text) / (1.6 * text)), 1)
    force_ticks = ticks(axes[2], axes[3], most, counts)
    if len(force_ticks) < 2 and not counts:  # one number is no scale
        force_ticks = [axes[2], axes[3]]
    force_digits = decimals_for(force_ticks[1] - force_ticks[0] if len(force_ticks) > 1 else 1.0)
    names = [number(value, force_digits) for value in force_ticks]
    gutter = max((type_.width(name, SMALL) for name in names), default=0) + 2 * pad
    digits = value_digits(label, [force for _, force in parts], axes[3] - axes[2])
    line = rect.top + pad // 2 + type_.height(BODY) // 2 + round(2 * scale)
    right = rect.right - 2 * pad
    _draw_headline(painter, rect, label, curves, digits, gutter, line)
    top = line + type_.height(BODY) // 2 + round(6 * scale)
    # Numbers of the stroke stand half a line below the axis, clear of the force axis' lowest.
    bottom = rect.bottom - text - text // 2 - round(4 * scale)
    named = [(curve, part) for curve, part in zip(curves, parts, strict=True) if part[0].size] * (
        len(curves) > 1
    )
    labels = [_label(curve, part[1], digits) for curve, part in named]
    column = names_width(painter, labels, 0.36 * rect.width)
    box = PlotBox(
        pygame.Rect(rect.left + gutter, top, right - rect.left - gutter - column, bottom - top),
        axes,
    )
    if box.rect.width < 10 or box.rect.height < 10:
        return None
    stroke_label = stroke_label or words.STROKE_AXIS
    steps = are_counts(unit_of(stroke_label), *(stroke for stroke, _ in parts))
    _draw_axes(painter, box, force_ticks, names, stroke_label, steps)
    if not any(stroke.size for stroke, _ in parts):
        painter.text(
            words.NO_CURVE, *box.rect.center, size=SMALL, colour=theme.soft_text, anchor="centre"
        )
        return box
    if limit is not None and limit <= axes[3]:
        present = [part for curve, part in zip(curves, parts, strict=True) if not curve.faint]
        _draw_limit(painter, box, limit, present)
    _draw_curves(painter, box, curves, parts)
    ends = [
        (float(box.x(part[0][-1])), float(box.y(part[1][-1])), _colour(painter, curve), curve.dash)
        for curve, part in named
    ]
    draw_names(painter, box.rect, right, labels, ends)
    return box


def _draw_headline(
    painter: Painter,
    rect: pygame.Rect,
    label: str,
    curves: Sequence[Curve],
    digits: int,
    gutter: int,
    line: int,
) -> None:
    """What is plotted at the left; at the right the present value of one alone, and as far as there is room, what marks mean."""
    type_, pad = painter.type, round(8 * painter.scale)
    left, end = rect.left + gutter, float(rect.right - 2 * pad)
    if len(curves) == 1:
        force = finite_part(curves[0])[1]
        end = _draw_value(painter, (end, line), force, digits, unit_of(label)) - 2 * pad
    kinds = [event.kind for curve in curves if not curve.faint for event in curve.events]
    room = end - left - type_.width(label, SMALL) - 3 * pad
    end = draw_event_key(painter, end, line, kinds, room)
    text = type_.shortened(label, SMALL, end - left - 2 * pad)
    painter.text(text, left, line, size=SMALL, colour=painter.theme.soft_text)


def _draw_curves(
    painter: Painter,
    box: PlotBox,
    curves: Sequence[Curve],
    parts: Sequence[tuple[Floats, Floats]],
) -> None:
    """The first one in front; present ones with a dot where they end, and marks."""
    scale = painter.scale
    inside = box.rect.inflate(round(12 * scale), round(12 * scale))
    from_behind = list(zip(curves, parts, strict=True))[::-1]
    for curve, part in from_behind:
        _draw_curve(painter, box, inside, curve, part)
    for curve, part in from_behind:
        if not curve.faint and part[0].size:
            last = float(box.x(part[0][-1])), float(box.y(part[1][-1]))
            painter.disc(*last, 6.5 * scale, painter.theme.panel, clip=inside)
            painter.disc(*last, 4.5 * scale, curve.colour, clip=inside)
            at = [(float(box.x(e.stroke)), float(box.y(e.force)), e.kind) for e in curve.events]
            draw_events(painter, inside, at)


def _draw_limit(
    painter: Painter, box: PlotBox, limit: float, curves: Sequence[tuple[Floats, Floats]]
) -> None:
    """How strong the hand is: its colour, dashed, with its name where no curve runs, if there is such a place."""
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    y = float(box.y(limit))
    ends = np.array([box.rect.left, box.rect.right], dtype=np.float64)
    dash = [length * scale for length in LIMIT_DASH]
    painter.polyline(ends, np.full(2, y), 1.6 * scale, HAND, box.rect, dash)
    text = words.HAND_LIMIT.format(strength=shown(limit))
    width, half = type_.width(text, SMALL), type_.height(SMALL) // 2 + round(2 * scale)
    pad = round(6 * scale)
    below = y - half < box.rect.top + half
    middle = y + half if below else y - half
    lefts = box.rect.left + pad, box.rect.right - pad - width

    def covered(left: float) -> bool:
        return any(
            np.any(
                (np.abs(box.x(stroke) - left - width / 2) < width / 2 + pad)
                & (np.abs(box.y(force) - middle) < half)
            )
            for stroke, force in curves
        )

    left = next((left for left in lefts if not covered(left)), lefts[0])
    painter.text(text, left, middle, size=SMALL, colour=theme.soft_text)


def _draw_value(
    painter: Painter, place: tuple[float, float], force: Floats, digits: int, unit: str
) -> float:
    """The latest force; returns where it begins [px]."""
    if not force.size:
        return place[0]
    text = f"{number(float(force[-1]), digits)} {unit}".rstrip()
    return painter.text(text, *place, size=BODY, bold=True, anchor="right").left


def _label(curve: Curve, force: Floats, digits: int) -> tuple[str, bool]:
    """What stands at a curve's end, and whether it is an earlier one."""
    if curve.faint:
        return curve.name, True
    return f"{curve.name} {number(float(force[-1]), digits)}", False


def _colour(painter: Painter, curve: Curve) -> int:
    return mix(curve.colour, painter.theme.panel, FAINT) if curve.faint else curve.colour


def _draw_curve(
    painter: Painter,
    box: PlotBox,
    inside: pygame.Rect,
    curve: Curve,
    part: tuple[Floats, Floats],
) -> None:
    scale = painter.scale
    x, y = thinned(box.x(part[0]), box.y(part[1]))
    dash = [length * scale for length in curve.dash]
    if curve.ahead is not None:
        later = thinned(box.x(curve.ahead[0]), box.y(curve.ahead[1]))
        faint = mix(curve.colour, painter.theme.panel, FAINT)
        painter.polyline(*later, FAINT_WIDTH * scale, faint, inside, dash)
    width = (FAINT_WIDTH if curve.faint else WIDTH) * scale
    painter.polyline(x, y, width, _colour(painter, curve), inside, dash)


def _draw_axes(
    painter: Painter,
    box: PlotBox,
    force_ticks: Sequence[float],
    names: Sequence[str],
    stroke_label: str,
    counts: bool,
) -> None:
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    thin = max(round(scale), 1)
    for value, name in zip(force_ticks, names, strict=True):
        y = round(float(box.y(value)))
        strong = value == 0.0
        colour = theme.soft_text if strong else theme.hairline
        painter.fill(pygame.Rect(box.rect.left, y, box.rect.width, thin), colour)
        painter.text(
            name,
            box.rect.left - round(8 * scale),
            y,
            size=SMALL,
            colour=theme.soft_text,
            anchor="right",
        )
    stroke_label = type_.shortened(stroke_label, SMALL, 0.5 * box.rect.width)
    unit = type_.width(stroke_label, SMALL)
    line = box.rect.bottom + type_.height(SMALL) + round(2 * scale)
    painter.text(
        stroke_label, box.rect.right, line, size=SMALL, colour=theme.soft_text, anchor="right"
    )
    free = box.rect.right - unit - round(14 * scale)
    widest = type_.width("0000", SMALL) * 2
    stroke_ticks = ticks(box.low, box.high, max(box.rect.width // widest, 1), counts)
    step = stroke_ticks[1] - stroke_ticks[0] if len(stroke_ticks) > 1 else 1.0
    for value in stroke_ticks:
        x = float(box.x(value))
        name = number(value, decimals_for(step))
        painter.fill(
            pygame.Rect(round(x), box.rect.bottom, thin, round(4 * scale)), theme.soft_text
        )
        if x + 0.5 * type_.width(name, SMALL) <= free:
            painter.text(name, x, line, size=SMALL, colour=theme.soft_text, anchor="centre")

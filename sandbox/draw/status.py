"""The status line (what is shown, and whether to believe it) and the header with the legend."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw import raster, words
from sandbox.draw.numbers import decimals_for, number, percent
from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, SMALL
from sandbox.draw.theme import AUXETIC, REGULAR, Theme, magnitude_colours, mix
from sandbox.frame import CONVERGED, Frame


@dataclass(frozen=True, slots=True)
class Lamp:
    """One look at the state of the computation."""

    colour: int
    state: str
    error: str  # how far the forces can be trusted; empty where that means nothing

    @property
    def words(self) -> str:
        """Both parts."""
        return f"{self.state} · {self.error}" if self.error else self.state


def lamp(frame: Frame, theme: Theme) -> Lamp:
    """Green: settled to the tolerance; amber: on the way; red: don't believe the picture."""
    if frame.stop_reason in words.BROKEN:
        return Lamp(theme.bad, words.STOPPED[frame.stop_reason], "")
    if not math.isfinite(frame.residual):
        error = words.NO_FORCES
    elif frame.residual > 1.0:
        error = words.UNKNOWN_FORCES
    else:
        error = words.FORCE_ERROR.format(error=percent(max(frame.residual, 1e-6)))
    if frame.busy:
        return Lamp(theme.working, words.SETTLING, error)
    if frame.stop_reason == CONVERGED:
        return Lamp(theme.good, words.SETTLED, error)
    reason = words.STOPPED.get(frame.stop_reason, frame.stop_reason)
    near = frame.residual <= 10.0 * frame.tolerance
    return Lamp(theme.working if near else theme.bad, reason, error)


@dataclass(frozen=True, slots=True)
class _Item:
    """A part of a line: its text, how long to keep it (low numbers first to go)."""

    text: str
    rank: int
    least: str = ""  # text whose width is reserved, so that counting moves nothing


def _width(painter: Painter, item: _Item) -> int:
    return max(painter.type.width(item.text, BODY), painter.type.width(item.least, BODY))


def draw_status(
    painter: Painter, rect: pygame.Rect, frame: Frame, *, rate: str, paused: bool
) -> None:
    """Scene · packing · seed · increment, the lamp with its words, frames a second."""
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    painter.fill(rect, theme.panel)
    painter.fill(pygame.Rect(rect.left, rect.top, rect.width, max(round(scale), 1)), theme.hairline)
    pad, gap = round(14 * scale), round(22 * scale)
    middle = rect.centery
    state = lamp(frame, theme)
    lamp_radius = 7.0 * scale
    lamp_space = round(2 * lamp_radius + 8 * scale)

    items = [
        _Item(frame.scene.replace("_", " "), 2),
        _Item(words.PACKINGS.get(frame.packing, frame.packing), 4),
        _Item(words.SEED.format(seed=frame.seed), 1),
        _Item(
            words.INCREMENT.format(increment=frame.increment),
            3,
            words.INCREMENT.format(increment="000"),
        ),
    ]
    if frame.grains_out:
        items.append(_Item(words.GRAINS_OUT.format(count=frame.grains_out), 5, "000 out"))
    if frame.protocol:
        items.append(_Item(words.DRIVE, 2))
    if paused:
        items.append(_Item(words.PAUSED, 6))
    room = rect.width - 2 * pad
    wanted = lamp_space + type_.width(state.words, BODY)
    rate_width = type_.width(rate, BODY) + gap if rate else 0
    while items and sum(_width(painter, item) + gap for item in items) + wanted + rate_width > room:
        if rate_width:
            rate_width = 0
            continue
        items.remove(min(items, key=lambda item: item.rank))

    x = rect.left + pad
    for index, item in enumerate(items):
        painter.text(item.text, x, middle, colour=theme.soft_text)
        x += _width(painter, item) + gap
        dot = x - gap // 2
        if index + 1 < len(items):
            painter.disc(dot, middle + scale, 1.6 * scale, theme.soft_text)
    painter.disc(
        x + lamp_radius,
        middle,
        lamp_radius,
        state.colour,
        edge=mix(state.colour, 0x000000, 0.3),
        edge_width=1.5 * scale,
    )
    x += lamp_space
    free = rect.right - pad - x - rate_width
    whole = type_.width(state.words, BODY) <= free
    painter.text(state.words if whole else type_.shortened(state.state, BODY, free), x, middle)
    if rate_width:
        painter.text(rate, rect.right - pad, middle, colour=theme.soft_text, anchor="right")


def draw_header(painter: Painter, rect: pygame.Rect, frame: Frame, chain_top: float | None) -> None:
    """Title at the left; at the right the kinds of grains and, with chains, the force scale."""
    if rect.height <= 0:
        return
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    painter.fill(rect, theme.panel)
    thin = max(round(scale), 1)
    painter.fill(pygame.Rect(rect.left, rect.bottom - thin, rect.width, thin), theme.hairline)
    pad, gap = round(14 * scale), round(26 * scale)
    left, right = rect.left + pad, rect.right - pad
    auxetic = int(np.count_nonzero(frame.auxetic))
    kinds = [("regular", frame.grains - auxetic), ("auxetic", auxetic)]
    present = [kind for kind, count in kinds if count]
    title = type_.width(frame.title, HEADING, bold=True) + gap
    bar = 0 if chain_top is None else _scale_bar_width(painter, chain_top) + gap
    long = _legend_width(painter, present, words.KINDS)
    short = _legend_width(painter, present, words.KINDS_SHORT)

    # What fits: whole title, legend in words, scale bar; then less of each.
    room = right - left
    names, with_bar = words.KINDS_SHORT, False
    if title + long + bar <= room:
        names, with_bar = words.KINDS, bar > 0
    elif title + short + bar <= room:
        with_bar = bar > 0
    elif title + long <= room:
        names = words.KINDS
    if with_bar and chain_top is not None:
        _draw_scale_bar(painter, right - bar + gap, rect.centery, chain_top)
        right -= bar
    width = _legend_width(painter, present, names)
    if width <= right - left:
        right -= width
        _draw_legend(painter, right, rect.centery, [(kind, names[kind]) for kind in present])
        right -= gap
    title_text = type_.shortened(frame.title, HEADING, right - left, bold=True)
    painter.text(title_text, left, rect.centery, size=HEADING, bold=True)


def _legend_width(painter: Painter, kinds: list[str], names: dict[str, str]) -> int:
    symbol, gap = round(27 * painter.scale), round(19 * painter.scale)
    return sum(painter.type.width(names[kind], BODY) + symbol + gap for kind in kinds) - gap


def _draw_legend(painter: Painter, x: float, y: float, kinds: list[tuple[str, str]]) -> None:
    """Grains as on the canvas, each with its name."""
    scale = painter.scale
    radius = 10.0 * scale
    for kind, name in kinds:
        colour = AUXETIC if kind == "auxetic" else REGULAR
        rim = mix(colour, 0x000000, 0.38)
        painter.disc(x + radius, y, radius, colour, edge=rim, edge_width=1.5 * scale)
        if kind == "auxetic":
            zero, one = np.zeros(1), np.ones(1)
            grain = ((x + radius) * one, -y * one, radius * one, zero, zero)
            marked = np.ones(1, dtype=np.bool_)
            ground = painter.theme.ground
            raster.draw_bow_ties(painter.canvas(), grain, zero, one, marked, ground, 1.0)
        painter.text(name, x + 2 * radius + 7 * scale, y)
        x += painter.type.width(name, BODY) + round(27 * scale) + round(19 * scale)


def _scale_bar_parts(top: float) -> tuple[str, str, str]:
    return words.CHAINS, "0", f"{number(top, decimals_for(0.1 * top))} {words.FORCE_UNIT}"


def _scale_bar_width(painter: Painter, top: float) -> int:
    texts = sum(painter.type.width(text, SMALL) for text in _scale_bar_parts(top))
    return texts + round((110 + 10 + 7 + 7) * painter.scale)


def _draw_scale_bar(painter: Painter, x: float, y: float, top: float) -> None:
    """A wedge: width and colour of the chains from no force to the top of the scale."""
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    name, low, high = _scale_bar_parts(top)
    painter.text(name, x, y, size=SMALL, colour=theme.soft_text)
    x += type_.width(name, SMALL) + 10 * scale
    painter.text(low, x, y, size=SMALL, colour=theme.soft_text)
    x += type_.width(low, SMALL) + 7 * scale
    length = round(110 * scale)
    places = x + np.arange(length) + 0.5
    share = (np.arange(length) + 0.5) / length
    half_height = 7.0 * scale * np.sqrt(share)
    raster.draw_lines(
        painter.canvas(),
        (places, -y - half_height, places, -y + half_height),
        np.full(length, 0.5),
        magnitude_colours(theme, share),
        np.ones(length),
    )
    painter.text(high, x + length + 7 * scale, y, size=SMALL, colour=theme.soft_text)

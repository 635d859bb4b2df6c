"""The status line: what is shown, and whether to believe it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pygame

from sandbox.draw import words
from sandbox.draw.numbers import percent
from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY
from sandbox.draw.theme import Theme, mix
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
        _Item(words.title(frame.scene, frame.scene.replace("_", " ")), 2),
        _Item(words.PACKINGS.get(frame.packing, frame.packing), 4),
        _Item(words.SEED.format(seed=frame.seed), 1),
        _Item(
            words.INCREMENT.format(increment=frame.increment),
            3,
            words.INCREMENT.format(increment="000"),
        ),
    ]
    if frame.grains_out:
        items.append(_Item(
                words.GRAINS_OUT.format(count=frame.grains_out),
                5,
                words.GRAINS_OUT.format(count="000"),
            ))
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

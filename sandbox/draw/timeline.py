"""The bar of time: the increments that are kept, the present one, and what happened when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw.event_shapes import SHAPES
from sandbox.draw.painter import Painter
from sandbox.draw.text import SMALL
from sandbox.draw.theme import EVENT, mix
from sandbox.session.history import Event
from sandbox.words import words

NEAR = 6.0  # a pointer so near an event reads it, at scale 1 [px]
THUMB = 9.0  # radius at scale 1 [px]


@dataclass(frozen=True, slots=True)
class Bar:
    """Where the bar is, and the increments along it."""

    rect: pygame.Rect
    first: int
    last: int
    now: int
    events: Sequence[Event]

    def x(self, increment: int) -> float:
        """Where an increment is [px]."""
        share = (increment - self.first) / max(self.last - self.first, 1)
        return self.rect.left + min(max(share, 0.0), 1.0) * self.rect.width

    def increment_at(self, x: float) -> int:
        """The increment under the pointer."""
        share = (x - self.rect.left) / max(self.rect.width, 1)
        return round(self.first + min(max(share, 0.0), 1.0) * (self.last - self.first))

    def event_at(self, x: float, near: float) -> Event | None:
        """The event nearest to the pointer, if it is that near [px]."""
        seen = [event for event in self.events if self.first <= event.increment <= self.last]
        best = min(seen, key=lambda event: abs(self.x(event.increment) - x), default=None)
        return best if best is not None and abs(self.x(best.increment) - x) <= near else None


def draw_bar(painter: Painter, bar: Bar, pointer: float | None) -> None:
    """The bar; with the pointer over it, in words what is there."""
    theme, scale = painter.theme, painter.scale
    middle = bar.rect.centery
    rail = mix(theme.panel, theme.text, 0.3)
    painter.line((bar.rect.left, middle), (bar.rect.right, middle), 5.0 * scale, rail)
    here = bar.x(bar.now)
    painter.line((bar.rect.left, middle), (here, middle), 5.0 * scale, theme.soft_text)
    mark = EVENT if theme.name == "dark" else mix(EVENT, 0x000000, 0.35)
    for event in bar.events:
        if bar.first <= event.increment <= bar.last:
            _draw_event(painter, bar.x(event.increment), middle, event.kind, mark)
    painter.disc(here, middle, THUMB * scale, theme.text, edge=theme.panel, edge_width=2.0 * scale)
    if pointer is None or bar.last <= bar.first:
        return
    found = bar.event_at(pointer, NEAR * scale)
    increment = bar.increment_at(pointer) if found is None else found.increment
    text = words.INCREMENT.format(increment=increment)
    if found is not None:
        text += " · " + words.say(found.text)
    draw_plate(painter, text, pointer, bar.rect.top)


def _draw_event(painter: Painter, x: float, y: float, kind: str, colour: int) -> None:
    """The mark that it has on the curve."""
    places = np.array(SHAPES[kind]) * 6.6 * painter.scale + np.array([x, -y])
    painter.hull(places, 1.5 * painter.scale, painter.theme.panel)
    painter.hull(places, 0.0, colour)


def draw_plate(painter: Painter, text: str, x: float, bottom: float) -> None:
    """A few words over what the pointer is at."""
    theme, scale, type_ = painter.theme, painter.scale, painter.type
    width = painter.surface.get_width()
    text = type_.shortened(text, SMALL, width - round(30 * scale))
    plate = pygame.Rect(
        0,
        0,
        type_.width(text, SMALL) + round(20 * scale),
        type_.height(SMALL) + round(8 * scale),
    )
    plate.midbottom = (round(x), round(bottom - 2 * scale))
    plate.clamp_ip(painter.everything)
    painter.box(plate, theme.panel, radius=6 * scale, edge=theme.soft_text, edge_width=1.5 * scale)
    painter.text(text, *plate.center, size=SMALL, anchor="centre")

"""The status line: what is shown, and whether to believe it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw.lamp import lamp, worst
from sandbox.draw.marks import marks
from sandbox.draw.numbers import percent
from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY
from sandbox.draw.theme import mix
from sandbox.session.frame import Frame
from sandbox.words import words

LAMP = 7.0  # radius at scale 1 [px]


def lamp_space(painter: Painter) -> int:
    """Width of a lamp and the gap after it [px]."""
    return round(2 * LAMP * painter.scale + 8 * painter.scale)


def draw_lamp(painter: Painter, x: float, y: float, colour: int) -> None:
    """A lamp with its left end and its middle height there."""
    radius = LAMP * painter.scale
    edge = mix(colour, 0x000000, 0.3)
    painter.disc(x + radius, y, radius, colour, edge=edge, edge_width=1.5 * painter.scale)


@dataclass(frozen=True, slots=True)
class Item:
    """A part of a line: its text, how long to keep it (low numbers first to go)."""

    text: str
    rank: int
    least: str = ""  # text whose width is reserved, so that counting moves nothing


def _width(painter: Painter, item: Item) -> int:
    return max(painter.type.width(item.text, BODY), painter.type.width(item.least, BODY))


def draw_status(
    painter: Painter, rect: pygame.Rect, frames: Sequence[Frame], *, rate: str, paused: bool
) -> None:
    """Scene · packing · seed · increment, the lamp with its words, frames a second.

    Side by side the lamp is that of the packing to be believed least.
    """
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    painter.fill(rect, theme.panel)
    painter.fill(pygame.Rect(rect.left, rect.top, rect.width, max(round(scale), 1)), theme.hairline)
    pad, gap = round(14 * scale), round(22 * scale)
    middle = rect.centery
    frame = worst(frames, theme)
    state = lamp(frame, theme)
    said = state.words
    if len(frames) > 1 and state.colour != theme.good:
        said = f"{marks(frames)[frames.index(frame)].name}: {said}"

    items_left = items(frames, paused)
    room = rect.width - 2 * pad
    wanted = lamp_space(painter) + type_.width(said, BODY)
    rate_width = type_.width(rate, BODY) + gap if rate else 0
    while (
        items_left
        and sum(_width(painter, item) + gap for item in items_left) + wanted + rate_width > room
    ):
        if rate_width:
            rate_width = 0
            continue
        items_left.remove(min(items_left, key=lambda item: item.rank))

    x = float(rect.left + pad)
    for index, item in enumerate(items_left):
        painter.text(item.text, x, middle, colour=theme.soft_text)
        x += _width(painter, item) + gap
        dot = x - gap // 2
        if index + 1 < len(items_left):
            painter.disc(dot, middle + scale, 1.6 * scale, theme.soft_text)
    draw_lamp(painter, x, middle, state.colour)
    x += lamp_space(painter)
    free = rect.right - pad - x - rate_width
    fitting = [text for text in (said, state.short) if type_.width(text, BODY) <= free]
    painter.text(fitting[0] if fitting else type_.shortened(state.state, BODY, free), x, middle)
    if rate_width:
        painter.text(rate, rect.right - pad, middle, colour=theme.soft_text, anchor="right")


def items(frames: Sequence[Frame], paused: bool) -> list[Item]:
    """What stands before the lamp."""
    frame, several = frames[0], len(frames) > 1
    packing = words.PACKINGS.get(frame.packing, frame.packing)
    if several:
        kinds = {each.packing for each in frames}
        side = words.SIDE_BY_SIDE if len(kinds) == len(frames) else words.RUNS_SIDE_BY_SIDE
        packing = side.format(count=len(frames))
    increment = max(frame.increment for frame in frames)
    one_seed = all(each.seed == frame.seed for each in frames)
    found = [
        Item(words.title(frame.scene) or frame.scene.replace("_", " "), 2),
        Item(packing, 4),
        *([Item(words.SEED.format(seed=frame.seed), 1)] if one_seed else []),
        Item(
            words.INCREMENT.format(increment=increment), 3, words.INCREMENT.format(increment="000")
        ),
    ]
    if frame.grains_out and not several:
        out = words.GRAINS_OUT
        found.append(Item(out.format(count=frame.grains_out), 5, out.format(count="000")))
    beyond = sum(int(np.count_nonzero(frame.squeezed)) for frame in frames)
    if beyond:
        squeezed = words.SQUEEZED
        found.append(Item(squeezed.format(count=beyond), 6, squeezed.format(count="00")))
    cone = max(frame.beyond_cone for frame in frames)
    if cone > 0.0:
        found.append(Item(words.BEYOND_CONE.format(share=percent(cone)), 6))
    if any(frame.protocol for frame in frames):
        found.append(Item(words.DRIVE, 2))
    if paused:
        found.append(Item(words.PAUSED, 6))
    return found

"""The header: the scene's title, and what the colours and widths on the canvas mean."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from core.arrays import Floats
from sandbox.draw import raster
from sandbox.draw.numbers import decimals_for, number
from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, SMALL
from sandbox.draw.theme import magnitude_colours, mix
from sandbox.draw.world import Look, grain_colours
from sandbox.session.frame import Frame
from sandbox.words import words

BAR, SHORT_BAR = 110.0, 60.0  # length of a scale bar at scale 1 [px]
BAR_HEIGHT = 14.0
SYMBOL = 10.0  # radius of the grains in the legend at scale 1 [px]


@dataclass(frozen=True, slots=True)
class Part:
    """One part of the legend: how wide it is [px], and how to draw it from a left end at a height."""

    width: float
    draw: Callable[[float, float], None]


def draw_header(
    painter: Painter,
    rect: pygame.Rect,
    frames: Sequence[Frame],
    look: Look,
    chain_top: float | None,
) -> None:
    """Title at the left; at the right the kinds of grains, the force scale and that of the view.

    Side by side all frames have the same scales: one header serves them all.
    """
    if rect.height <= 0:
        return
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    painter.fill(rect, theme.panel)
    thin = max(round(scale), 1)
    painter.fill(pygame.Rect(rect.left, rect.bottom - thin, rect.width, thin), theme.hairline)
    pad, gap = round(14 * scale), round(26 * scale)
    left, right = rect.left + pad, rect.right - pad
    name = words.title(frames[0].scene, frames[0].title)
    title = type_.width(name, HEADING, bold=True)

    choices, enough = _choices(painter, frames, look, chain_top)
    widths = [sum(part.width + gap for part in parts) for parts in choices]
    room = right - left
    fitting = [k for k, width in enumerate(widths[:-1]) if title + width <= room]
    # Where nothing fits beside the title, that is written smaller, beside what says enough.
    least = type_.width(name, SMALL / scale, bold=True)
    telling = range(enough, max(len(widths) - 1, enough + 1))
    fitting += [k for k in telling if least + widths[k] <= room]
    if (
        look.values is not None or look.view.only_chains
    ):  # a scale is worth more than all of a title
        fitting += [k for k in range(enough, len(widths)) if widths[k] <= room]
    x = float(right)
    if fitting:
        for part in reversed(choices[fitting[0]]):
            x -= part.width
            part.draw(x, rect.centery)
            x -= gap
    size = type_.fitting(name, HEADING, x - left, bold=True)
    shown = type_.shortened(name, size, x - left, bold=True)
    painter.text(shown, left, rect.centery, size=size, bold=True)


def _choices(
    painter: Painter, frames: Sequence[Frame], look: Look, chain_top: float | None
) -> tuple[list[list[Part]], int]:
    """What to show from left to right, best first; those from the index on say just enough."""
    long, short = (
        _kinds(painter, frames, look, names) for names in (words.KINDS, words.KINDS_SHORT)
    )
    name = _name(painter, words.VIEW.format(view=look.view.title))
    chains = [] if chain_top is None else [_chains(painter, look, chain_top, BAR)]
    if look.values is not None:
        bar, least = (_measure(painter, look, length) for length in (BAR, SHORT_BAR))
        return [[*short, *chains, bar], [*short, bar], [*chains, bar], [bar], [least], [name]], 3
    if look.view.only_chains and chain_top is not None:
        least = _chains(painter, look, chain_top, SHORT_BAR)
        return [[*long, *chains], [*short, *chains], chains, [least], [name]], 2
    full = [[*long, *chains, name], [*short, *chains, name], [*short, *chains]]
    return [*full, [*long, name], [*short, name], short], 5


def _name(painter: Painter, text: str) -> Part:
    """The view's name where there is no scale to carry it."""

    def draw(x: float, y: float) -> None:
        painter.text(text, x, y, size=SMALL, colour=painter.theme.soft_text)

    return Part(painter.type.width(text, SMALL), draw)


def _kinds(
    painter: Painter, frames: Sequence[Frame], look: Look, names: Mapping[str, str]
) -> list[Part]:
    """Grains as on the canvas, each with its name."""
    auxetic = sum(int(np.count_nonzero(frame.auxetic)) for frame in frames)
    grains = sum(frame.grains for frame in frames)
    kinds = [("regular", grains - auxetic), ("auxetic", auxetic)]
    return [_kind(painter, look, kind, names[kind]) for kind, count in kinds if count]


def _kind(painter: Painter, look: Look, kind: str, name: str) -> Part:
    scale, theme = painter.scale, painter.theme
    radius, gap = SYMBOL * scale, 7.0 * scale

    def draw(x: float, y: float) -> None:
        fills = grain_colours(theme, look.recede)  # as they are on the canvas
        colour, rim = fills[2:] if kind == "auxetic" else fills[:2]
        if look.values is not None:  # the view's colours mean something else
            colour, rim = theme.soft_text, mix(theme.soft_text, 0x000000, 0.38)
        zero, one = np.zeros(1), np.ones(1)
        marked = np.full(1, kind == "auxetic")
        grain = ((x + radius) * one, -y * one, radius * one, zero, zero)
        if look.view.made:
            painted = (np.full(1, colour, dtype=np.uint32), np.full(1, rim, dtype=np.uint32))
            raster.draw_made_grains(
                painter.canvas(), grain, radius * one, zero, one, marked, painted, float(scale), 0.0
            )
        else:
            painter.disc(x + radius, y, radius, colour, edge=rim, edge_width=1.5 * scale)
            raster.draw_bow_ties(painter.canvas(), grain, zero, one, marked, theme.panel, 1.0)
        painter.text(name, x + 2.0 * radius + gap, y)

    return Part(2.0 * radius + gap + painter.type.width(name, BODY), draw)


def _chains(painter: Painter, look: Look, top: float, length: float) -> Part:
    """A wedge: width and colour of the chains from no force to the top of the scale."""
    theme = painter.theme
    plain = look.values is not None

    def colours(share: Floats) -> NDArray[np.uint32]:
        if plain:
            return np.full(share.size, theme.text, dtype=np.uint32)
        return magnitude_colours(theme, share)

    return _bar(painter, words.CHAINS, top, words.FORCE_UNIT, length, colours, wedge=True)


def _measure(painter: Painter, look: Look, length: float) -> Part:
    """Colours of the view from nothing to the top of its scale."""

    def colours(share: Floats) -> NDArray[np.uint32]:
        return look.view.colours(painter.theme, share, 1.0)

    return _bar(painter, look.view.title, look.top, look.view.unit, length, colours, wedge=False)


def _bar(
    painter: Painter,
    name: str,
    top: float,
    unit: str,
    length: float,
    colours: Callable[[Floats], NDArray[np.uint32]],
    *,
    wedge: bool,
) -> Part:
    """A scale bar: its name, 0, the colours, and the top with its unit."""
    scale, type_, soft = painter.scale, painter.type, painter.theme.soft_text
    high = f"{number(top, decimals_for(0.1 * top))} {unit}".rstrip()
    pixels = round(length * scale)
    wide, narrow = 10.0 * scale, 7.0 * scale

    def draw(x: float, y: float) -> None:
        painter.text(name, x, y, size=SMALL, colour=soft)
        x += type_.width(name, SMALL) + wide
        painter.text("0", x, y, size=SMALL, colour=soft)
        x += type_.width("0", SMALL) + narrow
        share = (np.arange(pixels) + 0.5) / pixels
        places = round(x) + np.arange(pixels) + 0.5
        half = 0.5 * BAR_HEIGHT * scale * (np.sqrt(share) if wedge else np.ones(pixels))
        raster.draw_few_lines(
            painter.canvas(),
            (places, -y - half, places, -y + half),
            np.full(pixels, 0.5),
            colours(share),
            np.ones(pixels),
        )
        painter.text(high, x + pixels + narrow, y, size=SMALL, colour=soft)

    texts = sum(type_.width(text, SMALL) for text in (name, "0", high))
    return Part(texts + pixels + wide + 2.0 * narrow, draw)

"""The page of Explore: what is asked on the left, the map on the right: shares with intervals, or how a run of each ended."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import pygame

from sandbox.draw.numbers import number, short_number
from sandbox.draw.pages.cards import page_painter
from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, SMALL
from sandbox.draw.theme import CIVIDIS, EVENT
from sandbox.draw.widgets.look import ring_colour
from sandbox.words import words

DESIGNED = (640, 400)
# Widths of an interval from which on a cell is hatched, and how far apart [px].
UNSURE = ((0.5, 7.0), (0.3, 14.0))
LEGEND_STEPS = 64
NARROW = 1100.0  # window at scale 1, in which sentences have two lines [px]


@dataclass(frozen=True)
class MapCell:
    """A cell of the map: its place along both axes, the share that stopped with its interval, and one of its runs."""

    values: tuple[float | int, ...]
    share: float | None
    interval: tuple[float, float]
    counted: int  # runs that the share is of
    runs: int
    row: int  # of a run with the outcome that most of them have
    outcome: str


@dataclass(frozen=True)
class Line:
    """Something that can be changed: what it is, and how it is now. Of a button there is only the title."""

    name: str
    title: str
    value: str = ""


@dataclass(frozen=True)
class Shown:
    """All that the page shows."""

    title: str
    lines: Sequence[Line]
    chosen: str
    axes: tuple[str, str]  # titles, with units
    values: tuple[Sequence[float | int], Sequence[float | int]]
    cells: Sequence[MapCell]
    runs: int  # that a cell is to have
    status: str
    # How the runs of cells ended, drawn in so many pixels if they are known; None: shares are shown.
    picture: Callable[[MapCell, tuple[int, int]], pygame.Surface | None] | None = None
    pointed: tuple[float | int, ...] | None = None  # values of the cell that mouse or keys are at
    first: int = 0  # row of the run that another may be put beside


@dataclass
class ExplorePlaces:
    """Where things are [px]: lines, their arrows to the left and right, and cells by their values."""

    lines: dict[str, pygame.Rect] = field(default_factory=dict)
    arrows: dict[tuple[str, int], pygame.Rect] = field(default_factory=dict)
    cells: dict[tuple[float | int, ...], pygame.Rect] = field(default_factory=dict)


def draw_explore(painter: Painter, shown: Shown) -> ExplorePlaces:
    """The whole page. Returns where everything is."""
    painter = page_painter(painter, DESIGNED)
    scale, type_, theme = painter.scale, painter.type, painter.theme
    painter.fill(painter.everything, theme.ground)
    pad = round(16 * scale)
    places = ExplorePlaces()
    head = type_.height(HEADING, bold=True)
    room = painter.everything.width - 2 * pad
    painter.text(
        type_.shortened(shown.title, HEADING, room, bold=True),
        pad,
        pad + head // 2,
        size=HEADING,
        bold=True,
    )
    side = min(round(310 * scale), painter.everything.width * 2 // 5)
    _draw_lines(painter, shown, pygame.Rect(pad, 2 * pad + head, side, 0), places)
    lines = 2 if painter.everything.width < NARROW * scale else 1
    foot = lines * type_.height(SMALL) + pad
    box = pygame.Rect(0, 0, painter.everything.width - side - 3 * pad, 0)
    box.topleft = side + 2 * pad, 2 * pad + head
    box.height = painter.everything.height - box.top - foot
    _draw_map(painter, shown, box, lines, places)
    box.update(pad, painter.everything.bottom - foot + pad // 2, room, foot - pad)
    _draw_words(painter, shown.status, box, lines, theme.soft_text)
    painter.flush()
    return places


def _draw_lines(painter: Painter, shown: Shown, box: pygame.Rect, places: ExplorePlaces) -> None:
    scale, type_, theme = painter.scale, painter.type, painter.theme
    space = painter.everything.height - box.top - 2 * type_.height(SMALL) - round(16 * scale)
    height = min(round(34 * scale), space // max(len(shown.lines), 1))
    for place, line in enumerate(shown.lines):
        rect = pygame.Rect(box.left, box.top + place * height, box.width, height - round(4 * scale))
        on = line.name == shown.chosen
        places.lines[line.name] = rect
        painter.box(
            rect,
            theme.panel,
            radius=6.0 * scale,
            edge=ring_colour(theme) if on else theme.hairline,
            edge_width=(3.0 if on else 1.0) * scale,
        )
        inset = round(8 * scale)
        if not line.value:
            text = type_.shortened(line.title, BODY, rect.width - 2 * inset, bold=True)
            painter.text(text, *rect.center, anchor="centre", bold=True)
            continue
        middle = rect.left + rect.width * 9 // 20
        title = type_.shortened(line.title, BODY, middle - rect.left - inset)
        painter.text(title, rect.left + inset, rect.centery, colour=theme.soft_text)
        arrow = round(20 * scale)
        for way, x in ((-1, middle), (1, rect.right - arrow)):
            places.arrows[line.name, way] = pygame.Rect(x, rect.top, arrow, rect.height)
            painter.text(
                "‹" if way < 0 else "›", x + arrow // 2, rect.centery, anchor="centre", bold=True
            )
        value = type_.shortened(line.value, BODY, rect.right - middle - 2 * arrow)
        centre = (middle + rect.right) // 2
        painter.text(value, centre, rect.centery, anchor="centre")


def _draw_words(painter: Painter, text: str, box: pygame.Rect, most: int, colour: int) -> None:
    """So many lines at most, the last of them cut where there are more."""
    type_ = painter.type
    lines = type_.wrapped(text, SMALL, box.width)
    lines = [*lines[: most - 1], " ".join(lines[most - 1 :])]
    y = box.top + type_.height(SMALL) // 2
    for line in lines[:most]:
        short = type_.shortened(line, SMALL, box.width)
        painter.text(short, box.left, y, size=SMALL, colour=colour)
        y += type_.height(SMALL)


def _draw_map(
    painter: Painter, shown: Shown, box: pygame.Rect, lines: int, places: ExplorePlaces
) -> None:
    """The first axis goes to the right, the second upwards; ``lines`` for words below."""
    type_, theme, scale = painter.type, painter.theme, painter.scale
    across, up = shown.values
    line = type_.height(SMALL)
    ticks = max((type_.width(short_number(v), SMALL) for v in up), default=0) + round(8 * scale)
    grid = pygame.Rect(box.left + ticks, box.top + line + round(6 * scale), 0, 0)
    grid.size = (
        box.right - grid.left,
        box.bottom - grid.top - (2 + lines) * line - round(22 * scale),
    )
    painter.text(shown.axes[1], box.left, box.top + line // 2, size=SMALL, colour=theme.soft_text)
    known = {cell.values: cell for cell in shown.cells}
    for i, x in enumerate(across):
        left = grid.left + grid.width * i // len(across)
        right = grid.left + grid.width * (i + 1) // len(across)
        painter.text(
            short_number(x),
            (left + right) // 2,
            grid.bottom + line // 2 + 2,
            size=SMALL,
            anchor="centre",
        )
        for j, y in enumerate(up):
            top = grid.bottom - grid.height * (j + 1) // len(up)
            bottom = grid.bottom - grid.height * j // len(up)
            rect = pygame.Rect(left, top, right - left - 2, bottom - top - 2)
            places.cells[x, y] = rect
            _draw_cell(painter, known.get((x, y)), rect, shown)
            if not i:
                painter.text(short_number(y), box.left, rect.centery, size=SMALL)
    painter.flush()  # rings lie over pictures
    for values, rect in places.cells.items():
        _draw_ring(painter, known.get(values), values, rect, shown)
    title = type_.shortened(shown.axes[0], SMALL, grid.width)
    painter.text(
        title,
        grid.centerx,
        grid.bottom + line + line // 2 + 4,
        size=SMALL,
        anchor="centre",
        colour=theme.soft_text,
    )
    top = box.bottom - lines * line
    legend = pygame.Rect(grid.left, top, grid.width // 5, round(10 * scale))
    _draw_legend(painter, legend, grid.right, lines)


def _draw_ring(
    painter: Painter,
    cell: MapCell | None,
    values: tuple[float | int, ...],
    rect: pygame.Rect,
    shown: Shown,
) -> None:
    """Round the cell that is pointed at, and round that of the run that another may be put beside."""
    scale = painter.scale
    first = cell is not None and cell.row == shown.first
    if not (first or values == shown.pointed):
        return
    colour = EVENT if first else ring_colour(painter.theme)
    thick = round((4.0 if first else 3.0) * scale)
    for x, y, width, height in (
        (rect.left, rect.top, rect.width, thick),
        (rect.left, rect.bottom - thick, rect.width, thick),
        (rect.left, rect.top, thick, rect.height),
        (rect.right - thick, rect.top, thick, rect.height),
    ):
        painter.fill(pygame.Rect(x, y, width, height), colour)


def _draw_cell(painter: Painter, cell: MapCell | None, rect: pygame.Rect, shown: Shown) -> None:
    if cell is None:
        painter.fill(rect, painter.theme.panel)
        painter.text("·", *rect.center, anchor="centre", colour=painter.theme.soft_text)
    elif shown.picture is not None:
        _draw_end(painter, cell, rect, shown.picture)
    else:
        _draw_share(painter, cell, rect, shown.runs)


def _draw_share(painter: Painter, cell: MapCell, rect: pygame.Rect, runs: int) -> None:
    """The share as colour and number; the wider its interval, the closer the hatching."""
    theme, scale, type_ = painter.theme, painter.scale, painter.type
    if cell.share is None:
        painter.fill(rect, theme.panel)
        _draw_outcome(painter, cell, rect)
        return
    ground = int(CIVIDIS[round(255 * cell.share)])
    ink = 0xFFFFFF if cell.share < 0.5 else 0x000000
    painter.fill(rect, ground)
    low, high = cell.interval
    apart = next((gap for width, gap in UNSURE if high - low >= width), 0.0)
    if apart:
        x = np.arange(rect.left - rect.height, rect.right, apart * scale)
        bottom, top = (np.full(len(x), float(y)) for y in (rect.bottom, rect.top))
        painter.lines((x, bottom, x + rect.height, top), 1.0 * scale, ink, alpha=0.3, clip=rect)
    bar = _interval_place(rect, scale)
    _draw_interval(painter, cell, bar, ink)
    tall, line = type_.height(BODY, bold=True), type_.height(SMALL)
    words_below = [f"{number(low, 2)}–{number(high, 2)}"]
    if cell.runs < runs:
        words_below.append(f"{cell.runs}/{runs}")
    room = bar.top - rect.top
    fitting = max((room - tall) // line, 0)
    texts = [(number(cell.share, 2), BODY), *((text, SMALL) for text in words_below[:fitting])]
    y = rect.top + (room - tall - line * (len(texts) - 1)) // 2
    for text, size in texts:
        height = tall if size is BODY else line
        width = type_.width(text, size, size is BODY) + round(6 * scale)
        if width <= rect.width and height <= room:
            label = pygame.Rect(0, y, width, height)
            label.centerx = rect.centerx
            painter.fill(label, ground)
            painter.text(
                text,
                *label.center,
                size=size,
                anchor="centre",
                bold=size is BODY,
                colour=ink,
            )
        y += height


def _draw_outcome(painter: Painter, cell: MapCell, rect: pygame.Rect) -> None:
    """What most runs came to, where no share can be told."""
    soft, line = painter.theme.soft_text, painter.type.height(SMALL)
    type_, told = painter.type, words.OUTCOMES.get(cell.outcome, cell.outcome)
    lines = type_.wrapped(told, SMALL, rect.width)
    if len(lines) * line > rect.height or any(type_.width(t, SMALL) > rect.width for t in lines):
        lines = ["–"]
    y = rect.centery - line * (len(lines) - 1) // 2
    for text in lines:
        painter.text(text, rect.centerx, y, size=SMALL, anchor="centre", colour=soft)
        y += line


def _draw_end(
    painter: Painter,
    cell: MapCell,
    rect: pygame.Rect,
    picture: Callable[[MapCell, tuple[int, int]], pygame.Surface | None],
) -> None:
    """How one of its runs ended, over the share and its interval."""
    theme = painter.theme
    painter.fill(rect, theme.ground)
    bar = _interval_place(rect, painter.scale)
    above = pygame.Rect(rect.left, rect.top, rect.width, max(bar.top - rect.top, 1))
    found = picture(cell, above.size)
    if found is None:
        _draw_outcome(painter, cell, above)
    else:
        painter.picture(found, above.topleft)
    if cell.share is not None:
        _draw_interval(painter, cell, bar, theme.text)


def _interval_place(rect: pygame.Rect, scale: float) -> pygame.Rect:
    """At the foot of a cell."""
    height = min(round(9 * scale), rect.height // 4)
    return pygame.Rect(rect.left, rect.bottom - height, rect.width, height)


def _draw_interval(painter: Painter, cell: MapCell, place: pygame.Rect, ink: int) -> None:
    """From 0 at the left to 1 at the right: where the share may lie, and where it was found."""
    scale = painter.scale
    inset = round(5 * scale)
    left, length = place.left + inset, place.width - 2 * inset
    if length < inset or cell.share is None:
        return
    y = float(place.centery)
    low, high = (left + length * end for end in cell.interval)
    painter.line((float(left), y), (float(left + length), y), 1.0 * scale, ink, alpha=0.35)
    painter.line((low, y), (high, y), 3.0 * scale, ink)
    painter.disc(left + length * cell.share, y, 3.5 * scale, ink)


def _draw_legend(painter: Painter, bar: pygame.Rect, right: int, lines: int) -> None:
    type_ = painter.type
    for k in range(LEGEND_STEPS):
        left = bar.left + bar.width * k // LEGEND_STEPS
        end = bar.left + bar.width * (k + 1) // LEGEND_STEPS
        colour = int(CIVIDIS[255 * k // (LEGEND_STEPS - 1)])
        painter.fill(pygame.Rect(left, bar.top, end - left, bar.height), colour)
    painter.text("0", bar.left - round(12 * painter.scale), bar.centery, size=SMALL)
    x = bar.right + round(6 * painter.scale)
    painter.text("1", x, bar.centery, size=SMALL)
    x += type_.width("1   ", SMALL)
    place = pygame.Rect(x, bar.centery - type_.height(SMALL) // 2, right - x, 0)
    _draw_words(painter, words.EXPLORE_LEGEND, place, lines, painter.theme.text)

"""The page of Explore: what is asked on the left, the map on the right; wide intervals are hatched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import pygame

from sandbox.draw.pages.cards import page_painter
from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, SMALL
from sandbox.draw.theme import CIVIDIS
from sandbox.draw.widgets.look import ring_colour
from sandbox.words import words

DESIGNED = (640, 400)
# Widths of an interval from which on a cell is hatched, and how far apart [px].
UNSURE = ((0.5, 7.0), (0.3, 14.0))
LEGEND_STEPS = 64


@dataclass(frozen=True)
class MapCell:
    """A cell of the map: its place along both axes, the share that stopped, how wide its interval is, runs, and one of them."""

    values: tuple[float | int, ...]
    share: float | None
    width: float
    runs: int
    row: int


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
    foot = type_.height(SMALL) + pad
    box = pygame.Rect(0, 0, painter.everything.width - side - 3 * pad, 0)
    box.topleft = side + 2 * pad, 2 * pad + head
    box.height = painter.everything.height - box.top - foot
    _draw_map(painter, shown, box, places)
    status = type_.shortened(shown.status, SMALL, room)
    bottom = painter.everything.bottom - foot // 2
    painter.text(status, pad, bottom, size=SMALL, colour=theme.soft_text)
    painter.flush()
    return places


def _draw_lines(painter: Painter, shown: Shown, box: pygame.Rect, places: ExplorePlaces) -> None:
    scale, type_, theme = painter.scale, painter.type, painter.theme
    space = painter.everything.height - box.top - 2 * type_.height(SMALL) - round(16 * scale)
    height = min(round(34 * scale), space // max(len(shown.lines), 1))
    for number, line in enumerate(shown.lines):
        rect = pygame.Rect(
            box.left, box.top + number * height, box.width, height - round(4 * scale)
        )
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


def _draw_map(painter: Painter, shown: Shown, box: pygame.Rect, places: ExplorePlaces) -> None:
    """The first axis goes to the right, the second upwards."""
    type_, theme, scale = painter.type, painter.theme, painter.scale
    across, up = shown.values
    line = type_.height(SMALL)
    ticks = max((type_.width(f"{v:.4g}", SMALL) for v in up), default=0) + round(8 * scale)
    grid = pygame.Rect(box.left + ticks, box.top + line + round(6 * scale), 0, 0)
    grid.size = box.right - grid.left, box.bottom - grid.top - 3 * line - round(22 * scale)
    painter.text(shown.axes[1], box.left, box.top + line // 2, size=SMALL, colour=theme.soft_text)
    known = {cell.values: cell for cell in shown.cells}
    for i, x in enumerate(across):
        left = grid.left + grid.width * i // len(across)
        right = grid.left + grid.width * (i + 1) // len(across)
        painter.text(
            f"{x:.4g}",
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
            _draw_cell(painter, known.get((x, y)), rect, shown.runs)
            if not i:
                painter.text(f"{y:.4g}", box.left, rect.centery, size=SMALL)
    title = type_.shortened(shown.axes[0], SMALL, grid.width)
    painter.text(
        title,
        grid.centerx,
        grid.bottom + line + line // 2 + 4,
        size=SMALL,
        anchor="centre",
        colour=theme.soft_text,
    )
    legend = pygame.Rect(grid.left, box.bottom - line, grid.width // 4, round(10 * scale))
    _draw_legend(painter, legend, grid.right)


def _draw_cell(painter: Painter, cell: MapCell | None, rect: pygame.Rect, runs: int) -> None:
    theme, scale = painter.theme, painter.scale
    if cell is None or cell.share is None:
        painter.fill(rect, theme.panel)
        if cell is None:
            painter.text("·", *rect.center, anchor="centre", colour=theme.soft_text)
        return
    ground = int(CIVIDIS[round(255 * cell.share)])
    ink = 0xFFFFFF if cell.share < 0.5 else 0x000000
    painter.fill(rect, ground)
    apart = next((gap for width, gap in UNSURE if cell.width >= width), 0.0)
    if apart:
        for start in range(rect.left - rect.height, rect.right, round(apart * scale)):
            ends = (float(start), float(rect.bottom)), (float(start + rect.height), float(rect.top))
            painter.line(*ends, 1.0 * scale, ink, alpha=0.3, clip=rect)
    text = f"{cell.share:.2f}"
    tall = painter.type.height(BODY)
    if painter.type.width(text, BODY, True) + 6 > rect.width or tall > rect.height:
        return
    label = pygame.Rect(0, 0, painter.type.width(text, BODY, True) + round(6 * scale), tall)
    label.center = rect.center
    painter.fill(label, ground)
    painter.text(text, *rect.center, anchor="centre", bold=True, colour=ink)
    under = rect.centery + tall
    if cell.runs < runs and under + tall // 2 < rect.bottom:
        painter.text(
            f"{cell.runs}/{runs}", rect.centerx, under, size=SMALL, anchor="centre", colour=ink
        )


def _draw_legend(painter: Painter, bar: pygame.Rect, right: int) -> None:
    type_ = painter.type
    for k in range(LEGEND_STEPS):
        left = bar.left + bar.width * k // LEGEND_STEPS
        end = bar.left + bar.width * (k + 1) // LEGEND_STEPS
        colour = int(CIVIDIS[255 * k // (LEGEND_STEPS - 1)])
        painter.fill(pygame.Rect(left, bar.top, end - left, bar.height), colour)
    painter.text("0", bar.left - round(12 * painter.scale), bar.centery, size=SMALL)
    x = bar.right + round(6 * painter.scale)
    text = type_.shortened(f"1   {words.EXPLORE_LEGEND}", SMALL, right - x)
    painter.text(text, x, bar.centery, size=SMALL)

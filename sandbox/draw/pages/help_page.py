"""The page of keys: groups in as many columns as there is room for; it scrolls where even that is not enough."""

from __future__ import annotations

from dataclasses import dataclass

import pygame

from sandbox.draw.layout import SMALLEST
from sandbox.draw.pages.cards import page_painter, veil
from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, SMALL, Type
from sandbox.words import words

Group = tuple[str, list[tuple[str, str]]]

DESIGNED = (560, 420)  # the smallest window [px] that the page fits at scale 1, scrolled
MOST_COLUMNS = 3
LARGER = (
    1.3,
    1.15,
    1.0,
    0.9,
    0.8,
)  # letters of the page over those of the window, the first that fit


@dataclass(frozen=True, slots=True)
class HelpLayout:
    """Where the groups stand: their column, and their top below that of the first [px]."""

    card: pygame.Rect
    opening: pygame.Rect  # what shows of the groups
    columns: int
    column: int  # width of a column [px]
    keys: int  # of which the keys take so much [px]
    places: tuple[tuple[int, int], ...]  # (column, top) of each group
    content: int  # height of the tallest column [px]

    @property
    def most_scroll(self) -> int:
        """How far the groups can be scrolled [px]."""
        return max(self.content - self.opening.height, 0)


def help_layout(size: tuple[int, int], type_: Type, groups: list[Group]) -> HelpLayout:
    """The card in the middle of a window of that size [px], as few columns as show everything."""
    scale = type_.scale
    pad = min(round(24 * scale), size[1] // 16)
    head = type_.height(HEADING, bold=True) + round(10 * scale)
    gap = round(34 * scale)
    keys = max(type_.width(key, BODY, bold=True) for _, rows in groups for key, _ in rows)
    keys += round(16 * scale)
    widest = keys + max(type_.width(does, BODY) for _, rows in groups for _, does in rows)
    fitting = max(1, min((size[0] - 2 * pad + gap) // (widest + gap), MOST_COLUMNS, len(groups)))
    room = size[1] - 2 * pad - head
    for columns in range(1, fitting + 1):
        places, content = _distributed(type_, groups, columns)
        if content <= room:
            break
    column = min(widest, size[0] - 2 * pad)
    width = columns * column + (columns - 1) * gap + 2 * pad
    height = min(head + content + 2 * pad, size[1])
    card = pygame.Rect(0, 0, width, height)
    card.center = (size[0] // 2, size[1] // 2)
    opening = pygame.Rect(card.left + pad, card.top + pad + head, width - 2 * pad, 0)
    opening.height = card.bottom - pad - opening.top
    return HelpLayout(card, opening, columns, column, keys, places, content)


def _distributed(
    type_: Type, groups: list[Group], columns: int
) -> tuple[tuple[tuple[int, int], ...], int]:
    """Groups in order over columns, none much taller than the others; and the height of the tallest."""
    heights = [_group_height(type_, rows) for _, rows in groups]
    between = round(16 * type_.scale)
    limit = max(heights)
    while True:
        places, column, top, tallest = [], 0, 0, 0
        for height in heights:
            if top and top + height > limit:
                column, top = column + 1, 0
            places.append((column, top))
            tallest = max(tallest, top + height)
            top += height + between
        if column < columns:
            return tuple(places), tallest
        limit += max(between // 2, 1)


def _line(type_: Type) -> int:
    return type_.height(BODY) + round(4 * type_.scale)


def _group_height(type_: Type, rows: list[tuple[str, str]]) -> int:
    return type_.height(SMALL, bold=True) + round(4 * type_.scale) + len(rows) * _line(type_)


def draw_help(painter: Painter, scroll: int = 0) -> HelpLayout:
    """All keys on one page, scrolled down by so many pixels at most; returns where everything is."""
    size = painter.surface.get_size()
    groups = words.help_groups()
    # Rather smaller letters than a scroll bar, but not so small that they are hard to read.
    least = min(painter.scale, SMALLEST)
    for larger in LARGER:
        own = page_painter(painter, DESIGNED, max(larger * painter.scale, least))
        places = help_layout(size, own.type, groups)
        if not places.most_scroll:
            break
    painter = own
    theme, type_, scale = painter.theme, painter.type, painter.scale
    scroll = min(scroll, places.most_scroll)
    veil(painter)
    painter.box(
        places.card, theme.panel, radius=12.0 * scale, edge=theme.hairline, edge_width=1.5 * scale
    )
    head = places.opening.top - round(5 * scale) - type_.height(HEADING, bold=True) // 2
    painter.text(words.HELP_TITLE, places.opening.left, head, size=HEADING, bold=True)
    if places.most_scroll:
        room = places.opening.width - 2 * type_.width(words.HELP_TITLE, HEADING, bold=True)
        more = type_.shortened(words.HELP_MORE, SMALL, room)
        at = places.opening.right, head
        painter.text(more, *at, size=SMALL, colour=theme.soft_text, anchor="right")
    step = (places.opening.width - places.column) // max(places.columns - 1, 1)
    for (title, rows), (column, top) in zip(groups, places.places, strict=True):
        x = places.opening.left + column * step
        _draw_group(painter, title, rows, (x, places.opening.top + top - scroll), places)
    if places.most_scroll:
        _draw_scroll_bar(painter, places, scroll)
    painter.flush()
    return places


def _draw_group(
    painter: Painter,
    title: str,
    rows: list[tuple[str, str]],
    corner: tuple[int, int],
    places: HelpLayout,
) -> None:
    type_, theme = painter.type, painter.theme
    (x, y), line, keys = corner, _line(painter.type), places.keys
    head = type_.height(SMALL, bold=True)
    texts = [(title, x, y, head, SMALL, True, theme.soft_text)]
    y += head + round(4 * painter.scale)
    for key, meaning in rows:
        meaning = type_.shortened(meaning, BODY, places.column - keys)
        texts.append((key, x, y, line, BODY, True, theme.text))
        texts.append((meaning, x + keys, y, line, BODY, False, theme.soft_text))
        y += line
    for text, left, top, height, size, bold, colour in texts:
        if places.opening.top <= top and top + height <= places.opening.bottom + 1:
            painter.text(text, left, top + height // 2, size=size, bold=bold, colour=colour)


def _draw_scroll_bar(painter: Painter, places: HelpLayout, scroll: int) -> None:
    opening, width = places.opening, max(round(4 * painter.scale), 3)
    length = max(opening.height * opening.height // places.content, 3 * width)
    top = opening.top + (opening.height - length) * scroll // places.most_scroll
    bar = pygame.Rect(places.card.right - 2 * width, top, width, length)
    painter.box(bar, painter.theme.soft_text, radius=0.5 * width)

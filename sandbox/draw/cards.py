"""Pages drawn over the picture: the scene menu, and a message after an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pygame

from sandbox.draw import words
from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, SMALL, TITLE, Type, page_scale
from sandbox.draw.theme import HAND, mix

VEIL = 0.80  # how much of the picture behind a page is covered


@dataclass(frozen=True, slots=True)
class MenuEntry:
    """One scene in the menu."""

    name: str
    title: str
    question: str
    about: str


@dataclass(frozen=True, slots=True)
class MenuLayout:
    """Where everything in the menu is; the cards are shifted up by the scroll."""

    title: pygame.Rect
    view: pygame.Rect  # what shows of the cards
    cards: tuple[pygame.Rect, ...]  # unscrolled
    chips: tuple[pygame.Rect, ...]  # packings, with the label before the first
    foot: pygame.Rect
    content: int  # height of all cards [px]

    def scroll_to(self, index: int, scroll: int) -> int:
        """The scroll that brings a card into view, changed as little as possible."""
        if not self.cards:
            return 0
        card = self.cards[index]
        scroll = min(scroll, card.top - self.view.top)
        scroll = max(scroll, card.bottom - self.view.bottom)
        return max(0, min(scroll, self.content - self.view.height))


def menu_layout(
    size: tuple[int, int], type_: Type, entries: Sequence[MenuEntry], packings: Sequence[str]
) -> MenuLayout:
    """Divide the window: title and packings on top, cards in columns, keys at the foot."""
    width, height = size
    scale = type_.scale
    pad, gap = round(18 * scale), round(14 * scale)
    small = height < 430 * scale
    heading = HEADING if small else TITLE
    title = pygame.Rect(
        (pad, pad),
        (type_.width(words.MENU_TITLE, heading, bold=True), type_.height(heading, bold=True)),
    )
    chip_height, chip_gap = type_.height(BODY) + round(12 * scale), round(8 * scale)
    names = [words.PACKINGS.get(name, name) for name in packings]
    widths = [type_.width(name, BODY, bold=True) + round(28 * scale) for name in names]
    run = sum(widths) + chip_gap * max(len(widths) - 1, 0)
    x, y = width - pad - run, title.centery - chip_height // 2
    top = max(title.bottom, y + chip_height) + gap
    if x < title.right + gap:  # no room beside the title
        x, y = pad, title.bottom + gap // 2
        top = y + chip_height + gap
    chips = []
    for chip_width in widths:
        chips.append(pygame.Rect(x, y, chip_width, chip_height))
        x += chip_width + chip_gap
    foot_height = 0 if small else type_.height(SMALL) + gap
    foot = pygame.Rect(pad, height - foot_height - gap // 2, width - 2 * pad, foot_height)
    view = pygame.Rect(pad, top, width - 2 * pad, max(foot.top - top, 1))
    columns = max(1, min(3, len(entries), (view.width + gap) // round(360 * scale)))
    card_width = (view.width - (columns - 1) * gap) // columns
    heights = [_card_height(type_, entry, card_width) for entry in entries]
    card_height = min(max(heights, default=0), view.height)
    rows = -(-len(entries) // columns)
    content = rows * (card_height + gap) - gap
    shift = max((view.height - content) // 4, 0)  # few cards stand a little above the middle
    cards = tuple(
        pygame.Rect(
            view.left + (index % columns) * (card_width + gap),
            view.top + shift + (index // columns) * (card_height + gap),
            card_width,
            card_height,
        )
        for index in range(len(entries))
    )
    return MenuLayout(title, view, cards, tuple(chips), foot, content)


def _card_height(type_: Type, entry: MenuEntry, width: int) -> int:
    scale = type_.scale
    room = width - 2 * round(16 * scale)
    question = min(len(type_.wrapped(entry.question, BODY, room)), 3)
    about = min(len(type_.wrapped(entry.about, SMALL, room)), 3)
    lines = question * type_.height(BODY) + about * type_.height(SMALL)
    return type_.height(HEADING, bold=True) + lines + round((2 * 16 + 4 + 6 + 4) * scale)


def draw_menu(
    painter: Painter,
    entries: Sequence[MenuEntry],
    packings: Sequence[str],
    *,
    chosen: int,
    packing: str,
    scroll: int,
    notice: str = "",
) -> MenuLayout:
    """The scene menu: one card a scene, the packing as chips."""
    painter = page_painter(painter)
    theme, type_, scale = painter.theme, painter.type, painter.scale
    places = menu_layout(painter.surface.get_size(), type_, entries, packings)
    painter.fill(painter.everything, theme.ground)
    heading = HEADING if places.title.height < type_.height(TITLE, bold=True) else TITLE
    painter.text(words.MENU_TITLE, places.title.left, places.title.centery, size=heading, bold=True)
    for name, chip in zip(packings, places.chips, strict=True):
        on = name == packing
        painter.box(
            chip,
            theme.panel,
            radius=0.5 * chip.height,
            edge=HAND if on else theme.hairline,
            edge_width=(2.5 if on else 1.5) * scale,
        )
        painter.text(
            words.PACKINGS.get(name, name),
            *chip.center,
            anchor="centre",
            bold=on,
            colour=theme.text if on else theme.soft_text,
        )
    for index, (entry, card) in enumerate(zip(entries, places.cards, strict=True)):
        _draw_card(painter, entry, card.move(0, -scroll), places.view, on=index == chosen)
    if places.foot.height:
        foot = type_.shortened(notice or words.MENU_KEYS, SMALL, places.foot.width)
        painter.text(
            foot,
            places.foot.centerx,
            places.foot.centery,
            size=SMALL,
            anchor="centre",
            colour=theme.text if notice else theme.soft_text,
        )
    if places.content > places.view.height:
        _draw_scroll_bar(painter, places, scroll)
    painter.flush()
    return places


def _draw_card(
    painter: Painter, entry: MenuEntry, card: pygame.Rect, view: pygame.Rect, *, on: bool
) -> None:
    if not card.colliderect(view) or not view.contains(card):
        seen = card.clip(view)
        if seen.height < card.height // 3:
            return
    else:
        seen = card
    theme, type_, scale = painter.theme, painter.type, painter.scale
    painter.box(
        seen,
        mix(theme.panel, HAND, 0.10) if on else theme.panel,
        radius=10.0 * scale,
        edge=HAND if on else theme.hairline,
        edge_width=(3.0 if on else 1.5) * scale,
    )
    pad = round(16 * scale)
    room = card.width - 2 * pad
    y = card.top + pad
    parts = [(entry.title, HEADING, True, theme.text)]
    question = type_.wrapped(entry.question, BODY, room)
    about = type_.wrapped(entry.about, SMALL, room)
    parts += [(line, BODY, False, theme.text) for line in question]
    parts += [(line, SMALL, False, theme.soft_text) for line in about]
    for index, (text, size, bold, colour) in enumerate(parts):
        height = type_.height(size, bold)
        if y + height > card.bottom - pad // 2:
            break
        following = parts[index + 1] if index + 1 < len(parts) else None
        if following is not None and following[1] == size and not bold:
            below = y + height + type_.height(following[1])
            if below > card.bottom - pad // 2:  # the last line that fits says that more follows
                text = type_.shortened(text + " …", size, room)
        painter.text(
            type_.shortened(text, size, room, bold),
            card.left + pad,
            y + height // 2,
            size=size,
            bold=bold,
            colour=colour,
            clip=seen,
        )
        y += height
        if following is not None and following[1] != size:
            y += round((4 if bold else 6) * scale)


def _draw_scroll_bar(painter: Painter, places: MenuLayout, scroll: int) -> None:
    view = places.view
    width = max(round(4 * painter.scale), 3)
    length = max(view.height * view.height // places.content, 3 * width)
    travel = view.height - length
    top = view.top + travel * scroll // max(places.content - view.height, 1)
    bar = pygame.Rect(view.right + width, top, width, length)
    painter.box(bar, painter.theme.soft_text, radius=0.5 * width)


def page_painter(painter: Painter, designed: tuple[int, int] = (480, 360)) -> Painter:
    """A painter on the same surface whose type fits a page into it."""
    scale = page_scale(painter.scale, painter.surface.get_size(), designed)
    if scale == painter.scale:
        return painter
    painter.flush()
    return Painter(painter.surface, painter.theme, Type(scale))


def draw_error(painter: Painter, message: str) -> pygame.Rect:
    """What went wrong, in plain words, and what to do; returns the card."""
    size = painter.surface.get_size()
    painter = page_painter(painter)
    theme, type_, scale = painter.theme, painter.type, painter.scale
    pad = round(22 * scale)
    width = min(round(620 * scale), size[0] - round(16 * scale))
    room = width - 2 * pad
    body = type_.height(BODY)
    advice = type_.wrapped(words.ERROR_ADVICE, BODY, room)
    head = type_.height(HEADING, bold=True)
    space = size[1] - head - len(advice) * body - 4 * pad
    lines = type_.wrapped(message, BODY, room)[: max(space // body, 1)]
    height = min(head + (len(lines) + len(advice)) * body + 4 * pad, size[1])
    card = pygame.Rect(0, 0, width, height)
    card.center = (size[0] // 2, size[1] // 2)
    veil(painter)
    painter.box(card, theme.panel, radius=12.0 * scale, edge=theme.bad, edge_width=2.0 * scale)
    x, y = card.left + pad, card.top + pad + head // 2
    title = type_.shortened(words.ERROR_TITLE, HEADING, room, bold=True)
    painter.text(title, x, y, size=HEADING, bold=True)
    y += head // 2 + pad // 2 + body // 2
    for text in lines:
        painter.text(text, x, y)
        y += body
    y += pad // 2
    for text in advice:
        painter.text(text, x, y, colour=theme.soft_text)
        y += body
    painter.flush()
    return card


def veil(painter: Painter) -> None:
    """Cover the picture behind a page, not quite."""
    painter.box(painter.everything, painter.theme.ground, alpha=VEIL)

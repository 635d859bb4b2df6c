"""The scene menu: chips on top, where to start, a card a scene with its picture, question and one sentence."""

from __future__ import annotations

from collections.abc import Sequence

import pygame

from sandbox.draw.pages.cards import page_painter
from sandbox.draw.pages.menu_layout import (
    ABOUT_LINES,
    DISCARD,
    PAD,
    QUESTION_LINES,
    SCENE,
    START,
    TAKE_UP,
    TOUR,
    Card,
    Chip,
    Contents,
    MenuLayout,
    banner_picture,
    card_text_width,
    menu_layout,
    picture_side,
)
from sandbox.draw.pages.thumbnail import fitted
from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, SMALL, TITLE
from sandbox.draw.theme import HAND, mix
from sandbox.draw.widgets.look import ring_colour
from sandbox.words import words

DESIGNED = (480, 360)  # the smallest window [px] that the page fits at scale 1
WIDE = 1480.0  # a window of that many pixels has room for letters of scale 1
BANNER_PICTURES = ("hopper-regular", "hopper", "hopper-auxetic")


def menu_painter(painter: Painter) -> Painter:
    """A painter whose type suits the menu: larger in a wide window, smaller where it would not fit."""
    width = painter.surface.get_width()
    wanted = min(1.3 * painter.scale, max(painter.scale, width / WIDE))
    return page_painter(painter, DESIGNED, wanted)


def draw_menu(
    painter: Painter, contents: Contents, *, chosen: str, scroll: int, notice: str = ""
) -> MenuLayout:
    """The whole page; ``chosen`` has the ring. Returns where everything is."""
    painter = menu_painter(painter)
    theme, type_ = painter.theme, painter.type
    places = menu_layout(painter.surface.get_size(), type_, contents)
    scroll = min(scroll, places.most_scroll)
    painter.fill(painter.everything, theme.ground)
    for card in contents.cards:
        rect = places.scrolled[card.name].move(0, -scroll)
        _draw_card(painter, card, rect, places, on=card.name == chosen)
        if card.tour:
            name = TOUR + card.name.removeprefix(SCENE)
            place = places.scrolled[name].move(0, -scroll)
            _draw_button(painter, words.TOUR, place, places.opening, on=name == chosen, small=True)
    if contents.start:
        _draw_banner(painter, places.scrolled[START].move(0, -scroll), places, chosen == START)
    if places.strip is not None:
        _draw_strip(painter, contents.resume, places, chosen, scroll)
    _draw_frame(painter, contents, places, chosen, notice)
    if places.most_scroll:
        _draw_scroll_bar(painter, places, scroll)
    painter.flush()
    return places


def _draw_frame(
    painter: Painter, contents: Contents, places: MenuLayout, chosen: str, notice: str
) -> None:
    """Title and chips on top, keys at the foot."""
    type_, theme = painter.type, painter.theme
    heading = HEADING if places.title.height < type_.height(TITLE, bold=True) else TITLE
    title = type_.shortened(words.MENU_TITLE, heading, places.title.width, bold=True)
    painter.text(title, places.title.left, places.title.centery, size=heading, bold=True)
    for chip in contents.chips:
        _draw_chip(painter, chip, places.chips[chip.name], on=chip.name == chosen)
    if places.foot.height:
        foot = type_.shortened(notice or words.MENU_KEYS, SMALL, places.foot.width)
        colour = theme.text if notice else theme.soft_text
        painter.text(foot, *places.foot.center, size=SMALL, anchor="centre", colour=colour)


def _draw_chip(painter: Painter, chip: Chip, rect: pygame.Rect, *, on: bool) -> None:
    scale, theme = painter.scale, painter.theme
    fill = mix(theme.panel, HAND, 0.22) if chip.on else theme.panel
    edge = ring_colour(theme) if on else HAND if chip.on else theme.hairline
    painter.box(
        rect, fill, radius=0.5 * rect.height, edge=edge, edge_width=(3.0 if on else 1.5) * scale
    )
    text = painter.type.shortened(chip.text, BODY, rect.width - round(10 * scale), chip.on)
    painter.text(text, *rect.center, anchor="centre", bold=chip.on)


def _box(
    painter: Painter, rect: pygame.Rect, opening: pygame.Rect, *, on: bool
) -> pygame.Rect | None:
    """The ground of a card as far as it shows; None if nothing of it does."""
    seen = rect.clip(opening)
    if seen.height < min(rect.height // 4, painter.type.height(HEADING)):
        return None
    scale, theme = painter.scale, painter.theme
    painter.box(
        seen,
        mix(theme.panel, HAND, 0.10) if on else theme.panel,
        radius=10.0 * scale,
        edge=ring_colour(theme) if on else theme.hairline,
        edge_width=(3.0 if on else 1.5) * scale,
    )
    return seen


def _picture(painter: Painter, name: str, box: pygame.Rect, seen: pygame.Rect) -> None:
    """A thumbnail in the middle of a box, as far as it shows."""
    picture = fitted(name, painter.theme.name, *box.size)
    if picture is None:
        return
    place = picture.get_rect(center=box.center)
    part = place.clip(seen.inflate(-2, -2))
    if part.height > 0 and part.width > 0:
        painter.flush()
        painter.surface.blit(picture, part, part.move(-place.left, -place.top))


def _draw_card(
    painter: Painter, card: Card, rect: pygame.Rect, places: MenuLayout, *, on: bool
) -> None:
    seen = _box(painter, rect, places.opening, on=on)
    if seen is None:
        return
    type_, theme = painter.type, painter.theme
    pad = round(PAD * painter.scale)
    side = picture_side(type_, rect.width)
    if side and card.picture:
        box = pygame.Rect(rect.left + pad, 0, side, side)
        box.centery = rect.centery
        _picture(painter, card.picture, box, seen)
    x = rect.left + pad + (side + pad if side else 0)
    room = card_text_width(type_, rect.width, side)
    tour = places.scrolled.get(TOUR + card.name.removeprefix(SCENE))
    head = room - (tour.width if tour and not side else 0)
    size = HEADING if type_.width(card.title, HEADING, bold=True) <= head else BODY
    lines = [(type_.shortened(card.title, size, head, bold=True), size, True, theme.text)]
    question = type_.wrapped(card.question, BODY, room)
    lines += [
        (line, BODY, False, theme.text) for line in _cut(painter, question, QUESTION_LINES, room)
    ]
    about = type_.wrapped(card.about, SMALL, room)
    lines += [
        (line, SMALL, False, theme.soft_text) for line in _cut(painter, about, ABOUT_LINES, room)
    ]
    _write(painter, lines, (x, rect.top + pad), seen)


def _cut(painter: Painter, lines: list[str], most: int, room: int) -> list[str]:
    """No more lines than that; the last one says that more would follow."""
    if len(lines) <= most:
        return lines
    last = painter.type.shortened(lines[most - 1] + " …", SMALL, room)
    return [*lines[: most - 1], last if last.endswith("…") else last + "…"]


def _write(
    painter: Painter,
    lines: Sequence[tuple[str, float, bool, int]],
    corner: tuple[int, int],
    seen: pygame.Rect,
) -> None:
    """Lines under each other, (text, size, bold, colour), a little apart where the size changes; whole lines only."""
    x, y = corner
    for index, (text, size, bold, colour) in enumerate(lines):
        height = painter.type.height(size, bold)
        if seen.top <= y and y + height <= seen.bottom:
            painter.text(text, x, y + height // 2, size=size, bold=bold, colour=colour, clip=seen)
        y += height
        if index + 1 < len(lines) and lines[index + 1][1:] != (size, bold, colour):
            y += round(4 * painter.scale)


def _draw_banner(painter: Painter, rect: pygame.Rect, places: MenuLayout, on: bool) -> None:
    """Where to start: three hoppers side by side."""
    seen = _box(painter, rect, places.opening, on=on)
    if seen is None:
        return
    type_, theme = painter.type, painter.theme
    pad = round(PAD * painter.scale)
    width, height = banner_picture(type_, rect.width)
    x = rect.left + pad
    if width:
        for name in BANNER_PICTURES:
            box = pygame.Rect(x, 0, height, height)
            box.centery = rect.centery
            _picture(painter, name, box, seen)
            x += height
        x += pad
    room = rect.right - pad - x
    start = type_.shortened(words.START_HERE, SMALL, room, bold=True)
    lines = [(start, SMALL, True, theme.soft_text)]
    question = type_.wrapped(words.START_QUESTION, HEADING, room, bold=True)
    lines += [(line, HEADING, True, theme.text) for line in question]
    lines += [
        (line, BODY, False, theme.text) for line in type_.wrapped(words.START_ABOUT, BODY, room)
    ]
    tall = sum(type_.height(size, bold) for _, size, bold, _ in lines) + round(8 * painter.scale)
    _write(painter, lines, (x, rect.centery - tall // 2), seen)


def _draw_strip(painter: Painter, text: str, places: MenuLayout, chosen: str, scroll: int) -> None:
    """What was left unfinished, and what can be done about it."""
    assert places.strip is not None
    strip = places.strip.move(0, -scroll)
    seen = _box(painter, strip, places.opening, on=False)
    if seen is None:
        return
    type_, pad = painter.type, round(PAD * painter.scale)
    left = strip.right
    for name, said in ((TAKE_UP, words.TAKE_UP), (DISCARD, words.DISCARD)):
        rect = places.scrolled[name].move(0, -scroll)
        left = min(left, rect.left)
        _draw_button(painter, said, rect, places.opening, on=name == chosen)
    buttons = places.scrolled[TAKE_UP].move(0, -scroll)
    room = left - strip.left - 2 * pad
    if type_.width(text, BODY) <= room and strip.height <= buttons.height + 2 * pad:
        _write(
            painter,
            [(text, BODY, False, painter.theme.text)],
            (strip.left + pad, strip.centery - type_.height(BODY) // 2),
            seen,
        )
        return
    lines = type_.wrapped(text, BODY, strip.width - 2 * pad)
    corner = strip.left + pad, strip.top + pad // 2
    _write(painter, [(line, BODY, False, painter.theme.text) for line in lines], corner, seen)


def _draw_button(
    painter: Painter,
    text: str,
    rect: pygame.Rect,
    opening: pygame.Rect,
    *,
    on: bool,
    small: bool = False,
) -> None:
    if not opening.contains(rect):
        return
    scale, theme = painter.scale, painter.theme
    painter.box(
        rect,
        mix(theme.panel, theme.text, 0.08),
        radius=(0.5 * rect.height if small else 7.0 * scale),
        edge=ring_colour(theme) if on else theme.soft_text,
        edge_width=(3.0 if on else 1.5) * scale,
    )
    size = SMALL if small else BODY
    text = painter.type.shortened(text, size, rect.width - round(8 * scale), bold=True)
    painter.text(text, *rect.center, anchor="centre", size=size, bold=True)


def _draw_scroll_bar(painter: Painter, places: MenuLayout, scroll: int) -> None:
    opening = places.opening
    width = max(round(4 * painter.scale), 3)
    length = max(opening.height * opening.height // places.content, 3 * width)
    top = opening.top + (opening.height - length) * scroll // places.most_scroll
    bar = pygame.Rect(painter.everything.right - 2 * width, top, width, length)
    painter.box(bar, painter.theme.soft_text, radius=0.5 * width)

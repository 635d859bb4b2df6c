"""The whole panel as a picture: its controls, scrolled, and at the foot what one of them is about."""

from __future__ import annotations

import pygame

from sandbox.draw.painter import Painter
from sandbox.draw.signs import draw_sign
from sandbox.draw.text import SMALL, Type
from sandbox.draw.theme import Theme, channels
from sandbox.draw.widgets.controls import PAD, Place, Places
from sandbox.draw.widgets.look import Attention, draw_control
from sandbox.words import words

FOOT_LINES = 4  # of help, at most
SHARE = 6  # a panel is at least so many times as high as its foot


def foot_height(height: int, type_: Type) -> int:
    """What the help at the foot takes of a panel's height [px]: nothing of a low one."""
    for lines in range(FOOT_LINES, 1, -1):
        foot = lines * type_.height(SMALL) + round(16 * type_.scale)
        if height > SHARE * foot:
            return foot
    return 0


def panel_picture(
    size: tuple[int, int],
    places: Places,
    scroll: int,
    attention: Attention,
    theme: Theme,
    type_: Type,
) -> pygame.Surface:
    """A panel of that size [px], its controls moved up by the scroll."""
    width, height = size
    foot = foot_height(height, type_)
    seen = height - foot
    whole = pygame.Surface(size, 0, 32)
    whole.fill(channels(theme.panel))
    part = pygame.Surface((width, max(seen, 1)), 0, 32)
    part.fill(channels(theme.panel))
    painter = Painter(part, theme, type_)
    for place in places.all:
        moved = place.rect.move(0, -scroll)
        if moved.bottom > 0 and moved.top < seen:
            draw_control(painter, Place(place.control, moved), attention)
    _draw_scroll_bar(painter, places.height, scroll)
    painter.flush()
    whole.blit(part, (0, 0))
    painter = Painter(whole, theme, type_)
    painter.fill(pygame.Rect(0, 0, max(round(type_.scale), 1), height), theme.hairline)
    if foot:
        about = places.named(attention.hover) or places.named(attention.focus)
        said = "" if about is None else about.control.help
        _draw_foot(painter, pygame.Rect(0, seen, width, foot), said or words.PANEL_FOOT)
    painter.flush()
    return whole


def draw_tab(painter: Painter, rect: pygame.Rect) -> None:
    """What opens the panel: an arrow on a plate."""
    theme, scale = painter.theme, painter.scale
    plate = rect.inflate(-round(8 * scale), -round(8 * scale))
    painter.box(
        plate,
        theme.panel,
        radius=7.0 * scale,
        edge=theme.soft_text,
        edge_width=1.5 * scale,
        alpha=0.94,
    )
    draw_sign(painter, "‹", plate)


def _draw_scroll_bar(painter: Painter, content: int, scroll: int) -> None:
    whole = painter.everything
    if content <= whole.height:
        return
    width = max(round(4 * painter.scale), 3)
    length = max(whole.height * whole.height // content, 3 * width)
    top = (whole.height - length) * scroll // (content - whole.height)
    bar = pygame.Rect(whole.width - width - 2, top, width, length)
    painter.box(bar, painter.theme.soft_text, radius=0.5 * width)


def _draw_foot(painter: Painter, rect: pygame.Rect, text: str) -> None:
    """The help of the control under the mouse or the keyboard."""
    type_, pad = painter.type, round(PAD * painter.scale)
    thin = max(round(painter.scale), 1)
    painter.fill(pygame.Rect(rect.left, rect.top, rect.width, thin), painter.theme.hairline)
    room, line = rect.width - 2 * pad, type_.height(SMALL)
    most = (rect.height - pad) // line
    lines = type_.wrapped(text, SMALL, room)
    if len(lines) > most:
        lines = [*lines[: most - 1], type_.shortened(lines[most - 1] + " …", SMALL, room)]
    for index, each in enumerate(lines):
        y = rect.top + pad // 2 + round((index + 0.5) * line)
        painter.text(each, rect.left + pad, y, size=SMALL)

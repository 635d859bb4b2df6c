"""What pages over the picture have in common, and the one that says what went wrong."""

from __future__ import annotations

import pygame

from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, Type, page_scale
from sandbox.words import words

VEIL = 0.80  # how much of the picture behind a page is covered


def page_painter(
    painter: Painter, designed: tuple[int, int] = (480, 360), wanted: float | None = None
) -> Painter:
    """A painter on the same surface whose type fits a page into it; ``wanted``: no larger than that scale."""
    scale = page_scale(painter.scale, painter.surface.get_size(), designed)
    scale = scale if wanted is None else min(scale, wanted)
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

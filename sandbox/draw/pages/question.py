"""A small card that asks for one of a few things: a button each, with a line about it."""

from __future__ import annotations

from dataclasses import dataclass

import pygame

from sandbox.draw.pages.cards import page_painter, veil
from sandbox.draw.pages.tour_card import BUTTON, PAD, draw_button
from sandbox.draw.painter import Painter
from sandbox.draw.text import HEADING, SMALL
from sandbox.draw.theme import HAND

WIDTH = 420.0  # of the card at scale 1 [px]


@dataclass(frozen=True, slots=True)
class Asked:
    """What is asked, in the present language: a title, answers with a line about each, and how to go without."""

    title: str
    answers: tuple[tuple[str, str], ...]
    without: str


def draw_question(painter: Painter, asked: Asked, place: int) -> list[pygame.Rect]:
    """The card in the middle; the answer at ``place`` has the ring. Returns where the answers are in the window."""
    size = painter.surface.get_size()
    painter = page_painter(painter)
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    pad, tall, small = round(PAD * scale), round(BUTTON * scale), type_.height(SMALL)
    width = min(round(WIDTH * scale), size[0] - 2 * pad)
    room = width - 2 * pad
    head = type_.height(HEADING, bold=True)
    texts = [type_.wrapped(about, SMALL, room) for _, about in asked.answers]
    answers = sum(tall + pad // 2 + len(lines) * small + pad for lines in texts)
    card = pygame.Rect(0, 0, width, head + answers + small + 3 * pad)
    card.center = (size[0] // 2, size[1] // 2)
    veil(painter)
    painter.box(card, theme.panel, radius=12.0 * scale, edge=HAND, edge_width=2.0 * scale)
    x, y = card.left + pad, card.top + pad
    title = type_.shortened(asked.title, HEADING, room, bold=True)
    painter.text(title, x, y + head // 2, size=HEADING, bold=True)
    y += head + pad
    found = []
    for index, ((name, _), lines) in enumerate(zip(asked.answers, texts, strict=True)):
        found.append(pygame.Rect(x, y, room, tall))
        here = index == place
        draw_button(painter, f"{index + 1}   {name}", found[-1], strong=here, ring=here)
        y += tall + pad // 2
        for line in lines:
            painter.text(line, x, y + small // 2, size=SMALL, colour=theme.soft_text)
            y += small
        y += pad
    without = type_.shortened(asked.without, SMALL, room)
    painter.text(without, x, y + small // 2, size=SMALL, colour=theme.soft_text)
    painter.flush()
    return found

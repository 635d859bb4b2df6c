"""The card of a guided tour: what it says, what to do, why it came out so, and its buttons."""

from __future__ import annotations

from dataclasses import dataclass

import pygame

from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, Type
from sandbox.draw.theme import HAND, mix
from sandbox.draw.widgets.look import ring_colour
from sandbox.words import words

PAD = 14.0  # within the card at scale 1 [px]
BUTTON = 38.0  # height of a button at scale 1 [px]
DOT, DOT_GAP = 4.0, 14.0  # radius of a dot of progress, and from one to the next, at scale 1 [px]

NEXT, BACK, CLOSE = "tour/next", "tour/back", "tour/close"


@dataclass(frozen=True, slots=True)
class TourPage:
    """What the card shows, in the present language."""

    title: str  # of the scene
    step: int  # from 0
    steps: int
    say: str
    do: str = ""  # what a person is asked to do
    done: bool = False
    why: str = ""  # shown once it is done
    onward: str = ""  # what the button that leads on says

    @property
    def first(self) -> bool:
        """Is there nothing to go back to?"""
        return self.step == 0


@dataclass(frozen=True, slots=True)
class CardLayout:
    """Where the buttons are, and how high all of it is [px]."""

    buttons: dict[str, pygame.Rect]  # relative to the card's corner
    height: int


Line = tuple[str, float, bool, int, bool]  # text, size, bold, room above [px], is it what to do?


def card_lines(page: TourPage, type_: Type, width: int) -> list[Line]:
    """The texts, wrapped to a card of that width [px]."""
    scale = type_.scale
    room = width - 2 * round(PAD * scale)
    mark = round(22 * scale)
    gap = round(7 * scale)
    lines: list[Line] = []
    for index, line in enumerate(type_.wrapped(page.say, BODY, room)):
        lines.append((line, BODY, False, gap if index == 0 else 0, False))
    for index, line in enumerate(type_.wrapped(page.do, BODY, room - mark, bold=True)):
        lines.append((line, BODY, True, gap if index == 0 else 0, True))
    for index, line in enumerate(type_.wrapped(page.why, BODY, room)):
        lines.append((line, BODY, False, gap if index == 0 else 0, False))
    return lines


def card_layout(page: TourPage, type_: Type, width: int) -> CardLayout:
    """How high the card is at that width [px], and where its buttons are."""
    scale = type_.scale
    pad, tall = round(PAD * scale), round(BUTTON * scale)
    y = pad + type_.height(HEADING, bold=True)
    y += sum(
        type_.height(size, bold) + above
        for _, size, bold, above, _ in card_lines(page, type_, width)
    )
    y += round(10 * scale)
    onward = type_.width(page.onward, BODY, bold=True) + round(28 * scale)
    back = type_.width(words.TOUR_BACK, BODY, bold=True) + round(24 * scale)
    free = width - 2 * pad - round(8 * scale)
    onward = min(onward, free // 2)
    back = min(back, free - onward)
    buttons = {
        NEXT: pygame.Rect(width - pad - onward, y, onward, tall),
        BACK: pygame.Rect(width - pad - onward - round(8 * scale) - back, y, back, tall),
    }
    if page.first:
        del buttons[BACK]
    side = round(32 * scale)
    buttons[CLOSE] = pygame.Rect(width - side - round(6 * scale), round(6 * scale), side, side)
    return CardLayout(buttons, y + tall + pad)


def draw_tour_card(
    painter: Painter, rect: pygame.Rect, page: TourPage, *, focus: str, hover: str
) -> None:
    """The card in its place; ``focus``: the button with the ring."""
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    painter.box(
        rect, theme.panel, radius=12.0 * scale, edge=HAND, edge_width=2.0 * scale, alpha=0.97
    )
    pad = round(PAD * scale)
    head = type_.height(HEADING, bold=True)
    places = card_layout(page, type_, rect.width)
    close = places.buttons[CLOSE].move(rect.topleft)
    room = close.left - rect.left - pad - round(4 * scale)
    title = type_.shortened(page.title, HEADING, room, bold=True)
    painter.text(title, rect.left + pad, rect.top + pad + head // 2, size=HEADING, bold=True)
    y = rect.top + pad + head
    mark = round(22 * scale)
    lowest = rect.top + min(button.top for name, button in places.buttons.items() if name != CLOSE)
    marked = False
    for text, size, bold, above, task in card_lines(page, type_, rect.width):
        y += above
        height = type_.height(size, bold)
        if y + height > lowest:
            break
        if task and not marked:
            marked = True
            _draw_mark(painter, rect.left + pad, y + height // 2, page.done)
        painter.text(
            text, rect.left + pad + (mark if task else 0), y + height // 2, size=size, bold=bold
        )
        y += height
    _draw_dots(painter, rect.left + pad, lowest + round(0.5 * BUTTON * scale), page)
    for name, text in ((NEXT, page.onward), (BACK, words.TOUR_BACK)):
        if name in places.buttons:
            draw_button(
                painter,
                text,
                places.buttons[name].move(rect.topleft),
                strong=name == NEXT and (page.done or not page.do),
                ring=focus == name,
                hover=hover == name,
            )
    _draw_close(painter, close, ring=focus == CLOSE, hover=hover == CLOSE)


def _draw_mark(painter: Painter, x: float, y: float, done: bool) -> None:
    """An empty ring before what to do; a tick once it is done."""
    scale, theme = painter.scale, painter.theme
    radius = 7.5 * scale
    centre = x + radius
    if not done:
        painter.disc(centre, y, radius, theme.panel, edge=HAND, edge_width=2.0 * scale)
        return
    painter.disc(centre, y, radius, theme.good)
    dark = theme.panel
    painter.line(
        (centre - 3.5 * scale, y), (centre - 1.0 * scale, y + 3.0 * scale), 2.2 * scale, dark
    )
    painter.line(
        (centre - 1.0 * scale, y + 3.0 * scale),
        (centre + 4.0 * scale, y - 3.5 * scale),
        2.2 * scale,
        dark,
    )


def _draw_dots(painter: Painter, x: float, y: float, page: TourPage) -> None:
    """One a step; the present one is larger."""
    scale, theme = painter.scale, painter.theme
    for step in range(page.steps):
        here = step == page.step
        colour = HAND if here else theme.soft_text if step < page.step else theme.hairline
        centre = x + DOT * scale + step * DOT_GAP * scale
        painter.disc(centre, y, (DOT + 1.5 if here else DOT) * scale, colour)


def draw_button(
    painter: Painter, text: str, rect: pygame.Rect, *, strong: bool, ring: bool, hover: bool = False
) -> None:
    """A button: ``strong`` is what leads on, ``ring`` what the keyboard is at."""
    scale, theme = painter.scale, painter.theme
    fill = mix(theme.panel, HAND, 0.30) if strong else mix(theme.panel, theme.text, 0.08)
    painter.box(
        rect,
        mix(fill, theme.text, 0.10) if hover else fill,
        radius=7.0 * scale,
        edge=ring_colour(theme) if ring else HAND if strong else theme.soft_text,
        edge_width=(3.5 if ring else 1.5) * scale,
    )
    text = painter.type.shortened(text, BODY, rect.width - round(8 * scale), bold=True)
    painter.text(text, *rect.center, anchor="centre", bold=True)


def _draw_close(painter: Painter, rect: pygame.Rect, *, ring: bool, hover: bool) -> None:
    """A cross in the upper right corner."""
    scale, theme = painter.scale, painter.theme
    if ring or hover:
        painter.box(
            rect,
            mix(theme.panel, theme.text, 0.10),
            radius=7.0 * scale,
            edge=ring_colour(theme) if ring else theme.hairline,
            edge_width=(3.0 if ring else 1.0) * scale,
        )
    x, y, arm = *rect.center, 5.5 * scale
    for way in (1.0, -1.0):
        painter.line(
            (x - arm, y - way * arm), (x + arm, y + way * arm), 2.0 * scale, theme.soft_text
        )

"""The card of a lesson: what it says and asks, what to do, why it came out so, and its buttons."""

from __future__ import annotations

from dataclasses import dataclass

import pygame

from sandbox.draw.painter import Painter
from sandbox.draw.text import BODY, HEADING, SMALL, Type
from sandbox.draw.theme import HAND, mix
from sandbox.draw.widgets.look import ring_colour
from sandbox.words import words

PAD = 14.0  # within the card at scale 1 [px]
BUTTON = 38.0  # height of a button at scale 1 [px]
DOT, DOT_GAP = 4.0, 14.0  # radius of a dot of progress, and from one to the next, at scale 1 [px]
FIELD_WIDTH = 130.0  # of a number to be typed, at scale 1 [px]

SMALLER = (2.5, 2.0, 1.75, 1.5, 1.25, 1.0, 0.875)  # scales of letters where the card would not fit

NEXT, BACK, CLOSE, FIELD = "tour/next", "tour/back", "tour/close", "tour/number"
OPTION = "tour/option/"  # and its number, from 0


@dataclass(frozen=True, slots=True)
class Field:
    """A number that is typed, or was."""

    text: str
    unit: str = ""
    caret: int | None = None  # before which sign the next one goes; None: nobody types


@dataclass(frozen=True, slots=True)
class TourPage:
    """What the card shows, in the present language."""

    title: str  # of the lesson, or of the scene
    step: int  # from 0
    steps: int
    say: str
    do: str = ""  # what a person is asked to do
    done: bool = False
    why: str = ""  # shown once it is done
    onward: str = ""  # what the button that leads on says
    ask: str = ""  # a question
    options: tuple[str, ...] = ()  # its answers to choose from
    chosen: int | None = None  # one of them
    field: Field | None = None  # or a number
    hint: str = ""  # how to answer
    ready: bool = True  # nothing is asked, or it is answered

    @property
    def first(self) -> bool:
        """Is there nothing to go back to?"""
        return self.step == 0


@dataclass(frozen=True, slots=True)
class CardLine:
    """A line of text on the card: its left end and its middle, from the card's corner [px]."""

    text: str
    x: int
    y: int
    size: float = BODY
    bold: bool = False
    task: bool = False  # the first line of what to do: a mark stands before it


@dataclass(frozen=True, slots=True)
class CardLayout:
    """Where lines and buttons are, and how high all of it is [px]."""

    buttons: dict[str, pygame.Rect]  # relative to the card's corner
    height: int
    lines: tuple[CardLine, ...] = ()


def card_layout(page: TourPage, type_: Type, width: int) -> CardLayout:
    """How high the card is at that width [px], and where its lines and buttons are."""
    scale = type_.scale
    pad, tall, gap, mark = (round(size * scale) for size in (PAD, BUTTON, 7.0, 22.0))
    y = pad + type_.height(HEADING, bold=True)
    lines: list[CardLine] = []
    buttons: dict[str, pygame.Rect] = {}

    def write(
        text: str, *, bold: bool = False, size: float = BODY, task: bool = False, x: int = pad
    ) -> None:
        nonlocal y
        indent, high = x + mark * task, type_.height(size, bold)
        for index, line in enumerate(type_.wrapped(text, size, width - indent - pad, bold)):
            y += gap * (index == 0)
            lines.append(CardLine(line, indent, y + high // 2, size, bold, task and index == 0))
            y += high

    write(page.say)
    write(page.ask, bold=True)
    for index, option in enumerate(page.options):
        top = y = y + gap
        write(option, x=pad + mark + gap)
        y = max(y + gap, top + tall)
        buttons[f"{OPTION}{index}"] = pygame.Rect(pad, top, width - 2 * pad, y - top)
    if page.field is not None:
        wide = min(round(FIELD_WIDTH * scale), width - 2 * pad)
        buttons[FIELD] = pygame.Rect(pad, y + gap, wide, tall)
        y = buttons[FIELD].bottom
        lines.append(CardLine(page.field.unit, pad + wide + gap, y - tall // 2))
    write(page.hint, size=SMALL)
    write(page.do, bold=True, task=True)
    write(page.why)
    y += round(10 * scale)
    onward = type_.width(page.onward, BODY, bold=True) + round(28 * scale)
    back = type_.width(words.TOUR_BACK, BODY, bold=True) + round(24 * scale)
    free = width - 2 * pad - round(8 * scale)
    onward = min(onward, free - min(back, free // 3))
    back = min(back, free - onward)
    buttons[NEXT] = pygame.Rect(width - pad - onward, y, onward, tall)
    if not page.first:
        buttons[BACK] = pygame.Rect(buttons[NEXT].left - round(8 * scale) - back, y, back, tall)
    side = round(32 * scale)
    buttons[CLOSE] = pygame.Rect(width - side - round(6 * scale), round(6 * scale), side, side)
    return CardLayout(buttons, y + tall + pad, tuple(lines))


def fitting_type(page: TourPage, own: Type, width: int, height: int) -> Type:
    """The largest type up to ``own`` in which all of the card fits into so many pixels; the smallest if there is none."""
    types = [own, *(Type(scale) for scale in SMALLER if scale < own.scale)]
    return next((each for each in types if _fits(page, each, width, height)), types[-1])


def _fits(page: TourPage, type_: Type, width: int, height: int) -> bool:
    """Is the card no higher than that, and nothing on it cut off?"""
    places = card_layout(page, type_, width)
    title = type_.width(page.title, BODY, bold=True)
    named = [(NEXT, page.onward), *([] if page.first else [(BACK, words.TOUR_BACK)])]
    left = places.buttons[named[-1][0]].left - 2 * round(PAD * type_.scale)
    room = {name: places.buttons[name].width - round(8 * type_.scale) for name, _ in named}
    said = " ".join((page.say, page.ask, *page.options, page.hint, page.do, page.why))
    return (
        places.height <= height
        and type_.width(f"{page.step + 1}/{page.steps}", SMALL) <= left
        and title <= places.buttons[CLOSE].left - round((PAD + 4.0) * type_.scale)
        and all(type_.width(text, BODY, bold=True) <= room[name] for name, text in named)
        and sum("…" in line.text for line in places.lines) <= said.count("…")
    )


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
    size = HEADING if type_.width(page.title, HEADING, bold=True) <= room else BODY
    title = type_.shortened(page.title, size, room, bold=True)
    painter.text(title, rect.left + pad, rect.top + pad + head // 2, size=size, bold=True)
    lowest = rect.top + places.buttons[NEXT].top
    for index in range(len(page.options)):
        name = f"{OPTION}{index}"
        _draw_option(
            painter,
            places.buttons[name].move(rect.topleft),
            index == page.chosen,
            focus == name,
            hover == name,
        )
    for line in places.lines:
        x, y = rect.left + line.x, rect.top + line.y
        if y + type_.height(line.size, line.bold) // 2 > lowest:
            break
        if line.task:
            _draw_mark(painter, rect.left + pad, y, page.done)
        painter.text(line.text, x, y, size=line.size, bold=line.bold)
    if page.field is not None:
        _draw_field(painter, places.buttons[FIELD].move(rect.topleft), page.field, focus == FIELD)
    free = places.buttons.get(BACK, places.buttons[NEXT]).left - 2 * pad
    _draw_progress(painter, rect.left + pad, lowest + round(0.5 * BUTTON * scale), page, free)
    for name, text in ((NEXT, page.onward), (BACK, words.TOUR_BACK)):
        if name in places.buttons:
            draw_button(
                painter,
                text,
                places.buttons[name].move(rect.topleft),
                strong=name == NEXT and (page.done or not page.do) and page.ready,
                ring=focus == name,
                hover=hover == name,
            )
    _draw_close(painter, close, ring=focus == CLOSE, hover=hover == CLOSE)


def _draw_option(painter: Painter, rect: pygame.Rect, on: bool, ring: bool, hover: bool) -> None:
    """What can be chosen: a box with a ring at its left, filled if it is chosen."""
    scale, theme = painter.scale, painter.theme
    fill = (
        mix(theme.panel, HAND, 0.22)
        if on
        else mix(theme.panel, theme.text, 0.10 if hover else 0.05)
    )
    edge = ring_colour(theme) if ring else HAND if on else theme.hairline
    painter.box(
        rect, fill, radius=7.0 * scale, edge=edge, edge_width=(3.0 if ring else 1.5) * scale
    )
    x = rect.left + 15.0 * scale
    painter.disc(
        x, rect.centery, 7.5 * scale, theme.panel, edge=theme.soft_text, edge_width=2.0 * scale
    )
    if on:
        painter.disc(x, rect.centery, 4.0 * scale, ring_colour(theme))


def _draw_field(painter: Painter, rect: pygame.Rect, field: Field, ring: bool) -> None:
    """A number being typed."""
    scale, theme, type_ = painter.scale, painter.theme, painter.type
    edge = ring_colour(theme) if ring or field.caret is not None else theme.soft_text
    painter.box(
        rect, theme.ground, radius=7.0 * scale, edge=edge, edge_width=(3.0 if ring else 1.5) * scale
    )
    left = rect.left + round(10 * scale)
    text = type_.shortened(field.text, BODY, rect.right - left - round(8 * scale))
    painter.text(text, left, rect.centery)
    if field.caret is not None:
        x, half = left + type_.width(text[: field.caret], BODY) + scale, 0.4 * type_.height(BODY)
        painter.line((x, rect.centery - half), (x, rect.centery + half), 2.0 * scale, edge)


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


def _draw_progress(painter: Painter, x: float, y: float, page: TourPage, free: int) -> None:
    """A dot a step, the present one larger; numbers where so many have no room."""
    scale, theme = painter.scale, painter.theme
    if (page.steps - 1) * DOT_GAP * scale + 2 * DOT * scale > free:
        text = painter.type.shortened(f"{page.step + 1}/{page.steps}", SMALL, free)
        painter.text(text, x, y, size=SMALL, colour=theme.soft_text)
        return
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

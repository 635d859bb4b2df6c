"""How the controls of the panel look."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw.painter import Painter
from sandbox.draw.signs import SIGNS, draw_sign
from sandbox.draw.text import BODY, SMALL, Type
from sandbox.draw.theme import HAND, Theme, mix
from sandbox.draw.widgets.controls import (
    BARS,
    PAD,
    THUMB,
    Bars,
    Button,
    Choice,
    Fact,
    Heading,
    Note,
    Parts,
    Place,
    Slider,
    Stepper,
    Switch,
    TextField,
    parts_of,
    size_of_choice,
)
from sandbox.draw.widgets.scale import shown

CORNER = 7.0  # radius of corners at scale 1 [px]


@dataclass(frozen=True, slots=True)
class Typing:
    """What is being typed."""

    name: str  # of the control
    text: str
    caret: int  # before which character the next one goes
    anchor: int  # from here to the caret it is selected
    composed: str = ""  # at the caret, by an input method that has not decided yet


@dataclass(frozen=True, slots=True)
class Attention:
    """What the person is at: by the keyboard, by the mouse, typing."""

    focus: str = ""  # control with the ring; nothing: none is shown
    hover: str = ""
    typing: Typing | None = None


def ring_colour(theme: Theme) -> int:
    """The colour of the focus ring: the hand's; darker on a light ground."""
    return HAND if theme.name == "dark" else mix(HAND, 0x000000, 0.3)


def draw_ring(painter: Painter, rect: pygame.Rect, radius: float = CORNER) -> None:
    """The ring round what the keyboard is at."""
    scale = painter.scale
    points = _rounded(rect, radius * scale)
    painter.polyline(points[:, 0], points[:, 1], 3.0 * scale, ring_colour(painter.theme))


def _rounded(rect: pygame.Rect, radius: float) -> np.ndarray:
    """The closed outline (n, 2) of a rectangle with round corners [px]."""
    radius = min(radius, 0.5 * rect.width, 0.5 * rect.height)
    quarter = np.linspace(0.0, 0.5 * np.pi, 7)
    centres = [
        (rect.right - radius, rect.bottom - radius),
        (rect.left + radius, rect.bottom - radius),
        (rect.left + radius, rect.top + radius),
        (rect.right - radius, rect.top + radius),
    ]
    corners = [
        np.column_stack(
            (
                x + radius * np.cos(quarter + 0.5 * np.pi * turn),
                y + radius * np.sin(quarter + 0.5 * np.pi * turn),
            )
        )
        for turn, (x, y) in enumerate(centres)
    ]
    return np.vstack([*corners, corners[0][:1]])


def draw_control(painter: Painter, place: Place, attention: Attention) -> None:
    """One control; the texts are written when the painter is flushed."""
    control, rect = place.control, place.rect
    hover = bool(control.name) and attention.hover == control.name
    parts = parts_of(control, rect, painter.type)
    match control:
        case Slider():
            _draw_slider(painter, control, parts, attention, hover)
        case Switch():
            _draw_switch(painter, control, rect, hover)
        case Choice():
            _draw_choice(painter, control, parts, hover)
        case Stepper():
            _title(painter, control.title, "", parts.title)
            _draw_arrows(painter, parts, "−+", hover)
            _draw_box(painter, parts.box, str(control.value), control.name, attention, hover)
        case Button():
            _draw_button(painter, control, rect, hover)
        case TextField():
            _title(painter, control.title, "", parts.title)
            _draw_box(painter, parts.box, control.text, control.name, attention, hover)
            if control.colour is not None:
                bar = parts.box.inflate(0, -round(16 * painter.scale))
                bar.width = round(5 * painter.scale)
                bar.left += round(4 * painter.scale)
                painter.box(bar, control.colour, radius=2.0 * painter.scale)
        case Heading():
            _draw_heading(painter, control, rect, hover)
        case Fact():
            _draw_fact(painter, control, rect)
        case Bars():
            _draw_bars(painter, control, rect)
        case Note():
            _draw_note(painter, control, rect)
    if control.name and attention.focus == control.name:
        grown = round(3 * painter.scale)
        draw_ring(painter, rect.inflate(2 * grown, round(3 * painter.scale)))


def _field(painter: Painter, rect: pygame.Rect, hover: bool, on: bool = False) -> None:
    """The plate of something that can be pressed."""
    theme, scale = painter.theme, painter.scale
    ground = theme.text if on else mix(theme.panel, theme.text, 0.14 if hover else 0.06)
    edge = theme.text if on else mix(theme.hairline, theme.text, 0.35 if hover else 0.15)
    painter.box(rect, ground, radius=CORNER * scale, edge=edge, edge_width=1.5 * scale)


def _title(painter: Painter, title: str, more: str, rect: pygame.Rect) -> None:
    """The line over a control: what it is, and in soft words what else, as far as it fits."""
    if not rect.height:
        return
    type_ = painter.type
    size = type_.fitting(title, SMALL, rect.width)
    title = type_.shortened(title, size, rect.width)
    painter.text(title, rect.left, rect.centery, size=size)
    room = rect.width - type_.width(title, SMALL) - round(10 * painter.scale)
    if more and type_.width(more, SMALL) <= room:
        soft = painter.theme.soft_text
        painter.text(more, rect.right, rect.centery, size=SMALL, colour=soft, anchor="right")


def with_unit(title: str, unit: str) -> str:
    """A quantity's name with its unit in brackets."""
    return f"{title} [{unit}]" if unit else title


def extent(slider: Slider) -> str:
    """From where to where a slider goes."""
    return f"{shown(slider.low)} … {shown(slider.high)}"


def _draw_slider(
    painter: Painter, slider: Slider, parts: Parts, attention: Attention, hover: bool
) -> None:
    theme, scale = painter.theme, painter.scale
    title = with_unit(slider.title, slider.unit)
    room = parts.title.width - painter.type.width(title, SMALL) - round(10 * scale)
    both = " · ".join(part for part in (extent(slider), slider.mark) if part)
    fits = painter.type.width(both, SMALL) <= room
    _title(painter, title, both if fits else slider.mark or extent(slider), parts.title)

    track, middle = parts.track, parts.track.centery
    share = slider.range.share(slider.value)
    x = track.left + share * track.width
    start = track.left + slider.range.share(slider.default) * track.width
    rail = mix(theme.panel, theme.text, 0.3)
    painter.line((track.left, middle), (track.right, middle), 4.0 * scale, rail)
    origin = track.left + slider.range.share(min(max(0.0, slider.low), slider.high)) * track.width
    painter.line((origin, middle), (x, middle), 4.0 * scale, theme.soft_text)
    tick = 7.0 * scale  # where the default is
    painter.line((start, middle + tick), (start, middle + 1.7 * tick), 2.0 * scale, theme.soft_text)
    size = THUMB * scale * (1.15 if hover else 1.0)
    painter.disc(x, middle, size, theme.text, edge=theme.panel, edge_width=2.0 * scale)
    _draw_box(painter, parts.box, slider.said, slider.name, attention, hover)


def _draw_box(
    painter: Painter,
    rect: pygame.Rect,
    text: str,
    name: str,
    attention: Attention,
    hover: bool,
) -> None:
    """Something that can be typed: a number or a line of text."""
    theme, scale, type_ = painter.theme, painter.scale, painter.type
    inner = rect.inflate(0, -round(6 * scale))
    if attention.typing is not None and attention.typing.name == name:
        edge = theme.text
        painter.box(inner, theme.ground, radius=CORNER * scale, edge=edge, edge_width=2 * scale)
        _draw_typing(painter, _room(rect, type_), attention.typing)
        return
    _field(painter, inner, hover)
    _middle(painter, text, inner, round(16 * scale))


def _middle(painter: Painter, text: str, rect: pygame.Rect, least: int) -> None:
    """A text in the middle, smaller rather than cut; beside it stay so many pixels, or half of them where it is small."""
    type_ = painter.type
    size = type_.fitting(text, BODY, rect.width - least)
    room = rect.width - (least if size == BODY else least // 2)
    painter.text(type_.shortened(text, size, room), *rect.center, size=size, anchor="centre")


def _room(box: pygame.Rect, type_: Type) -> pygame.Rect:
    """Of a text that is typed, within its box."""
    return box.inflate(-round(16 * type_.scale), -round(6 * type_.scale))


def _left_edge(typing: Typing, room: pygame.Rect, type_: Type) -> int:
    """Of the text, shifted so that the caret stays in view [px]."""
    at = typing.caret
    text = typing.text[:at] + typing.composed + typing.text[at:]
    caret = type_.caret(text, at + len(typing.composed), BODY)
    return room.left - max(caret - room.width, 0)


def character_at(typing: Typing, box: pygame.Rect, x: int, type_: Type) -> int:
    """Before which character a press at ``x`` [px] in the box puts the caret."""
    along = x - _left_edge(typing, _room(box, type_), type_)
    places = range(len(typing.text) + 1)
    return min(places, key=lambda place: abs(type_.caret(typing.text, place, BODY) - along))


def _draw_typing(painter: Painter, room: pygame.Rect, typing: Typing) -> None:
    """The text; what is selected has a ground, what an input method composes a line."""
    scale, type_ = painter.scale, painter.type
    at, composed = typing.caret, typing.composed
    text = typing.text[:at] + composed + typing.text[at:]
    caret = type_.caret(text, at + len(composed), BODY)
    shift = _left_edge(typing, room, type_)
    view = room.inflate(round(4 * scale), 0)
    half = round(0.4 * type_.height(BODY))
    marks = [(typing.anchor, at, -half, 2 * half)] if not composed else []
    marks += [(at, at + len(composed), half, max(round(scale), 1))]
    for start, end, top, height in marks:
        for left, right in type_.spans(text, min(start, end), max(start, end), BODY):
            place = pygame.Rect(shift + left, room.centery + top, right - left, height)
            painter.fill(place.clip(view), mix(painter.theme.ground, painter.theme.text, 0.35))
    painter.text(text, shift, room.centery, clip=view)
    ends = (shift + caret, room.centery - half), (shift + caret, room.centery + half)
    painter.line(*ends, 2.0 * scale, ring_colour(painter.theme))


def _draw_switch(painter: Painter, switch: Switch, rect: pygame.Rect, hover: bool) -> None:
    theme, scale, type_ = painter.theme, painter.scale, painter.type
    plate = pygame.Rect(0, 0, round(44 * scale), round(24 * scale))
    plate.midright = rect.midright
    painter.box(
        plate,
        theme.text if switch.on else mix(theme.panel, theme.text, 0.14 if hover else 0.06),
        radius=0.5 * plate.height,
        edge=theme.soft_text,
        edge_width=1.5 * scale,
    )
    x = plate.right - 0.5 * plate.height if switch.on else plate.left + 0.5 * plate.height
    painter.disc(x, plate.centery, 8.0 * scale, theme.panel if switch.on else theme.soft_text)
    room = plate.left - rect.left - round(10 * scale)
    size = type_.fitting(switch.title, SMALL, room)
    title = type_.shortened(switch.title, size, room)
    painter.text(title, rect.left, rect.centery, size=size)
    free = room - type_.width(title, SMALL) - round(10 * scale)
    if switch.mark and type_.width(switch.mark, SMALL) <= free:
        painter.text(
            switch.mark,
            plate.left - round(10 * scale),
            rect.centery,
            size=SMALL,
            colour=theme.soft_text,
            anchor="right",
        )


def _draw_choice(painter: Painter, choice: Choice, parts: Parts, hover: bool) -> None:
    theme, scale, type_ = painter.theme, painter.scale, painter.type
    _title(painter, choice.title, "", parts.title)
    dot = 5.0 * scale
    if parts.arrows is not None:
        _draw_arrows(painter, parts, "‹›", hover)
        title = next((o.title for o in choice.options if o.value == choice.value), choice.value)
        _middle(painter, title, parts.box, round(10 * scale))
        return
    whole = _whole(parts.options)
    _field(painter, whole, hover)
    size = size_of_choice(choice.options, whole.width, type_) or SMALL
    for option, rect in zip(choice.options, parts.options, strict=True):
        on = option.value == choice.value
        if on:
            painter.box(rect, theme.text, radius=CORNER * scale)
        colour = theme.panel if on else theme.text
        x = float(rect.centerx)
        if option.colour is not None:
            width = type_.width(option.title, size, bold=on)
            place = x - 0.5 * (width + 3.0 * dot) + dot
            edge = colour if on else theme.panel
            painter.disc(place, rect.centery, dot, option.colour, edge=edge, edge_width=scale)
            x += 1.5 * dot
        painter.text(
            option.title, x, rect.centery, size=size, bold=on, colour=colour, anchor="centre"
        )


def _whole(rects: tuple[pygame.Rect, ...]) -> pygame.Rect:
    return rects[0].unionall(list(rects[1:]))


def _draw_arrows(painter: Painter, parts: Parts, signs: str, hover: bool) -> None:
    assert parts.arrows is not None
    for rect, sign in zip(parts.arrows, signs, strict=True):
        inner = rect.inflate(-round(4 * painter.scale), -round(6 * painter.scale))
        _field(painter, inner, hover)
        draw_sign(painter, sign, inner)


def _draw_button(painter: Painter, button: Button, rect: pygame.Rect, hover: bool) -> None:
    theme, type_ = painter.theme, painter.type
    inner = rect.inflate(0, -round(4 * painter.scale))
    on = bool(button.on)
    _field(painter, inner, hover and button.enabled, on)
    colour = theme.panel if on else theme.text
    if not button.enabled:
        colour = mix(theme.soft_text, theme.panel, 0.45)
    if button.title in SIGNS:
        draw_sign(painter, button.title, inner, colour)
        return
    room = inner.width - round(8 * painter.scale)
    large = type_.width(button.title, BODY, on) <= room
    size = BODY if large else type_.fitting(button.title, SMALL, room, on)
    text = type_.shortened(button.title, size, room, on)
    painter.text(text, *inner.center, size=size, colour=colour, anchor="centre", bold=on)


def _draw_heading(painter: Painter, heading: Heading, rect: pygame.Rect, hover: bool) -> None:
    theme, scale = painter.theme, painter.scale
    pad = round(PAD * scale)
    line = pygame.Rect(rect.left - pad, rect.top, rect.width + 2 * pad, max(round(scale), 1))
    painter.fill(line, theme.hairline)
    square = pygame.Rect(0, 0, round(16 * scale), round(16 * scale))
    square.midleft = (rect.left, rect.centery)
    colour = theme.text if hover else theme.soft_text
    draw_sign(painter, "⌄" if heading.open else "›", square, colour)
    x = square.right + round(6 * scale)
    title = painter.type.shortened(heading.title, BODY, rect.right - x, bold=True)
    painter.text(title, x, rect.centery, bold=True)


def _draw_fact(painter: Painter, fact: Fact, rect: pygame.Rect) -> None:
    type_, soft = painter.type, painter.theme.soft_text
    value = type_.shortened(fact.value, SMALL, 0.7 * rect.width, fact.strong)
    shown_value = painter.text(
        value, rect.right, rect.centery, size=SMALL, bold=fact.strong, anchor="right"
    )
    room = shown_value.left - rect.left - round(8 * painter.scale)
    size = type_.fitting(fact.title, SMALL, room)
    title = type_.shortened(fact.title, size, room)
    painter.text(title, rect.left, rect.centery, size=size, colour=soft)


def _draw_bars(painter: Painter, bars: Bars, rect: pygame.Rect) -> None:
    """A line of words, the bars on their axis, and what its ends mean."""
    type_, theme, scale = painter.type, painter.theme, painter.scale
    head = pygame.Rect(rect.left, rect.top, rect.width, type_.height(BODY))
    _draw_fact(painter, Fact(bars.title, bars.value, strong=True), head)
    base = head.bottom + round(BARS * scale)
    painter.fill(pygame.Rect(rect.left, base, rect.width, max(round(scale), 1)), theme.soft_text)
    top = max((*bars.shares, 1e-9))
    wide = rect.width / max(len(bars.shares), 1)
    for index, share in enumerate(bars.shares):
        high = round(share / top * (BARS - 4.0) * scale)
        left, right = round(rect.left + index * wide), round(rect.left + (index + 1) * wide)
        gap = max(round(scale), 1)
        painter.fill(pygame.Rect(left, base - high, right - left - gap, high), bars.colour)
    y = base + type_.height(SMALL) // 2 + round(scale)
    painter.text(bars.low, rect.left, y, size=SMALL, colour=theme.soft_text)
    painter.text(bars.high, rect.right, y, size=SMALL, colour=theme.soft_text, anchor="right")


def _draw_note(painter: Painter, note: Note, rect: pygame.Rect) -> None:
    type_, line = painter.type, painter.type.height(SMALL)
    for index, text in enumerate(type_.wrapped(note.text, SMALL, rect.width)):
        y = rect.top + index * line + line // 2
        painter.text(text, rect.left, y, size=SMALL, colour=painter.theme.soft_text)

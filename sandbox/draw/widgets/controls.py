"""Controls of the panel as plain data, and where they stand. How they look is in ``widgets_look``.

A control is made anew for every picture from what is true at the moment; it holds no state. Its
name tells it from all others. Sizes are at UI scale 1; every target is at least 36 px high.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pygame

from sandbox.draw.text import BODY, SMALL, Type
from sandbox.draw.widgets.scale import Range, shown

TARGET = 36.0  # height of what can be pressed [px]
GAP = 6.0  # between controls [px]
BOX = 80.0  # width of a typed number [px]
THUMB = 9.0  # radius of a slider's thumb [px]
PAD = 12.0  # beside the controls [px]
BARS = 46.0  # height of the highest bar [px]


@dataclass(frozen=True, slots=True)
class Slider:
    """A number within a range: a track, and a box where it can be typed."""

    name: str
    title: str
    value: float
    low: float
    high: float
    default: float
    unit: str = ""
    whole: bool = False
    at_once: bool = False  # takes effect while it is moved, and not only when that is done
    mark: str = ""  # a word after the range: what a change leads to
    help: str = ""
    top: str = ""  # a word for the highest value, if that means more than itself

    @property
    def said(self) -> str:
        """The value as it stands in the box."""
        return self.top if self.top and self.value >= self.high else shown(self.value)

    @property
    def range(self) -> Range:
        """The scale of the track."""
        return Range(self.low, self.high, self.whole)


@dataclass(frozen=True, slots=True)
class Switch:
    """On or off."""

    name: str
    title: str
    on: bool
    default: bool | None = None
    mark: str = ""
    help: str = ""


@dataclass(frozen=True, slots=True)
class Option:
    """One of several things to choose from."""

    value: str
    title: str
    colour: int | None = None  # a dot before the title


@dataclass(frozen=True, slots=True)
class Choice:
    """One of several: side by side where they fit, else one at a time between two arrows."""

    name: str
    title: str  # above; nothing: no line for it
    options: tuple[Option, ...]
    value: str
    help: str = ""


@dataclass(frozen=True, slots=True)
class Stepper:
    """A whole number between a minus and a plus."""

    name: str
    title: str
    value: int
    low: int
    high: int
    help: str = ""


@dataclass(frozen=True, slots=True)
class Button:
    """Something to do."""

    name: str
    title: str
    on: bool | None = None  # is what it switches on? None: it switches nothing
    enabled: bool = True
    help: str = ""
    spoken: str = ""  # its name for who hears it, where the title is a sign


@dataclass(frozen=True, slots=True)
class TextField:
    """A line of text that can be typed."""

    name: str
    title: str
    text: str
    colour: int | None = None  # a bar before the text
    help: str = ""


@dataclass(frozen=True, slots=True)
class Heading:
    """The beginning of a section that can be folded."""

    name: str
    title: str
    open: bool
    help: str = ""


@dataclass(frozen=True, slots=True)
class Fact:
    """Something to read: what it is, and how much."""

    title: str
    value: str
    strong: bool = False
    name: str = ""
    help: str = ""


@dataclass(frozen=True, slots=True)
class Bars:
    """How something is spread: a bar a bin, as high as its share, over an axis from ``low`` to ``high``."""

    title: str
    value: str  # mean and spread, in words
    shares: tuple[float, ...]
    low: str
    high: str
    colour: int
    name: str = ""
    help: str = ""


@dataclass(frozen=True, slots=True)
class Note:
    """A paragraph to read."""

    text: str
    name: str = ""
    help: str = ""


Simple = Slider | Switch | Choice | Stepper | Button | TextField | Heading | Fact | Bars | Note


@dataclass(frozen=True, slots=True)
class Row:
    """Controls side by side; ``shares`` of the width, equal if there are none."""

    controls: tuple[Simple, ...]
    shares: tuple[float, ...] = ()


Control = Simple | Row


@dataclass(frozen=True, slots=True)
class Place:
    """A control and where it stands, unscrolled."""

    control: Simple
    rect: pygame.Rect


@dataclass(frozen=True, slots=True)
class Places:
    """All controls of a panel, from the top."""

    all: tuple[Place, ...]
    height: int  # of all of them [px]

    def at(self, x: float, y: float) -> Place | None:
        """The control there that does something."""
        for place in self.all:
            if place.control.name and place.rect.collidepoint(x, y):
                return place
        return None

    def named(self, name: str) -> Place | None:
        """Where a control stands; what can only be read has no name."""
        found = (place for place in self.all if place.control.name == name)
        return next(found, None) if name else None

    def stops(self) -> tuple[str, ...]:
        """Names of what the keyboard can go to."""
        return tuple(place.control.name for place in self.all if can_be_used(place.control))

    def scroll_to(self, name: str, scroll: int, opening: int, room: int) -> int:
        """The scroll that shows a control and ``room`` [px] around it, changed as little as possible."""
        place = self.named(name)
        if place is not None:
            scroll = min(scroll, place.rect.top - room)
            scroll = max(scroll, place.rect.bottom + room - opening)
        return max(0, min(scroll, self.height - opening))


def can_be_used(control: Simple) -> bool:
    """Is there anything to do with it?"""
    return bool(control.name) and (not isinstance(control, Button) or control.enabled)


def arranged(controls: Sequence[Control], type_: Type, width: int) -> Places:
    """Put controls under each other."""
    scale = type_.scale
    pad, gap = round(PAD * scale), round(GAP * scale)
    y, places = gap, []
    for control, following in zip(controls, [*controls[1:], None], strict=True):
        row = control if isinstance(control, Row) else Row((control,))
        shares = row.shares or (1.0,) * len(row.controls)
        room = width - 2 * pad - gap * (len(row.controls) - 1)
        height = max(_height(part, type_, width - 2 * pad) for part in row.controls)
        x = float(pad)
        for part, share in zip(row.controls, shares, strict=True):
            right = x + room * share / sum(shares)
            own = _height(part, type_, width - 2 * pad) if isinstance(part, Button) else height
            corner = round(x), y + height - own
            places.append(Place(part, pygame.Rect(corner, (round(right) - round(x), own))))
            x = right + gap
        lines = isinstance(control, Fact) and isinstance(following, Fact)
        y += height + (0 if lines else gap)
    return Places(tuple(places), y)


def _height(control: Simple, type_: Type, width: int) -> int:
    target, line = round(TARGET * type_.scale), type_.height(SMALL)
    match control:
        case Slider():
            return line + target
        case Choice(title=title) | Stepper(title=title) | TextField(title=title):
            return target + (line if title else 0)
        case Fact():
            return type_.height(BODY)
        case Bars():
            return type_.height(BODY) + round(BARS * type_.scale) + line
        case Note(text=text):
            return max(len(type_.wrapped(text, SMALL, width)), 1) * line
        case _:
            return target


@dataclass(frozen=True, slots=True)
class Parts:
    """Where the parts of one control stand: what is pressed, and the line of its title."""

    title: pygame.Rect
    track: pygame.Rect  # of a slider: from the first place of the thumb's middle to the last
    box: pygame.Rect  # a number or a text
    options: tuple[pygame.Rect, ...] = ()  # of a choice that shows all of them
    arrows: tuple[pygame.Rect, pygame.Rect] | None = None  # less and more


def parts_of(control: Simple, rect: pygame.Rect, type_: Type) -> Parts:
    """Divide a control's rectangle."""
    scale = type_.scale
    titled = isinstance(control, (Slider, Choice, Stepper, TextField)) and control.title
    line = type_.height(SMALL) if titled else 0
    title = pygame.Rect(rect.left, rect.top, rect.width, line)
    body = pygame.Rect(rect.left, rect.top + line, rect.width, rect.height - line)
    none = pygame.Rect(body.topleft, (0, 0))
    thumb = round(THUMB * scale)
    match control:
        case Slider():
            box = body.copy()
            box.width = min(round(BOX * scale), body.width // 2)
            box.right = body.right
            track = pygame.Rect(
                body.left + thumb, body.top, box.left - body.left - 3 * thumb, body.height
            )
            return Parts(title, track, box)
        case Stepper():
            return _between_arrows(title, body)
        case Choice(options=options):
            return _parts_of_choice(options, title, body, type_)
        case _:
            return Parts(title, none, body)


def _parts_of_choice(
    options: Sequence[Option], title: pygame.Rect, body: pygame.Rect, type_: Type
) -> Parts:
    none = pygame.Rect(body.topleft, (0, 0))
    size = size_of_choice(options, body.width, type_)
    if size is not None:
        widths = _option_widths(options, size, type_)
        each, x, rects = (body.width - sum(widths)) / len(options), float(body.left), []
        for width in widths:
            right = x + width + each
            rects.append(pygame.Rect(round(x), body.top, round(right) - round(x), body.height))
            x = right
        return Parts(title, none, body, options=tuple(rects))
    return _between_arrows(title, body)


def _between_arrows(title: pygame.Rect, body: pygame.Rect) -> Parts:
    less, more = body.copy(), body.copy()
    less.width = more.width = min(body.height, body.width // 3)
    more.right = body.right
    box = pygame.Rect(less.right, body.top, more.left - less.right, body.height)
    return Parts(title, pygame.Rect(body.topleft, (0, 0)), box, arrows=(less, more))


def size_of_choice(options: Sequence[Option], width: int, type_: Type) -> int | None:
    """The size of type in which all options fit side by side; None: they don't."""
    for size in (BODY, SMALL):
        spare = width - sum(_option_widths(options, size, type_))
        if spare >= len(options) * round(10 * type_.scale):
            return size
    return None


def _option_widths(options: Sequence[Option], size: int, type_: Type) -> list[float]:
    dot = round(15 * type_.scale)
    return [
        type_.width(option.title, size, bold=True) + (dot if option.colour is not None else 0)
        for option in options
    ]


def slid_to(slider: Slider, parts: Parts, x: float) -> float:
    """The value under the pointer."""
    return slider.range.value((x - parts.track.left) / max(parts.track.width, 1))


def neighbour(choice: Choice, way: int) -> str:
    """The next option, or the one before; round at the ends."""
    values = [option.value for option in choice.options]
    here = values.index(choice.value) if choice.value in values else -max(way, 0)
    return values[(here + way) % len(values)]

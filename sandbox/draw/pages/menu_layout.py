"""Where everything in the scene menu stands.

On top the title and chips that switch something; below, in a part that scrolls, what was left unfinished, where to start, a
card a scene, and files with scenes. Everything that can be pressed has a name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pygame

from sandbox.draw.text import BODY, HEADING, SMALL, TITLE, Type
from sandbox.words import words

START = "start"  # names of what can be pressed
TAKE_UP, DISCARD = "resume", "discard"
SCENE, FILE, TOUR, PACKING, LESSON = "scene/", "file/", "tour/", "packing/", "lesson/"
LANGUAGE, THEME, KEYS, EXPLORE = "language", "theme", "keys", "explore"

CARD = 380.0  # least width of a card at scale 1 [px]
MOST_COLUMNS = 4
PICTURE = 132.0  # side of a thumbnail at scale 1 [px]
PAD, GAP = 14.0, 12.0  # within cards, and between them, at scale 1 [px]
QUESTION_LINES, ABOUT_LINES = 3, 3


@dataclass(frozen=True, slots=True)
class Card:
    """A scene, a lesson, or a file with a scene, in the menu: in the present language."""

    name: str  # SCENE, LESSON or FILE and what it is called
    title: str
    question: str
    about: str
    picture: str = ""  # name of the thumbnail
    tour: bool = False


@dataclass(frozen=True, slots=True)
class Chip:
    """Something that can be switched: its name, what it says, and whether it is on."""

    name: str
    text: str
    on: bool = False


@dataclass(frozen=True, slots=True)
class Contents:
    """What the menu offers."""

    cards: tuple[Card, ...]
    chips: tuple[Chip, ...] = ()
    resume: str = ""  # what was left unfinished; nothing if nothing was
    start: bool = True  # is there the card to start with?


@dataclass(frozen=True, slots=True)
class MenuLayout:
    """Places by name; those of ``scrolled`` are shifted up by the scroll."""

    title: pygame.Rect
    opening: pygame.Rect  # what shows of the part that scrolls
    foot: pygame.Rect
    chips: dict[str, pygame.Rect]
    scrolled: dict[str, pygame.Rect]
    strip: pygame.Rect | None  # behind the buttons for what was left unfinished
    content: int  # height of all that scrolls [px]

    @property
    def most_scroll(self) -> int:
        """How far the cards can be scrolled [px]."""
        return max(self.content - self.opening.height, 0)

    @property
    def cards(self) -> list[pygame.Rect]:
        """Of scenes, lessons and files, unscrolled."""
        kinds = SCENE, LESSON, FILE
        return [rect for name, rect in self.scrolled.items() if name.startswith(kinds)]

    def stops(self) -> list[str]:
        """Where Tab goes, in its order: what scrolls first. Tours are left out: they have a key."""
        return [name for name in (*self.scrolled, *self.chips) if not name.startswith(TOUR)]

    def shown(self, name: str, scroll: int) -> pygame.Rect | None:
        """Where something is in the window; None where it does not exist."""
        if name in self.chips:
            return self.chips[name]
        rect = self.scrolled.get(name)
        return None if rect is None else rect.move(0, -scroll)

    def at(self, place: tuple[int, int], scroll: int) -> str:
        """Name of what can be pressed there; nothing if there is nothing. A tour lies on its card."""
        for name, rect in self.chips.items():
            if rect.collidepoint(place):
                return name
        if not self.opening.collidepoint(place):
            return ""
        x, y = place
        found = [name for name, rect in self.scrolled.items() if rect.collidepoint(x, y + scroll)]
        return found[-1] if found else ""

    def scroll_to(self, name: str, scroll: int) -> int:
        """The scroll that brings something into view, changed as little as possible."""
        rect = self.scrolled.get(name)
        if rect is not None:
            scroll = min(scroll, rect.top - self.opening.top)
            scroll = max(scroll, rect.bottom - self.opening.bottom)
        return max(0, min(scroll, self.most_scroll))

    def neighbour(self, name: str, way: tuple[int, int]) -> str:
        """The next stop in a direction, (1, 0) for right and (0, 1) for down; the same where there is none."""
        stops = self.stops()
        places = {stop: self.shown(stop, 0) for stop in stops}
        here = places.get(name)
        if here is None:
            return stops[0] if stops else name
        best, nearest = name, float("inf")
        for stop, rect in places.items():
            if rect is None or stop == name:
                continue
            along, across = _apart(here, rect, way)
            if along > 0 and along + 3 * across < nearest:
                best, nearest = stop, along + 3 * across
        return best


def _apart(here: pygame.Rect, there: pygame.Rect, way: tuple[int, int]) -> tuple[int, int]:
    """How far another place is ahead, edge from edge, and how far aside [px]; not ahead: 0."""
    if way[0]:
        ahead = there.left - here.right if way[0] > 0 else here.left - there.right
        aside = max(there.top - here.bottom, here.top - there.bottom, -1)
        beside = aside < 0
        return (max(ahead, 1), 0) if beside and ahead > -here.width // 2 else (0, 0)
    ahead = there.top - here.bottom if way[1] > 0 else here.top - there.bottom
    overlap = min(here.right, there.right) - max(here.left, there.left)
    if ahead < 0:
        return 0, 0
    return max(ahead, 1), 0 if overlap > 0 else -overlap // 3 + 1


def menu_layout(size: tuple[int, int], type_: Type, contents: Contents) -> MenuLayout:
    """Divide the window [px]."""
    width, height = size
    scale = type_.scale
    pad, gap = round(18 * scale), round(GAP * scale)
    small = height < 430 * scale
    heading = HEADING if small else TITLE
    text = min(type_.width(words.MENU_TITLE, heading, bold=True), width - 2 * pad)
    title = pygame.Rect(pad, gap, text, type_.height(heading, bold=True))
    chips, below = _chips(contents.chips, type_, title, width - pad)
    foot_height = 0 if small else type_.height(SMALL) + gap // 2
    foot = pygame.Rect(pad, height - foot_height - gap // 3, width - 2 * pad, foot_height)
    top = below + gap
    opening = pygame.Rect(pad, top, width - 2 * pad, max(foot.top - top - gap // 3, 1))
    scrolled: dict[str, pygame.Rect] = {}
    y, strip = opening.top, None
    if contents.resume:
        strip = pygame.Rect(
            opening.left, y, opening.width, _strip_height(type_, contents.resume, opening.width)
        )
        scrolled.update(strip_buttons(strip, type_))
        y = strip.bottom + gap
    columns = max(1, min(MOST_COLUMNS, (opening.width + gap) // round(CARD * scale)))
    card_width = (opening.width - (columns - 1) * gap) // columns
    if contents.start:
        tall = min(banner_height(type_, opening.width), opening.height)
        scrolled[START] = pygame.Rect(opening.left, y, opening.width, tall)
        y = scrolled[START].bottom + gap
    tallest = max((card_height(type_, card, card_width) for card in contents.cards), default=0)
    tallest = min(tallest, opening.height)
    for index, card in enumerate(contents.cards):
        left = opening.left + (index % columns) * (card_width + gap)
        place = pygame.Rect(left, y + (index // columns) * (tallest + gap), card_width, tallest)
        scrolled[card.name] = place
        if card.tour:
            scrolled[TOUR + card.name.removeprefix(SCENE)] = tour_button(place, type_)
    bottom = max((rect.bottom for rect in scrolled.values()), default=opening.top)
    return MenuLayout(title, opening, foot, chips, scrolled, strip, bottom - opening.top)


def _chips(
    chips: Sequence[Chip], type_: Type, title: pygame.Rect, right: int
) -> tuple[dict[str, pygame.Rect], int]:
    """Beside the title at the right; under it, in as many lines as they need, where they don't fit. And the lowest edge."""
    scale = type_.scale
    tall, gap = type_.height(BODY) + round(12 * scale), round(8 * scale)
    widths = [type_.width(chip.text, BODY, bold=True) + round(24 * scale) for chip in chips]
    run = sum(widths) + gap * max(len(widths) - 1, 0)
    places: dict[str, pygame.Rect] = {}
    x, y = right - run, title.centery - tall // 2
    if x < title.right + gap:
        x, y = title.left, title.bottom + gap // 2
    for chip, width in zip(chips, widths, strict=True):
        width = min(width, right - title.left)
        if x + width > right:
            x, y = title.left, y + tall + gap
        places[chip.name] = pygame.Rect(x, y, width, tall)
        x += width + gap
    return places, max([title.bottom, *(rect.bottom for rect in places.values())])


def _strip_height(type_: Type, text: str, width: int) -> int:
    scale = type_.scale
    buttons = round(44 * scale)
    room = width - 2 * round(PAD * scale)
    lines = len(type_.wrapped(text, BODY, room))
    beside = type_.width(text, BODY) + _strip_buttons_width(type_) <= room
    text_height = type_.height(BODY)
    return (
        buttons + round(12 * scale) if beside else buttons + lines * text_height + round(18 * scale)
    )


def _strip_buttons_width(type_: Type) -> int:
    names = (words.TAKE_UP, words.DISCARD)
    return sum(type_.width(name, BODY, bold=True) + round(40 * type_.scale) for name in names)


def strip_buttons(strip: pygame.Rect, type_: Type) -> dict[str, pygame.Rect]:
    """The two buttons for what was left unfinished, at the right end of their strip."""
    scale = type_.scale
    tall, gap = round(44 * scale), round(8 * scale)
    right, places = strip.right - round(8 * scale), {}
    for name, text in ((DISCARD, words.DISCARD), (TAKE_UP, words.TAKE_UP)):
        width = min(type_.width(text, BODY, bold=True) + round(28 * scale), strip.width // 2 - gap)
        right -= width
        places[name] = pygame.Rect(right, strip.bottom - tall - round(6 * scale), width, tall)
        right -= gap
    return {name: places[name] for name in (TAKE_UP, DISCARD)}


def card_text_width(type_: Type, width: int, picture: int) -> int:
    """Room for text on a card of that width beside a picture [px]."""
    pad = round(PAD * type_.scale)
    return width - 2 * pad - (picture + pad if picture else 0)


def picture_side(type_: Type, width: int) -> int:
    """Of a card's thumbnail [px]; 0 where the card is too narrow to have one."""
    side = round(PICTURE * type_.scale)
    return side if width > 2.4 * side else 0


def card_height(type_: Type, card: Card, width: int) -> int:
    """As high as the text or the picture needs [px]."""
    scale = type_.scale
    picture = picture_side(type_, width)
    room = card_text_width(type_, width, picture)
    question = min(len(type_.wrapped(card.question, BODY, room)), QUESTION_LINES)
    about = min(len(type_.wrapped(card.about, SMALL, room)), ABOUT_LINES)
    lines = question * type_.height(BODY) + about * type_.height(SMALL)
    text = type_.height(HEADING, bold=True) + lines + round(8 * scale)
    return max(text, picture) + 2 * round(PAD * scale)


def tour_button(card: pygame.Rect, type_: Type) -> pygame.Rect:
    """The button for the tour: on the picture's lower left corner; without a picture in the card's upper right one."""
    scale = type_.scale
    width = type_.width(words.TOUR, SMALL, bold=True) + round(22 * scale)
    button = pygame.Rect(0, 0, width, type_.height(SMALL, bold=True) + round(12 * scale))
    inset = round(6 * scale)
    if picture_side(type_, card.width):
        button.bottomleft = card.left + inset, card.bottom - inset
    else:
        button.topright = card.right - inset, card.top + inset
    return button


def banner_height(type_: Type, width: int) -> int:
    """Of the card to start with [px]."""
    scale = type_.scale
    pad = round(PAD * scale)
    picture = banner_picture(type_, width)
    room = width - 2 * pad - (picture[0] + pad if picture[0] else 0)
    lines = len(type_.wrapped(words.START_QUESTION, HEADING, room, bold=True))
    text = type_.height(SMALL, bold=True) + lines * type_.height(HEADING, bold=True)
    text += len(type_.wrapped(words.START_ABOUT, BODY, room)) * type_.height(BODY)
    return max(text + round(8 * scale), picture[1]) + 2 * pad


def banner_picture(type_: Type, width: int) -> tuple[int, int]:
    """Width and height of the three hoppers on it [px]; nothing where it is too narrow."""
    side = round(118 * type_.scale)
    return (3 * side, side) if width > 5.5 * side else (0, 0)

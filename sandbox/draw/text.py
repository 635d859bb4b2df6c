"""Text in the bundled font, and in others what it has not: measured, shortened and rendered with a cache.

The font's digits all have one width, so a number that counts does not make its line jitter.
"""

from __future__ import annotations

import contextlib
import io
import re
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from functools import cache, lru_cache
from pathlib import Path

import pygame
import pygame.font

from sandbox.draw import scripts
from sandbox.draw.scripts import Piece
from sandbox.draw.theme import channels

SMALL = 14  # px at scale 1; nothing is smaller
BODY = 16
HEADING = 20
TITLE = 34

_FILES = {False: "SandboxSans-Regular.otf", True: "SandboxSans-SemiBold.otf"}
_CACHE_SIZE = 512
_FONTS = 64  # sizes that are kept, more than a window has at one scale
FIRM = "\u00a0"  # a space at which no line breaks
_LENGTH = re.compile(r"(?<=[0-9]) (?=R\b)")
BETWEEN = "  ·  "  # texts that share a line
_WHOLES = 64  # texts in boxes whose sizes are kept


def font_path(bold: bool = False) -> Path:
    """The font file: beside this module in an installed program, in assets/ in the repository."""
    here = Path(__file__).resolve().parent
    places = (here / "fonts", here.parents[1] / "assets" / "fonts")
    for place in places:
        if (place / _FILES[bold]).is_file():
            return place / _FILES[bold]
    raise FileNotFoundError(
        f"font {_FILES[bold]} is in none of {', '.join(str(place) for place in places)}"
    )


@cache
def _content(bold: bool) -> bytes:
    return font_path(bold).read_bytes()


@lru_cache(_FONTS)
def _font(
    size: int, bold: bool, path: str = "", script: str = "", leftward: bool = False
) -> pygame.font.Font:
    """The bundled font, or that of a file."""
    if not pygame.font.get_init():
        pygame.font.init()
    # From memory, as a font keeps the file open that it is read from.
    font = pygame.font.Font(io.BytesIO(scripts.content(path) if path else _content(bold)), size)
    with contextlib.suppress(pygame.error):  # a library without HarfBuzz
        if script:
            font.set_script(script)
        if leftward:
            font.set_direction(pygame.DIRECTION_RTL)
    return font


def _pieces(text: str, size: int, bold: bool) -> Iterator[tuple[Piece, pygame.font.Font]]:
    """The pieces of a text from the left, with their fonts."""
    for piece in scripts.pieces(text, _content(bold), bold):
        yield piece, _font(size, bold, piece.font, piece.script, piece.leftward)


@lru_cache(4 * _CACHE_SIZE)
def _width(text: str, size: int, bold: bool) -> int:
    """Measuring takes longer than one thinks, and a picture asks for the same hundred widths again and again."""
    return sum(font.size(piece.text)[0] for piece, font in _pieces(text, size, bold))


def _rendered(text: str, size: int, bold: bool, colour: int) -> pygame.Surface:
    """All pieces on one line, as high as the bundled font's."""
    pieces = list(_pieces(text, size, bold))
    shown = [font.render(piece.text, True, channels(colour)) for piece, font in pieces]
    if not any(piece.font for piece, _ in pieces):
        return shown[0]
    own = _font(size, bold)
    whole = sum(picture.get_width() for picture in shown), own.get_height()
    line, x = pygame.Surface(whole, pygame.SRCALPHA), 0
    for (_, font), picture in zip(pieces, shown, strict=True):
        line.blit(picture, (x, own.get_ascent() - font.get_ascent()))
        x += picture.get_width()
    return line


def page_scale(
    scale: float, size: tuple[int, int], designed: tuple[int, int] = (480, 360)
) -> float:
    """The UI scale for a page of text: larger where there is room, smaller where it would not fit.

    ``designed``: the smallest window [px] that the page fits at scale 1.
    """
    fitting = min(size[0] / designed[0], size[1] / designed[1])
    return min(1.3 * scale, max(fitting, SMALL / BODY))


def _kept_together(text: str) -> str:
    """With firm spaces between numbers and their units."""
    text = text.replace(" k R", f"{FIRM}k{FIRM}R").replace(" %", f"{FIRM}%")
    return _LENGTH.sub(FIRM, text)


class Type:
    """The type at one UI scale."""

    def __init__(self, scale: float) -> None:
        self.scale = scale
        self._cache: OrderedDict[tuple[str, int, bool, int], pygame.Surface] = OrderedDict()
        self._wholes: dict[object, tuple[float, list[str]]] = {}

    def pixels(self, size: float) -> int:
        """Font size in pixels of a size at scale 1; never below the smallest legible one."""
        return max(round(size * self.scale), SMALL)

    def height(self, size: float, bold: bool = False) -> int:
        """Height of a line [px]."""
        return _font(self.pixels(size), bold).get_height()

    def leading(self, size: float) -> int:
        """From a line to the next of a paragraph [px]: letters of some scripts rise above the height of a line."""
        return self.height(size) + 1

    def width(self, text: str, size: float, bold: bool = False) -> int:
        """Width of a text [px]."""
        return _width(text, self.pixels(size), bold)

    def caret(self, text: str, place: int, size: float) -> int:
        """Where what is typed before the character at ``place`` goes, from the text's left edge [px]."""
        x = edge = 0
        for piece, font in _pieces(text, self.pixels(size), False):
            width, inside = font.size(piece.text)[0], place - piece.start
            if 0 <= inside <= len(piece.text) and (inside or not place):
                before = font.size(piece.text[:inside])[0]
                edge = x + (width - before if piece.leftward else before)
            x += width
        return edge

    def spans(self, text: str, start: int, end: int, size: float) -> list[tuple[int, int]]:
        """From where to where the characters from ``start`` to ``end`` stand, from the text's left edge [px]."""
        x, found = 0, []
        for piece, font in _pieces(text, self.pixels(size), False):
            width = font.size(piece.text)[0]
            cuts = [min(max(cut - piece.start, 0), len(piece.text)) for cut in (start, end)]
            left, right = (font.size(piece.text[:cut])[0] for cut in cuts)
            if piece.leftward:
                left, right = width - right, width - left
            if right > left:
                found.append((x + left, x + right))
            x += width
        return found

    def fitting(self, text: str, size: float, width: float, bold: bool = False) -> float:
        """The largest size up to this one at which the text is no wider than that; the smallest legible one if there is none."""
        while self.width(text, size, bold) > width and self.pixels(size) > SMALL:
            size = (self.pixels(size) - 1) / self.scale
        return size

    def shortened(self, text: str, size: float, width: float, bold: bool = False) -> str:
        """The text, or as much of it as fits with an ellipsis; empty if not even that fits."""
        if self.width(text, size, bold) <= width:
            return text
        kept, dropped = 0, len(text)
        while dropped - kept > 1:
            middle = (kept + dropped) // 2
            if self.width(text[:middle].rstrip() + "…", size, bold) <= width:
                kept = middle
            else:
                dropped = middle
        return text[:kept].rstrip() + "…" if kept else ""

    def elided(self, text: str, size: float, width: float, bold: bool = False) -> str:
        """The text, or as much of its beginning and of its end as fits: names differ in the one or in the other."""
        if self.width(text, size, bold) <= width:
            return text
        kept, dropped = 0, len(text) // 2
        while dropped - kept > 1:
            middle = (kept + dropped) // 2
            if self.width(_ends(text, middle), size, bold) <= width:
                kept = middle
            else:
                dropped = middle
        return _ends(text, kept) if kept else self.shortened(text, size, width, bold)

    def wrapped(self, text: str, size: float, width: float, bold: bool = False) -> list[str]:
        """Lines no wider than the width, broken between words, but not within a unit; what is wider by itself is shortened."""
        parts = self._broken(text, size, width, bold)
        return [self.shortened(part, size, width, bold) for part in parts]

    def whole(
        self, texts: Sequence[str], size: float, width: float, height: float
    ) -> tuple[float, list[str]]:
        """The largest size up to this one at which all of the texts stand in a box, and their lines there.

        Each has lines of its own, or they follow one another with dots between where that takes less room. What does not fit at
        the smallest legible size either ends with an ellipsis.
        """
        key = (tuple(texts), size, round(width), round(height))
        if key not in self._wholes:
            if len(self._wholes) >= _WHOLES:
                self._wholes.clear()
            self._wholes[key] = self._fitted(*key)
        return self._wholes[key]

    def _fitted(
        self, texts: Sequence[str], size: float, width: float, height: float
    ) -> tuple[float, list[str]]:
        while True:
            most = max(int(height // self.leading(size)), 1)
            for parts in (texts, [BETWEEN.join(texts)]):
                lines = [line for part in parts for line in self._broken(part, size, width, False)]
                if len(lines) <= most and all(self.width(line, size) <= width for line in lines):
                    return size, lines
            if self.pixels(size) <= SMALL:
                lines = [self.shortened(line, size, width) for line in lines]
                if len(lines) > most:
                    last = self.shortened(f"{lines[most - 1]} …", size, width)
                    lines = [*lines[: most - 1], last]
                return size, lines
            size = (self.pixels(size) - 1) / self.scale

    def _broken(self, text: str, size: float, width: float, bold: bool) -> list[str]:
        lines: list[str] = []
        line = ""
        for word in _kept_together(text).split(" "):
            longer = f"{line} {word}" if line else word
            if line and self.width(longer, size, bold) > width:
                lines.append(line)
                longer = word
            line = longer
        if line:
            lines.append(line)
        return lines

    def render(self, text: str, size: float, colour: int, bold: bool = False) -> pygame.Surface:
        """The text as a picture with alpha."""
        key = (text, self.pixels(size), bold, colour)
        found = self._cache.get(key)
        if found is None:
            found = _rendered(text, key[1], bold, colour)
            self._cache[key] = found
            if len(self._cache) > _CACHE_SIZE:
                self._cache.popitem(last=False)
        else:
            self._cache.move_to_end(key)
        return found


def _ends(text: str, count: int) -> str:
    """So many signs of its beginning and of its end."""
    return f"{text[:count].rstrip()}…{text[-count:].lstrip()}"

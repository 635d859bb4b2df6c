"""Letters that the bundled font has not: each piece of a text in a font of the system's that has its signs, in the order in which
the pieces are seen.

What is written from right to left is turned by SDL's text library, piece by piece; lines as a whole go from left to right, as all
that stands round a name does. A sign that no font has is left to the bundled one.
"""

from __future__ import annotations

import io
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import groupby
from pathlib import Path

import pygame
import pygame.font
import pygame.freetype

# Families that have many scripts, of the systems that bring them; for others Noto's family of that script is tried first.
_FAMILIES = [
    "notosanscjksc",
    "notosanscjkjp",
    "notosanscjkkr",
    "notosans",
    "dejavusans",
    "freesans",
    "segoeui",
    "microsoftyahei",
    "yugothic",
    "msgothic",
    "malgungothic",
    "nirmalaui",
    "tahoma",
    "pingfangsc",
    "hiraginosansgb",
    "applesdgothicneo",
    "arialunicodems",
    "geezapro",
    "arial",
    "unifont",
]
# Scripts whose letters change with those beside them, by the first word of their letters' names; codes of ISO 15924.
_SHAPED = {
    "ARABIC": "Arab",
    "BENGALI": "Beng",
    "DEVANAGARI": "Deva",
    "GUJARATI": "Gujr",
    "GURMUKHI": "Guru",
    "HEBREW": "Hebr",
    "KANNADA": "Knda",
    "KHMER": "Khmr",
    "LAO": "Laoo",
    "MALAYALAM": "Mlym",
    "MYANMAR": "Mymr",
    "ORIYA": "Orya",
    "SINHALA": "Sinh",
    "SYRIAC": "Syrc",
    "TAMIL": "Taml",
    "TELUGU": "Telu",
    "THAANA": "Thaa",
    "THAI": "Thai",
    "TIBETAN": "Tibt",
}
_NUMBERS = ("EN", "AN")
_RIGHT_TO_LEFT = ("R", "AL")


@dataclass(frozen=True, slots=True)
class Piece:
    """Signs that are written with one font in one direction; they begin at ``start`` in the text as it is typed."""

    text: str
    start: int
    font: str = ""  # its file; empty: the bundled font
    leftward: bool = False

    @property
    def script(self) -> str:
        """Its code in ISO 15924, if letters of that script change with those beside them."""
        scripts = (_SHAPED.get(_script(sign), "") for sign in self.text)
        return next(filter(None, scripts), "")


@lru_cache(2048)
def pieces(text: str, bundled: bytes, bold: bool = False) -> tuple[Piece, ...]:
    """The pieces of a text from the left. ``bundled``: content of the font that is preferred."""
    if text.isascii() or all(_in_bundled(sign, bundled) for sign in text):
        return (Piece(text, 0),)
    found: list[Piece] = []
    levels = zip(_levels(text), _fonts_of(text, bundled, bold), range(len(text)), strict=True)
    for leftward, line in groupby(levels, key=lambda each: each[0] > 0):
        parts = []
        for (level, font), signs in groupby(line, key=lambda each: (each[0], each[1])):
            places = [place for _, _, place in signs]
            own = text[places[0] : places[-1] + 1]
            parts.append(Piece(own, places[0], font, level == 1))
        found += reversed(parts) if leftward else parts
    return tuple(found)


def _levels(text: str) -> list[int]:
    """0: to the right; 1: to the left; 2: a number within what goes to the left. The gist of Unicode's annex 9."""
    kinds = [unicodedata.bidirectional(sign) for sign in text]
    levels, leftward = [], False
    for kind in kinds:
        if kind in _RIGHT_TO_LEFT:
            leftward = True
        elif kind == "L":
            leftward = False
        strong = kind in (*_RIGHT_TO_LEFT, "L", "NSM")
        levels.append(int(leftward) if strong else 2 * leftward if kind in _NUMBERS else -1)
    before = 0
    for place, level in enumerate(levels):
        if level < 0:  # a sign without a direction takes that of both sides, if they agree
            after = next((following for following in levels[place:] if following >= 0), 0)
            levels[place] = int(before > 0 and after > 0)
        before = levels[place]
    return levels


def _fonts_of(text: str, bundled: bytes, bold: bool) -> Iterator[str]:
    """The font's file of every sign; spaces and marks keep to what is before them."""
    before = ""
    for sign in text:
        if sign != " " and not unicodedata.combining(sign):
            before = "" if _in_bundled(sign, bundled) else _found(sign, bold)
        yield before


def _script(sign: str) -> str:
    """ "ARABIC" of "ARABIC LETTER SEEN"."""
    return unicodedata.name(sign, "").partition(" ")[0]


@cache
def _found(sign: str, bold: bool) -> str:
    """The file of the first font that has a sign; empty if there is none."""
    installed = set(pygame.font.get_fonts())
    for family in (f"notosans{_script(sign).lower()}", *_FAMILIES):
        if family in installed:
            path = pygame.font.match_font(family, bold=bold) or pygame.font.match_font(family)
            if path and _has(path, sign):
                return path
    return ""


@cache
def content(path: str) -> bytes:
    """A font's file, in memory, as a font keeps the file open that it is read from."""
    return Path(path).read_bytes()


@cache
def _face(content_: bytes) -> pygame.freetype.Font:
    """Says which signs there are, which pygame.font does not."""
    if not pygame.freetype.get_init():
        pygame.freetype.init()
    return pygame.freetype.Font(io.BytesIO(content_), 16)


@lru_cache(4096)
def _in_bundled(sign: str, bundled: bytes) -> bool:
    return sign.isascii() or _face(bundled).get_metrics(sign)[0] is not None


@lru_cache(4096)
def _has(path: str, sign: str) -> bool:
    try:
        return _face(content(path)).get_metrics(sign)[0] is not None
    except (OSError, pygame.error):  # a font that is damaged is none
        return False

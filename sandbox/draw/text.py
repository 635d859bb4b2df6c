"""Text in the bundled font: measured, shortened and rendered with a cache.

The font's digits all have one width, so a number that counts does not make its line jitter.
"""

from __future__ import annotations

import io
from collections import OrderedDict
from functools import cache, lru_cache
from pathlib import Path

import pygame
import pygame.font

from sandbox.draw.theme import channels

SMALL = 14  # px at scale 1; nothing is smaller
BODY = 16
HEADING = 20
TITLE = 34

_FILES = {False: "SandboxSans-Regular.otf", True: "SandboxSans-SemiBold.otf"}
_CACHE_SIZE = 512
_FONTS = 64  # sizes that are kept, more than a window has at one scale
FIRM = "\u00a0"  # a space at which no line breaks


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
def _font(size: int, bold: bool) -> pygame.font.Font:
    if not pygame.font.get_init():
        pygame.font.init()
    # From memory, as a font keeps the file open that it is read from.
    return pygame.font.Font(io.BytesIO(_content(bold)), size)


@lru_cache(4 * _CACHE_SIZE)
def _width(text: str, size: int, bold: bool) -> int:
    """Measuring takes longer than one thinks, and a picture asks for the same hundred widths again and again."""
    return _font(size, bold).size(text)[0]


def page_scale(
    scale: float, size: tuple[int, int], designed: tuple[int, int] = (480, 360)
) -> float:
    """The UI scale for a page of text: larger where there is room, smaller where it would not fit.

    ``designed``: the smallest window [px] that the page fits at scale 1.
    """
    fitting = min(size[0] / designed[0], size[1] / designed[1])
    return min(1.3 * scale, max(fitting, SMALL / BODY))


class Type:
    """The type at one UI scale."""

    def __init__(self, scale: float) -> None:
        self.scale = scale
        self._cache: OrderedDict[tuple[str, int, bool, int], pygame.Surface] = OrderedDict()

    def pixels(self, size: float) -> int:
        """Font size in pixels of a size at scale 1; never below the smallest legible one."""
        return max(round(size * self.scale), SMALL)

    def height(self, size: float, bold: bool = False) -> int:
        """Height of a line [px]."""
        return _font(self.pixels(size), bold).get_height()

    def width(self, text: str, size: float, bold: bool = False) -> int:
        """Width of a text [px]."""
        return _width(text, self.pixels(size), bold)

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

    def wrapped(self, text: str, size: float, width: float, bold: bool = False) -> list[str]:
        """Lines no wider than the width, broken between words, but not within a unit."""
        lines: list[str] = []
        line = ""
        for word in text.replace(" k R", f"{FIRM}k{FIRM}R").split(" "):
            longer = f"{line} {word}" if line else word
            if line and self.width(longer, size, bold) > width:
                lines.append(line)
                longer = word
            line = longer
        if line:
            lines.append(line)
        return [self.shortened(part, size, width, bold) for part in lines]

    def render(self, text: str, size: float, colour: int, bold: bool = False) -> pygame.Surface:
        """The text as a picture with alpha."""
        key = (text, self.pixels(size), bold, colour)
        found = self._cache.get(key)
        if found is None:
            found = _font(key[1], bold).render(text, True, channels(colour))
            self._cache[key] = found
            if len(self._cache) > _CACHE_SIZE:
                self._cache.popitem(last=False)
        else:
            self._cache.move_to_end(key)
        return found

"""Colours: a dark theme, a light one for projectors, and the colour map for magnitudes.

Kinds carry Paul Tol's "vibrant" colours, which people with any common colour blindness can tell
apart (https://personal.sron.nl/~pault/); grains have them lighter and darker, so that kinds differ from the back row too, where a
grain is a dot, and for those who see no red. Magnitudes use cividis (Nunez, Anderton and Renslow 2018,
doi:10.1371/journal.pone.0199239; table CC0). A colour is an integer 0xRRGGBB.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError

Colours = NDArray[np.uint32]

REGULAR = 0x0077BB
AUXETIC = 0xEE3377
MIXED = 0x009988
HAND = 0xEE7733
EVENT = 0x33BBEE

# cividis at these of its 256 places; linear between them to within 2 levels of 255.
_CIVIDIS = (
    (0, 0x00224E),
    (17, 0x002E6C),
    (22, 0x003171),
    (28, 0x123570),
    (35, 0x203A6F),
    (53, 0x38476C),
    (86, 0x585E6D),
    (125, 0x7A7A78),
    (152, 0x938E78),
    (175, 0xAAA073),
    (203, 0xC7B767),
    (234, 0xE9D34E),
    (246, 0xF7DE3E),
    (251, 0xFDE334),
    (255, 0xFEE838),
)


@dataclass(frozen=True, slots=True)
class Theme:
    """All colours of one look."""

    name: str
    ground: int  # behind the grains
    panel: int  # behind text: header, plot, status line, cards
    hairline: int  # borders and grid
    text: int
    soft_text: int  # labels and hints; still 7:1
    wall: int
    piston: int
    intruder: int
    regular: int  # grains: the colours of the kinds, as far apart in lightness as the ground allows
    auxetic: int
    good: int  # lamps
    working: int
    bad: int
    ramp: tuple[float, float]  # part of cividis used, from no force to the largest


DARK = Theme(
    name="dark",
    ground=0x101418,
    panel=0x181E24,
    hairline=0x3A444D,
    text=0xF4F6F7,
    soft_text=0xB9C2C9,
    wall=0x59636B,
    piston=0x8B959D,
    intruder=0xB4BDC4,
    regular=0x006BAA,
    auxetic=0xF588AF,
    good=0x3DBE6C,
    working=0xF2B632,
    bad=0xF0533A,
    ramp=(0.30, 1.0),  # the darkest part would vanish on the dark ground
)

LIGHT = Theme(
    name="light",
    ground=0xFAFAF7,
    panel=0xF0F0EB,
    hairline=0xC3C6C4,
    text=0x14181C,
    soft_text=0x3E464D,
    wall=0xA3A9AE,
    piston=0x7C858C,
    intruder=0x59636B,
    regular=0x00477F,
    auxetic=0xEE4C86,
    good=0x1E8A4A,
    working=0xC98300,
    bad=0xC7300F,
    ramp=(0.78, 0.0),  # reversed, so that the largest force stands out most on a light ground
)

THEMES = {theme.name: theme for theme in (DARK, LIGHT)}


def theme_named(name: str) -> Theme:
    """The theme of that name."""
    try:
        return THEMES[name]
    except KeyError:
        raise InputError(f"unknown theme {name!r}: choose dark or light") from None


def channels(colour: int) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255."""
    return colour >> 16 & 255, colour >> 8 & 255, colour & 255


def mix(first: int, second: int, share: float) -> int:
    """``share`` in 0..1 of the second colour in the first."""
    parts = zip(channels(first), channels(second), strict=True)
    red, green, blue = (round(a + (b - a) * share) for a, b in parts)
    return red << 16 | green << 8 | blue


def kind_colour(theme: Theme, kind: str) -> int:
    """The colour of regular or of auxetic grains."""
    return theme.auxetic if kind == "auxetic" else theme.regular


def packing_colour(packing: str) -> int:
    """The colour of a packing's curve."""
    return {"regular": REGULAR, "auxetic": AUXETIC}.get(packing, MIXED)


def packing_dash(packing: str) -> tuple[float, ...]:
    """The dash of a packing's curve, lengths on and off at scale 1 [px]: never colour alone."""
    return {"regular": (), "auxetic": (12.0, 7.0)}.get(packing, (3.0, 6.0))


def _cividis_table() -> Colours:
    places = [place for place, _ in _CIVIDIS]
    table = np.zeros(256, dtype=np.uint32)
    for shift in (16, 8, 0):
        levels = [colour >> shift & 255 for _, colour in _CIVIDIS]
        values = np.rint(np.interp(np.arange(256), places, levels)).astype(np.uint32)
        table |= values << np.uint32(shift)
    return table


CIVIDIS: Colours = _cividis_table()


def magnitude_colours(
    theme: Theme, share: NDArray[np.float64], ramp: tuple[float, float] | None = None
) -> Colours:
    """Colours of magnitudes given as shares 0..1 of the scale's top; (N,) -> uint32 (N,).

    ``ramp``: the part of cividis, from no force to the top; without it the theme's.
    """
    start, end = theme.ramp if ramp is None else ramp
    bounded = np.clip(np.nan_to_num(share, nan=0.0), 0.0, 1.0)
    colours: Colours = CIVIDIS[np.rint(255.0 * (start + (end - start) * bounded)).astype(np.intp)]
    return colours

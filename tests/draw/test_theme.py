"""Colours: legible, distinguishable, in the right order."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from sandbox.draw.theme import (
    AUXETIC,
    CIVIDIS,
    HAND,
    MIXED,
    REGULAR,
    THEMES,
    Theme,
    channels,
    magnitude_colours,
    mix,
    packing_colour,
    theme_named,
)
from tests.draw.contrast import EYES, contrast

ALL = pytest.mark.parametrize("theme", THEMES.values(), ids=THEMES)


def test_contrast_of_known_pairs() -> None:
    # WCAG 2.1: black on white is 21, a colour on itself 1; #777777 on white is 4.48.
    assert contrast(0x000000, 0xFFFFFF) == pytest.approx(21.0)
    assert contrast(0x336699, 0x336699) == 1.0
    assert contrast(0x777777, 0xFFFFFF) == pytest.approx(4.48, abs=0.01)


@ALL
def test_text_stands_out(theme: Theme) -> None:
    for ground in (theme.ground, theme.panel, mix(theme.panel, HAND, 0.10)):
        for text in (theme.text, theme.soft_text):
            assert contrast(text, ground) >= 7.0


@ALL
def test_grains_marks_and_lamps_stand_out(theme: Theme) -> None:
    # WCAG 2.1, 1.4.11: 3:1 for what must be seen and is no text.
    for colour in (theme.regular, theme.auxetic):
        assert contrast(colour, theme.ground) >= 3.0
    for colour in (theme.good, theme.bad):
        assert contrast(colour, theme.panel) >= 3.0
    assert contrast(theme.working, theme.panel) >= 2.5  # amber on white; its words are beside it


@ALL
@pytest.mark.parametrize("eyes", EYES)
def test_kinds_differ_in_lightness(theme: Theme, eyes: str) -> None:
    """Without any colour, to all eyes: once with published blue and pink it was 1.2."""
    assert contrast(theme.regular, theme.auxetic, eyes) >= 1.7
    assert contrast(theme.regular, theme.auxetic) >= 2.2


def test_kinds_are_the_published_colours() -> None:
    assert (REGULAR, AUXETIC, MIXED, HAND) == (0x0077BB, 0xEE3377, 0x009988, 0xEE7733)
    assert packing_colour("regular") == REGULAR
    assert packing_colour("auxetic") == AUXETIC
    assert packing_colour("mixed") == MIXED


def test_cividis_gets_lighter_all_the_way() -> None:
    light = [contrast(int(colour), 0x000000) for colour in CIVIDIS]
    assert int(CIVIDIS[0]) == 0x00224E
    assert int(CIVIDIS[255]) == 0xFEE838
    assert np.all(np.diff(light) > -0.02)  # the published table wavers by a rounding too
    assert light[-1] > 10 * light[0]


@ALL
def test_the_largest_force_stands_out_most(theme: Theme) -> None:
    colours = magnitude_colours(theme, np.linspace(0.0, 1.0, 30))
    seen = [contrast(int(colour), theme.ground) for colour in colours]
    assert np.all(np.diff(seen) > -0.05)
    assert seen[0] < 0.4 * seen[-1]


def test_magnitudes_out_of_range_are_bounded() -> None:
    theme = theme_named("dark")
    odd = magnitude_colours(theme, np.array([np.nan, -1.0, 7.0, np.inf]))
    ends = magnitude_colours(theme, np.array([0.0, 0.0, 1.0, 1.0]))
    assert np.array_equal(odd, ends)


def test_unknown_theme_is_named() -> None:
    with pytest.raises(InputError, match=r"sepia.*dark or light"):
        theme_named("sepia")


def test_mix_and_channels() -> None:
    assert channels(0x123456) == (0x12, 0x34, 0x56)
    assert mix(0x000000, 0xFF8000, 0.5) == 0x804000
    assert mix(0x112233, 0xFFFFFF, 0.0) == 0x112233

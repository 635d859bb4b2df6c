"""Controls: scales of sliders, where everything stands, what it looks like."""

from __future__ import annotations

import os
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pygame
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.draw.painter import Painter
from sandbox.draw.text import Type
from sandbox.draw.theme import MIXED, THEMES, mix, theme_named
from sandbox.draw.widgets.controls import (
    TARGET,
    Button,
    Choice,
    Control,
    Fact,
    Heading,
    Note,
    Option,
    Row,
    Slider,
    Stepper,
    Switch,
    TextField,
    arranged,
    neighbour,
    parts_of,
    slid_to,
)
from sandbox.draw.widgets.look import Attention, Typing, ring_colour
from sandbox.draw.widgets.panel_frame import foot_height, panel_picture
from sandbox.draw.widgets.scale import Range, shown, typed
from sandbox.words import language
from scenes import registry
from tests.draw.contrast import contrast

GOLDEN = Path(__file__).parent / "golden"
LEVELS = 2  # a processor may round the last bit of a distance differently

RANGES = sorted(
    {
        Range(float(p.low), float(p.high), isinstance(p.default, int))
        for name in registry.names()
        for p in registry.get(name).parameters
        if not isinstance(p.default, bool)
    },
    key=str,
)

CONTROLS: list[Control] = [
    Choice(
        "general/packing",
        "packing",
        (Option("regular", "regular", 0x0077BB), Option("mixed", "mixed", MIXED)),
        "mixed",
        "Which grains are packed.",
    ),
    Choice("general/view", "view", tuple(Option(str(k), "force chains") for k in range(8)), "3"),
    Row((Stepper("general/seed", "seed", 7, 0, 99), Button("general/new", "new")), (3.0, 1.4)),
    Row((Button("general/reset", "reset"), Button("general/brush", "brush", on=True))),
    Row((Button("general/undo", "undo", enabled=False), Button("general/x", "×"))),
    Heading("grains", "Grains", open=True),
    Slider("grains/nu", "Poisson's ratio, auxetic", -0.35, -0.99, -0.01, -0.8, at_once=True),
    Slider("grains/c", "contact stiffness", 200.0, 5.0, 1000.0, 50.0, "k", mark="packs anew"),
    Switch("grains/four", "four plates", True, False, "packs anew"),
    TextField("files/name", "name", "my-scene", colour=MIXED),
    Fact("pressure", "0.1340 k", strong=True),
    Note("Mouse, or arrow keys and Enter on the canvas, and this goes on for two lines"),
    Heading("solver", "Solver", open=False),
]


@pytest.fixture(autouse=True)
def english() -> Iterator[None]:
    language.use("en")
    yield
    language.use("en")


# -- scales --


@pytest.mark.parametrize("range_", RANGES, ids=str)
def test_track_covers_the_range_in_order(range_: Range) -> None:
    values = [range_.value(share) for share in np.linspace(0.0, 1.0, 301)]
    assert values[0] == range_.low
    assert values[-1] == range_.high
    assert values == sorted(values)
    for value in values:
        assert range_.low <= value <= range_.high
        assert range_.value(range_.share(value)) == pytest.approx(value, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("range_", RANGES, ids=str)
@pytest.mark.parametrize("pages", [False, True])
def test_keys_lead_from_one_end_to_the_other(range_: Range, pages: bool) -> None:
    value, presses = range_.low, 0
    while value < range_.high:
        further = range_.stepped(value, 1, pages=pages)
        assert further > value
        assert further == int(further) or not range_.whole
        value, presses = further, presses + 1
        assert presses < 700
    while value > range_.low:
        back = range_.stepped(value, -1, pages=pages)
        assert back < value
        value = back


@pytest.mark.parametrize("range_", RANGES, ids=str)
def test_numbers_of_a_slider_are_short(range_: Range) -> None:
    for share in np.linspace(0.0, 1.0, 57):
        assert len(shown(range_.value(share))) <= 8


def test_numbers_can_be_typed_as_they_are_shown() -> None:
    assert [shown(value) for value in (0.8, -0.35, 8000.0, 1e-8, float("nan"))] == [
        "0.8",
        "−0.35",
        "8000",
        "1e−8",
        "—",
    ]
    language.use("de")
    assert shown(-0.35) == "−0,35"
    assert float(typed(" −0,35 ")) == -0.35
    assert float(typed(shown(1.5e-8))) == 1.5e-8


# -- places --


@settings(max_examples=60, deadline=None)
@given(scale=st.floats(1.0, 3.0), width=st.integers(280, 1200))
def test_nothing_overlaps_and_targets_are_large(scale: float, width: int) -> None:
    width = max(width, round(280 * scale))
    type_ = Type(scale)
    places = arranged(CONTROLS, type_, width)
    rects = [place.rect for place in places.all]
    for first, second in combinations(rects, 2):
        assert not first.colliderect(second)
    assert all(rect.left >= 0 and rect.right <= width for rect in rects)
    assert max(rect.bottom for rect in rects) <= places.height
    for place in places.all:
        if not place.control.name:
            continue
        assert place.rect.height >= round(TARGET * scale)
        parts = parts_of(place.control, place.rect, type_)
        pressable = [*parts.options, *(parts.arrows or ())]
        if isinstance(place.control, (Slider, Stepper)):
            pressable.append(parts.box)
        for rect in pressable:
            assert place.rect.contains(rect)
            assert rect.height >= round(TARGET * scale)
            assert rect.width >= round(30 * scale)


def test_stops_leave_out_what_cannot_be_used() -> None:
    stops = arranged(CONTROLS, Type(1.0), 316).stops()
    assert "general/undo" not in stops
    assert "" not in stops
    assert len(stops) == len(set(stops)) == 13


@pytest.mark.parametrize("name", ["general/packing", "grains/four", "solver"])
@pytest.mark.parametrize("scroll", [0, 60, 10_000])
def test_any_control_can_be_scrolled_into_view(name: str, scroll: int) -> None:
    places = arranged(CONTROLS, Type(1.0), 316)
    view = 200
    moved = places.scroll_to(name, scroll, view, 0)
    place = places.named(name)
    assert place is not None
    assert place.rect.top - moved >= 0
    assert place.rect.bottom - moved <= view


def test_what_can_only_be_read_is_not_found_by_its_empty_name() -> None:
    places = arranged(CONTROLS, Type(1.0), 316)
    assert places.named("") is None
    fact = next(place for place in places.all if isinstance(place.control, Fact))
    assert places.at(*fact.rect.center) is None


def test_choice_shows_all_where_there_is_room_and_one_where_not() -> None:
    type_ = Type(1.0)
    places = arranged(CONTROLS[:2], type_, 316).all
    all_shown, one_shown = (parts_of(place.control, place.rect, type_) for place in places)
    assert len(all_shown.options) == 2
    assert all_shown.arrows is None
    assert one_shown.options == ()
    assert one_shown.arrows is not None


def test_neighbours_of_a_choice_go_round() -> None:
    choice = Choice("c", "", tuple(Option(word, word) for word in "abc"), "c")
    assert (neighbour(choice, 1), neighbour(choice, -1)) == ("a", "b")
    lost = Choice("c", "", choice.options, "unknown")
    assert (neighbour(lost, 1), neighbour(lost, -1)) == ("a", "c")


def test_track_goes_from_end_to_end() -> None:
    place = arranged([CONTROLS[6]], Type(1.0), 316).all[0]
    assert isinstance(place.control, Slider)
    parts = parts_of(place.control, place.rect, Type(1.0))
    assert slid_to(place.control, parts, parts.track.left - 30) == -0.99
    assert slid_to(place.control, parts, parts.track.right + 30) == -0.01
    assert slid_to(place.control, parts, parts.track.centerx) == pytest.approx(-0.5, abs=0.01)


# -- looks --


@pytest.fixture
def texts(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, pygame.Rect]]:
    """Every text that is drawn, and its place."""
    written: list[tuple[str, pygame.Rect]] = []
    original = Painter.text

    def text(self: Painter, content: str, x: float, y: float, **more: Any) -> pygame.Rect:
        place = original(self, content, x, y, **more)
        written.append((content, place.clip(more.get("clip") or place)))
        return place

    monkeypatch.setattr(Painter, "text", text)
    return written


def picture(
    scale: float, theme: str, attention: Attention, height: int = 640, scroll: int = 0
) -> pygame.Surface:
    type_ = Type(scale)
    width = round(316 * scale)
    places = arranged(CONTROLS, type_, width)
    size = width, round(height * scale)
    return panel_picture(size, places, scroll, attention, theme_named(theme), type_)


@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0, 3.0])
def test_texts_stay_in_the_panel_and_apart(
    texts: list[tuple[str, pygame.Rect]], scale: float
) -> None:
    typing = Attention("grains/nu", "general/packing", Typing("grains/nu", "-0.123456789012", 9, 9))
    surface = picture(scale, "dark", typing, height=900)
    assert texts
    for content, place in texts:
        assert surface.get_rect().contains(place), content
    in_view = [text for text in texts if text[0]]
    for (first, place), (second, other) in combinations(in_view[:-1], 2):
        assert not place.inflate(0, -2).colliderect(other), (first, second)


@pytest.mark.parametrize("theme", THEMES)
def test_words_can_be_read_and_the_ring_be_seen(theme: str) -> None:
    colours = theme_named(theme)
    for ground in (colours.panel, mix(colours.panel, colours.text, 0.06)):
        assert contrast(colours.text, ground) >= 7.0
    assert contrast(colours.soft_text, colours.panel) >= 7.0
    assert contrast(colours.text, mix(colours.panel, colours.text, 0.14)) >= 7.0
    assert contrast(ring_colour(colours), colours.panel) >= 3.0


def test_focus_and_hover_change_the_picture() -> None:
    seen = {
        pygame.image.tobytes(picture(1.0, "dark", attention), "RGB")
        for attention in (
            Attention(),
            Attention(focus="grains/c"),
            Attention(hover="grains/c"),
            Attention("grains/c", "", Typing("grains/c", "12", 2, 2)),
            Attention("grains/c", "", Typing("grains/c", "12", 2, 0)),
            Attention("grains/c", "", Typing("grains/c", "12", 2, 2, "ka")),
        )
    }
    assert len(seen) == 6


def test_low_panel_has_no_foot() -> None:
    assert foot_height(150, Type(1.0)) == 0
    assert foot_height(900, Type(1.0)) > 3 * Type(1.0).height(14)


@pytest.mark.parametrize(
    ("name", "scale", "theme"),
    [("panel-dark", 1.0, "dark"), ("panel-light", 1.0, "light"), ("panel-scale-2", 2.0, "dark")],
)
def test_golden_panel(name: str, scale: float, theme: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # Without texts: they depend on the version of the font renderer. Places have fixed heights.
    monkeypatch.setattr(Painter, "text", lambda *_, **__: pygame.Rect(0, 0, 40, 16))
    monkeypatch.setattr(
        Type, "height", lambda self, size, bold=False: round(1.25 * size * self.scale)
    )
    monkeypatch.setattr(
        Type,
        "width",
        lambda self, text, size, bold=False: round(0.5 * size * len(text) * self.scale),
    )
    surface = picture(scale, theme, Attention("grains/c", "general/reset"))
    seen = pygame.surfarray.array3d(surface)
    path = GOLDEN / f"{name}.png"
    if os.environ.get("SANDBOX_REGENERATE_GOLDEN"):
        pygame.image.save(surface, str(path))
    wanted = pygame.surfarray.array3d(pygame.image.load(str(path)))
    assert wanted.shape == seen.shape
    difference = np.abs(wanted.astype(int) - seen.astype(int)).max(axis=-1)
    assert difference.max() <= LEVELS, f"{(difference > LEVELS).sum()} pixels differ from {path}"

"""Nothing overlaps and everything fits, at any size and scale."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import pygame
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.draw.camera import Camera
from sandbox.draw.layout import SEAM, layout
from sandbox.draw.pages.cards import draw_error
from sandbox.draw.pages.help_page import draw_help
from sandbox.draw.pages.menu_layout import SCENE, Card, Chip, Contents, menu_layout
from sandbox.draw.pages.menu_page import draw_menu
from sandbox.draw.pages.splash import draw_splash
from sandbox.draw.render import Renderer
from sandbox.draw.text import Type
from tests.draw.frames import empty_frame, hopper_frame, intruder_frame

sizes = st.tuples(st.integers(480, 3840), st.integers(360, 2160))
scales = st.floats(1.0, 3.0)

SIZES = [(480, 360), (640, 480), (1280, 720), (1024, 1366), (1920, 1080), (3840, 2160)]
SCALES = [1.0, 1.5, 2.0, 3.0]
FRAMES = {
    "intruder": intruder_frame(6, increment=123456, grains_out=299, protocol=True, busy=True),
    "hopper": hopper_frame(),
    "empty": empty_frame(),
    "long words": intruder_frame(
        6,
        title="A title that is much longer than any that a scene of this program has",
        scene="a_scene_with_a_long_name",
        stop_reason="collapsed",
        curve_label="force on something with a long name, seen from the left [k R]",
        notices=("a notice that goes on and on and will not stop before the window's edge " * 2,),
    ),
}
CARDS = [
    Card(
        f"{SCENE}s{index}",
        f"Scene {index}",
        "What happens, and why? " * 3,
        "It says so. " * 9,
        "hopper",
        index % 2 == 0,
    )
    for index in range(9)
]
CHIPS = tuple(
    Chip(name, name) for name in ("regular", "auxetic", "mixed", "language", "theme", "keys")
)


@given(
    size=sizes,
    scale=scales,
    panes=st.integers(1, 3),
    panel=st.booleans(),
    timeline=st.booleans(),
    card=st.integers(0, 1200),
)
def test_layout_fills_the_window_without_overlap(
    size: tuple[int, int], scale: float, panes: int, panel: bool, timeline: bool, card: int
) -> None:
    places = layout(size, scale, panes=panes, panel=panel, timeline=timeline, card=card)
    assert len(places.canvases) == panes
    window = pygame.Rect((0, 0), size)
    for rect in places.rects():
        assert window.contains(rect) or rect.height == 0 or rect.width == 0
    for first, second in combinations(places.rects(), 2):
        assert not first.colliderect(second)
    seams = (panes - 1) * round(SEAM * scale) * places.canvas.height
    assert sum(rect.width * rect.height for rect in places.rects()) + seams == size[0] * size[1]
    assert places.canvas.height >= 0.33 * size[1]
    assert not (places.panel.width and places.card.width)
    assert sum(rect.width for rect in places.canvases) >= 0.5 * size[0]
    assert places.status.height > 0


def check(texts: list[tuple[str, pygame.Rect]], window: pygame.Rect) -> None:
    for content, place in texts:
        assert window.contains(place), (content, place, window)
    for (first, place), (second, other) in combinations(texts, 2):
        assert not place.colliderect(other), (first, place, second, other)


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("name", FRAMES)
def test_texts_fit_their_places(
    texts: list[tuple[str, pygame.Rect]], name: str, scale: float, size: tuple[int, int]
) -> None:
    renderer = Renderer(size, scale)
    renderer.draw(FRAMES[name], rate="60 frames/s · 12 ms", paused=True)
    assert texts
    places = renderer.layout
    for strip in (places.header, places.plot, places.status):
        inside = [(content, place) for content, place in texts if strip.colliderect(place)]
        check(inside, strip)
    for content, place in texts:
        assert any(rect.contains(place) for rect in places.rects()), (content, place)


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("page", ["menu", "help", "error"])
def test_pages_fit_the_window(
    texts: list[tuple[str, pygame.Rect]], page: str, scale: float, size: tuple[int, int]
) -> None:
    painter = Renderer(size, scale).painter()
    window = pygame.Rect((0, 0), size)
    if page == "menu":
        contents = Contents(tuple(CARDS), CHIPS, "Something was left unfinished, a minute ago.")
        places = draw_menu(painter, contents, chosen=CARDS[4].name, scroll=0)
        check(texts, window)
        for first, second in combinations((places.title, *places.chips.values()), 2):
            assert not first.colliderect(second)
    elif page == "help":
        assert window.contains(draw_help(painter).card)
        check(texts, window)
        assert not any("…" in text for text, _ in texts)
    else:
        assert window.contains(draw_error(painter, "Something went wrong in a long way. " * 6))
        check(texts, window)


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("scale", SCALES)
def test_splash_draws_at_any_size(size: tuple[int, int], scale: float) -> None:
    renderer = Renderer(size, scale)
    for fraction in (float("nan"), 0.0, 0.4, 1.0):
        draw_splash(
            renderer.surface,
            renderer.theme,
            renderer.type,
            text="packing the grains",
            fraction=fraction,
            seconds=1.0,
        )


@settings(max_examples=30, deadline=None)
@given(size=sizes, scale=scales, count=st.integers(1, 12))
def test_anything_in_the_menu_can_be_scrolled_into_view(
    size: tuple[int, int], scale: float, count: int
) -> None:
    type_ = Type(min(scale, size[0] / 480, size[1] / 360))
    cards = tuple(replace(CARDS[0], name=f"{SCENE}{index}") for index in range(count))
    places = menu_layout(size, type_, Contents(cards, CHIPS, "Something was left unfinished."))
    scroll = 0
    for name in [*places.scrolled, *reversed(places.scrolled)]:
        scroll = places.scroll_to(name, scroll)
        shown = places.shown(name, scroll)
        assert shown is not None
        assert places.opening.contains(shown)


@settings(max_examples=30, deadline=None)
@given(size=sizes, scale=scales, resume=st.booleans())
def test_arrows_reach_everything_in_the_menu(
    size: tuple[int, int], scale: float, resume: bool
) -> None:
    type_ = Type(min(scale, size[0] / 480, size[1] / 360))
    left = "Something was left unfinished." if resume else ""
    places = menu_layout(size, type_, Contents(tuple(CARDS), CHIPS, left))
    reached, waiting = set(), [places.stops()[0]]
    while waiting:
        here = waiting.pop()
        reached.add(here)
        ways = ((1, 0), (-1, 0), (0, 1), (0, -1))
        waiting += [there for way in ways if (there := places.neighbour(here, way)) not in reached]
    assert reached == set(places.stops())


@given(
    size=sizes,
    bounds=st.tuples(*[st.floats(-100, 100)] * 2, *[st.floats(1, 300)] * 2),
    place=st.tuples(st.floats(-50, 50), st.floats(-50, 50)),
)
def test_camera_shows_all_and_goes_there_and_back(
    size: tuple[int, int],
    bounds: tuple[float, float, float, float],
    place: tuple[float, float],
) -> None:
    x, y, width, height = bounds
    rect = pygame.Rect(7, 11, *size)
    camera = Camera.fit((x, y, x + width, y + height), rect, 10.0)
    left, top = camera.to_screen(x, y + height)
    right, bottom = camera.to_screen(x + width, y)
    assert left >= rect.left + 9.99
    assert right <= rect.right - 9.99
    assert top >= rect.top + 9.99
    assert bottom <= rect.bottom - 9.99
    assert camera.to_world(*camera.to_screen(*place)) == pytest.approx(place, abs=1e-6)


def test_camera_survives_bounds_that_are_none() -> None:
    nan = float("nan")
    camera = Camera.fit((nan, 0.0, 1.0, 1.0), pygame.Rect(0, 0, 100, 100), 5.0)
    assert camera.scale > 0.0

"""Words are longer in one language than in another: they fit all the same."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pygame
import pytest

from sandbox.draw.pages.help_page import draw_help
from sandbox.draw.pages.tour_card import TourPage, card_layout, draw_tour_card
from sandbox.draw.render import Renderer
from sandbox.draw.text import Type
from sandbox.draw.views import VIEWS
from sandbox.lessons import tours
from sandbox.window.menu import Menu
from sandbox.words import language, words
from tests.draw.frames import hopper_frame, intruder_frame

SIZES = [(1280, 720), (1920, 1080)]
TIGHT = ((800, 600), 3.0)  # a small window and large letters
CARD = 296  # width of a tour's card above the panel at scale 1 [px]


@pytest.fixture(autouse=True, params=language.available())
def spoken(request: pytest.FixtureRequest) -> Iterator[None]:
    language.use(request.param)
    yield
    language.use(language.SOURCE)


def nothing_cut(texts: list[tuple[str, pygame.Rect]], window: tuple[int, int]) -> None:
    assert texts
    assert [content for content, _ in texts if "…" in content] == []
    for content, place in texts:
        assert pygame.Rect((0, 0), window).contains(place), content


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("view", VIEWS)
def test_the_picture_of_a_run(
    texts: list[tuple[str, pygame.Rect]], view: str, size: tuple[int, int]
) -> None:
    plain = intruder_frame(8, title="Intruder")
    known = replace(plain, usual_error=0.0065, force_error=0.026, beyond_cone=0.013)
    for frame in (hopper_frame(title="Hopper"), plain, known):
        Renderer(size, view=view).draw(frame, rate=words.RATE.format(fps=60, ms=12), paused=True)
    nothing_cut(texts, size)


@pytest.mark.parametrize(("size", "scale"), [(SIZES[0], 1.0), (SIZES[1], 1.5), TIGHT], ids=str)
def test_the_menu(
    texts: list[tuple[str, pygame.Rect]], scale: float, size: tuple[int, int]
) -> None:
    menu, renderer = Menu(), Renderer(size, scale)
    menu.resume = lambda: words.LEFT_UNFINISHED.format(
        scene=words.title("gravity_hopper"), grains=1234, when=words.AGO_HOURS.format(count=12)
    )
    for _ in range(12):  # from the top to the foot
        menu.draw(renderer.painter(), "mixed", "")
        menu.wheel(-3.0, 60)
    nothing_cut(texts, size)


@pytest.mark.parametrize(
    ("size", "scale"), [(SIZES[0], 1.0), (SIZES[0], 3.0), (SIZES[1], 2.0), TIGHT], ids=str
)
def test_the_page_of_keys(
    texts: list[tuple[str, pygame.Rect]], scale: float, size: tuple[int, int]
) -> None:
    renderer = Renderer(size, scale)
    places = draw_help(renderer.painter())
    scroll = 0
    while scroll < places.most_scroll:  # what does not fit is seen by scrolling
        scroll = min(scroll + places.opening.height // 2, places.most_scroll)
        places = draw_help(renderer.painter(), scroll)
    nothing_cut(texts, size)
    for _, rows in words.help_groups():
        for key, meaning in rows:
            assert {key, meaning} <= {content for content, _ in texts}


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_cards_of_tours_fit_above_the_panel(
    texts: list[tuple[str, pygame.Rect]], scale: float
) -> None:
    size = (round(1280 * scale), round(720 * scale))
    renderer = Renderer(size, scale)
    for scene in tours.scenes():
        steps = tours.steps(scene)
        for index, step in enumerate(steps):
            say, do, why = str(step.say), str(step.do), str(step.why)
            page = TourPage(
                words.title(scene), index, len(steps), say, do, True, why, words.TOUR_NEXT
            )
            width = round(CARD * scale)
            height = card_layout(page, Type(scale), width).height
            assert height < 0.7 * size[1], (scene, step.key)
            painter = renderer.painter()
            texts.clear()
            card = pygame.Rect(10, 10, width, height)
            draw_tour_card(painter, card, page, focus="", hover="")
            painter.flush()
            nothing_cut(texts, size)
            # Numbers stay with their units.
            written = " ".join(content for content, _ in texts).replace("\u00a0", " ")
            assert all(part in written for part in (say, do, why))
            for content, place in texts:
                assert card.contains(place), (scene, step.key, content)

"""Words are longer in one language than in another: they fit all the same."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pygame
import pytest

from sandbox.draw.pages.help_page import draw_help
from sandbox.draw.pages.tour_card import Field, TourPage, card_layout, draw_tour_card
from sandbox.draw.render import Renderer
from sandbox.draw.text import Type
from sandbox.draw.views import VIEWS
from sandbox.lessons import classroom, tours
from sandbox.lessons.lesson import Lesson
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


def pages_of(lesson: Lesson) -> Iterator[tuple[str, TourPage, tuple[str, ...]]]:
    """What the card shows in each step while it asks and when it has told all, and the texts on it."""
    title = str(lesson.title) or words.title(lesson.scene)
    for index, step in enumerate(lesson.steps):
        say, do, why = str(step.say), str(step.do), str(step.why)
        predict, count = step.predict, len(lesson.steps)
        if predict is not None:
            options, ask = tuple(map(str, predict.options)), str(predict.ask)
            field = Field("1234,5", predict.unit) if predict.kind == "number" else None
            hint = words.ASK_SKETCH if predict.kind == "sketch" else ""
            asking = TourPage(
                title,
                index,
                count,
                say,
                onward=words.ASK_KEEP,
                ask=ask,
                options=options,
                field=field,
                hint=hint,
            )
            yield step.key, asking, (say, ask, hint, *options)
            longest = max((*options, "1234 k R"), key=len)
            said = words.ASK_SAID.format(given=longest), words.ASK_RATHER.format(right=longest)
            why = " ".join(part for part in (*said, str(predict.answer), why) if part)
        told = TourPage(title, index, count, say, do, True, why, words.TOUR_NEXT)
        yield step.key, told, (say, do, why)


LESSONS = [
    *(tours.tour(scene) for scene in tours.scenes()),
    *map(classroom.lesson, classroom.names()),
]


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_cards_fit_above_the_panel(texts: list[tuple[str, pygame.Rect]], scale: float) -> None:
    size = (round(1280 * scale), round(720 * scale))
    renderer = Renderer(size, scale)
    for lesson in LESSONS:
        assert lesson is not None
        for key, page, written_there in pages_of(lesson):
            width = round(CARD * scale)
            height = card_layout(page, Type(scale), width).height
            assert height < 0.7 * size[1], (lesson.name, key)
            painter = renderer.painter()
            texts.clear()
            card = pygame.Rect(10, 10, width, height)
            draw_tour_card(painter, card, page, focus="", hover="")
            painter.flush()
            nothing_cut(texts, size)
            # Numbers stay with their units.
            written = " ".join(content for content, _ in texts).replace("\u00a0", " ")
            assert all(part.replace("\u00a0", " ") in written for part in written_there)
            for content, place in texts:
                assert card.contains(place), (lesson.name, key, content)

"""Words are longer in one language than in another: they fit all the same."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

import pygame
import pytest

from sandbox.draw.layout import PANEL
from sandbox.draw.pages.help_page import draw_help
from sandbox.draw.pages.tour_card import Field, TourPage, card_layout, draw_tour_card, fitting_type
from sandbox.draw.painter import Painter
from sandbox.draw.render import Renderer
from sandbox.draw.text import Type
from sandbox.draw.theme import theme_named
from sandbox.draw.views import VIEWS
from sandbox.draw.widgets.controls import Places, Slider, arranged
from sandbox.draw.widgets.look import Attention, draw_control
from sandbox.draw.widgets.panel_frame import foot_height, panel_picture
from sandbox.lessons import classroom, tours
from sandbox.lessons.lesson import Lesson
from sandbox.window.card import MARGIN, WIDTH
from sandbox.window.menu import Menu
from sandbox.words import language, words
from scenes import registry
from scenes.text import Text
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


@pytest.mark.parametrize("scale", [0.875, 1.0, 1.25])
def test_all_keys_are_on_one_page_in_a_usual_window(
    texts: list[tuple[str, pygame.Rect]], scale: float
) -> None:
    renderer = Renderer(SIZES[0], scale)
    places = draw_help(renderer.painter())
    assert not places.most_scroll
    nothing_cut(texts, SIZES[0])
    assert all(places.card.contains(rect) for _, rect in texts)
    assert words.HELP_MORE not in {content for content, _ in texts}


def test_where_not_all_keys_are_on_the_page_it_says_that_there_are_more(
    texts: list[tuple[str, pygame.Rect]],
) -> None:
    places = draw_help(Renderer(SIZES[0], 3.0).painter())
    assert places.most_scroll
    assert words.HELP_MORE in {content for content, _ in texts}


@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("height", [330, 520, 686])
def test_the_foot_of_the_panel_is_never_empty(
    texts: list[tuple[str, pygame.Rect]], height: int, scale: float
) -> None:
    """Nor cut: where the mouse is at no control it says what is to be found there."""
    type_, size = Type(scale), (round(PANEL * scale), round(height * scale))
    foot = foot_height(size[1], type_)
    assert foot > 0
    panel_picture(size, Places((), 0), 0, Attention(), theme_named("dark"), type_)
    said = " ".join(content for content, _ in texts)
    assert said == words.PANEL_FOOT
    assert all(size[1] - foot <= rect.top and rect.bottom <= size[1] for _, rect in texts)


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


@pytest.mark.parametrize("scene", registry.names())
@pytest.mark.parametrize("panes", [1, 3])
def test_the_words_of_a_run_in_a_small_window_with_large_letters(
    texts: list[tuple[str, pygame.Rect]], panes: int, scene: str
) -> None:
    """Title, names of packings and what is said: smaller, but whole."""
    size, scale = TIGHT
    renderer = Renderer(size, scale)
    renderer.arrange(panes=panes, panel=True, timeline=True)
    said = Text("clogged: {diameters:.1f} diameters of stroke, no grain came out", diameters=1.4)
    frame = hopper_frame(title=registry.get(scene).title, scene=scene, notices=(said,))
    renderer.draw([frame] * panes, notices=[words.SPEED_TOAST_MOST])
    nothing_cut(texts, size)
    drawn = re.sub(r"\s", "", "".join(content for content, _ in texts))
    for whole in (words.title(scene), words.say(said), words.SPEED_TOAST_MOST):
        assert re.sub(r"\s", "", whole) in drawn


@pytest.mark.parametrize(
    ("size", "scale"), [(TIGHT[0], 1.0), (TIGHT[0], 2.0), (SIZES[0], 1.0), ((720, 404), 0.5625)]
)
def test_long_words_at_the_foot_of_narrow_canvases(
    texts: list[tuple[str, pygame.Rect]], size: tuple[int, int], scale: float
) -> None:
    """The longest that a hopper says, in three canvases beside the panel where there is room for it."""
    clogged = Text("clogged: {diameters:.1f} diameters of stroke, no grain came out", diameters=2.4)
    said = Text(
        "{clogged}, held by an arch of {grains} {grains:grain|grains}", clogged=clogged, grains=7
    )
    renderer = Renderer(size, scale)
    window = scale >= 1.0  # else a film
    renderer.arrange(panes=3, panel=window, timeline=window)
    renderer.draw([hopper_frame(notices=(said,))] * 3)
    for canvas, body in zip(renderer.layout.canvases, renderer.bodies, strict=True):
        foot = pygame.Rect(canvas.left, body.bottom, canvas.width, canvas.bottom - body.bottom)
        seen = "".join(content for content, place in texts if foot.contains(place))
        assert re.sub(r"\s", "", seen) == re.sub(r"\s", "", words.say(said))


@pytest.mark.parametrize(("width", "scale"), [(316, 1.0), (632, 2.0), (736, 3.0)])
def test_the_panel(texts: list[tuple[str, pygame.Rect]], width: int, scale: float) -> None:
    """All parameters of all scenes; beside the canvas, and over it in a small window with large letters."""
    type_ = Type(scale)
    parameters = {
        parameter.name: parameter
        for name in registry.names()
        for parameter in registry.get(name).parameters
        if not isinstance(parameter.default, bool)
    }
    sliders = [
        Slider(
            name,
            words.parameter_name(name),
            float(each.default),
            float(each.low),
            float(each.high),
            float(each.default),
            words.unit(each.unit),
            whole=isinstance(each.default, int),
            mark="" if each.live else words.REBUILDS,
            top=words.TOPS[name] if each.top else "",
        )
        for name, each in parameters.items()
    ]
    places = arranged(sliders, type_, width)
    painter = Painter(pygame.Surface((width, places.height), 0, 32), theme_named("dark"), type_)
    for place in places.all:
        draw_control(painter, place, Attention())
    whole = [(content.replace(" … ", " to "), place) for content, place in texts]  # of ranges
    nothing_cut(whole, (width, places.height))
    assert {slider.said for slider in sliders} <= {content for content, _ in texts}


@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0, 3.0])
def test_cards_fit_where_there_is_no_panel(
    texts: list[tuple[str, pygame.Rect]], scale: float
) -> None:
    size = TIGHT[0]
    renderer = Renderer(size, scale)
    renderer.arrange(timeline=True, card=round((WIDTH + 2.0 * MARGIN) * scale))
    margin = round(MARGIN * scale)
    card = renderer.layout.card.inflate(-2 * margin, -2 * margin)
    for lesson in LESSONS:
        assert lesson is not None
        for key, page, written_there in pages_of(lesson):
            own = fitting_type(page, renderer.type, card.width, card.height)
            painter = Painter(renderer.surface, renderer.theme, own)
            texts.clear()
            draw_tour_card(painter, card, page, focus="", hover="")
            painter.flush()
            nothing_cut(texts, size)
            written = " ".join(content for content, _ in texts).replace("\u00a0", " ")
            parts = [part.replace("\u00a0", " ") for part in written_there]
            assert all(part in written for part in parts), (lesson.name, key)


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

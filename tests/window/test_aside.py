"""A lesson or a tour that is put aside comes back at the very step, with what was answered."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pygame
import pytest

from sandbox.draw.pages.tour_card import CLOSE, NEXT
from sandbox.draw.widgets.controls import Button
from sandbox.lessons.reading import parse_lesson
from sandbox.window.guide import Guide
from sandbox.words import words
from tests.window.desk import Desk

TEXT = """
format = "auxetic-sandbox lesson"
version = 1
scene = "intruder"
TITLE
[[step]]
key = "pick"
packings = ["mixed"]
view = "pressure"
say = "Look."
do = "Drag."
until = { moved = "intruder", by = 2.0, way = "right" }
why = "So."
[step.predict]
kind = "choice"
ask = "Which?"
options = ["this", "that"]
right = 2
[[step]]
key = "guess"
say = "Look again."
do = "Drag on."
until = { increments = 2 }
[step.predict]
kind = "number"
ask = "How much?"
right = 3
[[step]]
key = "draw"
say = "Look."
do = "Drag."
until = { increments = 2 }
[step.predict]
kind = "sketch"
ask = "How does it go on?"
along = [0, 30]
up = [0, 4]
"""

Leave = Callable[[Desk], None]


@pytest.fixture(params=['title = "Mine"', ""], ids=["named", "unnamed"])
def desk(request: pytest.FixtureRequest) -> Iterator[Desk]:
    place = Desk((1280, 720))
    text = TEXT.replace("TITLE", request.param)
    place.app.guide.begin(parse_lesson("mine", text.encode(), ""))
    ready(place)
    yield place
    place.app.close()


def ready(desk: Desk) -> None:
    run = desk.app.stage.panes
    desk.until(lambda: not desk.app._splash and all(s.phase == "running" for s in run.snapshots))
    desk.app.tick()


def escape(desk: Desk) -> None:
    desk.key(pygame.K_ESCAPE)


def key_of_tours(desk: Desk) -> None:
    desk.app.stage.focus.leave()  # not in the field, where it would be written
    desk.key(pygame.K_y)


def button(desk: Desk) -> None:
    desk.app.guide.press(CLOSE)


def another_scene(desk: Desk) -> None:
    desk.app.stage.start("hopper")
    ready(desk)


def another_tour(desk: Desk) -> None:
    desk.app.guide.start("hopper")
    ready(desk)
    desk.app.stage.start("intruder")
    ready(desk)


LEAVE = [escape, key_of_tours, button, another_scene, another_tour]


def state(guide: Guide) -> tuple[object, ...]:
    lesson = None if guide.lesson is None else guide.lesson.name
    return lesson, guide.index, guide.page, guide.stage.renderer.view.name


def to_question(desk: Desk, index: int) -> None:
    desk.app.guide._go(index)
    ready(desk)


def at_a_choice(desk: Desk) -> None:
    desk.key(pygame.K_DOWN)
    desk.key(pygame.K_SPACE, " ")


def at_a_number(desk: Desk) -> None:
    to_question(desk, 1)
    desk.type("3,2")


def at_a_sketch(desk: Desk) -> None:
    to_question(desk, 2)
    for key in (pygame.K_SPACE, pygame.K_RIGHT, pygame.K_UP, pygame.K_SPACE):
        desk.key(key)


def when_it_is_to_be_done(desk: Desk) -> None:
    at_a_choice(desk)
    desk.key(pygame.K_RETURN, "\r")


def when_it_is_told(desk: Desk) -> None:
    when_it_is_to_be_done(desk)
    desk.app.guide.press(NEXT)


def when_it_is_done(desk: Desk) -> None:
    when_it_is_to_be_done(desk)
    for _ in range(9):
        desk.key(pygame.K_RIGHT)
        desk.until(lambda: desk.session.idle)
    desk.until(lambda: desk.app.guide.done)


STEPS = [
    at_a_choice,
    at_a_number,
    at_a_sketch,
    when_it_is_to_be_done,
    when_it_is_told,
    when_it_is_done,
]


@pytest.mark.parametrize("leave", LEAVE)
@pytest.mark.parametrize("come", STEPS)
def test_y_brings_the_lesson_back_as_it_was(desk: Desk, come: Leave, leave: Leave) -> None:
    guide, stage = desk.app.guide, desk.app.stage
    come(desk)
    asked, before = guide.asking.on, state(guide)
    sketch = None if guide.asking.sketch is None else guide.asking.sketch.up.copy()
    leave(desk)
    assert not guide.on
    assert (desk.paused(), guide.asking.sketch, stage.renderer.plot_least) == (False, None, None)
    if leave in (escape, key_of_tours, button, another_scene):
        assert words.LESSON_ASIDE in stage.notices.said
    stage.focus.leave()
    desk.key(pygame.K_y)
    ready(desk)
    assert state(guide) == before
    assert (guide.asking.on, desk.paused()) == (asked, asked)
    if sketch is not None:
        assert guide.asking.sketch is not None
        assert str(guide.asking.sketch.up) == str(sketch)
    assert stage.panes.scene == guide.scene
    assert words.ASK_DIGITS not in stage.notices.said  # the key that brought it back writes nothing


def test_what_runs_goes_on_if_it_is_still_there(desk: Desk) -> None:
    when_it_is_to_be_done(desk)
    sessions = len(desk.sessions)
    for _ in range(2):
        desk.key(pygame.K_RIGHT)
        desk.until(lambda: desk.session.idle)
    desk.key(pygame.K_ESCAPE)
    desk.key(pygame.K_y)
    ready(desk)
    assert len(desk.sessions) == sessions
    for _ in range(6):  # from where the step began, not from where it was left
        desk.key(pygame.K_RIGHT)
        desk.until(lambda: desk.session.idle)
    desk.until(lambda: desk.app.guide.done)


def test_another_packing_begins_the_step_anew(desk: Desk) -> None:
    when_it_is_to_be_done(desk)
    desk.key(pygame.K_ESCAPE)
    desk.key(pygame.K_n)
    ready(desk)
    sessions = len(desk.sessions)
    desk.key(pygame.K_y)
    ready(desk)
    assert len(desk.sessions) == sessions + 1


def test_a_tour_waits_in_its_scene(desk: Desk) -> None:
    """Elsewhere the key begins the tour of what runs; a lesson comes first wherever one is."""
    guide = desk.app.guide
    guide.close()
    guide.start("intruder")
    ready(desk)
    for _ in range(2):
        desk.key(pygame.K_RETURN, "\r")
    before = state(guide)
    assert guide.index == 1
    desk.key(pygame.K_ESCAPE)
    assert desk.app.stage.notices.latest == words.TOUR_ASIDE
    desk.key(pygame.K_y)
    assert state(guide) == before
    desk.app.stage.start("hopper")
    ready(desk)
    assert not guide.on
    desk.key(pygame.K_y)
    ready(desk)
    assert (guide.scene, guide.index) == ("hopper", 0)
    desk.app.stage.start("intruder")
    ready(desk)
    desk.key(pygame.K_y)
    ready(desk)
    assert state(guide) == before


def test_the_panel_says_that_a_lesson_waits(desk: Desk) -> None:
    def title() -> str:
        desk.app.panel.tick(0.0)
        place = desk.app.panel._places.named("general/tour")
        assert place is not None
        assert isinstance(place.control, Button)
        return place.control.title

    for on in (True, False, True):
        assert desk.app.guide.on is on
        assert title() == words.BUTTONS["lesson"]
        desk.app.panel.use("general/tour", True, True)
    desk.app.guide.take_up(desk.app.guide.shelf.latest)  # type: ignore[arg-type]
    desk.app.guide.close()
    assert title() == words.BUTTONS["tour"]


def test_what_is_over_does_not_come_back(desk: Desk) -> None:
    guide = desk.app.guide
    to_question(desk, 2)
    desk.key(pygame.K_RETURN, "\r")
    guide.press(NEXT)
    assert not guide.on
    assert desk.app.stage.notices.latest == words.LESSON_OVER
    desk.key(pygame.K_y)
    ready(desk)
    assert guide.lesson is not None
    assert (guide.lesson.name, guide.index) == ("intruder", 0)  # the tour

"""A lesson in the window: questions by mouse and by keyboard, sketches over the plot, controls that are kept out of sight."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pygame
import pytest

from sandbox.draw.pages.tour_card import NEXT, OPTION
from sandbox.lessons import classroom
from sandbox.lessons.answers import Answers
from sandbox.lessons.reading import parse_lesson
from sandbox.session.commands import Move
from sandbox.window.asking import SKETCH, told
from sandbox.window.guide import Guide
from sandbox.words import language, words
from tests.window.desk import Desk
from tests.window.lesson_text import LESSON, begin, ready


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Desk]:
    place = Desk((1280, 720))
    place.app.guide.answers = Answers(tmp_path / "answers.csv")
    begin(place)
    ready(place)
    yield place
    place.app.close()


def button(desk: Desk, name: str) -> tuple[int, int]:
    guide = desk.app.guide
    return (
        guide.card.layout(guide.page, guide.rect.width)
        .buttons[name]
        .move(guide.rect.topleft)
        .center
    )


def rows(tmp_path: Path) -> list[dict[str, str]]:
    path = tmp_path / "answers.csv"
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def drag_handle(desk: Desk, way: float) -> None:
    start, scale = desk.handle_place(), desk.app.stage.renderer.camera.scale
    desk.press(start)
    desk.point((start[0] + way * scale, start[1]), pressed=True)
    desk.until(lambda: desk.app.guide.done)
    desk.release((start[0] + way * scale, start[1]))


def to_step(desk: Desk, index: int) -> Guide:
    guide = desk.app.guide
    guide._go(index)
    ready(desk)
    return guide


def test_a_choice_by_keyboard_then_it_is_tried_and_told(desk: Desk, tmp_path: Path) -> None:
    guide, focus = desk.app.guide, desk.app.stage.focus
    assert focus.name == f"{OPTION}0"
    assert guide.page.onward == words.ASK_WITHOUT
    assert guide.page.do == ""  # first the guess
    desk.key(pygame.K_DOWN)
    desk.key(pygame.K_UP)
    desk.key(pygame.K_SPACE, " ")
    assert (guide.page.chosen, guide.page.onward) == (0, words.ASK_KEEP)
    desk.key(pygame.K_RETURN, "\r")
    assert (guide.asking.on, guide.page.do) == (False, "Drag.")
    assert [(row["step"], row["given"], row["right"]) for row in rows(tmp_path)] == [
        ("pick", "1", "no")
    ]
    assert focus.on_canvas
    drag_handle(desk, 3.0)
    why = "You said: “this”. The answer: “that”. That, as everybody knows."
    assert guide.page.why == why


def test_one_enter_too_many_gives_nothing_away(desk: Desk) -> None:
    """Wherever the guess was handed over, keys lead the hand then, and the answer waits for who asks for it."""
    guide, focus = desk.app.guide, desk.app.stage.focus
    assert focus.ring == f"{OPTION}0"  # it can be seen where the keyboard is
    while focus.name != NEXT:
        desk.key(pygame.K_TAB)
    for _ in range(4):
        desk.key(pygame.K_RETURN, "\r")
        assert (guide.asking.on, guide.told, guide.page.why) == (False, False, "")
        assert focus.ring == "canvas/intruder"
    assert desk.app.stage.notices.latest == words.ASK_TRY.format(why=words.TOUR_WHY)
    desk.key(pygame.K_RIGHT)
    desk.until(lambda: any(isinstance(command, Move) for command in desk.session.commands))
    while focus.name != NEXT:
        desk.key(pygame.K_TAB)
    desk.key(pygame.K_RETURN, "\r")
    assert guide.told
    assert guide.page.why == "The answer: “that”. That, as everybody knows."


def test_one_click_too_many_gives_nothing_away(desk: Desk) -> None:
    """The button that tells may come to stand where that of the guess was."""
    guide = desk.app.guide
    guide.asking.choose(0)
    place = button(desk, NEXT)
    desk.click(place)
    assert not guide.asking.on
    again = button(desk, NEXT)  # as if it were there
    for pressed in (desk.press, desk.release):
        pressed(again)
    assert not guide.told
    assert desk.app.stage.notices.latest == words.ASK_TRY.format(why=words.TOUR_WHY)
    desk.click(again)
    assert guide.told


def test_every_answer_leaves_a_row_and_says_whether_it_had_been_shown(
    desk: Desk, tmp_path: Path
) -> None:
    guide = to_step(desk, 1)
    guide.press(NEXT)  # no guess
    guide.back()
    desk.key(pygame.K_RETURN, "\r")  # an option
    desk.key(pygame.K_RETURN, "\r")
    guide.press(NEXT)  # why?
    guide.press(NEXT)  # the next step
    desk.type("3")
    desk.key(pygame.K_RETURN, "\r")
    guide.back()
    guide.press(NEXT)
    guide.close()
    guide.begin(parse_lesson("mine", LESSON.encode(), ""))  # the same sitting
    ready(desk)
    guide.press(NEXT)
    told = [(row["step"], row["what"], row["given"], row["when"]) for row in rows(tmp_path)]
    assert told == [
        ("guess", "no guess", "", "before"),
        ("pick", "predicted", "1", "before"),
        ("guess", "predicted", "3", "after"),
        ("pick", "no guess", "", "after"),
        ("pick", "no guess", "", "after"),
    ]


LESSONS = [(name, code) for name in classroom.names() for code in ("en", "de")]


@pytest.mark.parametrize(("name", "code"), LESSONS)
def test_the_answer_is_stated_whatever_was_guessed(name: str, code: str) -> None:
    """Before it was tried or after, and what is told reads from the guess to the reason."""
    language.use(code)
    for step in classroom.lesson(name).steps:
        predict = step.predict
        if predict is None or predict.right is None:
            continue
        wrong = predict.right + (-1.0 if predict.right else 1.0) * (1.0 + predict.within)
        right = f"{predict.right:g}".replace(".", words.decimal_sign())
        if predict.kind == "choice":
            right = str(predict.options[round(predict.right)])
        for given in (None, predict.right, wrong):
            text = told(predict, given)
            assert (words.ASK_RIGHT in text) == (given == predict.right)
            assert right in text
            assert ".." not in text
            assert text.endswith(str(predict.answer))


def test_a_choice_by_mouse(desk: Desk, tmp_path: Path) -> None:
    desk.click(button(desk, f"{OPTION}1"))
    assert desk.app.guide.page.chosen == 1
    desk.click(button(desk, NEXT))
    assert rows(tmp_path)[0]["right"] == "yes"


def test_nothing_moves_before_the_guess(desk: Desk) -> None:
    stage, guide = desk.app.stage, desk.app.guide
    assert desk.paused()
    start = desk.handle_place()
    desk.press(start)
    assert not stage.mouse.holding
    desk.release(start)
    for key in (pygame.K_a, pygame.K_s):
        desk.key(key)
        assert stage.notices.latest == words.ASK_FIRST
    desk.key(pygame.K_m)  # the menu, and back
    desk.key(pygame.K_m)
    desk.app.tick()
    assert desk.paused()
    desk.click(button(desk, NEXT))  # no guess
    assert (guide.asking.on, desk.paused()) == (False, False)


def test_what_is_put_aside_lets_go(desk: Desk, tmp_path: Path) -> None:
    desk.key(pygame.K_ESCAPE)
    assert not desk.app.guide.on
    assert not desk.paused()
    assert rows(tmp_path) == []
    assert desk.app.stage.notices.latest == words.LESSON_ASIDE


def test_a_sketch_by_mouse_stays_over_the_curve(desk: Desk, tmp_path: Path) -> None:
    guide = to_step(desk, 2)
    asking, box = guide.asking, desk.app.stage.renderer.plot_box
    assert box is not None
    assert (box.low, box.high) == (0.0, 30.0)
    assert box.top >= 4.0
    start = (float(box.x(1.0)), float(box.y(1.0)))
    desk.press(start)
    for stroke, force in ((3.0, 2.0), (5.0, 3.0)):
        desk.point((float(box.x(stroke)), float(box.y(force))), pressed=True)
    desk.release((float(box.x(5.0)), float(box.y(3.0))))
    assert asking.sketch is not None
    drawn = np.isfinite(asking.sketch.up)
    assert np.interp(3.0, asking.sketch.along[drawn], asking.sketch.up[drawn]) == pytest.approx(
        2.0, abs=0.3
    )
    assert asking.sketch.along[drawn][[0, -1]] == pytest.approx([1.0, 5.0], abs=0.5)
    desk.click(button(desk, NEXT))
    assert asking.sketch is not None  # it lies there while it is measured
    drag_handle(desk, 1.0)
    assert [row["what"] for row in rows(tmp_path)] == ["predicted", "measured"]
    guide._go(0)
    assert desk.app.stage.renderer.plot_least is None


def test_a_sketch_by_keyboard(desk: Desk) -> None:
    asking = to_step(desk, 2).asking
    assert desk.app.stage.focus.name == SKETCH
    desk.key(pygame.K_SPACE, " ")
    for key in (*[pygame.K_RIGHT] * 8, *[pygame.K_UP] * 20):
        desk.key(key)
    desk.key(pygame.K_SPACE, " ")
    assert asking.sketch is not None
    drawn = np.flatnonzero(np.isfinite(asking.sketch.up))
    assert drawn.tolist() == list(range(17))
    assert asking.sketch.up[[0, 8, 16]] == pytest.approx([0.0, 1.0, 2.0])
    desk.key(pygame.K_BACKSPACE)
    assert not asking.sketch.there
    desk.key(pygame.K_RETURN, "\r")  # without
    assert not desk.paused()


def test_controls_are_kept_out_of_sight(desk: Desk) -> None:
    app = desk.app

    def there() -> set[str]:
        app.panel.tick(0.0)
        return {place.control.name for place in app.panel._places.all}

    app.panel.folded.clear()
    before = there()
    hidden = {"general/packing", "general/seed", "general/new", "grains/friction", "files/save"}
    assert not before & hidden
    assert {"general/view", "solver/step"} <= before
    for key in (pygame.K_n, pygame.K_1, pygame.K_w):
        app.stage.toast("")
        desk.key(key)
        assert app.stage.notices.latest == words.HIDDEN_HERE or key == pygame.K_1
    assert app.stage.panes.seed == 1
    to_step(desk, 2)
    assert "solver/step" not in there()
    app.guide.close()
    assert hidden <= there()

"""A number that a lesson asks for: what is written stays in its field, and what cannot be read is said."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import pygame
import pytest

from sandbox.draw.pages.tour_card import FIELD, NEXT
from sandbox.lessons.answers import Answers
from sandbox.lessons.reading import parse_lesson
from sandbox.window.guide import Guide
from sandbox.window.number_field import LONGEST, NumberField
from sandbox.words import words
from tests.window.desk import Desk

TEXT = """
format = "auxetic-sandbox lesson"
version = 1
scene = "intruder"
[[step]]
key = "guess"
packings = ["mixed"]
say = "Look."
[step.predict]
kind = "number"
ask = "How much?"
right = 3
within = 0.5
unit = "k R"
"""
READ = [  # what is written, the unit, what it comes to
    ("4", "%", 4.0),
    ("4,2", "k R", 4.2),
    ("4.2", "", 4.2),
    (".5", "", 0.5),
    ("+3", "", 3.0),
    ("-3", "", -3.0),
    ("−0,3", "", -0.3),
    (" 4 ", "%", 4.0),
    ("4 %", "%", 4.0),
    ("4%", "%", 4.0),
    ("30 %", "", 0.3),
]
UNREAD = [("3,4,5", ""), ("-", ""), ("%", "%"), ("3-", ""), ("4 %", "k R"), ("1 000", "")]


def filled(text: str, unit: str) -> NumberField:
    field = NumberField(unit)
    assert field.write(text)
    return field


@pytest.mark.parametrize(("text", "unit", "value"), READ)
def test_what_can_be_read(text: str, unit: str, value: float) -> None:
    field = filled(text, unit)
    assert field.value == pytest.approx(value)
    assert not field.unreadable


@pytest.mark.parametrize(("text", "unit"), UNREAD)
def test_what_cannot(text: str, unit: str) -> None:
    field = filled(text, unit)
    assert field.value is None
    assert field.unreadable


def test_nothing_is_not_unreadable() -> None:
    for text in ("", "  "):
        assert (filled(text, "").value, filled(text, "").unreadable) == (None, False)


def test_letters_are_left_out_and_what_is_too_long_is_cut() -> None:
    field = NumberField()
    assert not field.write("4a")
    assert field.text == "4"
    field.write("5" * 40)
    assert len(field.text) == LONGEST
    assert field.edit.caret == LONGEST


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Desk]:
    place = Desk((1280, 720))
    place.app.guide.answers = Answers(tmp_path / "answers.csv")
    place.app.guide.begin(parse_lesson("mine", TEXT.encode(), ""))
    place.until(lambda: not place.app._splash)
    place.app.tick()
    yield place
    place.app.close()


def rows(tmp_path: Path) -> list[tuple[str, str, str]]:
    path = tmp_path / "answers.csv"
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return [(row["what"], row["given"], row["right"]) for row in csv.DictReader(file)]


def state(desk: Desk) -> tuple[object, ...]:
    """All that keys of the window might have changed."""
    stage = desk.app.stage
    view = stage.renderer.view.name, stage.renderer.sight, stage.renderer.scale
    run = stage.panes.packing, stage.panes.seed, stage.panes._speed, desk.paused()
    return (*view, *run, desk.page(), desk.app.guide.index, desk.app.guide.on)


def text_of(guide: Guide) -> str:
    assert guide.page.field is not None
    return guide.page.field.text


def test_keys_go_to_the_field_while_it_has_the_keyboard(desk: Desk) -> None:
    guide = desk.app.guide
    assert desk.app.stage.focus.ring == FIELD
    before = state(desk)
    for sign in "0123-+,.%":
        desk.type(sign)
    assert text_of(guide) == "0123-+,.%"
    for _ in range(6):
        desk.key(pygame.K_BACKSPACE)
    assert text_of(guide) == "012"
    desk.key(pygame.K_HOME)
    desk.key(pygame.K_DELETE)
    assert text_of(guide) == "12"
    for letter in "abcdefghiklmnoprstvwxyz[]":
        desk.type(letter)
    assert text_of(guide) == "12"
    assert desk.app.stage.notices.latest == words.ASK_DIGITS
    assert state(desk) == before


def test_what_is_written_before_the_scene_is_there_is_no_key_of_the_window(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    guide, stage = desk.app.guide, desk.app.stage
    monkeypatch.setattr(stage, "parts_now", list)  # as while it is built
    before = stage.panes.packing, stage.panes.seed
    for event in (
        pygame.event.Event(pygame.KEYDOWN, key=pygame.K_3, unicode="3", mod=0),
        pygame.event.Event(pygame.TEXTINPUT, text="3"),
    ):
        desk.app.handle(event)
    assert text_of(guide) == "3"
    assert (stage.panes.packing, stage.panes.seed) == before


def test_keys_of_functions_are_the_windows_all_the_same(desk: Desk) -> None:
    desk.key(pygame.K_F1)
    assert desk.page() == "help"
    desk.key(pygame.K_F1)
    desk.key(pygame.K_PLUS, mod=pygame.KMOD_LCTRL)
    assert desk.app.stage.renderer.scale == 1.25


def test_what_cannot_be_read_is_said_and_stays(desk: Desk, tmp_path: Path) -> None:
    guide = desk.app.guide
    desk.type("3,4,5")
    assert guide.page.onward == words.ASK_KEEP
    assert guide.page.hint == ""  # it may still become one
    desk.key(pygame.K_RETURN, "\r")
    assert (guide.asking.on, text_of(guide), rows(tmp_path)) == (True, "3,4,5", [])
    assert guide.page.hint == words.ASK_UNREADABLE.format(text="3,4,5")
    assert "\n" not in guide.page.hint
    desk.key(pygame.K_BACKSPACE)
    assert guide.page.hint == ""
    desk.key(pygame.K_BACKSPACE)
    desk.key(pygame.K_RETURN, "\r")
    assert rows(tmp_path) == [("predicted", "3.4", "yes")]
    assert guide.page.why == f"You said: 3.4 k R. {words.ASK_RIGHT}"


def test_the_button_refuses_it_too_and_gives_the_keyboard_back(desk: Desk, tmp_path: Path) -> None:
    guide, focus = desk.app.guide, desk.app.stage.focus
    desk.type("%")
    while focus.name != NEXT:
        desk.key(pygame.K_TAB)
    desk.key(pygame.K_RETURN, "\r")
    assert guide.page.hint != ""
    assert focus.name == FIELD
    desk.key(pygame.K_BACKSPACE)
    assert guide.page.onward == words.ASK_WITHOUT
    desk.key(pygame.K_RETURN, "\r")
    assert rows(tmp_path) == [("no guess", "", "")]
    assert guide.page.why == "The answer: 3 k R."  # it is stated, whatever was said

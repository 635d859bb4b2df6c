"""A lesson as a screen reader has it: what is asked, what may not be done yet, what is drawn, what is done."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pygame
import pytest

from sandbox.draw.pages.tour_card import FIELD, NEXT, OPTION
from sandbox.draw.widgets.scale import shown
from sandbox.lessons.answers import mean_distance
from sandbox.session.commands import Move, Protocol
from sandbox.window.access.speech import Speech
from sandbox.window.asking import SKETCH
from sandbox.words import words
from tests.window.desk import Desk
from tests.window.fake_session import FakeSession
from tests.window.hearing import do, seen
from tests.window.lesson_text import begin, ready

X = "canvas/intruder/x"


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = Desk((1024, 720))
    yield place
    place.app.close()


def test_a_reader_that_is_there_from_the_beginning_hears_the_first_card(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    built, build = threading.Event(), FakeSession.build

    def slowly(session: FakeSession, progress: Any = None) -> None:
        built.wait(20.0)
        build(session, progress)

    monkeypatch.setattr(FakeSession, "build", slowly)
    begin(desk)
    speech = Speech(desk.app.stage, desk.app.guide)
    speech.begin()  # while the scene is built, there is nothing to be read
    said = list(speech.new())
    step = words.TOUR_STEP.format(step=1, steps=3)
    for text in ("A lesson", step, "Look.", "Which?"):
        assert said.count(text) == 1, text
    built.set()
    ready(desk)
    assert "Look." not in list(speech.new())
    desk.app.guide._go(1)
    later = list(speech.new())
    assert words.TOUR_STEP.format(step=2, steps=3) in later
    assert "A lesson" not in later


def test_what_is_asked_is_the_name_of_what_answers_and_stands_there_once(desk: Desk) -> None:
    begin(desk)
    ready(desk)
    nodes = seen(desk).nodes
    group = nodes[OPTION]
    assert (group.role, group.label) == ("RADIO_GROUP", "Which?")
    assert [nodes[name].label for name in group.children] == ["this", "that"]
    assert OPTION in nodes["tour"].children
    assert seen(desk).focus == f"{OPTION}0"
    assert sum("Which?" in (node.label, node.text) for node in nodes.values()) == 1
    desk.app.guide._go(1)
    desk.app.tick()
    do(desk, FIELD, "SET_VALUE", "much")
    do(desk, NEXT)
    nodes = seen(desk).nodes
    assert nodes[FIELD].label == "How much? [k R]"
    assert "much" in nodes[FIELD].about  # what is wrong with it
    assert "How much?" not in [node.text for node in nodes.values()]


def test_no_reader_leads_a_handle_before_the_answer(desk: Desk) -> None:
    begin(desk)
    ready(desk)
    place = seen(desk).nodes[X].number
    assert place is not None
    for action, value in (("SET_VALUE", place.value + 3.0), ("INCREMENT", None)):
        said = desk.app.stage.notices.count
        do(desk, X, action, value)
        assert desk.app.stage.notices.count == said + 1
        assert desk.app.stage.notices.said[-1] == words.ASK_FIRST
    do(desk, f"{OPTION}0")
    do(desk, NEXT)
    for _ in range(50):
        desk.app.tick()
    assert not [command for command in desk.session.commands if isinstance(command, Move)]
    do(desk, X, "SET_VALUE", place.value + 3.0)
    desk.until(lambda: desk.app.guide.done)
    done = f"{words.TOUR_DONE}: Drag."
    assert done in [node.text for node in seen(desk).nodes.values()]


def test_that_a_step_is_done_is_said(desk: Desk) -> None:
    """The card has a mark for it."""
    begin(desk)
    ready(desk)
    do(desk, f"{OPTION}0")
    do(desk, NEXT)
    speech = Speech(desk.app.stage, desk.app.guide)
    speech.begin()
    desk.app.guide.done = True
    assert words.TOUR_DONE in list(speech.new())


def test_a_sketch_is_told_while_it_is_drawn_and_compared_after(desk: Desk) -> None:
    app = desk.app
    speech = Speech(app.stage, app.guide)
    begin(desk)
    app.guide._go(2)
    ready(desk)

    def heard(seconds: float = 0.0) -> list[str]:
        return [*speech._from_the_sketch(seconds), *speech._from_the_sketch(seconds + 10.0)]

    node = seen(desk).nodes[SKETCH]
    assert words.SKETCH_NOTHING in node.about
    assert app.stage.picture.panes()[0][0].curve_label in node.about
    assert any(one in node.about for one in heard())
    desk.key(pygame.K_SPACE, " ")
    for key in (*[pygame.K_RIGHT] * 8, *[pygame.K_UP] * 20):
        desk.key(key)
    desk.key(pygame.K_SPACE, " ")
    drawn = seen(desk).nodes[SKETCH].about
    assert "17 points, from 0 at 0 to 2 at 7.5" in drawn
    assert words.SKETCH_PEN.format(along="7.5", up="2") in drawn
    said = heard(20.0)
    assert any("17 points" in one for one in said)
    assert any("7.5" in one for one in said)
    assert heard(40.0) == []
    desk.key(pygame.K_RETURN, "\r")
    assert SKETCH not in seen(desk).nodes
    assert "17 points" in seen(desk).nodes["sketch"].text
    app.stage.send(Protocol(True))
    desk.until(lambda: app.guide.done)
    app.stage.panes.pause_or_go_on()
    desk.until(lambda: not app.stage.picture.panes()[0][0].busy)
    app.tick()
    frame = app.stage.picture.panes()[0][0]
    sketch = app.guide.asking.sketch
    assert sketch is not None
    away = mean_distance(frame.curve_stroke, frame.curve_force, sketch.along, sketch.up)
    (line,) = [each.text for each in app.guide.asking.measured]
    assert f"{shown(float(f'{away:.3g}'))} k R" in line
    assert seen(desk).nodes["sketch/0"].text == line
    assert heard(60.0) == [line]  # once

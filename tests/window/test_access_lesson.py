"""A lesson as a screen reader has it: what is asked, what may not be done yet, what is done; one hand and several packings."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from sandbox.draw.pages.tour_card import FIELD, NEXT, OPTION
from sandbox.lessons.reading import parse_lesson
from sandbox.session.commands import Move
from sandbox.session.frame import Frame
from sandbox.window.access.speech import Speech
from sandbox.window.access.tree import Tree
from sandbox.window.measure.measuring import SPREADS
from sandbox.words import words
from tests.window.desk import Desk
from tests.window.fake_session import FakeSession

LESSON = """
format = "auxetic-sandbox lesson"
version = 1
scene = "intruder"
title = "A lesson"
[[step]]
key = "pick"
packings = ["mixed"]
say = "Look."
do = "Drag."
until = { moved = "intruder", by = 2.0 }
[step.predict]
kind = "choice"
ask = "Which?"
options = ["this", "that"]
[[step]]
key = "guess"
say = "Once more."
[step.predict]
kind = "number"
ask = "How much?"
unit = "k R"
"""
X = "canvas/intruder/x"


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = Desk((1024, 720))
    yield place
    place.app.close()


def seen(desk: Desk) -> Tree:
    return Tree(desk.app.reader.parts)


def do(desk: Desk, name: str, action: str = "CLICK", value: object = None) -> None:
    seen(desk).nodes[name].does[action](value)
    desk.app.tick()


def begin(desk: Desk) -> None:
    desk.app.guide.begin(parse_lesson("mine", LESSON.encode(), ""))


def ready(desk: Desk) -> None:
    desk.until(lambda: not desk.app._splash and bool(desk.app.stage.picture.panes()))
    desk.app.tick()


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
    step = words.TOUR_STEP.format(step=1, steps=2)
    for text in ("A lesson", step, "Look.", "Which?"):
        assert said.count(text) == 1, text
    built.set()
    ready(desk)
    assert "Look." not in list(speech.new())
    desk.app.guide._go(1)
    later = list(speech.new())
    assert words.TOUR_STEP.format(step=2, steps=2) in later
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


@pytest.mark.parametrize("held", [True, False])
def test_a_body_that_is_locked_holds_back_none_beside_it(
    desk: Desk, monkeypatch: pytest.MonkeyPatch, held: bool
) -> None:
    """The hand by keys, and the slider, go on from the body that has followed best."""
    stage, arrows = desk.app.stage, desk.app.reader.parts.arrows
    stage.start("intruder", packings=("regular", "mixed", "auxetic"))
    desk.until(lambda: not desk.app._splash and len(stage.picture.panes()) == 3)
    target = (9.0, 0.0) if held else None

    def at(frame: Frame, x: float, stroke: float) -> Frame:
        handle = replace(frame.handles[0], x=x, y=0.0, target=target)
        return replace(frame, handles=(handle,), stroke=stroke)

    places = {"regular": (1.0, 1.0), "mixed": (2.0, 2.0), "auxetic": (8.0, 8.0)}
    for pane in stage.panes._row.panes:
        pane.solver.stop()
        kept = pane.solver.snapshot
        assert kept.frame is not None
        moved = replace(kept, frame=at(kept.frame, *places[pane.packing]))
        pane.solver._snapshot = moved
    monkeypatch.setattr(stage, "send", lambda command: sent.append(command))
    sent: list[object] = []
    number = seen(desk).nodes[X].number
    assert number is not None
    assert number.value == 8.0
    stage.focus.go("canvas/intruder", True)
    handle = arrows.handle_state()
    assert handle is not None
    arrows.lead(handle, 0.25, 0.0)
    assert sent[-1] == Move("intruder", 9.25 if held else 8.25, 0.0)


def test_histograms_are_told_in_words_and_no_line_is_empty(desk: Desk) -> None:
    stage = desk.app.stage
    stage.start("intruder", packings=("regular", "auxetic"))
    desk.until(lambda: not desk.app._splash and len(stage.picture.panes()) == 2)
    desk.app.measuring.take(SPREADS)
    desk.app.tick()
    tree = seen(desk)
    read = [node for node in tree.nodes.values() if node.role == "LABEL"]
    assert all(node.text.strip(" :") == node.text for node in read), read
    told = [node.text for node in read if node.text.startswith(words.MEASURE_FORCES)]
    assert len(told) == 2
    for text in told:
        shares = text.rpartition(": ")[2].removesuffix(" %").split(words.LIST_SIGN)
        assert len(shares) > 8
        assert abs(sum(map(float, shares)) - 100.0) <= len(shares) / 2

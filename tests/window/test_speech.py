"""What is said of itself to who hears the window: notices, readings at rest, a long wait."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sandbox.session.history import Event
from sandbox.window.access.speech import Speech
from sandbox.window.solvers.snapshot import Snapshot
from sandbox.words import words
from tests.window.desk import Desk
from tests.window.hearing import open_desk


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = open_desk()
    yield place
    place.app.close()


def test_notices_and_events_are_said_once(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    stage = desk.app.stage
    speech = Speech(stage, desk.app.guide)
    stage.toast("before anybody listened")
    speech.begin()
    assert list(speech.new()) == []
    for text in ("one", "two", "two"):
        stage.toast(text)
    assert list(speech.new()) == ["one", "two", "two"]
    ((frame, camera, rect),) = stage.picture.panes()
    event = Event("clog", 3, 0.1, 1.0, "the grains have locked up")
    pane = replace(frame, events=(*frame.events, event)), camera, rect
    monkeypatch.setattr(stage.picture, "panes", lambda: (pane,))
    assert list(speech.new()) == [event.text]
    assert list(speech.new()) == []


def test_readings_are_said_where_a_run_has_come_to_rest(desk: Desk) -> None:
    speech = Speech(desk.app.stage, desk.app.guide)
    frame = desk.app.stage.picture.panes()[0][0]
    speech.begin()

    def at(increment: int, now: float, busy: bool = False, missing: int = 0) -> list[str]:
        note = f"height {increment} R"
        curve = np.array([0.0, 0.25 * increment])
        moved = replace(frame, increment=increment, busy=busy, curve_force=curve, notices=(note,))
        snapshots = [Snapshot("running", frame=moved), *[Snapshot("building")] * missing]
        pane = moved, *desk.app.stage.picture.panes()[0][1:]
        speech.stage = SimpleNamespace(  # type: ignore[assignment]
            picture=SimpleNamespace(panes=lambda: [pane]),
            panes=SimpleNamespace(snapshots=snapshots),
            renderer=desk.app.stage.renderer,
        )
        return list(speech._from_the_readings(now))

    for step in range(1, 9):
        assert at(step, 100.0 + 0.1 * step) == []
    said, note = at(8, 103.0)
    assert note == "height 8 R"
    assert "force on the intruder 2 k R" in said
    assert at(8, 104.0) == []
    for now in (105.0, 109.0):  # an increment that takes long has not come to rest
        assert at(9, now, busy=True) == []
    for now in (110.0, 114.0):  # nor have packings side by side of which one is still built
        assert at(10, now, missing=1) == []
    assert at(10, 115.0) == []
    assert at(10, 116.0)


def test_what_was_said_when_it_happened_is_not_said_again_at_rest(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = desk.app.stage
    speech = Speech(stage, desk.app.guide)
    speech.begin()
    ((frame, camera, rect),) = stage.picture.panes()
    text = "an arch of 4 grains holds what is above"
    event = Event("arch", 3, 0.1, 1.0, text)
    later = replace(frame, increment=3, events=(*frame.events, event), notices=(text, "leaning"))
    monkeypatch.setattr(stage.picture, "panes", lambda: ((later, camera, rect),))
    assert list(speech._from_the_runs()) == [text]
    heard = [*speech._from_the_readings(100.0), *speech._from_the_readings(110.0)]
    assert heard[-1] == "leaning"
    assert text not in heard


def test_a_lesson_says_what_comes_next(desk: Desk) -> None:
    speech = Speech(desk.app.stage, desk.app.guide)
    speech.begin()
    desk.app.guide.start("intruder")
    page = desk.app.guide.page
    said = list(speech.new())
    assert page.say in said
    assert page.do in said or not page.do
    desk.app.guide.next()
    later = list(speech.new())
    assert desk.app.guide.page.why in later or desk.app.guide.page.say in later
    assert page.say not in later


def test_a_long_wait_is_told_and_its_end(desk: Desk) -> None:
    speech = Speech(desk.app.stage, desk.app.guide)
    ready = desk.app.stage.panes.snapshot
    assert ready.frame is not None
    building = replace(ready, phase="building", text="compiling", frame=None)
    for snapshot, now, said in (
        (ready, 0.0, []),
        (building, 1.0, []),
        (building, 1.5, []),
        (building, 2.5, ["compiling"]),
        (building, 3.5, []),
        (ready, 4.0, [words.title("intruder", ready.frame.title)]),
        (ready, 5.0, []),
    ):
        speech.stage = SimpleNamespace(panes=SimpleNamespace(snapshot=snapshot))  # type: ignore[assignment]
        assert list(speech._from_the_build(now)) == said

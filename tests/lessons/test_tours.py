"""Tours lead through what exists, say it in every language, and each step can be done."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sandbox.draw.views import VIEWS
from sandbox.lessons import tours
from sandbox.lessons.lesson import Condition, Step
from sandbox.lessons.moments import Moment, met
from sandbox.session.frame import Frame
from sandbox.session.history import Event
from sandbox.words import language
from scenes import registry
from tests.draw.frames import intruder_frame

EVENTS = {"locked", "clog", "arch", "avalanche"}
ALL = [(scene, step) for scene in tours.scenes() for step in tours.steps(scene)]
NAMES = [f"{scene}.{step.key}" for scene, step in ALL]


def test_every_scene_has_a_tour_of_three_to_five_steps() -> None:
    assert set(tours.scenes()) == set(registry.names())
    for scene in tours.scenes():
        assert 3 <= len(tours.steps(scene)) <= 5
        assert tours.steps(scene)[0].packings, "a tour begins with a scene of its own"
        assert len({step.key for step in tours.steps(scene)}) == len(tours.steps(scene))
    assert tours.steps("no such scene") == ()


@pytest.mark.parametrize("code", language.available())
def test_every_step_has_its_words_in_every_language(code: str) -> None:
    for scene, step in ALL:
        parts = {part for part in ("say", "do", "why") if code in getattr(step, part).by_language}
        assert "say" in parts
        assert ("do" in parts) == (step.until is not None), (scene, step.key)
        assert "why" in parts or step.until is None
        for part in parts - {"say"} if code != language.SOURCE else ():
            texts = getattr(step, part).by_language
            assert texts[code] != texts[language.SOURCE], (scene, step.key, "not translated")


@pytest.mark.parametrize(("scene", "step"), ALL, ids=NAMES)
def test_steps_speak_of_what_exists(scene: str, step: Step) -> None:
    known = registry.get(scene)
    assert set(step.packings) <= set(known.packings)
    values = known.settings(dict(step.settings))
    assert not step.view or step.view in VIEWS
    until = step.until
    if until is None:
        return
    wants = (
        until.moved,
        until.event,
        until.view,
        until.setting,
        until.out,
        until.force,
        until.grains,
        until.walls,
    )
    assert sum(bool(want) for want in wants) == 1
    assert not until.event or until.event in EVENTS
    assert not until.or_event or until.or_event in EVENTS
    assert not until.view or until.view in VIEWS
    assert not until.setting or until.setting in values
    assert not until.moved or until.by > 0.0


def moment(frame: Frame, view: str = "kind") -> Moment:
    return Moment.of([frame], view)


def test_conditions() -> None:
    frame = intruder_frame(6, settings={"friction": 0.5}, increment=3)
    handle = frame.handles[0]
    then = moment(frame)
    away = replace(frame, handles=(replace(handle, x=handle.x + 3.0, y=handle.y - 4.0),))
    assert met(Condition(moved=handle.name, by=5.0), then, moment(away))
    assert not met(Condition(moved=handle.name, by=5.1), then, moment(away))
    assert not met(Condition(moved="no handle", by=0.0), then, moment(away))
    clog = replace(frame, events=(Event("clog", 3, 1.0, 1.0, "clogged"),))
    assert met(Condition(event="clog"), then, moment(clog))
    assert not met(Condition(event="arch"), then, moment(clog))
    assert met(Condition(event="locked", or_event="clog"), then, moment(clog))
    assert not met(Condition(event="clog"), moment(clog), moment(clog)), "that was before"
    assert met(Condition(view="area"), then, moment(frame, "area"))
    other = replace(frame, settings={"friction": 0.2})
    assert met(Condition(setting="friction"), then, moment(other))
    assert not met(Condition(setting="friction"), then, then)
    assert met(Condition(setting="friction", below=0.3), then, moment(other))
    assert not met(Condition(setting="friction", below=0.1), then, moment(other))
    assert met(Condition(out=4), then, moment(replace(frame, grains_out=4)))
    assert met(Condition(force=1.5), then, moment(replace(frame, curve_force=np.array([9.0, 1.5]))))
    assert not met(
        Condition(force=1.5), then, moment(replace(frame, curve_force=np.array([9.0, 1.4])))
    )
    assert not met(Condition(grains=1), then, moment(frame))
    drawn = replace(frame, bodies=(*frame.bodies, frame.bodies[0]))
    assert met(Condition(walls=1), then, moment(drawn))
    assert not met(Condition(walls=1), then, then)


def test_one_of_several_panes_is_enough() -> None:
    """Where one hand drives all, one packing may be locked while the others move."""
    frame = intruder_frame(6)
    handle = frame.handles[0]
    away = replace(frame, handles=(replace(handle, x=handle.x + 3.0),))
    then, now = Moment.of([frame, frame], "kind"), Moment.of([frame, away], "kind")
    assert met(Condition(moved=handle.name, by=2.9), then, now)
    assert not met(Condition(moved=handle.name, by=3.1), then, now)


def test_grains_that_leave_are_not_taken_for_erased_ones() -> None:
    frame = intruder_frame(6)
    fewer = replace(intruder_frame(6), grains_out=3)
    then = moment(frame)
    assert met(Condition(grains=3), then, moment(fewer))  # three more than there were
    assert not met(Condition(grains=4), then, moment(fewer))

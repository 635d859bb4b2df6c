"""Tours lead through what exists, say it in every language, and each step can be done."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sandbox.draw.views import VIEWS
from sandbox.session.commands import Change, Command, DrawWall, Grab, Move, Place, Release
from sandbox.session.frame import Frame
from sandbox.session.history import Event
from sandbox.session.session import Session
from sandbox.window import tours
from sandbox.window.tours import Condition, Moment, Step, met
from sandbox.words import language
from scenes import registry
from tests.draw.frames import intruder_frame

EVENTS = {"clog", "arch", "avalanche"}
PATIENCE = 400  # increments in which a step must be done
AHEAD = 0.4  # of the hand, in front of what it pulls [R]
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
def test_every_step_has_its_words_and_no_words_are_left_over(code: str) -> None:
    texts = language.table(code)["tours"]
    there = {(scene, key) for scene, steps in texts.items() for key in steps}
    assert there == {(scene, step.key) for scene, step in ALL}
    for scene, step in ALL:
        parts = set(texts[scene][step.key])
        assert "say" in parts
        assert ("do" in parts) == (step.until is not None), (scene, step.key)
        assert "why" in parts or step.until is None


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
        until.grains,
        until.walls,
    )
    assert sum(bool(want) for want in wants) == 1
    assert not until.event or until.event in EVENTS
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
    assert not met(Condition(event="clog"), moment(clog), moment(clog)), "that was before"
    assert met(Condition(view="area"), then, moment(frame, "area"))
    other = replace(frame, settings={"friction": 0.2})
    assert met(Condition(setting="friction"), then, moment(other))
    assert not met(Condition(setting="friction"), then, then)
    assert met(Condition(setting="friction", below=0.3), then, moment(other))
    assert not met(Condition(setting="friction", below=0.1), then, moment(other))
    assert met(Condition(out=4), then, moment(replace(frame, grains_out=4)))
    assert not met(Condition(grains=1), then, moment(frame))
    drawn = replace(frame, bodies=(*frame.bodies, frame.bodies[0]))
    assert met(Condition(walls=1), then, moment(drawn))
    assert not met(Condition(walls=1), then, then)


def test_grains_that_leave_are_not_taken_for_erased_ones() -> None:
    frame = intruder_frame(6)
    fewer = replace(intruder_frame(6), grains_out=3)
    then = moment(frame)
    assert met(Condition(grains=3), then, moment(fewer))  # three more than there were
    assert not met(Condition(grains=4), then, moment(fewer))


@pytest.mark.slow
@pytest.mark.parametrize("scene", tours.scenes())
def test_each_step_can_be_done(scene: str) -> None:
    """By a hand that pulls the first handle where its scene would drive it."""
    session: Session | None = None
    for step in tours.steps(scene):
        if step.packings:
            session = Session(scene, step.packings[0], 1, dict(step.settings))
            session.build()
        assert session is not None
        until = step.until
        if until is None:
            continue
        view = step.view or "kind"
        then = moment(session.frame(), view)
        for command in asked(until, session):
            session.submit(command)
        for _ in range(PATIENCE):
            now = moment(session.frame(), until.view or view)
            if met(until, then, now):
                break
            pull(session, until.moved)
        assert met(until, then, moment(session.frame(), until.view or view)), step.key
        if until.moved:
            session.submit(Release(until.moved))


def asked(until: Condition, session: Session) -> list[Command]:
    """Commands that do what is asked for, apart from pulling."""
    _, ymin, xmax, ymax = session.frame().bounds
    if until.setting:
        return [Change(until.setting, 0.25)]
    if until.grains:
        return [
            Place(xmax - 4.0, ymin + share * (ymax - ymin), "auxetic")
            for share in (0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85)
        ]
    if until.walls:
        return [DrawWall(((xmax - 8.0, ymin + 3.0), (xmax - 8.0, ymin + 5.0)))]
    return []


def pull(session: Session, name: str) -> None:
    """One increment, the hand a little ahead of the handle; nobody pulls where grains go on by themselves."""
    if not name and session.run.setup.drag > 0.0:
        session.advance(2000)
        return
    handles = {handle.body: handle for handle in session.run.setup.handles}
    handle = handles[name or next(iter(handles))]
    frame = session.frame()
    state = next(each for each in frame.handles if each.name == handle.body)
    session.submit(Grab(handle.body))
    way = handle.direction
    session.submit(Move(handle.body, state.x + AHEAD * way[0], state.y + AHEAD * way[1]))
    for _ in range(200):
        if session.advance(2000) or session.idle:
            return

"""A sentence that says which way a handle is to go has it in its condition too; and what lessons ask for can be hit by keys."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import pytest

from sandbox.lessons import classroom, tours
from sandbox.lessons.lesson import WAYS, Condition, Step
from sandbox.lessons.moments import NEAR, Moment, met
from sandbox.lessons.reading import parse_lesson
from sandbox.window.canvas.arrows import FINE_STEP, STEP
from scenes import registry
from tests.draw.frames import intruder_frame

ALL = [
    (name, step)
    for name, lesson in [
        *((name, classroom.lesson(name)) for name in classroom.names()),
        *((name, tours.tour(name)) for name in tours.scenes()),
    ]
    if lesson is not None
    for step in lesson.steps
    if step.until is not None and step.until.moved
]
NAMES = [f"{name}.{step.key}" for name, step in ALL]
SAID = {
    "en": {
        "down": r"\bdown\b",
        "up": r"\bup\b",
        "right": r"to the right",
        "left": r"to the left",
        "inwards": r"\binwards\b",
        "outwards": r"\boutwards\b",
    },
    "de": {
        "down": r"nach unten",
        "up": r"nach oben",
        "right": r"nach rechts",
        "left": r"nach links",
        "inwards": r"nach innen",
        "outwards": r"nach außen",
    },
    "uk": {
        "down": r"\b[ув]низ\b",
        "up": r"\b(вгору|угору)\b",
        "right": r"праворуч",
        "left": r"ліворуч",
        "inwards": r"\b[ув]середину\b",
        "outwards": r"назовні",
    },
}
PLACES = {
    "left": (-1.0, 0.0),
    "right": (1.0, 0.0),
    "up": (0.0, 1.0),
    "down": (0.0, -1.0),
}


@pytest.mark.parametrize(("name", "step"), ALL, ids=NAMES)
def test_what_a_sentence_says_of_the_way_its_condition_says_too(name: str, step: Step) -> None:
    assert step.until is not None
    for code, ways in SAID.items():
        text = step.do.by_language.get(code)
        said = {way for way, sign in ways.items() if text and re.search(sign, text, re.IGNORECASE)}
        assert text is None or said == ({step.until.way} if step.until.way else set()), (code, text)


@pytest.mark.parametrize(("name", "step"), ALL, ids=NAMES)
def test_a_number_in_the_sentence_is_that_of_the_condition(name: str, step: Step) -> None:
    assert step.until is not None
    for text in step.do.by_language.values():
        for number in re.findall(r"(\d+(?:[.,]\d+)?) R\b", text):
            assert float(number.replace(",", ".")) == step.until.by, text


def scene_of(name: str, step: Step) -> str:
    lesson = classroom.lesson(name) if name in classroom.names() else tours.tour(name)
    assert lesson is not None
    return lesson.scene_of(lesson.steps.index(step))


@cache
def axis(name: str) -> str:
    """What a scene's plot counts along its axis."""
    scene = registry.get(name)
    curve = scene.build(scene.settings(), scene.packings[0], 1).curve
    return "" if curve is None else curve.stroke_label


@pytest.mark.parametrize(("name", "step"), ALL, ids=NAMES)
def test_where_the_plot_counts_otherwise_the_sentence_says_how_much_that_is(
    name: str, step: Step
) -> None:
    """A way in R cannot be read off an axis in percent."""
    texts = [text for text in step.do.by_language.values() if re.search(r"\d R\b", text)]
    if not texts or "% of a diameter" not in axis(scene_of(name, step)):
        return
    for text in texts:
        percent = re.search(r"(\d+(?:[.,]\d+)?) %", text)
        assert percent is not None, text
        assert step.until is not None
        assert float(percent[1].replace(",", ".")) == pytest.approx(50.0 * step.until.by)


@pytest.mark.parametrize(("name", "step"), ALL, ids=NAMES)
def test_every_way_can_be_hit_by_keys(name: str, step: Step) -> None:
    """By large steps as far as they go, then by small ones: there, and not beyond."""
    assert step.until is not None
    large, rest = divmod(step.until.by + NEAR, STEP)
    small = (rest - NEAR) / FINE_STEP
    assert small == pytest.approx(round(small), abs=1e-6)
    assert large * STEP + round(small) * FINE_STEP == pytest.approx(step.until.by, abs=NEAR)


def moved(x: float, y: float) -> tuple[Moment, Moment, str]:
    """Before and after a handle has gone so far from a place left of the middle."""
    frame = intruder_frame(6)
    handle = replace(
        frame.handles[0], x=frame.bounds[0], y=0.5 * (frame.bounds[1] + frame.bounds[3])
    )
    away = replace(handle, x=handle.x + x, y=handle.y + y)
    then, now = (Moment.of([replace(frame, handles=(h,))], "kind") for h in (handle, away))
    return then, now, handle.name


@pytest.mark.parametrize("way", PLACES)
def test_only_the_way_that_is_asked_for_counts(way: str) -> None:
    for other, (x, y) in PLACES.items():
        then, now, name = moved(2.0 * x, 2.0 * y)
        assert met(Condition(moved=name, by=2.0, way=way), then, now) == (other == way)
        assert met(Condition(moved=name, by=2.0), then, now), "whichever way"


def test_inwards_is_towards_the_middle_of_what_there_is() -> None:
    for x, inwards in ((1.0, True), (-1.0, False)):
        then, now, name = moved(x, 0.0)
        assert met(Condition(moved=name, by=1.0, way="inwards"), then, now) is inwards
        assert met(Condition(moved=name, by=1.0, way="outwards"), then, now) is not inwards


def test_what_goes_aside_does_not_count() -> None:
    then, now, name = moved(0.9, 3.0)
    assert not met(Condition(moved=name, by=1.0, way="right"), then, now)
    then, now, name = moved(1.0 - 0.5 * NEAR, 3.0)
    assert met(Condition(moved=name, by=1.0, way="right"), then, now), "rounding is no matter"


@pytest.mark.parametrize("way", WAYS)
def test_every_way_can_be_written(way: str) -> None:
    text = (
        'format = "auxetic-sandbox lesson"\nversion = 1\nscene = "hopper"\n'
        '[[step]]\nkey = "push"\npackings = ["regular"]\nsay = "Look."\ndo = "Push."\n'
        f'until = {{ moved = "piston", by = 1, way = "{way}" }}\n'
    )
    step = parse_lesson("mine", text.encode(), "").steps[0]
    assert step.until == Condition(moved="piston", by=1.0, way=way)

"""Every scene with a hand has its strength: live, on command line, in log, scene file and table; without enough it is locked."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from core.hand import SLACK
from sandbox.files.log_file import read_log, write_log
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import Change, Erase, Grab, Move, Protocol
from sandbox.session.session import Session
from scenes import registry
from scenes.scene import HAND_STRENGTH, STRONGEST

SMALL = {"grains": 60, "width": 12.0, "intruder_radius": 2.0, "pressure": 0.06}
WITHOUT = {"two_ellipses"}  # its grains are put where a hand wants them: nothing is pushed
SCENES = [name for name in registry.names() if name not in WITHOUT]
WEAK = 0.05  # [k R]


def small(name: str, **more: object) -> Session:
    known = {p.name: p for p in registry.get(name).parameters}
    asked = {key: value for key, value in {**SMALL, **more}.items() if key in known}
    if "grains" in asked:
        asked["grains"] = max(asked["grains"], known["grains"].low)  # type: ignore[call-overload]
    session = Session(name, "regular", 1, asked)
    session.build()
    return session


def drive(session: Session, most: int) -> None:
    session.submit(Protocol(True))
    for _ in session.slices(400):
        if len(session.history) > most:
            return


@pytest.mark.parametrize("name", SCENES)
def test_a_word_and_the_highest_value_mean_a_testing_machine(name: str) -> None:
    scene = registry.get(name)
    (strength,) = [p for p in scene.parameters if p.name == HAND_STRENGTH]
    assert strength.live
    assert strength.unit == "k R"
    assert scene.settings({HAND_STRENGTH: "machine"})[HAND_STRENGTH] == STRONGEST
    assert scene.settings({HAND_STRENGTH: "2.5"})[HAND_STRENGTH] == 2.5
    assert strength.check(STRONGEST) == STRONGEST


def test_only_where_a_hand_pushes() -> None:
    for name in WITHOUT:
        assert all(p.name != HAND_STRENGTH for p in registry.get(name).parameters)


@pytest.mark.parametrize(
    "name", [name for name in SCENES if name not in ("workshop", "gravity_hopper")]
)
def test_a_weak_hand_is_locked_in_every_scene(name: str) -> None:
    """Its force stays within its strength; it says what holds; the script ends; a strength that is set live lets it go on."""
    session = small(name, hand_strength=WEAK)
    start = session.run.hand_force
    assert math.isnan(start)
    drive(session, 200)
    assert session.run.locked
    assert session.idle
    frame = session.frame()
    assert not frame.protocol
    assert frame.events[-1].kind == "locked"
    assert f"locked at {WEAK} k R" in frame.notices[0]
    assert "hold" in frame.notices[0]
    # A cell may resist more than that already as it is built; nothing has moved it then.
    least = session.history[0].resisting if session.run.way is None else 0.0
    if least <= 0.0:
        assert session.run.hand_force <= WEAK * (1.0 + SLACK) + 1e-12
    assert session.history[-1].hand_strength == WEAK
    rows = len(session.history)
    session.submit(Change(HAND_STRENGTH, STRONGEST))
    drive(session, rows + 6)
    assert session.history[-1].hand_strength == STRONGEST
    later = [event.kind for event in session.frame().events if event.increment >= rows]
    assert "locked" not in later


def test_log_and_scene_file_keep_it(tmp_path: Path) -> None:
    session = small("hopper", hand_strength=2.0)
    session.submit(Change(HAND_STRENGTH, 3.0))
    drive(session, 12)
    write_log(tmp_path / "run.jsonl", session.log())
    log = read_log(tmp_path / "run.jsonl")
    assert log.settings[HAND_STRENGTH] == 2.0
    assert any(isinstance(c, Change) and c.value == 3.0 for _, c in log.commands)
    write_scene(tmp_path / "made.scene", session.made())
    again = Session.from_file(read_scene(tmp_path / "made.scene"))
    again.build()
    assert again.settings[HAND_STRENGTH] == 3.0
    assert again.run.strength == 3.0


def test_what_is_locked_stays_locked_however_often_it_is_tried() -> None:
    """With nothing changed there is nothing that could yield: caps of friction are those of the state."""
    session = small("hopper", friction=0.5, hand_strength=4.0)
    drive(session, 400)
    assert session.run.locked
    way = session.run.way
    x, y = session.run.setup.world["piston"].position
    session.submit(Grab("piston"))
    for k in range(12):
        session.submit(Move("piston", x, y - 5.0 - 0.01 * k))
        for _ in session.slices(400):
            pass
    assert session.run.way == pytest.approx(way, abs=1e-3)


def test_a_hand_that_cannot_give_way_ends_too() -> None:
    """Grains that press harder than the hand has, and a piston at the end of its travel: locked, not for ever at it."""
    session = small("hopper", hand_strength=0.01, packing_fraction=0.92, orifice=0.5)
    drive(session, 400)
    assert session.idle
    assert session.run.locked
    assert "pushed back by" in session.run.how_locked
    assert session.run.way is not None
    assert session.run.way < 0.0


def test_what_held_may_be_erased_and_the_hand_goes_on() -> None:
    session = small("hopper", orifice=0.5)
    x, y = session.run.setup.world["piston"].position
    session.submit(Grab("piston"))
    session.submit(Move("piston", x, y - 9.0))
    for _ in session.slices(400):
        pass
    assert session.run.locked
    way = session.run.way
    assert way is not None
    session.submit(Erase(0.0, 0.0, 60.0))
    for _ in session.slices(400):
        pass
    assert session.run.way is not None
    assert session.run.way > way + 1.0


def test_a_scene_without_limits_has_no_limit_in_the_plot() -> None:
    frame = small("hopper", hand_strength=STRONGEST).frame()
    assert frame.hand_limit is None
    assert replace(frame, hand_limit=6.0).hand_limit == 6.0
    assert small("hopper", hand_strength=4.0).frame().hand_limit == 4.0
    assert small("biaxial_press", hand_strength=4.0).frame().hand_limit is None  # plots pressure

"""Back in time and on again: recall, undo, redo and reset restore every bit, and logs replay them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sandbox.files.log_file import read_log, write_log
from sandbox.session.commands import (
    Change,
    Command,
    Grab,
    Move,
    Protocol,
    Recall,
    Redo,
    Release,
    Reset,
    Undo,
)
from sandbox.session.replay import replay
from sandbox.session.session import Session

SMALL = {"grains": 60.0}
SCENES: dict[str, dict[str, float]] = {
    "intruder": {**SMALL, "intruder_radius": 2.0},
    "hopper": {**SMALL, "width": 12.0, "friction": 0.5, "orifice": 4.0},
    "gravity_hopper": {"grains": 30, "width": 10.0},
    "couette": {"grains": 160, "friction": 0.3},
    "avalanches": {"grains": 60},
    "biaxial_periodic": SMALL,
    "single_grain": {},
    "two_ellipses": {},
    "grain_row": {"friction": 0.2},
}


def built(scene: str = "intruder", **more: float) -> Session:
    session = Session(scene, "mixed", 1, {**SCENES[scene], **more})
    session.build()
    return session


def do(session: Session, *commands: Command) -> None:
    """Let the commands take effect and nothing more."""
    for command in commands:
        session.submit(command)
    session.settle()


def go(session: Session, increments: int) -> list[str]:
    """State after each of so many increments, or fewer when nothing moves any more."""
    hashes: list[str] = []
    while len(hashes) < increments and not session.idle:
        if session.advance(1000):
            hashes.append(session.state_hash())
    return hashes


def rest(session: Session) -> None:
    """Until nothing moves."""
    while not session.idle:
        session.advance(1000)


@pytest.mark.parametrize("scene", SCENES)
def test_going_on_from_a_recalled_state_gives_the_same_bits(scene: str) -> None:
    session = built(scene)
    do(session, Protocol(True))
    hashes = [session.state_hash(), *go(session, 9)]
    rows, curve = list(session.history.rows()), session.frame().curve_force
    do(session, Recall(4))
    assert session.state_hash() == hashes[4]
    frame = session.frame()
    assert (frame.increment, frame.first_kept, frame.last_kept) == (4, 0, 9)
    assert np.array_equal(frame.curve_force, curve[:5])
    assert go(session, 5) == hashes[5:]
    assert list(session.history.rows()) == rows


def test_the_future_can_be_recalled_until_something_moves() -> None:
    session = built()
    do(session, Protocol(True))
    hashes = [session.state_hash(), *go(session, 6)]
    for increment in (2, 6, 0, 5):
        do(session, Recall(increment))
        assert session.state_hash() == hashes[increment]
    do(session, Recall(3), Grab("intruder"), Move("intruder", 20.0, 20.0))
    assert session.frame().last_kept == 6
    go(session, 1)
    assert session.frame().last_kept == session.frame().increment == 4
    do(session, Recall(99))
    assert session.frame().increment == 4
    do(session, Recall(3))
    assert session.state_hash() == hashes[3]


def test_recalled_frames_look_as_they_did() -> None:
    session = built("hopper")
    do(session, Protocol(True))
    frames = [session.frame()]
    for _ in range(5):
        go(session, 1)
        frames.append(session.frame())
    do(session, Recall(2))
    then, now = frames[2], session.frame()
    for name in ("x", "p", "pressure", "motion", "spin", "residual_force", "label"):
        assert np.array_equal(getattr(then, name), getattr(now, name)), name
    for name in ("x0", "y1", "force", "i", "j"):
        assert np.array_equal(getattr(then.contacts, name), getattr(now.contacts, name)), name
    for name in ("handles", "stroke", "grains_out", "residual", "stop_reason", "notices"):
        if name == "handles":
            assert (then.handles[0].y, then.handles[0].fy) == (now.handles[0].y, now.handles[0].fy)
        else:
            assert getattr(then, name) == getattr(now, name), name


def test_undo_takes_back_gestures_one_by_one_and_redo_does_them_again() -> None:
    session = built()
    assert not session.frame().can_undo
    hashes = [session.state_hash()]
    for x in (12.0, 16.0, 5.0):
        do(session, Grab("intruder"), Move("intruder", x, 12.0))
        go(session, 4)
        do(session, Release("intruder"))
        hashes.append(session.state_hash())
    assert len(set(hashes)) == 4
    for expected in reversed(hashes[:-1]):
        assert session.frame().can_undo
        do(session, Undo())
        assert session.state_hash() == expected
        assert session.idle
    assert not session.frame().can_undo
    do(session, Undo())
    assert "nothing to undo" in session.frame().notices[0]
    for expected in hashes[1:]:
        assert session.frame().can_redo
        do(session, Redo())
        assert session.state_hash() == expected
    assert not session.frame().can_redo
    do(session, Redo())
    assert "nothing to redo" in session.frame().notices[0]


def test_a_new_gesture_after_an_undo_ends_what_could_be_redone() -> None:
    session = built()
    do(session, Grab("intruder"), Move("intruder", 20.0, 12.0))
    go(session, 3)
    do(session, Undo(), Grab("intruder"), Move("intruder", 2.0, 2.0))
    go(session, 3)
    assert not session.frame().can_redo
    assert session.frame().increment == 3


def test_a_click_that_moves_nothing_is_nothing_to_undo() -> None:
    session = built()
    do(session, Grab("intruder"), Release("intruder"), Grab("intruder"), Release("intruder"))
    assert not session.frame().can_undo


def test_undo_brings_back_packing_seed_scene_and_what_a_reset_threw_away() -> None:
    session = built("hopper")
    do(session, Protocol(True))
    go(session, 4)
    do(session, Protocol(False))
    moved = session.state_hash()
    commands: list[Command] = [
        Reset(),
        Change("packing", "auxetic"),
        Change("seed", 5),
        Change("grains", 50),
        Change("scene", "single_grain"),
    ]
    hashes = [moved]
    for command in commands:
        do(session, command)
        hashes.append(session.state_hash())
    assert session.scene.name == "single_grain"
    for expected in reversed(hashes[:-1]):
        do(session, Undo())
        assert session.state_hash() == expected
    frame = session.frame()
    assert (frame.scene, frame.packing, frame.seed) == ("hopper", "mixed", 1)
    assert (frame.settings["grains"], frame.first_kept, frame.last_kept) == (60, 0, 4)
    for expected in hashes[1:]:
        do(session, Redo())
        assert session.state_hash() == expected
    do(session, *(Undo(),) * 5, Recall(2))
    assert session.frame().increment == 2


def test_a_scrub_is_undone_in_one_step() -> None:
    session = built()
    do(session, Grab("intruder"), Move("intruder", 20.0, 12.0))
    go(session, 6)
    do(session, Release("intruder"))
    end = session.state_hash()
    do(session, Recall(5), Recall(3), Recall(1), Grab("intruder"), Move("intruder", 1.0, 1.0))
    go(session, 2)
    do(session, Undo(), Undo())
    assert session.state_hash() == end
    # The way there and back was another: only what lies on the way to this state is kept.
    assert session.frame().increment == session.frame().last_kept == 6
    do(session, Recall(1))
    assert session.frame().increment == 1


def test_slider_moves_of_one_parameter_are_undone_together() -> None:
    session = built()
    start = session.state_hash()
    for nu in (0.7, 0.6, 0.5):
        do(session, Change("regular_poisson_ratio", nu))
        rest(session)
    do(session, Change("contact_stiffness", 80.0))
    rest(session)
    do(session, Undo())
    assert session.settings["contact_stiffness"] == 50.0
    assert session.settings["regular_poisson_ratio"] == 0.5
    do(session, Undo())
    assert session.state_hash() == start
    assert session.frame().settings["regular_poisson_ratio"] == 0.8


def test_the_hand_does_not_go_on_after_an_undo() -> None:
    session = built()
    do(session, Grab("intruder"), Move("intruder", 20.0, 12.0))
    go(session, 2)
    do(session, Undo(), Move("intruder", 0.0, 0.0))
    assert session.idle
    do(session, Protocol(True))
    go(session, 3)
    do(session, Undo())
    assert session.idle


def test_a_log_with_all_of_it_replays_to_the_same_bits(tmp_path: Path) -> None:
    session = built("hopper")
    do(session, Grab("piston"), Move("piston", 0.0, 0.0))
    go(session, 5)
    do(session, Change("regular_poisson_ratio", 0.2), Change("friction", 0.0))
    go(session, 3)
    do(session, Recall(3), Move("piston", 0.0, 30.0))
    go(session, 4)
    do(session, Undo(), Undo(), Redo(), Change("friction", 0.4), Protocol(True))
    go(session, 6)
    do(session, Reset(), Change("auxetic_poisson_ratio", -0.3))
    go(session, 1)
    do(session, Change("packing", "regular"), Grab("piston"), Move("piston", 0.0, 1.0))
    go(session, 3)
    do(session, Undo(), Undo(), Undo())
    go(session, 2)
    path = tmp_path / "run.jsonl"
    write_log(path, session.log())
    log = read_log(path)
    assert {type(command) for _, command in log.commands} >= {Recall, Undo, Redo}
    again = list(replay(log, slice_iterations=77))[-1]
    assert again.state_hash() == session.state_hash()
    assert list(again.history.rows()) == list(session.history.rows())
    assert again.frame().settings == session.frame().settings


def test_a_recall_or_an_undo_is_seen_before_anything_moves() -> None:
    session = built()
    do(session, Protocol(True))
    hashes = [session.state_hash(), *go(session, 5)]
    session.submit(Recall(2))
    assert not session.advance()
    assert session.state_hash() == hashes[2]
    assert session.frame().last_kept == 5
    assert not session.idle
    assert go(session, 1) == hashes[3:4]

"""The loop: the same commands give the same bits, and nothing that a hand does breaks it."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from sandbox.files.log_file import read_log, write_log
from sandbox.session.commands import (
    Change,
    Command,
    DrawWall,
    Grab,
    Move,
    Place,
    Protocol,
    Release,
    Reset,
)
from sandbox.session.replay import replay
from sandbox.session.session import Session

RADIUS = 2.0
SMALL = {"grains": 60, "intruder_radius": RADIUS}


def intruder(packing: str = "mixed", seed: int = 1) -> Session:
    session = Session("intruder", packing, seed, SMALL)
    session.build()
    return session


def hopper(**settings: object) -> Session:
    session = Session("hopper", "mixed", 2, {"grains": 60, "width": 12.0, **settings})
    session.build()
    return session


def run(session: Session, increments: int, slice_iterations: int = 1000) -> int:
    """Advance until so many increments are finished, or nothing is left to do; how many there were."""
    done = 0
    while done < increments and not session.idle:
        done += session.advance(slice_iterations)
    return done


def drag(session: Session, *commands: Command) -> None:
    for command in commands:
        session.submit(command)


def test_same_seed_and_commands_give_the_same_bits_however_the_work_is_sliced() -> None:
    hashes = set()
    for slice_iterations in (1, 37, 100_000):
        session = intruder()
        drag(session, Grab("intruder"), Move("intruder", 20.0, 12.0))
        run(session, 6, slice_iterations)
        hashes.add(session.state_hash())
    assert len(hashes) == 1


def test_another_seed_is_another_packing() -> None:
    assert intruder(seed=1).state_hash() != intruder(seed=2).state_hash()


@pytest.mark.parametrize("make", [intruder, hopper])
def test_a_log_replays_to_the_same_bits(make: Callable[[], Session], tmp_path: Path) -> None:
    session = make()
    name = session.run.setup.handles[0].body
    x, y = session.run.setup.world[name].position
    drag(session, Grab(name), Move(name, x + 5.0, y - 2.0))
    run(session, 5)
    drag(session, Move(name, x - 1.0, y - 3.0))
    run(session, 3)
    drag(session, Release(name), Reset(), Protocol(True))
    run(session, 4)
    drag(session, Change("packing", "auxetic"), Grab(name), Move(name, x, y - 4.0))
    run(session, 3)
    path = tmp_path / "run.jsonl"
    write_log(path, session.log())
    log = read_log(path)
    assert log.hash == session.state_hash()
    assert log.end == session.finished == 15
    again = list(replay(log, slice_iterations=61))[-1]
    assert again.state_hash() == session.state_hash()
    assert list(again.history.rows()) == list(session.history.rows())


def test_reset_returns_to_the_start_to_the_last_bit() -> None:
    for session in (intruder(), hopper(friction=0.5)):
        start, row = session.state_hash(), session.history[0]
        drag(session, Protocol(True))
        run(session, 8)
        assert session.state_hash() != start
        drag(session, Reset())
        session.advance()
        assert session.state_hash() == start
        assert session.history[0] == row
        assert len(session.history) == 1


def test_a_flung_intruder_passes_through_nothing() -> None:
    session = intruder()
    setup = session.run.setup
    width, height = setup.outline[2]
    drag(session, Grab("intruder"))
    for corner in ((1e6, 1e6), (-1e6, 0.5 * height), (0.5 * width, -1e6)):
        drag(session, Move("intruder", *corner))
        before = np.array(setup.world["intruder"].position)
        for _ in range(25):
            if not run(session, 1):
                break
            now = np.array(setup.world["intruder"].position)
            # A step and what four substeps of the wall's push can add.
            assert np.hypot(*(now - before)) <= 2.0 * setup.solver.step
            before = now
            assert RADIUS - 0.05 <= now[0] <= width - RADIUS + 0.05
            assert RADIUS - 0.05 <= now[1] <= height - RADIUS + 0.05
    assert all(check.holds is not False for check in session.checks()[:2])


def test_a_body_pressed_into_a_wall_stops_and_the_session_rests() -> None:
    session = Session("intruder", "mixed", 1, {**SMALL, "hand_strength": 1000.0})
    session.build()
    x, y = session.run.setup.world["intruder"].position
    drag(session, Grab("intruder"), Move("intruder", x - 100.0, y))
    run(session, 400)
    assert session.idle
    assert any("wall" in notice for notice in session.frame().notices)


def test_bad_commands_change_nothing_and_say_why() -> None:
    session = intruder()
    start = session.state_hash()
    drag(session, Grab("spoon"), Change("packing", "wooden"), Change("grains", 1e9))
    session.advance()
    assert session.state_hash() == start
    assert "grains must lie between" in session.frame().notices[0]
    assert session.log().commands == ()


@pytest.mark.parametrize("nonsense", [math.nan, math.inf, -math.inf, 10**400])
def test_numbers_that_are_none_are_refused_and_never_logged(
    nonsense: float, tmp_path: Path
) -> None:
    session = intruder()
    start = session.state_hash()
    drag(
        session,
        Grab("intruder"),
        Move("intruder", nonsense, 1.0),
        Move("intruder", 1.0, nonsense),
        Change("friction", nonsense),
        Place(nonsense, 1.0, "regular"),
        DrawWall(((nonsense, 1.0), (2.0, 2.0))),
    )
    run(session, 3)
    assert session.state_hash() == start
    assert "finite" in session.frame().notices[0]
    write_log(tmp_path / "run.jsonl", session.log())
    assert read_log(tmp_path / "run.jsonl").commands == ((0, Grab("intruder")),)


def test_an_increment_that_cannot_be_begun_is_told_and_waits_for_the_hand(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    session = intruder()
    x, y = session.run.setup.world["intruder"].position
    drag(session, Protocol(True))
    run(session, 2)

    def refuse(*_: object) -> None:
        raise InputError("it cannot be done")

    with monkeypatch.context() as patch:
        patch.setattr(session.run.engine, "_begin", refuse)
        before = session.state_hash()
        assert not session.advance()
        assert session.idle
        assert session.state_hash() == before
        assert "it cannot be done" in session.frame().notices
    drag(session, Grab("intruder"), Move("intruder", x + 5.0, y))
    assert run(session, 2) == 2


def test_requests_are_checked_before_anything_is_built() -> None:
    with pytest.raises(InputError, match="did you mean hopper"):
        Session("hoper")
    with pytest.raises(InputError, match="choose regular, auxetic, mixed"):
        Session("hopper", "wooden")
    with pytest.raises(InputError, match="seed"):
        Session("hopper", "mixed", -1)
    with pytest.raises(InputError, match="did you mean orifice"):
        Session("hopper", "mixed", 1, {"orifise": 3.0})


def test_frames_share_nothing_with_the_session() -> None:
    session = intruder()
    frame = session.frame()
    x, force = frame.x.copy(), frame.curve_force.copy()
    drag(session, Protocol(True))
    run(session, 3)
    assert np.array_equal(frame.x, x)
    assert np.array_equal(frame.curve_force, force)


def test_grains_that_leave_are_counted_and_gone() -> None:
    session = hopper(orifice=4.0, friction=0.0)
    first = len(session.run.setup.packing)
    drag(session, Protocol(True))
    run(session, 60)
    out = session.frame().grains_out
    assert out > 0
    assert session.frame().grains + out == first
    assert session.history[-1].grains_out == out


@pytest.mark.parametrize("make", [intruder, lambda: hopper(orifice=0.5)])
def test_a_frame_says_how_far_each_grain_is_from_balance(make: Callable[[], Session]) -> None:
    session = make()
    drag(session, Change("friction", 0.0), Protocol(True))
    run(session, 12)
    frame = session.frame()
    pairs, bodies = session.run.engine.contacts()
    force = np.zeros((2, frame.grains))
    for axis, (f, g) in enumerate(((pairs.fx, bodies.fx), (pairs.fy, bodies.fy))):
        np.add.at(force[axis], pairs.i, f)
        np.add.at(force[axis], pairs.j, -f)
        np.add.at(force[axis], bodies.grain, g)
    assert np.allclose(np.hypot(*force), frame.residual_force, rtol=1e-6, atol=1e-12)
    assert frame.residual_force.max() > 0.0
    touching = frame.contacts
    assert np.array_equal(touching.rigid, touching.j < 0)
    inside = touching.j >= 0
    assert np.array_equal(touching.x0, frame.x[touching.i])
    assert np.allclose(touching.x1[inside], frame.x[touching.j[inside]])


@pytest.mark.parametrize(
    "change",
    [Change("friction", 0.3), Change("packing", "regular"), Change("seed", 7), Change("step", 0.1)],
    ids=lambda change: change.name,
)
def test_wherever_a_change_is_broken_off_all_is_as_before(
    change: Change, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each time that it tells how far it is somebody may say that it is not wanted any more."""
    tells, least = 0, math.inf

    def tell(text: str, share: float) -> None:
        nonlocal tells
        tells += 1
        if tells > least:
            raise InputError("not wanted")

    session = Session("intruder", "mixed", 1, {**SMALL, "friction": 0.0})
    session.build(tell)
    run(session, 2)
    compiles: list[int] = []
    monkeypatch.setattr(
        "sandbox.session.session.compile_kernels", lambda **_: compiles.append(tells)
    )

    def state() -> tuple[object, ...]:
        return session.state_hash(), dict(session.settings), session.packing, session.seed

    before, allowed = state(), 0
    while True:
        tells, least = 0, allowed
        session.submit(change)
        session.settle()
        if session.refusals[0] == allowed:  # it came to its end
            break
        assert state() == before
        allowed += 1
    assert state() != before
    assert allowed >= (1 if change.name != "step" else 0)
    if compiles:  # it can be broken off when that is done
        assert tells > compiles[-1]


@pytest.mark.parametrize("scene", ["biaxial_periodic", "avalanches"])
def test_the_handle_of_a_box_goes_along_the_line_that_it_names(scene: str) -> None:
    """Wherever a hand pulls it: what is drawn at it and told of it is that line."""
    session = Session(scene, "mixed", 1, {"grains": 60})
    session.build()
    (before,) = session.frame().handles
    axis = before.axis
    assert axis is not None
    assert math.hypot(*axis) == pytest.approx(1.0)
    by, across = 0.2, 0.7
    wanted = by * axis[0] - across * axis[1], by * axis[1] + across * axis[0]
    session.submit(Grab("box"))
    session.submit(Move("box", before.x + wanted[0], before.y + wanted[1]))
    for _ in range(60):
        while not session.advance() and session.busy:
            pass
    (after,) = session.frame().handles
    went = after.x - before.x, after.y - before.y
    assert went == pytest.approx((by * axis[0], by * axis[1]), abs=1e-6)

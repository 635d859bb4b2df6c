"""The solver's thread: commands in, pictures out, never silent when something goes wrong."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import pytest

from core.errors import InputError
from sandbox.session.commands import Change, Grab, Move, Protocol, Release, Reset
from sandbox.window.solvers.conductor import Conductor
from sandbox.window.solvers.solver_thread import SolverThread
from tests.window.fake_session import SLICES, FakeSession, started, wait_until


@pytest.fixture
def session() -> FakeSession:
    return FakeSession()


@pytest.fixture
def solver(session: FakeSession) -> Iterator[SolverThread]:
    thread = started(session)
    yield thread
    assert thread.stop()


def assert_between_increments(session: FakeSession) -> None:
    assert not session.busy


def handle_x(solver: SolverThread) -> float:
    frame = solver.snapshot.frame
    assert frame is not None
    return frame.handles[0].x


def test_all_work_is_done_in_the_thread(session: FakeSession, solver: SolverThread) -> None:
    solver.conductor.submit(Protocol(True))
    wait_until(lambda: session.increments > 3)
    assert session.threads.isdisjoint({threading.get_ident()})
    assert len(session.threads) == 1


def test_progress_of_the_build_is_published() -> None:
    session = FakeSession()
    session.block_build = threading.Event()
    solver = SolverThread(session, Conductor())
    solver.start()
    wait_until(lambda: solver.snapshot.fraction == 0.5)
    seen = solver.snapshot
    assert (seen.phase, seen.text, seen.frame) == ("building", "compiling", None)
    session.block_build.set()
    wait_until(lambda: solver.snapshot.phase == "running")
    assert solver.snapshot.frame is not None
    assert solver.stop()


def test_a_build_can_be_broken_off() -> None:
    session = FakeSession()
    session.block_build = threading.Event()
    solver = SolverThread(session, Conductor())
    solver.start()
    assert solver.stop()
    assert not session.built


def test_dragged_handle_arrives(session: FakeSession, solver: SolverThread) -> None:
    start = handle_x(solver)
    solver.conductor.submit(Grab("intruder"))
    solver.conductor.submit(Move("intruder", start + 3.0, 0.0))
    wait_until(lambda: handle_x(solver) == pytest.approx(start + 3.0))
    solver.conductor.submit(Release("intruder"))
    wait_until(lambda: Release("intruder") in session.commands)
    assert session.idle


def test_of_many_moves_the_latest_counts(session: FakeSession, solver: SolverThread) -> None:
    solver.conductor.pause(True)
    solver.conductor.submit(Grab("intruder"))
    for x in range(500):
        solver.conductor.submit(Move("intruder", float(x), 0.0))
    solver.conductor.submit(Release("intruder"))
    solver.conductor.submit(Grab("intruder"))
    solver.conductor.submit(Move("intruder", 5.0, 0.0))
    solver.conductor.submit(Move("intruder", 6.0, 0.0))
    solver.conductor.pause(False)
    wait_until(lambda: len(session.commands) >= 5)
    assert session.commands == [
        Grab("intruder"),
        Move("intruder", 499.0, 0.0),
        Release("intruder"),
        Grab("intruder"),
        Move("intruder", 6.0, 0.0),
    ]


def test_idle_solver_sleeps(session: FakeSession, solver: SolverThread) -> None:
    serial = solver.snapshot.serial
    time.sleep(0.1)
    assert solver.snapshot.serial == serial


def test_pause_finishes_the_increment_and_step_does_one(
    session: FakeSession, solver: SolverThread
) -> None:
    solver.conductor.submit(Protocol(True))
    wait_until(lambda: session.increments >= 2)
    solver.conductor.pause(True)
    time.sleep(20 * SLICES * session.slice_time)
    held = session.increments
    time.sleep(0.05)
    assert session.increments == held
    assert_between_increments(session)
    for step in (1, 2):
        solver.conductor.step()
        wait_until(lambda step=step: session.increments == held + step)  # type: ignore[misc]
    time.sleep(0.05)
    assert session.increments == held + 2
    assert solver.conductor.paused
    frame = solver.snapshot.frame
    assert frame is not None
    assert frame.increment == held + 2
    solver.conductor.pause(False)
    wait_until(lambda: session.increments > held + 4)


def test_step_with_nothing_to_do_is_not_saved_up(
    session: FakeSession, solver: SolverThread
) -> None:
    for _ in range(5):
        solver.conductor.step()
    time.sleep(0.05)
    solver.conductor.submit(Protocol(True))
    time.sleep(0.1)
    assert session.increments == 0
    solver.conductor.step()
    wait_until(lambda: session.increments == 1)
    time.sleep(0.05)
    assert session.increments == 1


@pytest.mark.parametrize("command", [Reset(), Change("packing", "auxetic"), Change("seed", 9)])
def test_reset_and_changes_work_while_paused(
    session: FakeSession, solver: SolverThread, command: Reset | Change
) -> None:
    solver.conductor.pause(True)
    solver.conductor.submit(command)
    wait_until(lambda: session.commands == [command])
    wait_until(lambda: solver.snapshot.phase == "running")
    assert solver.conductor.paused


def test_frames_of_a_long_increment_are_shown(session: FakeSession, solver: SolverThread) -> None:
    session.slice_time = 0.03
    solver.conductor.submit(Protocol(True))
    seen: set[bool] = set()
    patience = time.perf_counter() + 60.0
    while not seen >= {True, False} and time.perf_counter() < patience:
        frame = solver.snapshot.frame
        assert frame is not None
        seen.add(frame.busy)
        time.sleep(0.005)
    assert seen == {True, False}


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (InputError("the orifice is wider than the channel"), "the orifice is wider"),
        (ZeroDivisionError("division by zero"), "ZeroDivisionError: division by zero"),
        (MemoryError(), "MemoryError"),
    ],
)
def test_error_is_published_with_the_last_frame(
    session: FakeSession, error: Exception, words: str
) -> None:
    solver = started(session)
    session.fail = error
    solver.conductor.submit(Protocol(True))
    wait_until(lambda: solver.snapshot.phase == "failed")
    assert words in solver.snapshot.error
    assert solver.snapshot.frame is not None
    assert solver.stop()


def test_error_in_the_build_is_published() -> None:
    session = FakeSession()
    session.fail_build = InputError("too few grains")
    solver = SolverThread(session, Conductor())
    solver.start()
    wait_until(lambda: solver.snapshot.phase == "failed")
    assert solver.snapshot.error == "too few grains"
    assert solver.snapshot.frame is None
    assert solver.stop()


def test_stop_ends_between_increments(session: FakeSession) -> None:
    solver = started(session)
    solver.conductor.submit(Protocol(True))
    wait_until(lambda: session.busy)
    assert solver.stop()
    assert_between_increments(session)
    assert solver.snapshot.phase == "stopped"


def test_stop_before_start() -> None:
    assert SolverThread(FakeSession(), Conductor()).stop()

"""Several solvers in step: the same commands before the same increment, whoever is slow or late."""

from __future__ import annotations

import math
import time

import pytest

from sandbox.session.commands import Change, Command, Grab, Move, Protocol, Recall, Release, Reset
from sandbox.window.solvers.conductor import Conductor
from sandbox.window.solvers.solver_thread import SolverThread
from tests.window.fake_session import FakeSession, wait_until


class Diary(FakeSession):
    """Writes down before which increment every command came."""

    def __init__(self, pace: float) -> None:
        super().__init__()
        self.slice_time = pace
        self.pages: list[tuple[int, Command]] = []

    def _apply(self, command: Command) -> None:
        self.pages.append((self.increments, command))
        super()._apply(command)


def together(conductor: Conductor, *paces: float) -> tuple[list[Diary], list[SolverThread]]:
    sessions = [Diary(pace) for pace in paces]
    solvers = [SolverThread(session, conductor) for session in sessions]
    for solver in solvers:
        solver.start()
    return sessions, solvers


def drag(conductor: Conductor, steps: int) -> None:
    conductor.submit(Grab("intruder"))
    for step in range(steps):
        conductor.submit(Move("intruder", 3.0 + 0.37 * step, 0.0))
        time.sleep(0.004)
    conductor.submit(Release("intruder"))


def test_all_take_the_same_path() -> None:
    conductor = Conductor()
    sessions, solvers = together(conductor, 0.0002, 0.003, 0.001)
    drag(conductor, 40)
    wait_until(lambda: all(Release("intruder") in session.commands for session in sessions))
    assert sessions[0].pages == sessions[1].pages == sessions[2].pages
    assert len({session.increments for session in sessions}) == 1
    assert sessions[0].increments > 1
    for solver in solvers:
        assert solver.stop()


def test_who_comes_late_goes_the_same_way_first() -> None:
    conductor = Conductor()
    sessions, solvers = together(conductor, 0.0005)
    drag(conductor, 20)
    wait_until(lambda: Release("intruder") in sessions[0].commands)
    late, more = together(conductor, 0.0005)
    seen: set[str] = set()
    while more[0].snapshot.phase != "running":
        seen.add(more[0].snapshot.phase)
        time.sleep(0.0005)
    assert "catching up" in seen
    assert late[0].pages == sessions[0].pages
    assert late[0].increments == sessions[0].increments
    drag(conductor, 5)
    wait_until(lambda: late[0].commands.count(Release("intruder")) == 2)
    wait_until(lambda: late[0].pages == sessions[0].pages)
    assert all(solver.stop() for solver in (*solvers, *more))


def test_what_was_before_a_reset_is_not_repeated() -> None:
    conductor = Conductor()
    sessions, solvers = together(conductor, 0.0005)
    drag(conductor, 5)
    conductor.submit(Reset())
    conductor.submit(Grab("intruder"))
    wait_until(lambda: sessions[0].commands[-1:] == [Grab("intruder")])
    late, more = together(conductor, 0.0005)
    wait_until(lambda: more[0].snapshot.phase == "running")
    assert [command for _, command in late[0].pages] == [Grab("intruder")]
    assert all(solver.stop() for solver in (*solvers, *more))


def test_one_that_fails_does_not_hold_the_others_up() -> None:
    conductor = Conductor()
    sessions, solvers = together(conductor, 0.0005, 0.0005)
    wait_until(lambda: all(solver.snapshot.phase == "running" for solver in solvers))
    sessions[1].fail = RuntimeError("lost")
    conductor.submit(Protocol(True))
    wait_until(lambda: sessions[0].increments > 5)
    assert solvers[1].snapshot.phase == "failed"
    assert all(solver.stop() for solver in solvers)


def test_pause_and_step_hold_for_all() -> None:
    conductor = Conductor(paused=True)
    sessions, solvers = together(conductor, 0.0005, 0.001)
    conductor.submit(Protocol(True))
    for count in (1, 2):
        conductor.step()
        wait_until(lambda count=count: all(s.increments == count for s in sessions))  # type: ignore[misc]
    time.sleep(0.05)
    assert [session.increments for session in sessions] == [2, 2]
    assert all(solver.stop() for solver in solvers)


def test_speed_is_a_limit_and_can_be_lifted() -> None:
    conductor = Conductor()
    conductor.set_speed(20.0)
    sessions, solvers = together(conductor, 0.0001)
    wait_until(lambda: solvers[0].snapshot.phase == "running")
    conductor.submit(Protocol(True))
    begun = time.perf_counter()
    wait_until(lambda: sessions[0].increments == 5)
    assert time.perf_counter() - begun > 0.19
    conductor.set_speed(math.inf)
    wait_until(lambda: sessions[0].increments > 3000, 60.0)  # 150 s at the limit
    assert all(solver.stop() for solver in solvers)


@pytest.mark.parametrize(
    ("sent", "kept"),
    [
        ([Recall(3), Recall(5)], [Recall(5)]),
        ([Change("step", 0.1), Change("step", 0.2)], [Change("step", 0.2)]),
        (
            [Change("step", 0.1), Change("seed", 2), Change("step", 0.2)],
            [Change("step", 0.1), Change("seed", 2), Change("step", 0.2)],
        ),
        ([Move("a", 1, 1), Move("b", 2, 2)], [Move("a", 1, 1), Move("b", 2, 2)]),
    ],
)
def test_of_some_commands_the_latest_counts(sent: list[Command], kept: list[Command]) -> None:
    conductor = Conductor(begins_anew=lambda command: command == Change("seed", 2))
    member = conductor.join()
    for command in sent:
        conductor.submit(command)
    assert conductor.next_turn(member, wants=False, advanced=False) == tuple(kept)


def test_a_rebuild_can_be_cancelled_and_the_run_goes_on() -> None:
    conductor = Conductor()
    sessions, solvers = together(conductor, 0.0005)
    wait_until(lambda: solvers[0].snapshot.phase == "running")
    solvers[0].cancel()  # nothing is being built: no later build is harmed
    conductor.submit(Change("seed", 5))
    wait_until(lambda: sessions[0].seed == 5)
    assert solvers[0].snapshot.phase == "running"
    assert solvers[0].stop()

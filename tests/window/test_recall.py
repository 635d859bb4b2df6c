"""A recall in the solver's thread: it holds, so that the future is not lost before somebody goes on from there."""

from __future__ import annotations

from functools import partial

from sandbox.session.commands import Change, Grab, Move, Protocol, Recall, Undo
from sandbox.session.frame import Frame
from sandbox.session.session import Session
from sandbox.window.solvers.conductor import Conductor
from sandbox.window.solvers.solver_thread import SolverThread
from tests.window.fake_session import wait_until


def test_a_scrub_holds_and_play_goes_on_from_there() -> None:
    solver = SolverThread(
        Session("intruder", "mixed", 1, {"grains": 60, "intruder_radius": 2.0}), Conductor()
    )

    def frame() -> Frame:
        seen = solver.snapshot.frame
        assert seen is not None
        return seen

    def stands_at(increment: int) -> bool:
        return frame().increment == increment

    solver.start()
    solver.conductor.submit(Protocol(True))
    # A first start compiles.
    wait_until(lambda: solver.snapshot.phase == "running" and frame().increment >= 12, 400.0)
    for increment in (9, 3, 6):
        solver.conductor.submit(Recall(increment))
        wait_until(partial(stands_at, increment))
        assert solver.conductor.paused
        assert frame().last_kept >= 12
        assert frame().protocol
    solver.conductor.submit(Change("regular_poisson_ratio", 0.5))
    wait_until(lambda: frame().settings["regular_poisson_ratio"] == 0.5 and not frame().busy)
    assert frame().increment == frame().last_kept == 7
    solver.conductor.submit(Undo())
    wait_until(lambda: frame().increment == 6 and not frame().protocol)
    solver.conductor.submit(Undo())
    wait_until(lambda: frame().increment >= 12)
    solver.conductor.submit(Grab("intruder"))
    solver.conductor.submit(Move("intruder", 20.0, 12.0))
    before = frame().increment
    solver.conductor.pause(False)
    wait_until(lambda: frame().increment > before)
    assert solver.stop(30.0)

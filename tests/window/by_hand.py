"""Solvers whose every slice of work a test asks for: no thread, and no clock."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from sandbox.session.commands import Protocol
from sandbox.session.history import Row
from sandbox.session.log import Log
from sandbox.session.replay import replay
from sandbox.session.session import Session
from sandbox.window.solvers.ahead import DEPTH
from sandbox.window.solvers.conductor import Conductor, Word
from sandbox.window.solvers.solver_thread import SolverThread

SCENES: dict[str, tuple[str, dict[str, float]]] = {
    "intruder": ("intruder", {"grains": 60, "intruder_radius": 2.0}),
    "hopper": ("piston", {"grains": 60, "width": 12.0, "friction": 0.5, "orifice": 4.0}),
    "couette": ("upper plate", {"grains": 160, "friction": 0.3}),
    "gravity_hopper": ("funnel", {"grains": 30, "width": 10.0}),
}


class ByHand:
    """One solver for each session, all with one conductor."""

    def __init__(self, conductor: Conductor, *sessions: Any) -> None:
        self.conductor, self.sessions = conductor, sessions
        self.logs: list[list[Log]] = [[] for _ in sessions]
        self.solvers = [
            SolverThread(session, conductor, logs.append)
            for session, logs in zip(sessions, self.logs, strict=True)
        ]
        self._work: list[Any] = [None for _ in sessions]
        for solver in self.solvers:
            solver._build()

    def slice(self, k: int = 0) -> bool:
        """One of solver ``k``; False if there is nothing that it may do."""
        solver = self.solvers[k]
        if self._work[k] is None:
            advanced, solver._advanced = solver._advanced, False
            wants = not self.sessions[k].idle
            turn = self.conductor.turn_now(solver._member, wants=wants, advanced=advanced)
            if turn is None or turn is Word.NOTHING:
                return False
            self._work[k] = solver._work(turn)
        if next(self._work[k], Word.NOTHING) is Word.NOTHING:
            self._work[k] = None
        return True

    def slices(self, count: int) -> None:
        """So many of all, by turns, or as many as there are."""
        for _ in range(count):
            if not sum(self.slice(k) for k in range(len(self.solvers))):
                return

    def work(self) -> None:
        """All that can be done before another picture is shown."""
        self.slices(1_000_000)

    def settle(self) -> None:
        """Until everything is done and seen."""
        while sum(self.slice(k) for k in range(len(self.solvers))) or self.conductor.show():
            pass

    @property
    def shown(self) -> int:
        """Increments of the first run that are seen."""
        frame = self.solvers[0].snapshot.frame
        assert frame is not None
        return frame.increment

    def finish(self) -> None:
        """As at the end of a window."""
        for solver, work in zip(self.solvers, self._work, strict=True):
            self.conductor.stop(solver._member)
            for _ in work or ():
                pass
            solver._patience = math.inf
            solver._finish()


def small(scene: str, kind: str = "mixed") -> Session:
    return Session(scene, kind, 1, SCENES[scene][1])


def by_hand(scene: str, depth: int = DEPTH, kinds: Sequence[str] = ("mixed",)) -> ByHand:
    return ByHand(Conductor(depth=depth), *(small(scene, kind) for kind in kinds))


def rows(session: Session) -> list[Row]:
    return list(session.history.rows())


def assert_replayed(session: Session, log: Log) -> None:
    again = list(replay(log, slice_iterations=97))[-1]
    assert again.state_hash() == log.hash == session.state_hash()
    assert rows(again) == rows(session)
    assert again.history.events == session.history.events
    assert again.run.checkpoints.increments == session.run.checkpoints.increments
    seen, there = session.frame(), again.frame()
    assert np.array_equal(seen.curve_force, there.curve_force)
    assert np.array_equal(seen.contacts.fx, there.contacts.fx)
    assert seen.residual == there.residual
    assert (seen.grains_out, seen.can_undo, seen.can_redo) == (
        there.grains_out,
        there.can_undo,
        there.can_redo,
    )
    # And what follows.
    for one in (session, again):
        one.submit(Protocol(True))
        while one.finished < log.end + 3 and (one.advance(50) or not one.idle):
            pass
    assert session.state_hash() == again.state_hash()

"""Packings side by side: the session of each and the thread that runs it, from when it is begun until it has ended."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass

from sandbox.files.growing_log import GrowingLog
from sandbox.session.session import Session
from sandbox.window.solvers.conductor import Conductor
from sandbox.window.solvers.snapshot import Snapshot
from sandbox.window.solvers.solver_thread import SolverThread

PATIENCE = 1.5  # with all threads that are to end [s]


@dataclass
class Pane:
    """One packing: its session and the thread that runs it."""

    packing: str
    session: Session
    solver: SolverThread


def begun(
    packing: str, session: Session, conductor: Conductor, log: GrowingLog | None = None
) -> Pane:
    """A pane whose thread has begun to build."""
    solver = SolverThread(session, conductor, None if log is None else log.keep)
    solver.start()
    return Pane(packing, session, solver)


class PaneRow:
    """The panes, from the left. Nothing here waits for a solver, except ``end``."""

    def __init__(self) -> None:
        self.panes: list[Pane] = []
        self._leaving: list[SolverThread] = []

    @property
    def packings(self) -> tuple[str, ...]:
        """Of the panes."""
        return tuple(pane.packing for pane in self.panes)

    @property
    def snapshots(self) -> tuple[Snapshot, ...]:
        """What the solvers' threads have published."""
        return tuple(pane.solver.snapshot for pane in self.panes)

    def of(self, packing: str) -> Pane | None:
        """The pane of that packing, or the first where none has it; None where there is none."""
        first = self.panes[0] if self.panes else None
        return next((pane for pane in self.panes if pane.packing == packing), first)

    def only(self, pane: Pane | None) -> None:
        """Take all others away."""
        others = [one for one in self.panes if one is not pane]
        self.panes = [] if pane is None else [pane]
        for one in others:
            one.solver.cancel()
        # One that compiles ends by itself later.
        self._leaving += [one.solver for one in others if not one.solver.stop(0.2)]

    def has_ended(self, pane: Pane) -> bool:
        """Of one that was taken away: may its session be used?"""
        return pane.solver not in self._leaving

    def end(self, first: Pane | None) -> tuple[bool, bool]:
        """End all threads at the same time. Has that of the ``first`` ended, have all?"""
        solvers = [pane.solver for pane in self.panes if pane is not first] + self._leaving
        for solver in solvers:
            solver.stop(0.0)
        until = time.monotonic() + PATIENCE

        def ended(solvers: Iterable[SolverThread]) -> list[bool]:
            return [solver.stop(max(until - time.monotonic(), 0.0)) for solver in solvers]

        of_first = ended([] if first is None else [first.solver])
        return any(of_first), all([*of_first, *ended(solvers)])

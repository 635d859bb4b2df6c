"""The run that the window shows: which session, its thread, and what may be asked of it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping

from core.errors import InputError
from sandbox.commands import Change, Command, Protocol, Reset
from sandbox.session import Session
from sandbox.views.solver_thread import Snapshot, SolverThread

Settings = Mapping[str, object]

PATIENCE = 2.0  # with a thread that is to end [s]
LONG = 20.0  # the same, when a log is to be written: it ends with a finished increment


class Run:
    """At most one scene at a time. Nothing here waits for the solver, except ``close``."""

    def __init__(self, packing: str, seed: int, make: Callable[..., Session] = Session) -> None:
        self.packing = packing
        self.seed = seed
        self.scene = ""
        self._make = make
        self._settings: Settings | None = None
        self._session: Session | None = None
        self._solver: SolverThread | None = None
        self._leaving: list[SolverThread] = []
        self._paused_by_menu = False

    @property
    def snapshot(self) -> Snapshot:
        """What the solver's thread has published."""
        return Snapshot("stopped") if self._solver is None else self._solver.snapshot

    @property
    def exists(self) -> bool:
        """Has a scene been started?"""
        return self._solver is not None

    @property
    def paused(self) -> bool:
        """Is the solver held?"""
        return self._solver is not None and self._solver.paused

    def start(self, scene: str, settings: Settings | None = None) -> None:
        """Leave what runs and build a scene. Raises InputError for one that does not exist."""
        session = self._make(scene, self.packing, self.seed, dict(settings or {}))
        if self._solver is not None and not self._solver.stop(0.2):
            self._leaving.append(self._solver)  # it is compiling, and ends by itself later
        self.scene, self._settings, self._session = scene, settings, session
        self._paused_by_menu = False
        self._solver = SolverThread(session)
        self._solver.start()

    def send(self, command: Command) -> None:
        """A command to the solver."""
        if self._solver is not None:
            self._solver.submit(command)

    def reset(self) -> None:
        """To the start; a run that has failed is built anew."""
        if self.snapshot.phase == "failed":
            self.start(self.scene, self._settings)
        else:
            self.send(Reset())

    def pause_or_go_on(self) -> None:
        """Hold, or go on."""
        if self._solver is not None:
            self._solver.pause(not self._solver.paused)

    def step(self) -> None:
        """One increment."""
        if self._solver is not None:
            self._solver.step()

    def drive(self, on: bool) -> None:
        """The scripted drive."""
        self.send(Protocol(on))

    def change_packing(self, packing: str) -> None:
        """Pack again, with other grains."""
        self.packing = packing
        self.send(Change("packing", packing))

    def change_seed(self) -> None:
        """Pack again, by other chances."""
        self.seed += 1
        self.send(Change("seed", self.seed))

    def hold(self) -> None:
        """Pause while the menu is open."""
        if self._solver is not None and not self._solver.paused:
            self._paused_by_menu = True
            self._solver.pause(True)

    def go_on(self) -> None:
        """The menu was closed: as it was before."""
        frame = self.snapshot.frame
        if frame is not None:
            self.packing = frame.packing  # whatever was looked at in the menu
        if self._solver is not None and self._paused_by_menu:
            self._solver.pause(False)
        self._paused_by_menu = False

    def close(self, log: str | os.PathLike[str] | None) -> bool:
        """End the threads and write the session's log if one is wanted.

        False if a thread is still compiling. Raises InputError if the log cannot be written.
        """
        wanted = log is not None and self.snapshot.frame is not None
        ended = self._solver is None or self._solver.stop(LONG if wanted else PATIENCE)
        if log is not None and wanted and ended and self._session is not None:
            try:
                self._session.write_log(os.fspath(log))
            except OSError as error:
                raise InputError(f"{os.fspath(log)}: {error.strerror or error}") from error
        return all(solver.stop(PATIENCE) for solver in self._leaving) and ended

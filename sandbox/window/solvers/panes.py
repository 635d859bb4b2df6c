"""The runs that the window shows: one packing or several side by side, their threads, and what may be asked of them."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from core.errors import InputError, reason_of
from sandbox.files.autosave import Autosave, Leftover
from sandbox.files.growing_log import GrowingLog
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Change, Command, Recall, Redo, Reset, Undo
from sandbox.session.frame import Frame
from sandbox.session.session import Session
from sandbox.window.solvers.ahead import DEPTH
from sandbox.window.solvers.conductor import Conductor
from sandbox.window.solvers.in_step import begins_anew, comparable, way_back
from sandbox.window.solvers.kept_curves import Curves
from sandbox.window.solvers.run_logs import RunLogs
from sandbox.window.solvers.snapshot import Snapshot
from sandbox.window.solvers.solver_thread import SolverThread
from sandbox.words import words
from scenes import registry
from scenes.text import message

NOTHING_TO_SAVE = "there is nothing to save yet"
PATIENCE = 1.5  # with all threads that are to end [s]
MOST_MISSED = 1500  # increments that a packing that joins repeats; after more all begin anew


@dataclass(frozen=True)
class Wanted:
    """A scene as it was asked for; its solvers may not have got there yet."""

    scene: str
    packing: str  # of the pane that was there first
    seed: int
    settings: Mapping[str, object]


@dataclass
class Pane:
    """One packing: its session and the thread that runs it."""

    packing: str
    session: Session
    solver: SolverThread


class Panes:
    """At most one scene at a time, in one pane or several. Nothing here waits for a solver, except ``close``."""

    def __init__(
        self,
        packing: str,
        seed: int,
        make: Callable[..., Session] = Session,
        autosave: Autosave | None = None,
        log: str | os.PathLike[str] | None = None,
        depth: int = DEPTH,
    ) -> None:
        """``log``: where the first run is logged, further ones beside it; side by side that of the first packing.

        ``depth``: so many increments are made ahead of what is seen; ``tick`` is called once a picture.
        """
        self.autosave = autosave
        self._logs = RunLogs(log)
        self.packing = packing  # chosen in the menu, for the next scene
        self.curves = Curves()
        self._make = make
        self._wanted = Wanted("", packing, seed, {})
        self._start = self._wanted  # the same when the scene was last built or reset
        # Serial of the snapshot when somebody has gone back in time; None: nobody has since the scene was last built.
        self._gone_back: int | None = None
        self._panes: list[Pane] = []
        self._runs: tuple[Wanted, ...] = ()  # that were begun side by side
        self.depth = depth  # of the next scene that is started
        self._conductor = Conductor()
        self._speed = math.inf
        self._leaving: list[SolverThread] = []
        self._paused_by_menu = False

    # What is there.

    @property
    def scene(self) -> str:
        """Its name; nothing before the first."""
        return self._wanted.scene

    @property
    def seed(self) -> int:
        """Of the random packing."""
        return self._wanted.seed

    @property
    def snapshots(self) -> tuple[Snapshot, ...]:
        """What the solvers' threads have published, from the left."""
        return tuple(pane.solver.snapshot for pane in self._panes)

    @property
    def snapshot(self) -> Snapshot:
        """The same of the packing that was there first."""
        main = self._main
        return Snapshot("stopped") if main is None else main.solver.snapshot

    @property
    def packings(self) -> tuple[str, ...]:
        """Of the panes, from the left."""
        return tuple(pane.packing for pane in self._panes)

    @property
    def comparing(self) -> bool:
        """Are there several packings?"""
        return len(self._panes) > 1

    @property
    def exists(self) -> bool:
        """Has a scene been started?"""
        return bool(self._panes)

    @property
    def paused(self) -> bool:
        """Are the solvers held?"""
        return bool(self._panes) and self._conductor.paused

    @property
    def _main(self) -> Pane | None:
        if not self.comparing:
            return self._panes[0] if self._panes else None
        return next((p for p in self._panes if p.packing == self._wanted.packing), self._panes[0])

    # Beginning and ending.

    def start(
        self,
        scene: str,
        settings: Mapping[str, object] | None = None,
        packings: Sequence[str] = (),
        seed: int | None = None,
    ) -> None:
        """Leave what runs and build a scene, with these packings side by side if any are named; without a seed with the last one.

        Raises InputError for what does not exist.
        """
        seed = self.seed if seed is None else seed
        given = dict(settings or {})
        kinds = tuple(packings) or (self.packing,)
        first = self.packing if self.packing in kinds else kinds[0]
        runs = [Wanted(scene, kind, seed, given) for kind in kinds]
        self._start_all(Wanted(scene, first, seed, given), runs)

    def start_beside(self, runs: Sequence[Wanted]) -> None:
        """Leave what runs and build these, of one scene, side by side. Raises InputError for what does not exist."""
        self.packing = runs[0].packing
        self._start_all(runs[0], runs)
        self._runs = tuple(runs)

    def _start_all(self, wanted: Wanted, runs: Sequence[Wanted]) -> None:
        """Build them; ``wanted`` is what the window knows of."""
        sessions = [self._make(r.scene, r.packing, r.seed, dict(r.settings)) for r in runs]
        self._begin(wanted, [run.packing for run in runs], sessions)

    def open(self, file: str | os.PathLike[str] | SceneFile) -> None:
        """Leave what runs and go on where a scene file was written. Raises InputError for one that cannot be read."""
        kept = file if isinstance(file, SceneFile) else read_scene(file)
        self._begin_with([kept], kept.packing)

    def _begin_with(self, files: Sequence[SceneFile], packing: str) -> None:
        """With what files have, of which one is the first to be looked at."""
        self.packing = packing
        first = files[0]
        wanted = Wanted(first.scene, packing, first.seed, first.settings)
        self._begin(wanted, [file.packing for file in files], [*map(Session.from_file, files)])

    def take_up(self, leftover: Leftover) -> None:
        """Go on where a program that is gone had to stop. Its autosave is taken away as soon as there is another."""
        self.open(leftover.file)
        if self.autosave is not None:
            self.autosave.adopt(leftover)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write what there is down as a scene file. Raises InputError if that cannot be."""
        made = self.snapshot.made
        if made is None:
            raise InputError(NOTHING_TO_SAVE)
        try:
            write_scene(path, made)
        except OSError as error:
            raise InputError(f"{os.fspath(path)}: {reason_of(error)}") from error

    def _begin(self, wanted: Wanted, kinds: Sequence[str], sessions: Sequence[Session]) -> None:
        """Leave what runs, and begin with these."""
        self._keep_curves()
        before = self._main
        self._leave(self._panes)
        if before is not None and before.solver not in self._leaving:
            self._log_the_end(before)
        self._wanted = self._start = wanted
        self._gone_back = None
        self._paused_by_menu = False
        self._conductor = Conductor(begins_anew=self._begins_anew, depth=self.depth)
        self._conductor.set_speed(self._speed)
        log = self._logs.begin()
        self._runs = ()
        logged = kinds.index(wanted.packing)
        self._panes = [
            self._pane(kind, session, log if place == logged else None)
            for place, (kind, session) in enumerate(zip(kinds, sessions, strict=True))
        ]

    def _log_the_end(self, main: Pane) -> None:
        """What has been done in the last increment of a run whose thread has ended."""
        if main.solver.snapshot.frame and not main.session.busy:
            self._logs.keep(main.session.log())

    def compare(self) -> str:
        """Put the scene's other packings beside the present one, or take them away; returns what to say."""
        if self.comparing:
            self._only_main()
            return words.COMPARE_OFF
        frame = self.snapshot.frame
        kinds = comparable(self.scene)
        if frame is None or self.snapshot.phase != "running":
            return words.COMPARE_LATER
        if len(kinds) < 2 or frame.packing not in kinds:
            return words.COMPARE_NOTHING
        made = self.snapshot.made
        if made is not None and made.file is not None:
            # All of them from the same places, and counted from there.
            self._begin_with([made.file.of_kind(kind) for kind in kinds], frame.packing)
            return words.COMPARE_ANEW
        repeat = self._can_be_repeated(frame)
        if not repeat:
            self._start = self._wanted = replace(
                self._wanted, seed=frame.seed, settings=frame.settings
            )
        self._of_kind(frame.packing)
        others = [kind for kind in kinds if kind != frame.packing]
        try:
            begun = [self._another(kind) for kind in others]
        except InputError as error:
            return words.say(message(error))
        if not repeat:
            self.send(Reset())
            self._conductor.forget_past()
        panes = [self._pane(*each) for each in zip(others, begun, strict=True)]
        self._panes = sorted([*self._panes, *panes], key=lambda pane: kinds.index(pane.packing))
        return words.COMPARE_ON if repeat else words.COMPARE_ANEW

    def _another(self, kind: str) -> Session:
        """The same start with another packing."""
        start = self._start
        return self._make(start.scene, kind, start.seed, dict(start.settings))

    def cancel(self) -> bool:
        """Break off what is being built; True if a run is left to go on with.

        Side by side, only the packing that was there first stays.
        """
        building = [s.phase in ("building", "catching up") for s in self.snapshots]
        if not any(building):
            return self.exists
        first = self.snapshot
        if self.comparing:
            self._only_main()
        if first.phase == "building" and self._panes:
            self._panes[0].solver.cancel()
            if first.frame is None:
                self._leave(self._panes)
                self._panes = []
            else:
                self._gone_back = first.serial
                self._follow(first.frame)
        return self.exists

    def _pane(self, packing: str, session: Session, log: GrowingLog | None = None) -> Pane:
        solver = SolverThread(session, self._conductor, None if log is None else log.keep)
        solver.start()
        return Pane(packing, session, solver)

    def _only_main(self) -> None:
        main = self._main
        self._keep_curves()
        self._leave([pane for pane in self._panes if pane is not main])
        self._panes = [] if main is None else [main]

    def _leave(self, panes: Sequence[Pane]) -> None:
        for pane in panes:
            pane.solver.cancel()
        # One that compiles ends by itself later.
        self._leaving += [pane.solver for pane in panes if not pane.solver.stop(0.2)]

    def _keep_curves(self) -> None:
        for snapshot in self.snapshots:
            self.curves.keep(snapshot.frame)

    # What is asked of it.

    def send(self, command: Command) -> None:
        """A command to all solvers. Raises InputError for a setting that cannot be."""
        if not self._panes:
            return
        if isinstance(command, Change):
            self._note_change(command)
        elif isinstance(command, (Undo, Redo, Recall)):
            command = self._back(command)
        if self._begins_anew(command):
            self._keep_curves()
            self._start, self._gone_back = self._wanted, None
        self._conductor.submit(command)

    def reset(self) -> None:
        """To the start; a run that has failed is built anew."""
        made = self.snapshot.made
        if not any(snapshot.phase == "failed" for snapshot in self.snapshots):
            self.send(Reset())
        elif made is not None and made.file is not None:
            self.open(made.file)
        elif self.comparing and self._runs:
            self.start_beside([self._as_changed(run) for run in self._runs])
        else:
            packings = self.packings if self.comparing else ()
            self.start(self.scene, self._wanted.settings, packings)

    def _as_changed(self, run: Wanted) -> Wanted:
        """One of those that were begun side by side, with what has been changed in all of them since."""
        first, now = self._runs[0], self._wanted
        changed = {k: v for k, v in now.settings.items() if first.settings.get(k) != v}
        seed = run.seed if now.seed == first.seed else now.seed
        return replace(run, seed=seed, settings={**run.settings, **changed})

    def pause_or_go_on(self) -> None:
        """Hold, or go on."""
        self._conductor.pause(not self._conductor.paused)

    def step(self) -> None:
        """One increment."""
        self._conductor.step()

    def set_speed(self, increments_per_second: float) -> None:
        """No more increments a second than that; inf: as many as the solvers manage."""
        self._speed = increments_per_second
        self._conductor.set_speed(increments_per_second)

    def hold(self) -> None:
        """Pause while the menu is open."""
        if self._panes and not self._conductor.paused:
            self._paused_by_menu = True
            self._conductor.pause(True)

    def go_on(self) -> None:
        """The menu was closed: as it was before."""
        if self._panes:
            self.packing = self._wanted.packing  # whatever was looked at in the menu
        if self._paused_by_menu:
            self._conductor.pause(False)
        self._paused_by_menu = False

    def tick(self) -> str:
        """Once a picture, at its beginning: the next of what the solvers have ready is seen from now on.

        What was undone may be a packing, a seed or a setting. Returns what to say, if anything.
        """
        self._conductor.show()
        seen = self.snapshot
        if self.autosave is not None:
            self.autosave.keep(seen.made)
        gone_back = self._gone_back
        if gone_back is not None and seen.serial > gone_back and seen.phase == "running":
            self._follow(seen.frame)
        unseen = seen.phase == "building" and seen.frame is None  # what is said now nobody reads
        return "" if unseen else self._logs.tell()

    @property
    def logs(self) -> list[Path]:
        """Those that there are, in the order of the runs."""
        return self._logs.there

    def close(self, clean: bool = True) -> bool:
        """End the threads and the log.

        A ``clean`` end then takes the autosave away. False if a thread is still compiling. Raises InputError if the log cannot be
        written; the autosave stays then.
        """
        try:
            ended = self._end()
        except InputError as error:
            self._close_autosave(clean=False)
            if self.autosave is None:
                raise
            raise InputError(
                f"{error}; what was there is kept, the menu offers it next time"
            ) from error
        self._close_autosave(clean)
        return ended

    def _end(self) -> bool:
        """End the threads, all at the same time, and the log: what is not finished by then is not in it."""
        main = self._main
        solvers = [pane.solver for pane in self._panes if pane is not main] + self._leaving
        for solver in solvers:
            solver.stop(0.0)
        end = time.monotonic() + PATIENCE
        if main is not None:
            solvers = [main.solver, *solvers]
        stopped = [solver.stop(max(end - time.monotonic(), 0.0)) for solver in solvers]
        if main is not None and stopped[0]:
            self._log_the_end(main)
        self._logs.close()
        return all(stopped)

    def _close_autosave(self, clean: bool) -> None:
        if self.autosave is not None:
            self.autosave.keep(self.snapshot.made)
            self.autosave.close(clean)

    # What is known of the session without asking it.

    def _note_change(self, change: Change) -> None:
        if change.name == "seed" and isinstance(change.value, int):
            self._wanted = replace(self._wanted, seed=change.value)
        elif change.name == "packing":
            self._of_kind(str(change.value))
        elif change.name != "scene":
            settings = {**self._wanted.settings, change.name: change.value}
            if self.scene in registry.names():
                registry.get(self.scene).settings(settings)
            self._wanted = replace(self._wanted, settings=settings)

    def _of_kind(self, packing: str) -> None:
        """The first pane has that packing, and so has the next scene."""
        self.packing = self._panes[0].packing = packing
        self._wanted = replace(self._wanted, packing=packing)

    def _back(self, command: Undo | Redo | Recall) -> Command:
        """A way back that all packings can go. Raises InputError if there is none."""
        way = way_back(command, [seen.frame for seen in self.snapshots if seen.frame is not None])
        self._gone_back = self.snapshot.serial
        return way

    def _begins_anew(self, command: Command) -> bool:
        return begins_anew(self.scene, command)

    def _can_be_repeated(self, frame: Frame) -> bool:
        """Can another packing be brought to where this one is, by the same commands?"""
        settings = registry.get(self.scene).settings(self._wanted.settings)
        same = frame.seed == self.seed and dict(frame.settings) in ({}, settings)
        return same and self._gone_back is None and self._conductor.turns <= MOST_MISSED

    def _follow(self, frame: Frame | None) -> None:
        """What the solver has is what there is."""
        if frame is None:
            return
        if not self.comparing:
            self._of_kind(frame.packing)
        self._wanted = replace(self._wanted, seed=frame.seed, settings=frame.settings)

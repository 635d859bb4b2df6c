"""The runs that the window shows, one packing or several side by side, and what may be asked of them."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from core.errors import InputError, reason_of
from sandbox.files.autosave import Autosave, Leftover
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Change, Command, Recall, Redo, Reset, Undo
from sandbox.session.frame import Frame
from sandbox.session.session import Session
from sandbox.window.solvers.ahead import DEPTH
from sandbox.window.solvers.conductor import Conductor
from sandbox.window.solvers.in_step import begins_anew, comparable, way_back
from sandbox.window.solvers.keeping import Keeping
from sandbox.window.solvers.kept_curves import Curves
from sandbox.window.solvers.pane_row import Pane, PaneRow, begun
from sandbox.window.solvers.snapshot import Snapshot
from sandbox.window.solvers.wanted import Wanted
from sandbox.words import words
from scenes import registry
from scenes.text import message

NOTHING_TO_SAVE = "there is nothing to save yet"
MOST_MISSED = 1500  # increments that a packing that joins repeats; after more all begin anew


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
        self._keeping = Keeping(autosave, log)
        self.packing = packing  # chosen in the menu, for the next scene
        self.curves = Curves()
        self._make = make
        self._wanted = Wanted("", packing, seed, {})
        self._start = self._wanted  # the same when the scene was last built or reset
        # Serial of the snapshot when somebody has gone back in time; None: nobody has since the scene was last built.
        self._gone_back: int | None = None
        self._row = PaneRow()
        self._runs: tuple[Wanted, ...] = ()  # that were begun side by side
        self.depth = depth  # of the next scene that is started
        self._conductor = Conductor()
        self._speed = math.inf
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
        return self._row.snapshots

    @property
    def snapshot(self) -> Snapshot:
        """The same of the packing that was there first."""
        main = self._main
        return Snapshot("stopped") if main is None else main.solver.snapshot

    @property
    def packings(self) -> tuple[str, ...]:
        """Of the panes, from the left."""
        return self._row.packings

    @property
    def comparing(self) -> bool:
        """Are there several packings?"""
        return len(self._row.panes) > 1

    @property
    def exists(self) -> bool:
        """Has a scene been started?"""
        return bool(self._row.panes)

    @property
    def paused(self) -> bool:
        """Are the solvers held?"""
        return self.exists and self._conductor.paused

    @property
    def _main(self) -> Pane | None:
        return self._row.of(self._wanted.packing)

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
        if self._keeping.autosave is not None:
            self._keeping.autosave.adopt(leftover)

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
        self._row.only(None)
        if before is not None and self._row.has_ended(before):
            self._keeping.log_the_end(before)
        self._wanted = self._start = wanted
        self._gone_back = None
        self._paused_by_menu = False
        self._conductor = Conductor(begins_anew=self._begins_anew, depth=self.depth)
        self._conductor.set_speed(self._speed)
        log = self._keeping.logs.begin()
        self._runs = ()
        logged = kinds.index(wanted.packing)
        self._row.panes = [
            begun(kind, session, self._conductor, log if place == logged else None)
            for place, (kind, session) in enumerate(zip(kinds, sessions, strict=True))
        ]

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
            self._start = self._wanted = self._wanted.as_shown(frame)
        self._of_kind(frame.packing)
        others = [kind for kind in kinds if kind != frame.packing]
        try:
            sessions = [self._another(kind) for kind in others]
        except InputError as error:
            return words.say(message(error))
        if not repeat:
            self.send(Reset())
            self._conductor.forget_past()
        for kind, session in zip(others, sessions, strict=True):
            self._row.panes.append(begun(kind, session, self._conductor))
        self._row.panes.sort(key=lambda pane: kinds.index(pane.packing))
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
        if first.phase == "building" and self.exists:
            self._row.panes[0].solver.cancel()
            if first.frame is None:
                self._row.only(None)
            else:
                self._gone_back = first.serial
                self._follow(first.frame)
        return self.exists

    def _only_main(self) -> None:
        self._keep_curves()
        self._row.only(self._main)

    def _keep_curves(self) -> None:
        for snapshot in self.snapshots:
            self.curves.keep(snapshot.frame)

    # What is asked of it.

    def send(self, command: Command) -> None:
        """A command to all solvers. Raises InputError for a setting that cannot be."""
        if not self.exists:
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
            first = self._runs[0]
            self.start_beside([run.changed_as(first, self._wanted) for run in self._runs])
        else:
            packings = self.packings if self.comparing else ()
            self.start(self.scene, self._wanted.settings, packings)

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
        if self.exists and not self._conductor.paused:
            self._paused_by_menu = True
            self._conductor.pause(True)

    def go_on(self) -> None:
        """The menu was closed: as it was before."""
        if self.exists:
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
        self._keeping.keep(seen.made)
        gone_back = self._gone_back
        if gone_back is not None and seen.serial > gone_back and seen.phase == "running":
            self._follow(seen.frame)
        unseen = seen.phase == "building" and seen.frame is None  # what is said now nobody reads
        return "" if unseen else self._keeping.logs.tell()

    @property
    def logs(self) -> list[Path]:
        """Those that there are, in the order of the runs."""
        return self._keeping.logs.there

    def close(self, clean: bool = True) -> bool:
        """End the threads and the log.

        A ``clean`` end then takes the autosave away. False if a thread is still compiling. Raises InputError if the log cannot be
        written; the autosave stays then.
        """
        main = self._main
        main_ended, all_ended = self._row.end(main)
        if main is not None and main_ended:  # what is not finished by then is not in the log
            self._keeping.log_the_end(main)
        self._keeping.close(self.snapshot.made, clean)
        return all_ended

    # What is known of the session without asking it.

    def _note_change(self, change: Change) -> None:
        self._wanted = self._wanted.changed(change)
        if change.name == "packing":
            self._of_kind(self._wanted.packing)

    def _of_kind(self, packing: str) -> None:
        """The first pane has that packing, and so has the next scene."""
        self.packing = self._row.panes[0].packing = packing
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
        self._wanted = self._wanted.as_shown(frame)

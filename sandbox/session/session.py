"""THE loop: commands in → bodies move → grains relax → a row of history and a frame. Window, films and tests all run this one."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, replace
from typing import get_args

from core import kernel_cache
from core.engine_state import keep_bodies, place_bodies
from core.errors import InputError
from core.warmup import (
    compile_increments,
    compile_kernels,
    compile_packing,
    compiled,
    increments_part,
)
from sandbox.beside import beside
from sandbox.session.beginning import Asked, Made, SceneFile, put_into
from sandbox.session.checkpoints import Checkpoint
from sandbox.session.commands import (
    Change,
    Command,
    DrawWall,
    Edit,
    Erase,
    EraseWall,
    Grab,
    Move,
    Place,
    Protocol,
    Recall,
    Redo,
    Release,
    Reset,
    Retype,
    Undo,
    check,
)
from sandbox.session.forces import ContactForces, contact_forces
from sandbox.session.frame import Frame
from sandbox.session.history import History, Row
from sandbox.session.log import Log
from sandbox.session.mark import Mark
from sandbox.session.run import Run
from sandbox.session.table import RunTable
from sandbox.session.take_frame import take
from sandbox.session.undo import OLD_RUN_BYTES, Moment, Past, Start
from scenes import registry
from scenes.checks import Check
from scenes.parameter import check_seed
from scenes.scene import Ingredients, Scene, Setup, Values
from scenes.text import message

COMPILING, PACKING = "compiling the solver (first start only)", "packing the grains"
COMPILED, PACKED = 0.4, 0.8  # shares of a start
UNDOABLE = (Grab, Protocol, Reset, Change, Recall, *get_args(Edit))
JOURNEYS = (Reset, Recall, Undo, Redo)

Tell = Callable[[str, float], None]  # what is being built, and the share of it that is done


def _go_on() -> None:
    """Nobody wants to break the work off."""


def _increments(terms: Ingredients) -> list[str]:
    """What nobody has compiled yet, and packing does not compile on the way."""
    part = increments_part(**asdict(terms))
    there = compiled(kernel_cache.CORE, part) or not (terms.friction or terms.gravity)
    return [] if there else [part]


class Session:
    """A scene, the commands given to it, and its run. Everything but ``submit`` belongs to one thread, the solver's."""

    def __init__(
        self,
        scene: str,
        packing: str = "mixed",
        seed: int = 1,
        settings: Mapping[str, object] | None = None,
    ) -> None:
        """Checks the request and is quick. Raises InputError."""
        known = registry.get(scene)
        kind, seed = known.check_packing(packing), check_seed(seed)
        self._first = Asked(known, kind, seed, known.settings(settings))
        self._pending: deque[Command] = deque()
        self._lock = threading.Lock()
        self._commands: list[tuple[int, Command]] = []
        self._finished = 0
        self._refusals = 0, ""
        self._run: Run | None = None
        self._start: Start | None = None
        self._past = Past()
        self._progress: Tell | None = None

    @classmethod
    def from_file(cls, file: SceneFile) -> Session:
        """A session that begins where a scene file was written."""
        session = cls(file.scene, file.packing, file.seed, file.built)
        session._first = replace(session._first, file=file)
        return session

    def build(self, progress: Tell | None = None) -> None:
        """Compile the kernels, pack the grains, relax. ``progress(text, share)`` is called from this thread."""
        self._progress = progress
        self._build(self._first)

    def _build(self, asked: Asked) -> None:
        report = self._progress or _silent
        terms = asked.scene.ingredients(asked.settings_now)
        report(COMPILING, 0.0)
        with beside(_increments(terms)):
            compile_packing(
                periodic=terms.periodic,
                rigid=terms.rigid,
                progress=lambda share: report(COMPILING, COMPILED * share),
            )
            report(PACKING, COMPILED)
            setup = asked.scene.build(
                asked.settings,
                asked.packing,
                asked.seed,
                lambda share: report(PACKING, COMPILED + (PACKED - COMPILED) * share),
            )
            report(COMPILING, PACKED)
        compile_increments(**asdict(terms))
        report(COMPILING, PACKED)
        kept = None if asked.file is None else put_into(setup, asked)
        bodies = keep_bodies(setup.world)
        friction = None if setup.friction is None else setup.friction.copy()
        start = Start(setup.packing.copy(), friction, setup, bodies, asked, kept)
        run = _first_run(asked, setup, kept)
        report("ready", 1.0)  # the last that can break it off: all is as it was until here
        self._start, self._run = start, run

    # Commands.

    def submit(self, command: Command) -> None:
        """Ask for something; it takes effect before the next increment. May be called from any thread."""
        with self._lock:
            self._pending.append(command)

    def settle(self) -> bool:
        """Let waiting commands take effect, unless an increment is under way. True if they led to another time."""
        travelled = False
        while not self.busy:
            with self._lock:
                if not self._pending:
                    break
                command = self._pending.popleft()
            try:
                self._apply(command)
            except InputError as error:
                self.run.say(message(error))
                self._refusals = self._refusals[0] + 1, message(error)
                continue
            travelled |= isinstance(command, JOURNEYS)
            self._commands.append((self._finished, command))
        return travelled

    def _apply(self, command: Command) -> None:
        check(command)
        before = self._moment() if isinstance(command, UNDOABLE) else None
        self._do(command)
        if before is not None:
            if before.run is not self.run:
                before.run.checkpoints.squeeze(OLD_RUN_BYTES)
            self._past.remember(before, command, self._finished)

    def _do(self, command: Command) -> None:
        match command:
            case Grab(handle):
                self.run.hands.grab(handle)
            case Move(handle, x, y):
                self.run.hands.move(handle, (x, y))
            case Release(handle):
                self.run.hands.release(handle)
            case Protocol(on):
                self.run.hands.follow_script(on)
            case Reset():
                self._reset()
            case Place() | Erase() | Retype() | DrawWall() | EraseWall():
                self.run.edit(command)
            case Change(name, value) if self.rebuilds(command):
                self._rebuild(name, value)
            case Change(name, value):
                self._adjust(name, value)
            case Recall(increment):
                self.run.recall(increment)
            case Undo():
                self._go_to(self._past.undo(self._moment()))
            case Redo():
                self._go_to(self._past.redo(self._moment()))

    def _reset(self) -> None:
        """The start, with the settings as they are now: as it was built, or as a file had it, nothing held and the script off."""
        start = self._start
        assert start is not None
        if start.kept is not None:
            self._go_back_to(start, start.kept)
            return
        start.setup.packing = start.packing.copy()
        start.setup.friction = None if start.friction is None else start.friction.copy()
        place_bodies(start.setup.world, start.bodies)
        changed = _differing(self.settings, start.asked.settings_now)
        self.scene.adjust(start.setup, self.settings, changed)
        self._run = Run(self.scene, self.settings, self.packing, self.seed, start.setup)

    def _go_back_to(self, start: Start, kept: Checkpoint) -> None:
        settings = self.settings
        asked = start.asked
        self._run = Run(asked.scene, kept.settings, asked.packing, asked.seed, start.setup, kept)
        self._run.course.still()
        if changed := _differing(settings, kept.settings):
            self._run.adjust(settings, changed)

    def _moment(self) -> Moment:
        """Where the session stands."""
        assert self._start is not None
        checkpoint = self.run.present()
        return Moment(self._start, self.run, checkpoint)

    def _go_to(self, moment: Moment) -> None:
        """Be as at that moment, with nothing held and the script off."""
        if moment.run is not self.run:
            self.run.checkpoints.squeeze(OLD_RUN_BYTES)
        self._start, self._run = moment.start, moment.run
        self._run.restore(moment.checkpoint)
        self._run.course.still()

    def rebuilds(self, command: Command) -> bool:
        """True for a change that builds the scene anew, which takes a moment. May be called from any thread."""
        if not isinstance(command, Change):
            return False
        return command.name not in self.scene.live

    def _adjust(self, name: str, value: object) -> None:
        """A live parameter acts on the grains where they stand."""
        settings = self.scene.settings({**self.settings, name: value})
        if settings[name] == self.settings[name]:
            return
        terms = self.scene.ingredients(settings)
        if terms != self.scene.ingredients(self.settings):
            report = self._progress or _silent
            report(COMPILING, 0.0)
            compile_kernels(**asdict(terms))
            report(COMPILING, 1.0)  # who does not want it any more says so here
        self.run.adjust(settings, frozenset({name}))

    def _rebuild(self, name: str, value: object) -> None:
        scene, packing, seed, settings = self.scene, self.packing, self.seed, dict(self.settings)
        if name == "scene":
            scene = registry.get(str(value))
            settings = scene.settings()
            packing = packing if packing in scene.packings else scene.packings[0]
        elif name == "packing":
            packing = scene.check_packing(str(value))
        elif name == "seed":
            seed = check_seed(value)
        else:
            settings = scene.settings({**settings, name: value})
        self._build(Asked(scene, packing, seed, settings))

    # Running.

    @property
    def run(self) -> Run:
        """The run under way. Raises RuntimeError before ``build``."""
        if self._run is None:
            raise RuntimeError("build the session first")
        return self._run

    @property
    def refusals(self) -> tuple[int, str]:
        """How many commands could not be carried out, and why the latest."""
        return self._refusals

    @property
    def busy(self) -> bool:
        """True while an increment is being relaxed."""
        return self._run is not None and self._run.engine.busy

    @property
    def idle(self) -> bool:
        """True if there is nothing to do: no command waits, no body has to move, and nothing is being relaxed."""
        return self._run is None or (not self._pending and self._run.idle)

    @property
    def finished(self) -> int:
        """Increments finished since the session began, resets included: the stamp of a log."""
        return self._finished

    def advance(self, max_iterations: int = 200) -> bool:
        """One slice of work, at most so many force evaluations. True if it finished an increment. Commands enter in between.

        Where they lead to another time, nothing moves yet: it can be looked at first, and its future is not lost.
        """
        if self.settle() or not self.run.advance(max_iterations):
            return False
        self._finished += 1
        return True

    def slices(self, iterations: int, check: Callable[[], None] = _go_on) -> Iterator[bool]:
        """Work, at most so many force evaluations at a time, until nothing is left to do; True where an increment was finished.

        Whoever drives a session, a film, a replay, a study, looks at it in between. ``check`` is called before each slice: what
        it raises breaks the work off.
        """
        check()
        while (finished := self.advance(iterations)) or not self.idle:
            yield finished
            check()

    def increments(self, iterations: int, check: Callable[[], None] = _go_on) -> Iterator[Row]:
        """The same, for who looks at finished increments only: the newest row after each."""
        for finished in self.slices(iterations, check):
            if finished:
                yield self.history[-1]

    def mark(self) -> Mark:
        """A place to come back to, between two increments and with no command waiting."""
        return Mark(self.run.mark(), len(self._commands), self._finished, self._refusals)

    def go_back(self, mark: Mark) -> None:
        """Be as at that mark; since then only increments were made, even the one under way, and bodies were asked to move."""
        self.run.go_back(mark.run)
        del self._commands[mark.commands :]
        self._finished, self._refusals = mark.finished, mark.refusals

    # What can be seen.

    @property
    def scene(self) -> Scene:
        """What is built, or is going to be."""
        return self._first.scene if self._run is None else self._run.scene

    @property
    def packing(self) -> str:
        """The kind of it."""
        return self._first.packing if self._run is None else self._run.packing_kind

    @property
    def seed(self) -> int:
        """Of the random packing."""
        return self._first.seed if self._run is None else self._run.seed

    @property
    def settings(self) -> Values:
        """All parameters as they are now."""
        return self._first.settings_now if self._run is None else self._run.settings

    @property
    def history(self) -> History:
        """One row an increment since the last reset."""
        return self.run.history

    @property
    def table(self) -> RunTable:
        """The same with the names of its columns."""
        return RunTable(self.run.setup, self.run.history)

    def frame(self) -> Frame:
        """A snapshot that shares nothing with the session."""
        now = self.run.kept
        return take(self.run, self._past.can_undo(now), self._past.can_redo, self._refusals)

    def contact_forces(self) -> ContactForces:
        """Of the contacts of the frame, as the newest row adds them up on bodies."""
        return contact_forces(self.run.last, self.run.setup.world)

    def state_hash(self) -> str:
        """Hash of every bit of the state."""
        return self.run.state_hash()

    @property
    def file(self) -> SceneFile | None:
        """What the scene was read from, if it was."""
        return (self._first if self._start is None else self._start.asked).file

    def made(self) -> Made:
        """What there is to be kept in a file; quick, as it shares the checkpoint that is kept anyway."""
        run, start = self.run, self._start
        assert start is not None
        asked = start.asked
        worth = bool(self._commands) or asked.file is not None
        return Made(
            asked.scene.name,
            asked.packing,
            asked.seed,
            asked.settings,
            run.settled,
            asked.file,
            worth,
        )

    def checks(self) -> list[Check]:
        """The scene's claims about this run."""
        return self.run.checks()

    def log(self) -> Log:
        """All since the session began. Raises RuntimeError in the middle of an increment: finish it first."""
        if self.busy:
            raise RuntimeError("finish the increment before taking the log")
        first, commands = self._first, tuple(self._commands)
        return Log(
            first.scene.name,
            first.packing,
            first.seed,
            dict(first.settings),
            commands,
            self._finished,
            self.state_hash(),
            first.file,
        )


def _differing(one: Values, other: Values) -> frozenset[str]:
    """The names of settings that differ."""
    return frozenset(name for name, value in one.items() if value != other[name])


def _first_run(asked: Asked, setup: Setup, kept: Checkpoint | None) -> Run:
    """The run of what was just built. Raises InputError where a file has brought what cannot be run."""
    try:
        run = Run(asked.scene, asked.settings_now, asked.packing, asked.seed, setup, kept)
    except InputError as error:
        if asked.file is None:
            raise
        raise InputError(f"{asked.file.name}: {error}") from None
    if asked.file and kept is None and run.failed:
        raise InputError(f"{asked.file.name}: its grains cannot be relaxed")
    return run


def _silent(text: str, share: float) -> None:
    """Progress that nobody watches."""
    del text, share

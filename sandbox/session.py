"""THE loop: commands in → bodies move → grains relax → a row of history and a frame. Window, films and tests all run this one."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Mapping

from core.errors import InputError
from core.packing import Packing
from core.warmup import compile_kernels
from sandbox.commands import (
    Change,
    Command,
    Grab,
    Move,
    Protocol,
    Recall,
    Redo,
    Release,
    Reset,
    Undo,
)
from sandbox.frame import Frame
from sandbox.history import History
from sandbox.log import Log
from sandbox.log import write_log as write_log_file
from sandbox.run import Run
from scenes import registry
from scenes.scene import Check, Scene, Setup, Values

COMPILING, PACKING = "compiling the solver (first start only)", "packing the grains"
COMPILE_SHARE = 0.5

Progress = Callable[[str, float], None]


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
        self.scene: Scene = registry.get(scene)
        self.packing = self.scene.check_packing(packing)
        self.seed = check_seed(seed)
        self.settings: Values = self.scene.settings(settings)
        self._first = (scene, self.packing, self.seed, dict(self.settings))
        self._pending: deque[Command] = deque()
        self._lock = threading.Lock()
        self._commands: list[tuple[int, Command]] = []
        self._finished = 0
        self._run: Run | None = None
        self._start: tuple[Packing, Setup] | None = None
        self._progress: Progress | None = None

    def build(self, progress: Progress | None = None) -> None:
        """Compile the kernels, pack the grains, relax. ``progress(text, share)`` is called from this thread."""
        self._progress = progress
        report = progress or _silent
        report(COMPILING, 0.0)
        terms = self.scene.ingredients(self.settings)
        compile_kernels(
            periodic=terms.periodic,
            rigid=terms.rigid,
            friction=terms.friction,
            gravity=terms.gravity,
            progress=lambda share: report(COMPILING, COMPILE_SHARE * share),
        )
        report(PACKING, COMPILE_SHARE)
        setup = self.scene.build(
            self.settings,
            self.packing,
            self.seed,
            lambda share: report(PACKING, COMPILE_SHARE + (1.0 - COMPILE_SHARE) * share),
        )
        self._placement = setup.world.placement()
        self._start = setup.packing.copy(), setup
        self._run = Run(self.scene, self.settings, self.packing, self.seed, setup)
        report("ready", 1.0)

    # Commands.

    def submit(self, command: Command) -> None:
        """Ask for something; it takes effect before the next increment. May be called from any thread."""
        with self._lock:
            self._pending.append(command)

    def settle(self) -> None:
        """Let waiting commands take effect, unless an increment is under way."""
        while not self.busy:
            with self._lock:
                if not self._pending:
                    return
                command = self._pending.popleft()
            try:
                self._apply(command)
            except InputError as error:
                self.run.notices = [str(error)]
                continue
            self._commands.append((self._finished, command))

    def _apply(self, command: Command) -> None:
        match command:
            case Grab(handle):
                self.run.grab(handle)
            case Move(handle, x, y):
                self.run.move(handle, (x, y))
            case Release(handle):
                self.run.release(handle)
            case Protocol(on):
                self.run.follow_script(on)
            case Reset():
                self._reset()
            case Change(name, value):
                self._change(name, value)
            case Recall() | Undo() | Redo():
                raise InputError("there is nothing to go back to")

    def _reset(self) -> None:
        assert self._start is not None
        packing, setup = self._start
        setup.packing = packing.copy()
        setup.world.place(self._placement)
        self._run = Run(self.scene, self.settings, self.packing, self.seed, setup)

    def _change(self, name: str, value: object) -> None:
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
        before = self.scene, self.packing, self.seed, self.settings
        self.scene, self.packing, self.seed, self.settings = scene, packing, seed, settings
        try:
            self.build(self._progress)
        except InputError:
            self.scene, self.packing, self.seed, self.settings = before
            raise

    # Running.

    @property
    def run(self) -> Run:
        """The run under way. Raises RuntimeError before ``build``."""
        if self._run is None:
            raise RuntimeError("build the session first")
        return self._run

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
        """One slice of work, at most so many force evaluations. True if it finished an increment. Commands enter in between."""
        self.settle()
        if not self.run.advance(max_iterations):
            return False
        self._finished += 1
        return True

    # What can be seen.

    @property
    def history(self) -> History:
        """One row an increment since the last reset."""
        return self.run.history

    def frame(self) -> Frame:
        """A snapshot that shares nothing with the session."""
        return self.run.frame()

    def state_hash(self) -> str:
        """Hash of every bit of the state."""
        return self.run.state_hash()

    def checks(self) -> list[Check]:
        """The scene's claims about this run."""
        return self.run.checks()

    def log(self) -> Log:
        """All since the session began. Raises RuntimeError in the middle of an increment: finish it first."""
        if self.busy:
            raise RuntimeError("finish the increment before taking the log")
        scene, packing, seed, settings = self._first
        commands = tuple(self._commands)
        return Log(scene, packing, seed, settings, commands, self._finished, self.state_hash())

    def write_log(self, path: str) -> None:
        """Write the log whole or not at all."""
        write_log_file(path, self.log())


def _silent(text: str, share: float) -> None:
    """Progress that nobody watches."""
    del text, share


def check_seed(seed: object) -> int:
    """A seed is a whole number from 0 to 2⁶³ − 1. Raises InputError otherwise."""
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**63:
        raise InputError(f"the seed must be 0 or a positive whole number below 2^63, not {seed!r}")
    return seed

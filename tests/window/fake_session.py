"""A session without physics: a handle that follows the hand, slowly, and can be told to fail."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any

from core.errors import InputError
from sandbox.session.commands import (
    Change,
    Command,
    Grab,
    Move,
    Protocol,
    Recall,
    Release,
    Reset,
    Scalar,
)
from sandbox.session.frame import Frame
from sandbox.session.log import Log
from sandbox.window.solvers.conductor import Conductor
from sandbox.window.solvers.solver_thread import SolverThread
from tests.draw.frames import intruder_frame

SLICES = 3  # to an increment
STEP = 0.5  # of the handle in an increment [R]


_REMEMBERED = {
    *("increments", "last_kept", "commands", "_waiting", "_slice", "_script", "_place", "_target")
}


class FakeMark:
    """Where such a session stands; every other target is a turn."""

    def __init__(self, state: Mapping[str, Any]) -> None:
        self.state = state

    def detour(self, move: Move, ready: Sequence[Any]) -> float:
        return math.inf


class FakeSession:
    """The interface of a session, as far as the thread and the window use it."""

    def __init__(
        self,
        scene: str = "intruder",
        packing: str = "mixed",
        seed: int = 1,
        settings: Mapping[str, object] | None = None,
    ) -> None:
        if scene == "unknown":
            raise InputError("no scene is called 'unknown'")
        self.scene, self.packing, self.seed, self.settings = scene, packing, seed, settings
        self.changed: dict[str, Scalar] = {}  # parameters
        self.refused: set[str] = set()  # parameters that it will not change
        self.last_kept = 0  # increments that can be gone back to
        self.commands: list[Command] = []  # in the order in which they took effect
        self.built = 0
        self.increments = 0
        self.threads: set[int] = set()
        self.fail: Exception | None = None
        self.fail_build: Exception | None = None
        self.block_build: threading.Event | None = None
        self.block_change: threading.Event | None = (
            None  # as a change does for which kernels are compiled
        )
        self.waits = False  # does it, for that?
        self.slice_time = 0.0005
        self._waiting: list[Command] = []
        self._slice = 0
        self._script = False
        self._still = intruder_frame(6)
        self._home = (self._still.handles[0].x, self._still.handles[0].y)
        self._place = self._home
        self._target: tuple[float, float] | None = None

    def build(self, progress: Callable[[str, float], None] | None = None) -> None:
        self.threads.add(threading.get_ident())
        report = progress or (lambda text, share: None)
        report("compiling", 0.0)
        if self.fail_build is not None:
            raise self.fail_build
        while self.block_build is not None and not self.block_build.wait(0.005):
            report("compiling", 0.5)
        report("packing the grains", 0.9)
        self.built += 1

    def submit(self, command: Command) -> None:
        self._waiting.append(command)

    def advance(self, max_iterations: int = 200) -> bool:
        self.threads.add(threading.get_ident())
        assert self.built, "not built yet"
        if self.fail is not None:
            raise self.fail
        if not self.busy:
            for command in self._waiting:
                self._apply(command)
            self._waiting.clear()
            if self.idle:
                return False
        time.sleep(self.slice_time)
        self._slice = (self._slice + 1) % SLICES
        if self._slice:
            return False
        self.increments += 1
        self.last_kept = self.increments
        if self._target is not None:
            way = self._target[0] - self._place[0]
            self._place = (self._place[0] + max(min(way, STEP), -STEP), self._place[1])
        return True

    def _apply(self, command: Command) -> None:
        if self.block_change is not None and isinstance(command, Change):
            self.waits = True
            self.block_change.wait()
        self.commands.append(command)
        match command:
            case Move(_, x, y):
                self._target = (x, y)
            case Release() | Grab():
                self._target = None
            case Reset():
                self._place, self._target, self._script = self._home, None, False
                self.increments = 0
            case Protocol(on):
                self._script = on
            case Change("packing", value):
                self.packing = str(value)
                self.built += 1
            case Change("seed", value):
                self.seed = int(value)
                self.built += 1
            case Change(name, value) if name not in self.refused:
                self.changed[name] = value
            case Recall(increment):
                self.increments = increment

    @property
    def busy(self) -> bool:
        return self._slice > 0

    @property
    def idle(self) -> bool:
        if self.busy or self._waiting or self._script:
            return False
        return self._target is None or abs(self._target[0] - self._place[0]) < 1e-9

    def frame(self) -> Frame:
        if not self.built:
            raise RuntimeError("build the session first")
        handle = replace(
            self._still.handles[0],
            x=self._place[0],
            y=self._place[1],
            target=self._target,
            fx=0.0,
            fy=0.0,
        )
        return replace(
            self._still,
            scene=self.scene,
            packing=self.packing,
            seed=self.seed,
            increment=self.increments,
            handles=(handle,),
            busy=self.busy,
            protocol=self._script,
            settings={k: v for k, v in self.changed.items() if not isinstance(v, str)},
            last_kept=max(self.last_kept, self.increments),
            can_undo=bool(self.commands),
        )

    def made(self) -> None:
        """Nothing to be kept in a file."""

    def mark(self) -> Any:
        return FakeMark({k: copy(v) for k, v in vars(self).items() if k in _REMEMBERED})

    def go_back(self, mark: Any) -> None:
        vars(self).update({k: copy(v) for k, v in mark.state.items()})

    def log(self) -> Log:
        assert not self.busy, "a log ends between increments"
        done = tuple((0, command) for command in self.commands)
        return Log("hopper", self.packing, self.seed, {}, done, self.increments, "")


def wait_until(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    """Until it holds; fails after a while."""
    patience = time.perf_counter() + seconds
    while not condition():
        assert time.perf_counter() < patience, "waited in vain"
        time.sleep(0.002)


def started(session: FakeSession, paused: bool = False) -> SolverThread:
    """A thread that has built the session."""
    solver = SolverThread(session, Conductor(paused=paused))
    solver.start()
    wait_until(lambda: solver.snapshot.phase == "running")
    return solver

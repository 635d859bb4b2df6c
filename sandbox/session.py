"""THE loop: commands in → bodies move → grains relax → a row of history and a frame. Window, films and tests all run this one."""

from __future__ import annotations

import hashlib
import math
import threading
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from core.errors import InputError
from core.friction import Friction
from core.quasistatic import Increment, Quasistatic
from core.relaxation import StopReason
from core.rigid import Point
from core.warmup import compile_kernels
from sandbox.commands import Change, Command, Grab, Move, Protocol, Release, Reset
from sandbox.frame import Frame
from sandbox.history import History, Row
from sandbox.log import Log
from sandbox.log import write_log as write_log_file
from sandbox.snapshot import View, take
from scenes import registry
from scenes.scene import Check, Handle, Scene, Setup, Track, Values

BOX = "box"  # the handle that is no body: the periodic cell
ARRIVED = 1e-6  # [R] a body this near its target is there
STUCK = 1e-3  # of a step: a body that moves less than that is stopped
COMPILING, PACKING = "compiling the solver (first start only)", "packing the grains"
COMPILE_SHARE = 0.5

Progress = Callable[[str, float], None]


class Session:
    """A scene that runs. Everything but ``submit`` belongs to one thread, the solver's."""

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
        self.history = History()
        self._first = (scene, self.packing, self.seed, dict(self.settings))
        self._pending: deque[Command] = deque()
        self._lock = threading.Lock()
        self._commands: list[tuple[int, Command]] = []
        self._finished = 0  # increments since the session began, resets included
        self._setup: Setup | None = None
        self._progress: Progress | None = None

    # -- building -------------------------------------------------------------------------------------------------------------

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
        self._start_packing = setup.packing.copy()
        self._start_placement = setup.world.placement()
        self._begin(setup)
        report("ready", 1.0)

    def _begin(self, setup: Setup) -> None:
        """Start from what was built: relax with all bodies at rest, and record that as increment 0."""
        self._setup = setup
        friction = Friction(setup.friction, len(setup.packing)) if setup.friction > 0.0 else None
        self._engine = Quasistatic(
            setup.packing,
            setup.world,
            setup.solver,
            friction,
            setup.gravity,
            setup.follow,
            setup.relaxes,
        )
        self.history = History()
        self._targets: dict[str, Point] = {}
        self._held: set[str] = set()
        self._blocked: set[str] = set()
        self._script: int | None = None
        self._stroke = 0.0
        self._out = 0
        self._initial = len(setup.packing)
        self._clear_since = 0.0  # stroke at which a grain last left
        self._notices: list[str] = []
        handle = setup.handles[0]
        self._drive = handle
        self._direction = np.array(handle.direction)
        self._engine.begin({})
        last: Increment | None = None
        while last is None:
            last = self._engine.relax(1_000)
        self._last = last
        self._record(last)

    # -- commands -------------------------------------------------------------------------------------------------------------

    def submit(self, command: Command) -> None:
        """Ask for something; it takes effect before the next increment. May be called from any thread."""
        with self._lock:
            if isinstance(command, Move) and self._pending:
                newest = self._pending[-1]
                if isinstance(newest, Move) and newest.handle == command.handle:
                    self._pending.pop()  # only where the hand is now matters
            self._pending.append(command)

    def submit_exactly(self, command: Command) -> None:
        """As ``submit``, but never merged with the command before: for replays."""
        with self._lock:
            self._pending.append(command)

    def _take_commands(self) -> None:
        while True:
            with self._lock:
                if not self._pending:
                    return
                command = self._pending.popleft()
            try:
                self._apply(command)
            except InputError as error:
                self._notices = [str(error)]
                continue
            self._commands.append((self._finished, command))

    def _apply(self, command: Command) -> None:
        setup = self._require()
        match command:
            case Grab(handle):
                self._handle(handle)
                self._held.add(handle)
                self._script = None
                self._targets.clear()
            case Move(handle, x, y):
                self._handle(handle)
                if handle in self._held:
                    reach = setup.reach
                    self._targets[handle] = (x, y) if reach is None else reach(handle, (x, y))
                    self._blocked.discard(handle)
                    self._notices = []
            case Release(handle):
                self._handle(handle)
                self._held.discard(handle)
                self._targets.pop(handle, None)
            case Protocol(on):
                self._script = 0 if on else None
                self._targets.clear()
                self._blocked.clear()
            case Reset():
                setup.packing = self._start_packing.copy()
                setup.world.place(self._start_placement)
                self._begin(setup)
            case Change(name, value):
                self._change(name, value)

    def _change(self, name: str, value: object) -> None:
        scene, packing, seed, settings = self.scene, self.packing, self.seed, dict(self.settings)
        if name == "scene":
            scene = registry.get(str(value))
            settings = scene.settings()
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

    def _handle(self, name: str) -> Handle:
        for handle in self._require().handles:
            if handle.body == name:
                return handle
        raise InputError(
            f"nothing here is called {name!r}; there are: {', '.join(h.body for h in self._require().handles)}"
        )

    # -- running --------------------------------------------------------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """True while an increment is being relaxed."""
        return self._setup is not None and self._engine.busy

    @property
    def idle(self) -> bool:
        """True if there is nothing to do: no command waits, no body has to move, and nothing is being relaxed."""
        if self._setup is None or self._engine.busy or self._pending:
            return False
        return self._script is None and not self._wanted()

    @property
    def finished(self) -> int:
        """Increments finished since the session began, resets included: the stamp of a log."""
        return self._finished

    def advance(self, max_iterations: int = 200) -> bool:
        """One slice of work, at most so many force evaluations. True if it finished an increment. Commands enter in between."""
        if not self._engine.busy:
            self._take_commands()
            setup = self._require()
            targets = self._next_targets()
            if not targets:
                return False
            box = targets.pop(BOX, None)
            goal = None if box is None or setup.box_target is None else setup.box_target(box)
            self._engine.begin(targets, goal)
        increment = self._engine.relax(max_iterations)
        if increment is None:
            return False
        self._finished += 1
        self._last = increment
        self._after(increment)
        return True

    def settle(self) -> None:
        """Let waiting commands take effect without beginning an increment."""
        if not self._engine.busy:
            self._take_commands()

    def _next_targets(self) -> dict[str, Point]:
        if self._script is not None:
            targets = self.scene.drive(self._require(), self.settings, self._script)
            if targets is not None:
                self._script += 1
                self._targets = dict(targets)
                return dict(targets)
            self._script = None
            self._targets.clear()
        return self._wanted()

    def _wanted(self) -> dict[str, Point]:
        """Held bodies that are not yet where the hand wants them, unless something stops them."""
        wanted = {}
        for name, target in self._targets.items():
            if name == BOX:
                if not self._box_arrived(target):
                    wanted[name] = target
                continue
            body = self._require().world[name]
            way = np.array(target) - body.position
            distance = (
                abs(float(np.dot(way, body.axis)))
                if body.axis is not None
                else float(np.hypot(*way))
            )
            if distance > ARRIVED and name not in self._blocked:
                wanted[name] = target
        return wanted

    def _box_arrived(self, target: Point) -> bool:
        setup = self._require()
        box = setup.packing.box
        if box is None or setup.box_target is None or BOX in self._blocked:
            return True
        goal = setup.box_target(target)
        now, then = (np.nan_to_num([b.width, b.height, b.shift], posinf=0.0) for b in (box, goal))
        return bool(np.max(np.abs(then - now)) <= ARRIVED)

    def _after(self, increment: Increment) -> None:
        setup = self._require()
        self._notices = []
        for name, why in increment.stopped.items():
            moved = math.hypot(*increment.moved[name])
            label = self._handle(name).label
            if moved < STUCK * setup.solver.step:
                self._blocked.add(name)
            if why == "force limit":
                self._notices.append(
                    f"the hand is not stronger than {setup.world[name].force_limit:g} k R: {label} stopped"
                )
            elif why == "end of travel":
                self._notices.append(f"{label}: end of travel")
            elif moved < STUCK * setup.solver.step:
                self._notices.append(f"{label}: stopped by the wall")
        if increment.report.reason in (StopReason.NOT_FINITE, StopReason.COLLAPSED):
            self._blocked.update(increment.moved)
            self._blocked.add(BOX)
            self._script = None
            what = (
                "a grain was squeezed flat"
                if increment.report.reason is StopReason.COLLAPSED
                else "the numbers blew up"
            )
            self._notices.append(f"{what}: back to the state before this step. Draw back, or reset")
        self._remove_those_gone()
        self._follow(np.array(increment.moved.get(self._drive.body, (0.0, 0.0))))
        self._record(increment)
        self._watch_for_clog()

    def _remove_those_gone(self) -> None:
        setup = self._require()
        if setup.outlet is None:
            return
        gone = setup.outlet.gone(self._engine.packing)
        if gone.any():
            self._out += int(gone.sum())
            self._engine.remove(gone)
            setup.packing = self._engine.packing
            pairs, bodies = self._engine.contacts()
            self._last = replace(self._last, grain_contacts=pairs, body_contacts=bodies)

    def _follow(self, moved: np.ndarray) -> None:
        """Stroke and direction of the drive: along its axis for a body that slides, along its path for one that is dragged."""
        if self._drive.body == BOX:
            return
        body = self._require().world[self._drive.body]
        if body.axis is not None:
            self._stroke = float(np.dot(np.array(body.position) - body.home, body.axis))
        else:
            length = float(np.hypot(*moved))
            self._stroke += length
            if length > 0.0:
                self._direction = moved / length

    def _record(self, increment: Increment) -> None:
        setup = self._require()
        fx = fy = 0.0
        if self._drive.body != BOX:
            fx, fy = map(float, increment.reactions[setup.world.index(self._drive.body), :2])
        resisting = -(fx * self._direction[0] + fy * self._direction[1]) + 0.0
        if setup.curve is not None:
            self._stroke = setup.curve.stroke(setup.packing, increment)
            resisting = setup.curve.force(setup.packing, increment)
        report = increment.report
        self.history.append(
            Row(
                increment=len(self.history),
                stroke=self._stroke,
                fx=fx,
                fy=fy,
                grains_out=self._out,
                energy=report.energy,
                residual=report.residual,
                iterations=report.iterations,
                stop_reason=str(report.reason),
                resisting=float(resisting),
            )
        )

    def _watch_for_clog(self) -> None:
        """Clogged: the force rises over a stroke of one grain diameter while nothing leaves."""
        if self._require().outlet is None:
            return
        rows = self.history
        if len(rows) > 1 and rows[len(rows) - 1].grains_out > rows[len(rows) - 2].grains_out:
            self._clear_since = self._stroke
        since = self._stroke - self._clear_since
        if since >= 2.0:
            start = next(
                row
                for row in (rows[k] for k in range(len(rows)))
                if row.stroke >= self._clear_since
            )
            if (
                rows[len(rows) - 1].resisting > start.resisting
                and rows[len(rows) - 1].resisting > 0.0
            ):
                self._notices.append(
                    f"clogged: {since / 2.0:.1f} diameters of stroke, nothing left"
                )

    # -- what can be seen -----------------------------------------------------------------------------------------------------

    def frame(self) -> Frame:
        """A snapshot that shares nothing with the session."""
        return take(self.view())

    def view(self) -> View:
        """What a snapshot is taken of."""
        setup = self._require()
        return View(
            scene=self.scene,
            packing_kind=self.packing,
            seed=self.seed,
            setup=setup,
            engine=self._engine,
            last=self._last,
            history=self.history,
            drive=self._drive,
            targets=self._targets,
            stroke=self._stroke,
            grains_out=self._out,
            protocol=self._script is not None,
            notices=tuple(self._notices),
        )

    def state_hash(self) -> str:
        """Hash of every bit of the packing and of where the bodies are."""
        setup = self._require()
        digest = hashlib.sha256(setup.packing.hash().encode() + setup.world.placement().tobytes())
        if self._engine.friction is not None:
            digest.update(self._engine.friction.hash().encode())
        return digest.hexdigest()

    def checks(self) -> list[Check]:
        """The scene's claims about this run."""
        rows = self.history
        reasons = rows.column("stop_reason")
        track = Track(
            stroke=rows.column("stroke"),
            force=rows.column("resisting"),
            grains_out=rows.column("grains_out"),
            residual=rows.column("residual"),
            converged=reasons == str(StopReason.CONVERGED),
            initial_grains=self._initial,
        )
        return self.scene.checks(self._require(), track)

    # -- logs -----------------------------------------------------------------------------------------------------------------

    def log(self) -> Log:
        """The run so far. Raises RuntimeError in the middle of an increment: finish it first."""
        if self.busy:
            raise RuntimeError("finish the increment before taking the log")
        scene, packing, seed, settings = self._first
        return Log(
            scene, packing, seed, settings, tuple(self._commands), self._finished, self.state_hash()
        )

    def write_log(self, path: str) -> None:
        """Write the log whole or not at all."""
        write_log_file(path, self.log())

    def _require(self) -> Setup:
        if self._setup is None:
            raise RuntimeError("build the session first")
        return self._setup


def _silent(text: str, share: float) -> None:
    """Progress that nobody watches."""
    del text, share


def check_seed(seed: object) -> int:
    """A seed is a whole number from 0 to 2⁶³ − 1. Raises InputError otherwise."""
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**63:
        raise InputError(f"the seed must be 0 or a positive whole number below 2^63, not {seed!r}")
    return seed

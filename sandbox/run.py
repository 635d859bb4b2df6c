"""A built scene under way: hands pull, increments follow one another, each leaves a row of history."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace

import numpy as np

from core.errors import InputError
from core.friction import Friction
from core.packing import PeriodicBox
from core.quasistatic import Increment, Quasistatic
from core.relaxation import StopReason
from core.rigid import Point
from sandbox.frame import Frame
from sandbox.history import History, Row
from sandbox.snapshot import View, take
from scenes.scene import Check, Handle, Latest, Remarks, Scene, Setup, Track, Values
from scenes.text import Text

BOX = "box"  # the handle that is no body: the periodic cell
ARRIVED = 1e-6  # [R] a body this near its target is there
STUCK = 1e-3  # of a step: a body that moves less than that is stopped
SQUEEZED_FLAT = "a grain was squeezed flat: back to the state before this step. Draw back, or reset"
BLEW_UP = "the numbers blew up: back to the state before this step. Draw back, or reset"
AT_REST = 0.01  # of the fall of a free grain: where there is drag, grains that move less have come to rest


class Run:
    """From what was built onwards. ``finished`` counts increments; row 0 of the history is the start, relaxed at rest."""

    def __init__(
        self, scene: Scene, values: Values, packing_kind: str, seed: int, setup: Setup
    ) -> None:
        self.scene, self.values, self.packing_kind, self.seed = scene, values, packing_kind, seed
        self.setup = setup
        friction = Friction(setup.friction, len(setup.packing)) if setup.friction > 0.0 else None
        self.engine = Quasistatic(
            setup.packing,
            setup.world,
            setup.solver,
            friction,
            setup.gravity,
            follow=setup.follow,
            drag=setup.drag,
            relaxes=setup.relaxes,
        )
        self.history = History()
        self.notices: list[str] = []
        self._drive = setup.handles[0]
        self._direction = np.array(self._drive.direction)
        self._targets: dict[str, Point] = {}
        self._held: set[str] = set()
        self._blocked: set[str] = set()  # stopped by something: they try again when the hand moves
        self._script: int | None = None  # increments of the scripted drive so far
        self._stroke = 0.0
        self._initial, self._out = len(setup.packing), 0
        self._last_exit = (0.0, 0.0)  # stroke and force when a grain last left
        self.engine.begin({})
        last: Increment | None = None
        while last is None:
            last = self.engine.relax(1_000)
        self._last = last
        self._moving = setup.drag > 0.0  # the grains go on by themselves
        self._record(last)
        self._remarks = self._remark(None, 0)

    # What a hand does.

    def grab(self, handle: str) -> None:
        """Take hold of a handle; the scripted drive ends. Raises InputError for an unknown one."""
        self._handle(handle)
        self._held.add(handle)
        self._script = None
        self._targets.clear()

    def move(self, handle: str, target: Point) -> None:
        """Where a held handle is to go [R]."""
        self._handle(handle)
        if handle in self._held:
            reach = self.setup.reach
            there = target if reach is None else reach(self.setup.packing, handle, target)
            self._targets[handle] = there
            self._blocked.discard(handle)
            self.notices = []

    def release(self, handle: str) -> None:
        """Let go; the body stays where it is."""
        self._handle(handle)
        self._held.discard(handle)
        self._targets.pop(handle, None)

    def follow_script(self, on: bool) -> None:
        """Switch the scripted drive on, from its beginning, or off."""
        self._script = 0 if on else None
        self._targets.clear()
        self._blocked.clear()

    def _handle(self, name: str) -> Handle:
        for handle in self.setup.handles:
            if handle.body == name:
                return handle
        known = ", ".join(handle.body for handle in self.setup.handles)
        raise InputError(f"nothing here is called {name!r}; there are: {known}")

    # Increments.

    @property
    def idle(self) -> bool:
        """True if no body has to move and nothing is being relaxed."""
        return self._still and not self.engine.busy and not self._wanted()

    def advance(self, max_iterations: int) -> bool:
        """At most so many force evaluations. True if they finished an increment."""
        if not self.engine.busy:
            targets = self._next_targets()
            if not targets and self._still:
                return False
            box = targets.pop(BOX, None)
            self.engine.begin(targets, None if box is None else self._cell(box))
        increment = self.engine.relax(max_iterations)
        if increment is None:
            return False
        before, self._last = self._last, increment
        self._tell_what_stopped(increment)
        left = self._remove_those_gone()
        self._follow(np.array(increment.moved.get(self._drive.body, (0.0, 0.0))))
        self._record(increment)
        if left:
            self._last_exit = self.history[-1].stroke, self.history[-1].resisting
        self._moving = self._goes_on(left)
        self._remarks = self._remark(None if left else before, left)
        return True

    @property
    def _still(self) -> bool:
        """True if neither the script nor the grains by themselves want another increment."""
        return self._script is None and not self._moving

    def _goes_on(self, left: int) -> bool:
        """With drag: whether the grains are still on their way."""
        gravity, drag = self.setup.gravity, self.setup.drag
        failed = self._last.report.reason in (StopReason.NOT_FINITE, StopReason.COLLAPSED)
        if gravity is None or drag == 0.0 or failed:
            return False
        return left > 0 or self.engine.farthest_move() > AT_REST * math.hypot(*gravity) / drag

    def _remark(self, before: Increment | None, left: int) -> Remarks:
        """What the scene has to say about the newest increment."""
        at_rest = self.setup.drag > 0.0 and not self._moving
        latest = Latest(before, self._last, self.history.curve, left, self._last_exit, at_rest)
        return self.scene.remarks(self.setup, self.values, latest)

    def _next_targets(self) -> dict[str, Point]:
        if self._script is not None:
            targets = self.scene.drive(self.setup, self.values, self._script)
            if targets is not None:
                self._script += 1
                self._targets = dict(targets)
                return dict(targets)
            self._script = None
            self._targets.clear()
        return self._wanted()

    def _wanted(self) -> dict[str, Point]:
        """What is not yet where the hand wants it, unless something stops it."""
        return {
            name: target
            for name, target in self._targets.items()
            if name not in self._blocked and self._distance(name, target) > ARRIVED
        }

    def _cell(self, target: Point) -> PeriodicBox | None:
        """The periodic cell that a hand at ``target`` asks for."""
        to_box = self.setup.box_target
        return to_box(target) if to_box is not None else None

    def _distance(self, name: str, target: Point) -> float:
        """How far a handle is from its target [R]."""
        if name == BOX:
            cells = self.setup.packing.box, self._cell(target)
            now, then = ((c.width, c.height, c.shift) if c else (0.0,) * 3 for c in cells)
            return float(np.max(np.abs(np.nan_to_num(then) - np.nan_to_num(now))))
        body = self.setup.world[name]
        way = np.array(target) - body.position
        return abs(float(np.dot(way, body.axis))) if body.axis is not None else math.hypot(*way)

    def _tell_what_stopped(self, increment: Increment) -> None:
        self.notices = []
        for name, why in increment.stopped.items():
            label = self._handle(name).label
            stuck = math.hypot(*increment.moved[name]) < STUCK * self.setup.solver.step
            if stuck:
                self._blocked.add(name)
            if why == "force limit":
                limit = self.setup.world[name].force_limit
                text = "the hand is not stronger than {limit:g} k R: {label} stopped"
                self.notices.append(Text(text, limit=limit, label=label))
            elif why == "end of travel":
                self.notices.append(Text("{label}: end of travel", label=label))
            elif stuck:
                self.notices.append(Text("{label}: stopped by the wall", label=label))
        reason = increment.report.reason
        if reason in (StopReason.NOT_FINITE, StopReason.COLLAPSED):
            self._blocked.update(increment.moved, {BOX})
            self._script = None
            flat = reason is StopReason.COLLAPSED
            self.notices.append(SQUEEZED_FLAT if flat else BLEW_UP)

    def _remove_those_gone(self) -> int:
        """How many grains have left by the outlet in this increment."""
        if self.setup.outlet is None:
            return 0
        gone = self.setup.outlet.gone(self.engine.packing)
        if gone.any():
            self._out += int(gone.sum())
            self.engine.remove(gone)
            self.setup.packing = self.engine.packing
            pairs, bodies = self.engine.contacts()
            unbalanced = self._last.unbalanced[~gone]
            self._last = replace(
                self._last, grain_contacts=pairs, body_contacts=bodies, unbalanced=unbalanced
            )
        return int(gone.sum())

    def _follow(self, moved: np.ndarray) -> None:
        """Stroke and direction of the drive: along its axis for a body that slides, along its path for one that is dragged."""
        if self._drive.body == BOX:
            return
        body = self.setup.world[self._drive.body]
        if body.axis is not None:
            self._stroke = float(np.dot(np.array(body.position) - body.home, body.axis))
        else:
            length = math.hypot(*moved)
            self._stroke += length
            if length > 0.0:
                self._direction = moved / length

    def _record(self, increment: Increment) -> None:
        fx = fy = 0.0
        if self._drive.body != BOX:
            index = self.setup.world.index(self._drive.body)
            fx, fy = map(float, increment.reactions[index, :2])
        resisting = -(fx * self._direction[0] + fy * self._direction[1]) + 0.0
        curve = self.setup.curve
        if curve is not None:
            at = curve.stroke
            self._stroke = len(self.history) if at is None else at(self.setup.packing, increment)
            resisting = curve.force(self.setup.packing, increment)
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

    # What can be seen.

    def frame(self) -> Frame:
        """A snapshot that shares nothing with the run."""
        return take(
            View(
                scene=self.scene,
                settings=self.values,
                packing_kind=self.packing_kind,
                seed=self.seed,
                setup=self.setup,
                engine=self.engine,
                last=self._last,
                history=self.history,
                drive=self._drive,
                targets=self._targets,
                stroke=self._stroke,
                grains_out=self._out,
                protocol=self._script is not None,
                notices=(*self.notices, *self._remarks.notices),
                highlight=self._remarks.highlight,
            )
        )

    def state_hash(self) -> str:
        """Hash of every bit of the packing, of where the bodies are, and of what frictional contacts remember."""
        placement = self.setup.world.placement().tobytes()
        digest = hashlib.sha256(self.setup.packing.hash().encode() + placement)
        if self.engine.friction is not None:
            digest.update(self.engine.friction.hash().encode())
        return digest.hexdigest()

    def checks(self) -> list[Check]:
        """The scene's claims about this run."""
        rows = self.history
        track = Track(
            stroke=rows.column("stroke"),
            force=rows.column("resisting"),
            grains_out=rows.column("grains_out"),
            residual=rows.column("residual"),
            converged=rows.column("stop_reason") == str(StopReason.CONVERGED),
            initial_grains=self._initial,
        )
        return self.scene.checks(self.setup, track)

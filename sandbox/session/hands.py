"""Who drives a run: hands that hold, and the script."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from core.errors import InputError
from core.hand import CELL
from core.packing import PeriodicBox
from core.rigid import Point
from sandbox.session.course import Course
from scenes.scene import Handle, Scene, Setup, Values

ARRIVED = 1e-6  # [R] a body this near its target is there


@dataclass(frozen=True)
class Hands:
    """A built scene with its settings as they are, and its course: where its bodies are to go. Holds nothing of its own."""

    scene: Scene
    settings: Values
    setup: Setup
    course: Course

    def grab(self, handle: str) -> None:
        """Take hold of a handle; the scripted drive ends. Raises InputError for an unknown one."""
        self._handle(handle)
        self.course.held.add(handle)
        self.course.script = None
        self.course.targets.clear()

    def move(self, handle: str, target: Point) -> None:
        """Where a held handle is to go [R]."""
        self._handle(handle)
        if handle in self.course.held:
            reach = self.setup.reach
            there = target if reach is None else reach(self.setup.packing, handle, target)
            self.course.targets[handle] = there
            self.course.blocked.discard(handle)
            self.course.notices.clear()

    def release(self, handle: str) -> None:
        """Let go; the body stays where it is."""
        self._handle(handle)
        self.course.held.discard(handle)
        self.course.targets.pop(handle, None)

    def follow_script(self, on: bool) -> None:
        """Switch the scripted drive on, from its beginning, or off."""
        self.course.script = 0 if on else None
        self.course.targets.clear()
        self.course.blocked.clear()

    def _handle(self, name: str) -> Handle:
        for handle in self.setup.handles:
            if handle.body == name:
                return handle
        known = ", ".join(handle.body for handle in self.setup.handles)
        raise InputError(f"nothing here is called {name!r}; there are: {known}")

    def next_targets(self) -> dict[str, Point]:
        """Where bodies are to go in the next increment; the script is one further then."""
        course = self.course
        if course.script is not None:
            targets = self.scene.drive(self.setup, self.settings, course.script)
            if targets is not None:
                course.script += 1
                course.targets = dict(targets)
                return dict(targets)
            course.script = None
            course.targets.clear()
        return self.wanted()

    def wanted(self) -> dict[str, Point]:
        """What is not yet where the hand wants it, unless something stops it."""
        return {
            name: target
            for name, target in self.course.targets.items()
            if name not in self.course.blocked and self._distance(name, target) > ARRIVED
        }

    def cell(self, target: Point) -> PeriodicBox | None:
        """The periodic cell that a hand at ``target`` asks for."""
        to_box = self.setup.box_target
        return to_box(target) if to_box is not None else None

    def _distance(self, name: str, target: Point) -> float:
        """How far a handle is from its target [R]."""
        if name == CELL:
            cells = self.setup.packing.box, self.cell(target)
            now, then = ((c.width, c.height, c.shift) if c else (0.0,) * 3 for c in cells)
            return float(np.max(np.abs(np.nan_to_num(then) - np.nan_to_num(now))))
        body = self.setup.world[name]
        way = np.array(target) - body.position
        return abs(float(np.dot(way, body.axis))) if body.axis is not None else math.hypot(*way)

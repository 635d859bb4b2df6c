"""Who drives a run: hands that hold, and the script."""

from __future__ import annotations

import math

import numpy as np

from core.errors import InputError
from core.packing import PeriodicBox
from core.rigid import Point
from sandbox.session.course import Course
from sandbox.session.reading import BOX
from scenes.scene import Handle, Scene, Setup, Values

ARRIVED = 1e-6  # [R] a body this near its target is there


class Driven:
    """A built scene, and where its bodies are to go."""

    def __init__(self, scene: Scene, values: Values, setup: Setup, course: Course) -> None:
        self.scene, self.values, self.setup = scene, values, setup
        self._course = course

    def grab(self, handle: str) -> None:
        """Take hold of a handle; the scripted drive ends. Raises InputError for an unknown one."""
        self._handle(handle)
        self._course.held.add(handle)
        self._course.script = None
        self._course.targets.clear()

    def move(self, handle: str, target: Point) -> None:
        """Where a held handle is to go [R]."""
        self._handle(handle)
        if handle in self._course.held:
            reach = self.setup.reach
            there = target if reach is None else reach(self.setup.packing, handle, target)
            self._course.targets[handle] = there
            self._course.blocked.discard(handle)
            self._course.notices.clear()

    def release(self, handle: str) -> None:
        """Let go; the body stays where it is."""
        self._handle(handle)
        self._course.held.discard(handle)
        self._course.targets.pop(handle, None)

    def follow_script(self, on: bool) -> None:
        """Switch the scripted drive on, from its beginning, or off."""
        self._course.script = 0 if on else None
        self._course.targets.clear()
        self._course.blocked.clear()

    def still(self) -> None:
        """Nothing is held, nothing is wanted, and the script is off."""
        self._course.still()

    def say(self, notice: str) -> None:
        """Plain words for the person at the window, until something else is to be said."""
        self._course.notices = [notice]

    def _handle(self, name: str) -> Handle:
        for handle in self.setup.handles:
            if handle.body == name:
                return handle
        known = ", ".join(handle.body for handle in self.setup.handles)
        raise InputError(f"nothing here is called {name!r}; there are: {known}")

    def _next_targets(self) -> dict[str, Point]:
        course = self._course
        if course.script is not None:
            targets = self.scene.drive(self.setup, self.values, course.script)
            if targets is not None:
                course.script += 1
                course.targets = dict(targets)
                return dict(targets)
            course.script = None
            course.targets.clear()
        return self._wanted()

    def _wanted(self) -> dict[str, Point]:
        """What is not yet where the hand wants it, unless something stops it."""
        return {
            name: target
            for name, target in self._course.targets.items()
            if name not in self._course.blocked and self._distance(name, target) > ARRIVED
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

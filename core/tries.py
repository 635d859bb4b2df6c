"""The tries of one increment: a hand that has overpowered itself goes back and tries a shorter way (``core.hand``)."""

from __future__ import annotations

import math

import numpy as np

from core.arrays import Floats
from core.hand import CELL, Push, force_on_body, force_on_box
from core.observables import GrainContacts
from core.packing import PeriodicBox
from core.rigid import Point
from core.system import System


class Tries:
    """What the hand is asked for in one increment, how it pulls, and what the latest try has moved."""

    def __init__(
        self, system: System, targets: dict[str, Point], box: PeriodicBox | None = None
    ) -> None:
        """``targets`` are where bodies are wanted [R], ``box`` is what the periodic cell shall come to."""
        self._system = system
        self._targets, self._box = dict(targets), box
        self._push = Push(system.solver.hand_strength, -math.inf)
        self.moved: dict[str, Point] = {}  # as in ``quasistatic.Increment``, and so the next two
        self.pulled: dict[str, Point] = {}
        self.stopped: dict[str, str] = {}
        self.spent = 0  # force evaluations of the tries before this one

    @property
    def limited(self) -> bool:
        """True if a hand of limited strength is at work."""
        asked = self._targets or self._box is not None
        return math.isfinite(self._system.solver.hand_strength) and bool(asked)

    @property
    def share(self) -> float:
        """The share of a step that is tried."""
        return self._push.share

    def move_bodies(self, reactions: Floats) -> None:
        """Each body towards its target, by the share of a step that is tried, unless the grains push it harder than the hand.

        ``reactions`` (B, 3) are the pushes of the grains on the bodies before they move [k R, k R²].
        """
        world, step = self._system.world, self._system.solver.step
        self.moved, self.stopped = {}, {}
        self.pulled = {name: self._way(name, target) for name, target in self._targets.items()}
        forces = {}
        for name, target in self._targets.items():
            pull = self.pulled[name]
            forces[name] = force_on_body(self._push_on(name, reactions), pull)
            if self.share == 0.0:
                moved, stopped = (0.0, 0.0), None
            elif self._push.too_much(forces[name]):
                moved, stopped = world.give_way(name, pull, step), "force limit"
            else:
                moved, stopped = world.advance(name, target, self.share * step)
            self.moved[name] = moved
            if self.share < 1.0:
                stopped = "force limit"
            if stopped is not None:
                self.stopped[name] = stopped
        self._push.before = max(forces.values(), default=-math.inf)

    def cell(self, old: PeriodicBox | None) -> PeriodicBox | None:
        """What the periodic cell, ``old`` before, comes to in this try."""
        if self._box is not None and self.share < 1.0:
            self.stopped[CELL] = "force limit"
        return self._towards(old, self.share * self._system.solver.step)

    def again(self, force: float, before: float, *, squeezed: bool) -> bool:
        """After a try: has the hand overpowered itself? Then a shorter way is set.

        ``force`` [k R] is what it took, not finite if it led to nothing; ``before`` what there was, which counts where no body
        is asked for; ``squeezed`` whether the cell has changed.
        """
        if not (squeezed or any(math.hypot(*moved) > 0.0 for moved in self.moved.values())):
            return False
        if self._targets and self.too_much(self._push.before):
            return False  # it has given way
        if not self._targets:
            self._push.before = before
        if not self._push.overpowered(force):
            return False
        self._push.shorten(force)
        return True

    def too_much(self, force: float) -> bool:
        """True if that is more force [k R] than the hand has."""
        return self._push.too_much(force)

    def hand_force(self, pairs: GrainContacts, reactions: Floats, box: PeriodicBox | None) -> float:
        """The hand's force along its pull [k R], the largest of those on several bodies; nan where it pulls at nothing.

        ``box`` is the cell at the start of the increment.
        """
        if self.pulled:
            pushes = (self._push_on(name, reactions) for name in self.pulled)
            return max(map(force_on_body, pushes, self.pulled.values()))
        asked = self._towards(box, self._system.solver.step)
        if box is None or asked is None or self._box is None:
            return math.nan
        ends = [(box.width, asked.width), (box.height, asked.height), (box.shift, asked.shift)]
        width, height, shift = (b - a if math.isfinite(a) else 0.0 for a, b in ends)
        return force_on_box(pairs, box, (width, height, shift))

    def _way(self, name: str, target: Point) -> Point:
        """The way in which the hand pulls a body, a unit vector; 0 at its target."""
        body = self._system.world[name]
        way = target[0] - body.position[0], target[1] - body.position[1]
        if body.axis is not None:
            along = np.sign(way[0] * body.axis[0] + way[1] * body.axis[1])
            return float(along * body.axis[0]), float(along * body.axis[1])
        length = math.hypot(*way)
        return (way[0] / length, way[1] / length) if 0.0 < length < math.inf else (0.0, 0.0)

    def _push_on(self, name: str, reactions: Floats) -> Point:
        """The push of the grains on a body [k R]."""
        fx, fy, _ = map(float, reactions[self._system.world.index(name)])
        return fx, fy

    def _towards(self, old: PeriodicBox | None, step: float) -> PeriodicBox | None:
        """The cell that is at most ``step`` [R] nearer to what it shall come to than ``old``."""
        target = self._box
        if target is None or old is None:
            return old

        def towards(now: float, then: float) -> float:
            return now + min(max(then - now, -step), step) if np.isfinite(now) else now

        return PeriodicBox(
            towards(old.width, target.width),
            towards(old.height, target.height),
            towards(old.shift, target.shift),
        )

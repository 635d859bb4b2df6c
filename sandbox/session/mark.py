"""A place between two increments to come back to as if nothing had happened since.

A recall is a step of a person's: it is in the log, and what came after stays for another recall. To go back to a mark is
none: increments and commands since then have never been, in no row, log or list of states to go back to.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from core.hand import CELL
from core.quasistatic import Increment
from core.rigid import Point
from sandbox.session.checkpoints import Checkpoint, Checkpoints
from sandbox.session.commands import Move
from sandbox.session.course import Course
from sandbox.session.history import Event, History


@dataclass(frozen=True)
class RunMark:
    """Where a run stands. It shares with the run only what is never written to, and the rows so far."""

    state: Checkpoint  # all that the next increment depends on
    kept: Checkpoint | None  # the very object that the run had, by which undo knows the state
    last: Increment
    before_edit: tuple[Checkpoint, Course] | None
    history: History  # of which the first ``state.length`` rows are of then
    events: tuple[Event, ...]
    checkpoints: Checkpoints
    straight: bool  # do handles go straight to where they are wanted?


@dataclass(frozen=True)
class Mark:
    """Where a session stands."""

    run: RunMark
    commands: int  # that took effect so far
    finished: int  # increments
    refusals: tuple[int, str]

    def detour(self, move: Move, ready: Sequence[Mark]) -> float:
        """How much longer, in steps of the hand, the way of a body from here to where it is wanted now is, if it first goes
        through all of ``ready``, than straight. Not finite where the hand pulls the other way, or the way is not known.
        """
        name, run = move.handle, self.run
        if name == CELL or not run.straight or not ready:
            return math.inf
        bodies = {state.body.name: state for state in run.state.engine.bodies}
        wanted = ready[-1].run.state.course.targets.get(name)
        if name not in bodies or wanted is None:
            return math.inf
        axis = bodies[name].axis
        way = [_place(mark, name) for mark in (self, *ready)]
        start, old = way[0], _reached(way[0], axis, wanted)
        new = _reached(start, axis, (move.x, move.y))
        if sum((b - a) * (c - a) for a, b, c in zip(start, old, new, strict=True)) < 0.0:
            return math.inf
        gone = sum(map(math.dist, way[:-1], way[1:]))
        step = run.state.engine.solver.step
        return (gone + math.dist(way[-1], new) - math.dist(start, new)) / step


def _place(mark: Mark, name: str) -> Point:
    """Of a body then [R]."""
    bodies = mark.run.state.engine.bodies
    return next(state.position for state in bodies if state.body.name == name)


def _reached(start: Point, axis: Point | None, target: Point) -> Point:
    """Where a body at ``start`` gets to [R], on its axis if it has one."""
    if axis is None:
        return target
    along = (target[0] - start[0]) * axis[0] + (target[1] - start[1]) * axis[1]
    return start[0] + along * axis[0], start[1] + along * axis[1]

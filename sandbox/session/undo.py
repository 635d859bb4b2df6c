"""Undo and redo: where a session stood before each of the things that a person did."""

from __future__ import annotations

from dataclasses import dataclass

from core.engine_state import BodyState
from core.errors import InputError
from core.friction import Friction
from core.packing import Packing
from sandbox.session.beginning import Asked
from sandbox.session.checkpoints import MOST_BYTES, Checkpoint
from sandbox.session.commands import Change, Command, Erase, Place, Recall, Retype
from sandbox.session.run import Run
from scenes.scene import Setup

MOST_MOMENTS = 100
MOST_RUNS = 8  # of those that a reset or a new start has ended
OLD_RUN_BYTES = MOST_BYTES // 16  # of the checkpoints of each of them
ONE_GESTURE = 20  # increments: changes of one parameter no further apart are undone together


@dataclass(frozen=True)
class Start:
    """What a reset goes back to."""

    packing: Packing
    friction: Friction | None
    setup: Setup
    bodies: tuple[BodyState, ...]
    asked: Asked
    kept: Checkpoint | None = None  # where a file begins


@dataclass(frozen=True)
class Moment:
    """Where a session stands."""

    start: Start
    run: Run
    checkpoint: Checkpoint


class Past:
    """Moments before what can be undone, and before what can be redone; the latest last."""

    def __init__(self) -> None:
        self._undo: list[Moment] = []
        self._redo: list[Moment] = []
        self._latest: tuple[object, int] = (None, 0)  # what was done last, and when

    def remember(self, before: Moment, command: Command, finished: int) -> None:
        """``command`` was done after so many increments, at ``before``. What was undone cannot be redone any more."""
        self._redo.clear()
        kind = command.name if isinstance(command, Change) else type(command)
        near = finished - self._latest[1] <= (0 if isinstance(command, Recall) else ONE_GESTURE)
        stroke = isinstance(command, (Place, Erase, Retype)) and command.goes_on
        same_gesture = stroke or (isinstance(command, (Change, Recall)) and near)
        goes_on = same_gesture and kind == self._latest[0]
        self._latest = kind, finished
        same_state = bool(self._undo) and self._undo[-1].checkpoint is before.checkpoint
        if not (self._undo and (goes_on or same_state)):
            self._undo.append(before)
            self._forget()

    def can_undo(self, now: Checkpoint | None) -> bool:
        """True if there is another state to go back to than ``now`` (None: none of those that are remembered)."""
        return any(moment.checkpoint is not now for moment in self._undo)

    @property
    def can_redo(self) -> bool:
        """True if something was undone."""
        return bool(self._redo)

    def undo(self, now: Moment) -> Moment:
        """The moment to go back to. Raises InputError if there is none."""
        if not self.can_undo(now.checkpoint):
            raise InputError("there is nothing to undo")
        while self._undo[-1].checkpoint is now.checkpoint:
            self._undo.pop()
        self._redo.append(now)
        return self._step(self._undo)

    def redo(self, now: Moment) -> Moment:
        """The moment to go on to. Raises InputError if there is none."""
        if not self._redo:
            raise InputError("there is nothing to redo")
        self._undo.append(now)
        return self._step(self._redo)

    def _step(self, moments: list[Moment]) -> Moment:
        self._latest = None, 0
        moment = moments.pop()
        self._forget()
        return moment

    def _forget(self) -> None:
        """Let go of what is too long ago."""
        del self._undo[:-MOST_MOMENTS]
        while len({id(moment.run) for moment in self._undo}) > MOST_RUNS:
            del self._undo[0]

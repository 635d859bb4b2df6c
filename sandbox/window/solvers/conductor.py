"""Several solvers in step: all take the same commands before the same increment.

A turn is the commands that came in since the last one, and then at most one increment. It begins when every solver has ended
the one before, so packings side by side feel the same path of the hand however fast each of them is. A solver that comes
later first goes through the turns that it has missed.
"""

from __future__ import annotations

import math
import os
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import get_args

from sandbox.session.commands import Change, Command, Edit, Move, Recall, Redo, Reset, Undo

Turn = tuple[Command, ...]

# They take effect while paused, too.
AT_ONCE = (Reset, Change, Recall, Undo, Redo, *get_args(Edit))


def begins_anew(command: Command) -> bool:
    """Does what came before matter no more? Without knowing the scene: after any reset or change."""
    return isinstance(command, (Reset, Change))


def cores() -> int:
    """How many this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Member:
    """One solver's place among the others."""

    def __init__(self, missed: list[Turn], turn: int) -> None:
        self.missed = deque(missed)  # turns to catch up with
        self.behind = len(missed)  # how many there were at first
        self.turn = turn  # the latest that it has taken; of those missed none counts
        self.waiting = False
        self.wants = False  # would it go on by itself?
        self.stopping = False

    @property
    def caught_up(self) -> float:
        """The share of the missed turns that it has gone through."""
        return 1.0 - len(self.missed) / self.behind if self.behind else 1.0


class Conductor:
    """Takes the commands and says when a turn begins. Nothing that the window calls waits."""

    def __init__(
        self,
        *,
        paused: bool = False,
        begins_anew: Callable[[Command], bool] = begins_anew,
    ) -> None:
        self.core = threading.Semaphore(max(cores() - 1, 1))  # one is left to the window
        self._begins_anew = begins_anew
        self._changed = threading.Condition()
        self._mail: list[Command] = []
        self._members: list[Member] = []
        self._past: list[Turn] = []  # since the scene was last as built
        self._turn = 0
        self._commands: Turn = ()  # of the latest turn
        self._advanced = False  # has a solver finished an increment in it?
        self._paused = paused
        self._steps = 0
        self._pause = 0.0  # between the beginnings of two turns [s]
        self._due = 0.0  # when the next may begin [s]

    # What the window calls.

    @property
    def paused(self) -> bool:
        """Are the solvers held?"""
        return self._paused

    @property
    def turns(self) -> int:
        """How many turns a solver that joins now has missed."""
        return len(self._past)

    def submit(self, command: Command) -> None:
        """Send a command to all. Of those that only the latest of counts, only the latest is kept. A recall pauses."""
        with self._changed:
            if isinstance(command, Recall):
                self._paused, self._steps = True, 0
            if self._mail and self._replaces(command, self._mail[-1]):
                self._mail[-1] = command
            else:
                self._mail.append(command)
            self._changed.notify_all()

    def pause(self, on: bool) -> None:
        """Hold after the increment at work, or go on."""
        with self._changed:
            self._paused = on
            self._steps = 0
            self._changed.notify_all()

    def step(self) -> None:
        """Hold, but do one more increment."""
        with self._changed:
            self._paused = True
            self._steps += 1
            self._changed.notify_all()

    def set_speed(self, increments_per_second: float) -> None:
        """No more increments a second than that; inf: as many as the solvers manage."""
        with self._changed:
            self._pause = 1.0 / max(increments_per_second, 1e-3)
            self._due = min(self._due, time.perf_counter() + self._pause)
            self._changed.notify_all()

    def forget_past(self) -> None:
        """A solver that joins from now on has missed nothing."""
        with self._changed:
            self._past.clear()

    def join(self) -> Member:
        """A place for one more solver. Until it has caught up, the others wait."""
        with self._changed:
            member = Member(self._past, self._turn)
            self._members.append(member)
            return member

    def stop(self, member: Member) -> None:
        """Let a solver end."""
        with self._changed:
            member.stopping = True
            self._changed.notify_all()

    # What the solvers' threads call.

    def next_turn(self, member: Member, *, wants: bool, advanced: bool) -> Turn | None:
        """Wait for the next turn; None when it is time to end.

        ``wants``: would the solver go on by itself? ``advanced``: has it finished an increment since the last call?
        """
        with self._changed:
            if member.missed and not member.stopping:
                return member.missed.popleft()
            member.waiting, member.wants = True, wants
            self._advanced |= advanced
            while member.turn == self._turn or member.stopping:
                if member.stopping:
                    return None
                pause = self._begin()
                if pause > 0.0:
                    self._changed.wait(None if math.isinf(pause) else pause)
            member.turn = self._turn
            return self._commands

    def leave(self, member: Member) -> None:
        """A solver has ended; the others go on without it."""
        with self._changed:
            if member in self._members:
                self._members.remove(member)
            self._changed.notify_all()

    def _begin(self) -> float:
        """Begin a turn, if one is due: 0. Otherwise how long to wait at least [s]."""
        if not all(member.waiting or member.stopping for member in self._members):
            return math.inf
        if self._advanced:
            self._steps = max(self._steps - 1, 0)
        self._advanced = False
        at_once = any(isinstance(command, AT_ONCE) for command in self._mail)
        if self._paused and not self._steps and not at_once:
            return math.inf
        if not self._mail and not any(member.wants for member in self._members):
            self._steps = 0  # a step with nothing to do is done
            return math.inf
        now = time.perf_counter()
        if now < self._due and not at_once and not self._steps:
            return self._due - now
        late = now - self._due  # made up for, as long as it is not a whole turn
        self._due = (self._due if late < self._pause else now) + self._pause
        self._commands, self._mail = tuple(self._mail), []
        self._remember(self._commands)
        self._turn += 1
        for member in self._members:
            member.waiting = False
        self._changed.notify_all()
        return 0.0

    def _remember(self, commands: Turn) -> None:
        """What a solver that joins later must go through."""
        for index in reversed(range(len(commands))):
            if self._begins_anew(commands[index]):
                self._past.clear()
                commands = commands[index + 1 :]
                break
        self._past.append(commands)

    def _replaces(self, new: Command, old: Command) -> bool:
        """Does only the newer of two commands count, when nothing comes between them?"""
        if isinstance(new, Move) and isinstance(old, Move):
            return new.handle == old.handle
        if isinstance(new, Change) and isinstance(old, Change):
            return new.name == old.name and not self._begins_anew(new)
        return isinstance(new, Recall) and isinstance(old, Recall)

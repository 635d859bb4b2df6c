"""Several solvers in step: all take the same commands before the same increment.

A turn is the commands that came in since the last one, and then at most one increment. It begins when every solver has ended
the one before, so packings side by side feel the same path of the hand however fast each of them is. A solver that comes
later first goes through the turns that it has missed.

The conductor also says which turns are seen, and how far ahead of them the solvers work: ``ahead`` tells how that goes.
"""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from enum import Enum
from typing import Literal, get_args

from sandbox.environment import cores
from sandbox.session.commands import Change, Command, Edit, Move, Recall, Redo, Reset, Undo
from sandbox.session.mark import Mark
from sandbox.window.solvers.ahead import Pace, Ready, may_wait

Turn = tuple[Command, ...]


class Word(Enum):
    """What a solver may be told instead of a turn."""

    BACK = "go back to what was shown last"
    NOTHING = "nothing yet"


# They take effect while paused, too.
AT_ONCE = (Reset, Change, Recall, Undo, Redo, *get_args(Edit))


def begins_anew(command: Command) -> bool:
    """Does what came before matter no more? Without knowing the scene: after any reset or change."""
    return isinstance(command, (Reset, Change))


def unseen(ready: Ready) -> None:
    """Nobody looks."""
    del ready


class Member:
    """One solver's place among the others."""

    def __init__(self, missed: list[Turn], turn: int, show: Callable[[Ready], None]) -> None:
        self.missed = deque(missed)  # turns to catch up with
        self.behind = len(missed)  # how many there were at first
        self.turn = turn  # the latest that it has taken; of those missed none counts
        self.waiting = False
        self.wants = False  # would it go on by itself?
        self.stopping = False
        self.back = False  # is it still to go back to what was shown?
        self.shown: Ready | None = None  # the latest of its turns that was
        self.ready: deque[Ready] = deque()  # those that were not
        self._show = show

    @property
    def caught_up(self) -> float:
        """The share of the missed turns that it has gone through."""
        return 1.0 - len(self.missed) / self.behind if self.behind else 1.0

    @property
    def way_back(self) -> Mark | None:
        """Where it is to go back to; None if it is to go on from where it is."""
        return self.shown.mark if self.back and self.shown is not None else None

    def show(self, turn: int) -> None:
        """What is ready up to that turn is seen."""
        newest = None
        while self.ready and self.ready[0].turn <= turn:
            newest = self.ready.popleft()
        if newest is not None:
            self.shown = newest
            self._show(newest)


class Conductor:
    """Takes the commands and says when a turn begins. Nothing that the window calls waits."""

    def __init__(
        self,
        *,
        paused: bool = False,
        begins_anew: Callable[[Command], bool] = begins_anew,
        depth: int = 0,
    ) -> None:
        """``depth``: so many increments may be ready that nobody has seen; somebody must call ``show`` then."""
        self.core = threading.Semaphore(max(cores() - 1, 1))  # one is left to the window
        self._begins_anew = begins_anew
        self._changed = threading.Condition()
        self._mail: list[Command] = []
        self._members: list[Member] = []
        self._past: list[Turn] = []  # since the scene was last as built
        self._turn = 0  # the latest that has begun
        self._commands: Turn = ()  # of it
        self._depth = depth
        self._shown = 0  # the latest turn that is seen, as soon as it has ended
        self._unseen: list[Turn] = []  # those after it
        self._pace = Pace()
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
            if self._ahead and not all(may_wait(command, m.shown, m.ready) for m in self._members):
                self._drop()
            if isinstance(command, Recall):
                self._paused, self._steps = True, 0
            self._post(command)
            self._changed.notify_all()

    def show(self) -> int:
        """A picture is going to be drawn: some of what is ready is seen from now on. Returns how many increments."""
        with self._changed:
            count = self._pace.count(self._ahead, max(self._depth, 1))
            self._see(self._shown + count)
            self._changed.notify_all()
            return count

    def pause(self, on: bool) -> None:
        """Hold after the increment at work, or go on."""
        with self._changed:
            self._drop()
            self._paused = on
            self._steps = 0
            self._changed.notify_all()

    def step(self) -> None:
        """Hold, but do one more increment."""
        with self._changed:
            self._drop()
            self._paused = True
            self._steps += 1
            self._changed.notify_all()

    def set_speed(self, increments_per_second: float) -> None:
        """No more increments a second than that; inf: as many as the solvers manage."""
        with self._changed:
            self._drop()
            self._pause = 1.0 / max(increments_per_second, 1e-3)
            self._due = min(self._due, time.perf_counter() + self._pause)
            self._changed.notify_all()

    def forget_past(self) -> None:
        """A solver that joins from now on has missed nothing."""
        with self._changed:
            self._past.clear()

    @property
    def works_ahead(self) -> bool:
        """May there be something to go back to?"""
        return self._depth > 0

    def join(self, show: Callable[[Ready], None] = unseen) -> Member:
        """A place for one more solver, ``show`` is told what is seen of it. Until it has caught up, the others wait."""
        with self._changed:
            self._drop()
            self._see(self._turn)  # it will have gone through that, too
            member = Member(self._past, self._turn, show)
            self._members.append(member)
            self._changed.notify_all()
            return member

    def stop(self, member: Member) -> None:
        """Let a solver end."""
        with self._changed:
            self._drop()
            member.stopping = True
            self._changed.notify_all()

    # What the solvers' threads call.

    def next_turn(
        self, member: Member, *, wants: bool, advanced: bool
    ) -> Turn | Literal[Word.BACK] | None:
        """Wait for the next turn, or for the word to go back; None when it is time to end.

        ``wants``: would the solver go on by itself? ``advanced``: has it finished an increment since the last call?
        """
        with self._changed:
            self._advanced |= advanced and not member.back
            while (turn := self._poll(member, wants)) is Word.NOTHING:
                pause = self._begin()
                if pause > 0.0:
                    self._changed.wait(None if math.isinf(pause) else pause)
            return turn

    def turn_now(self, member: Member, *, wants: bool, advanced: bool) -> Turn | Word | None:
        """The same without waiting."""
        with self._changed:
            self._advanced |= advanced and not member.back
            turn = self._poll(member, wants)
            if turn is not Word.NOTHING or self._begin() > 0.0:
                return turn
            return self._poll(member, wants)

    def deliver(self, member: Member, ready: Ready) -> None:
        """What a turn has come to: seen at once, or when its picture is due."""
        with self._changed:
            if not member.back:
                member.ready.append(ready)
                member.show(self._shown)

    def may_be_seen(self, member: Member) -> bool:
        """May a picture of the increment under way be shown? Then it counts as seen."""
        with self._changed:
            if member.back or (self._ahead > 0 and member.turn > self._shown):
                return False
            self._see(max(self._shown, member.turn))
            return True

    def gone_back(self, member: Member) -> None:
        """A solver stands where it was told to go back to."""
        with self._changed:
            member.back = False

    def leave(self, member: Member) -> None:
        """A solver has ended; the others go on without it."""
        with self._changed:
            if member in self._members:
                self._members.remove(member)
            self._changed.notify_all()

    def _poll(self, member: Member, wants: bool) -> Turn | Word | None:
        """What a solver is to do now, if anything."""
        if member.stopping:
            return None
        if member.back:
            return Word.BACK
        if member.missed:
            return member.missed.popleft()
        if member.turn == self._turn:
            member.waiting, member.wants = True, wants
            return Word.NOTHING
        member.turn = self._turn
        return self._commands

    @property
    def _at_rest(self) -> bool:
        """Has every solver ended its turn?"""
        return all(member.waiting or member.stopping for member in self._members)

    @property
    def _ahead(self) -> int:
        """How many turns that nobody has seen yet have been ended by all."""
        return len(self._unseen) - (0 if self._at_rest else min(len(self._unseen), 1))

    def _begin(self) -> float:
        """Begin a turn, if one is due: 0. Otherwise how long to wait at least [s]."""
        if not self._at_rest:
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
        seen = self._seen_from_the_start()
        if seen:
            self._see(self._turn)  # what was at work when a command came
        elif self._ahead >= self._depth:
            return math.inf
        now = time.perf_counter()
        if now < self._due and not at_once and not self._steps:
            return self._due - now
        late = now - self._due  # made up for, as long as it is not a whole turn
        self._due = (self._due if late < self._pause else now) + self._pause
        self._commands, self._mail = tuple(self._mail), []
        self._remember(self._commands)
        self._turn += 1
        self._unseen.append(self._commands)
        if seen:
            self._see(self._turn)
        for member in self._members:
            member.waiting = False
        self._changed.notify_all()
        return 0.0

    def _seen_from_the_start(self) -> bool:
        """Does the turn that begins now count as seen, and is never dropped?"""
        alone = self._depth == 0 or self._pause > 0.0 or self._paused
        return alone or not all(isinstance(command, Move) for command in self._mail)

    def _see(self, turn: int) -> None:
        """All turns up to that one are seen from now on."""
        del self._unseen[: turn - self._shown]
        self._shown = turn
        for member in self._members:
            member.show(turn)

    def _drop(self) -> None:
        """What is ready, and the turn under way, have never been; what they were asked for comes again."""
        if self._ahead == 0:
            return
        again = [command for turn in self._unseen for command in turn]
        del self._past[max(len(self._past) - len(self._unseen), 0) :]
        self._unseen.clear()
        self._turn = self._shown
        for member in self._members:
            if member.turn > self._turn:
                member.turn, member.waiting, member.back = self._turn, False, True
                member.ready.clear()
        self._advanced = False
        again, self._mail = [*again, *self._mail], []
        for command in again:
            self._post(command)

    def _post(self, command: Command) -> None:
        if self._mail and self._replaces(command, self._mail[-1]):
            self._mail[-1] = command
        else:
            self._mail.append(command)

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

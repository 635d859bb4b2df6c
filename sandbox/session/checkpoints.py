"""States of a run to go back to: one after every increment, thinned the more, the longer ago it was.

How many stay depends on how many increments there were and how large they are, never on the clock, so that a replay of a
log keeps the same ones.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass, replace

import numpy as np

from core.engine_state import EngineState
from core.observables import GrainContacts, RigidContacts
from core.quasistatic import Increment
from sandbox.session.course import Course
from sandbox.session.history import History, Row
from scenes.scene import Values

DENSE = 600  # of the latest increments each is kept, of 600 more every second, of 1200 more every fourth …
MOST_BYTES = 150_000_000
OVERHEAD = 4_000  # bytes of a checkpoint beside its arrays, about

# The contacts follow from the state.
NO_PAIRS = GrainContacts(*(np.zeros(0, dtype=np.int64),) * 2, *(np.zeros(0),) * 6)
NO_BODIES = RigidContacts(*(np.zeros(0, dtype=np.int64),) * 2, *(np.zeros(0),) * 8)


@dataclass(frozen=True)
class Checkpoint:
    """All that a run needs to go on from after an increment. Nothing in it is ever written to."""

    engine: EngineState
    course: Course
    last: Increment  # bare
    history: History  # of which the first ``length`` rows belong to it
    length: int
    settings: Values
    before_edit: Checkpoint | None = (
        None  # while an edit is not relaxed yet: to go back if it was too tight
    )

    @property
    def increment(self) -> int:
        """The row of the history after which it was made."""
        return self.length - 1

    @property
    def row(self) -> Row:
        """The row of the increment after which it was made: no other branch of a history has the same object."""
        return self.history[self.length - 1]

    @property
    def size(self) -> int:
        """Bytes, about."""
        return self.engine.size + self.last.unbalanced.nbytes + OVERHEAD


class Checkpoints:
    """The checkpoints of one run along one course of events: its past, and after a recall its future too."""

    def __init__(self, dense: int = DENSE, most_bytes: int = MOST_BYTES) -> None:
        self._dense = dense
        self._most_bytes = most_bytes
        self._kept: list[Checkpoint] = []
        self._increments: list[int] = []
        self.size = 0  # bytes, about

    def __len__(self) -> int:
        return len(self._kept)

    def copy(self) -> Checkpoints:
        """The same checkpoints in a list of its own."""
        twin = Checkpoints(self._dense, self._most_bytes)
        twin._kept, twin._increments = self._kept.copy(), self._increments.copy()
        twin.size = self.size
        return twin

    @property
    def first(self) -> int:
        """The earliest increment that can be recalled."""
        return self._increments[0]

    @property
    def last(self) -> int:
        """The latest one."""
        return self._increments[-1]

    @property
    def increments(self) -> tuple[int, ...]:
        """All that can be recalled."""
        return tuple(self._increments)

    def future(self, length: int) -> History | None:
        """The history that goes on after so many rows, if later increments are kept."""
        newest = self._kept[-1]
        return newest.history if newest.length > length else None

    def at(self, increment: int) -> Checkpoint:
        """The checkpoint after that increment, or the nearest before it, or else the first."""
        return self._kept[max(bisect_right(self._increments, increment) - 1, 0)]

    def add(self, new: Checkpoint) -> None:
        """Keep the newest state. What was kept of its future is gone: it comes otherwise now."""
        self._cut(bisect_left(self._increments, new.increment))
        self._put(len(self._kept), new)
        age = self._dense
        while age < new.increment:
            self._drop_if_old(new.increment - age, new.increment)
            age *= 2
        while self.size > self._most_bytes and self._dense > 1:
            self._dense //= 2
            self._thin()

    def travel(self, to: Checkpoint) -> None:
        """``to`` is where the run stands now: what lies neither before nor after it on one course of events is forgotten."""
        self._replace([kept for kept in self._kept if _on_one_course(kept, to)])
        place = bisect_left(self._increments, to.increment)
        if place == len(self._kept) or self._increments[place] != to.increment:
            self._put(place, to)

    def squeeze(self, most_bytes: int) -> None:
        """Thin until what is left takes no more than so many bytes; what comes later is kept as densely as ever."""
        dense = self._dense
        while self.size > most_bytes and self._dense > 1:
            self._dense //= 2
            self._thin()
        self._dense = dense

    def forget_most(self) -> None:
        """For a run that nobody will go back in: keep no more than a handful from now on."""
        self._dense = 1
        self._thin()

    def _put(self, place: int, new: Checkpoint) -> None:
        self._kept.insert(place, new)
        self._increments.insert(place, new.increment)
        self.size += new.size

    def _cut(self, place: int) -> None:
        if place < len(self._kept):
            self._replace(self._kept[:place])

    def _replace(self, kept: list[Checkpoint]) -> None:
        if len(kept) != len(self._kept):
            self._kept = kept
            self._increments = [one.increment for one in kept]
            self.size = sum(one.size for one in kept)

    def _thin(self) -> None:
        newest = self.last
        self._replace([one for one in self._kept if not self._old(one.increment, newest)])

    def _drop_if_old(self, increment: int, newest: int) -> None:
        place = bisect_left(self._increments, increment)
        there = place < len(self._kept) and self._increments[place] == increment
        if there and self._old(increment, newest):
            self.size -= self._kept.pop(place).size
            del self._increments[place]

    def _old(self, increment: int, newest: int) -> bool:
        """Not to be kept: of increments as long ago only every second, fourth, … is."""
        return increment % (1 << ((newest - increment) // self._dense).bit_length()) != 0


def bare(increment: Increment) -> Increment:
    """The increment without its contacts, which follow from the state, and their frictional forces: most of its bytes."""
    return replace(increment, grain_contacts=NO_PAIRS, body_contacts=NO_BODIES, friction=None)


def _on_one_course(one: Checkpoint, other: Checkpoint) -> bool:
    """True if the later of the two has the earlier one's row in its past."""
    early, late = sorted((one, other), key=lambda kept: kept.length)
    return late.history[early.length - 1] is early.row

"""What is kept of a run while it goes on: of one packing, or of several side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from sandbox.player.kept import Kept, keep
from sandbox.session.frame import Frame

MOST_MOMENTS = 800
MOST_GRAINS = 240_000  # grains times moments: some 12 MB of memory, and 1.5 MB of page

Moment = tuple[Kept, ...]  # side by side
T = TypeVar("T")


class Tape:
    """Grows with the run; beyond its budget it keeps every second moment only, then every fourth, and the last one always.

    A run that goes back, by undo, reset or a look at an earlier increment, goes on from there: what came later is forgotten.
    """

    def __init__(
        self, every: int = 1, most_moments: int = MOST_MOMENTS, most_grains: int = MOST_GRAINS
    ) -> None:
        self._asked, self._most = every, (most_moments, most_grains)
        self._kept: list[Moment] = []
        self._latest: Moment | None = None
        self.every = every  # increments from one moment to the next, at least
        self.last: tuple[Frame, ...] = ()  # what was added last

    def add(self, frames: Sequence[Frame]) -> None:
        """The state at the start, or after an increment: a frame of each packing, always in the same order."""
        moment = tuple(keep(frame) for frame in frames)
        now = increment_of(moment)
        while self._kept and increment_of(self._kept[-1]) >= now:
            self._kept.pop()
        if not self._kept:
            self.every = self._asked
        self.last, self._latest = tuple(frames), moment
        if not self._kept or now - increment_of(self._kept[-1]) >= self.every:
            self._kept.append(moment)
        grains = sum(frame.grains for frame in frames)
        most = max(min(self._most[0], self._most[1] // max(grains, 1)), 2)
        while len(self._kept) > most:
            self.every *= 2
            self._kept = spaced(self._kept, self.every, increment_of)

    @property
    def moments(self) -> list[Moment]:
        """All that is kept, in order; the latest is always there."""
        latest = [self._latest] if self._latest is not None else []
        return self._kept if latest == self._kept[-1:] else self._kept + latest

    @property
    def increments(self) -> int:
        """How many there were."""
        return 0 if self._latest is None else increment_of(self._latest)


def spaced(moments: Sequence[T], every: int, increment: Callable[[T], int]) -> list[T]:
    """The first one, and of the others those that come so many increments after the one before, or more."""
    kept: list[T] = []
    for moment in moments:
        if not kept or increment(moment) - increment(kept[-1]) >= every:
            kept.append(moment)
    return kept


def increment_of(moment: Sequence[Kept | Frame]) -> int:
    """Where the packing stands that has come furthest."""
    return max(kept.increment for kept in moment)

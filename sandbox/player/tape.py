"""What is kept of a run while it goes on: of one packing, or of several side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, TypeVar

from sandbox.player.kept import Kept, keep
from sandbox.session.frame import Frame

MOST_MOMENTS = 800
MOST_GRAINS = 240_000  # grains times moments: some 12 MB of memory, and 1.5 MB of page

Moment = tuple[Kept, ...]  # side by side
M = TypeVar("M", bound=Sequence[Kept] | Sequence[Frame])


class Thinning(Generic[M]):
    """Grows with the run; beyond its budget it keeps every second moment only, then every fourth, and the last one always.

    A run that goes back, by undo, reset or a look at an earlier increment, goes on from there: what came later is forgotten.
    """

    def __init__(self, most_moments: int, most_grains: int, every: int = 1) -> None:
        self._asked, self._most = every, (most_moments, most_grains)
        self._kept: list[M] = []
        self._latest: M | None = None
        self.every = every  # increments from one moment to the next, at least

    def add(self, moment: M, grains: int) -> None:
        """The state at the start, or after an increment, of so many grains."""
        now = increment_of(moment)
        while self._kept and increment_of(self._kept[-1]) >= now:
            self._kept.pop()
        if not self._kept:
            self.every = self._asked
        self._latest = moment
        self._keep(moment)
        most = max(min(self._most[0], self._most[1] // max(grains, 1)), 2)
        while len(self._kept) > most:
            self.every *= 2
            before, self._kept = self._kept, []
            for each in before:
                self._keep(each)

    def _keep(self, moment: M) -> None:
        """If it comes as many increments after the one before as it should, or more."""
        if not self._kept or increment_of(moment) - increment_of(self._kept[-1]) >= self.every:
            self._kept.append(moment)

    def clear(self) -> None:
        """Another run begins."""
        self._kept, self._latest = [], None

    @property
    def moments(self) -> list[M]:
        """All that is kept, in order; the latest is always there."""
        if self._latest is None or self._kept[-1] is self._latest:
            return self._kept
        return [*self._kept, self._latest]


class Tape:
    """What a page is made from."""

    def __init__(
        self, every: int = 1, most_moments: int = MOST_MOMENTS, most_grains: int = MOST_GRAINS
    ) -> None:
        self._thinning = Thinning[Moment](most_moments, most_grains, every)
        self.last: tuple[Frame, ...] = ()  # what was added last

    def add(self, frames: Sequence[Frame]) -> None:
        """The state at the start, or after an increment: a frame of each packing, always in the same order."""
        self.last = tuple(frames)
        moment = tuple(keep(frame) for frame in frames)
        self._thinning.add(moment, sum(frame.grains for frame in frames))

    @property
    def every(self) -> int:
        """Increments from one moment to the next, at least."""
        return self._thinning.every

    @property
    def moments(self) -> list[Moment]:
        """All that is kept, in order; the latest is always there."""
        return self._thinning.moments

    @property
    def increments(self) -> int:
        """How many there were."""
        return increment_of(self.last) if self.last else 0


def increment_of(moment: Sequence[Kept] | Sequence[Frame]) -> int:
    """Where the packing stands that has come furthest."""
    return max(kept.increment for kept in moment)

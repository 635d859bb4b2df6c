"""What happened, increment by increment."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np


@dataclass(frozen=True)
class Row:
    """One finished increment. Forces are those of the grains on the handle."""

    increment: int
    stroke: float  # [R], or what the scene plots instead
    fx: float  # [k R]
    fy: float  # [k R]
    grains_out: int
    energy: float  # [k R²]
    residual: float  # relative
    iterations: int
    stop_reason: str
    resisting: float  # force against the drive [k R], from fx, fy and the direction of motion; or what the scene plots instead
    # How far off the force on the handle is, estimated [k R]: usually no further than the first, nine times of ten the second.
    # See ``scenes.accuracy``.
    usual_error: float = math.nan
    force_error: float = math.nan
    hand_strength: float = 0.0  # the most that the hand could give [k R], as it is set
    beyond_cone: float = 0.0  # share of contacts that pull harder than friction allows
    # Forces of the grains on each of ``Setup.solids``, x and y by turns, and on all walls that a person has drawn [k R].
    on_solids: tuple[float, ...] = ()
    on_drawn_x: float = 0.0
    on_drawn_y: float = 0.0

    @property
    def magnitude(self) -> float:
        """Of the force on the handle [k R]; where the handle is a periodic cell, of what the scene plots."""
        return math.hypot(self.fx, self.fy) or abs(self.resisting)


EventKind = Literal["locked", "clog", "arch", "avalanche"]


@dataclass(frozen=True)
class Event:
    """Something that a scene announces once, when it begins."""

    kind: EventKind
    increment: int  # the row of the history that it happened in
    stroke: float  # of that row [R], or what the scene plots instead
    force: float  # against the drive, of that row [k R], or what the scene plots instead
    text: str  # plain words


class History:
    """Rows of all increments since the last reset."""

    def __init__(self) -> None:
        self._rows: list[Row] = []
        self._curve = np.empty((3, 256))  # stroke, force, sum of all magnitudes so far
        self.events: tuple[Event, ...] = ()  # the newest last

    @classmethod
    def of(cls, rows: Iterable[Row], events: tuple[Event, ...]) -> History:
        """One with these rows and these events."""
        history = cls()
        for row in rows:
            history.append(row)
        history.events = events
        return history

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, index: int) -> Row:
        return self._rows[index]

    def append(self, row: Row) -> None:
        """Add a finished increment."""
        count = len(self._rows)
        if count == self._curve.shape[1]:
            self._curve = np.concatenate([self._curve, np.empty_like(self._curve)], axis=1)
        total = (self._curve[2, count - 1] if count else 0.0) + row.magnitude
        self._curve[:, count] = row.stroke, row.resisting, total
        self._rows.append(row)

    def announce(self, event: Event) -> None:
        """Add an event."""
        self.events = (*self.events, event)

    def upto(self, length: int) -> History:
        """The history as it was with so many rows, to go on from there; itself if there are no more."""
        return self if length == len(self._rows) else self.first(length)

    def first(self, length: int) -> History:
        """So many rows, which stay as they are whatever becomes of the run: another thread may read them."""
        early = History()
        early._rows = self._rows[:length]
        early._curve = self._curve[:, : max(length, 256)].copy()
        early.events = tuple(event for event in self.events if event.increment < length)
        return early

    def cut(self, length: int, events: tuple[Event, ...]) -> None:
        """Be as it was with so many rows and these events. Nobody may have looked at later rows, as others take their place."""
        del self._rows[length:]
        self.events = events

    @property
    def curve(self) -> np.ndarray:
        """Stroke [R] and force against the drive [k R], (2, M): a view of rows that never change again."""
        return self._curve[:2, : len(self._rows)]

    @property
    def mean_magnitude(self) -> float:
        """Mean magnitude of the force on the handle so far [k R]; 0 of nothing."""
        count = len(self._rows)
        return float(self._curve[2, count - 1]) / count if count else 0.0

    def rows(self, begin: int = 0) -> Iterator[Row]:
        """One an increment, from that one on."""
        return itertools.islice(self._rows, begin, None)

    @property
    def drawn_upon(self) -> bool:
        """True if grains have pushed at a wall that a person has drawn."""
        return any(row.on_drawn_x or row.on_drawn_y for row in self._rows)

    def column(self, name: str) -> np.ndarray:
        """One column, by the attribute's name in ``Row``: (M,), of ``on_solids`` (M, 2 B)."""
        values = [getattr(row, name) for row in self._rows]
        if name != "on_solids":
            return np.array(values)
        unknown = (math.nan,) * max(map(len, values), default=0)
        return np.array([value or unknown for value in values], dtype=np.float64)

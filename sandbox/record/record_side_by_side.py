"""Several packings under one drive, without a window: in step by increment, in one film and one table."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from sandbox.record.record import SLICE, Outcome, Output, build_bar, run
from sandbox.session.commands import Protocol

if TYPE_CHECKING:
    from sandbox.session.session import Session


def record_side_by_side(sessions: Sequence[Session], steps: int, output: Output) -> Outcome:
    """Build all sessions, run their scripted drives for ``steps`` increments, write the output.

    Each packing relaxes every increment to the end before any begins the next; one that is done waits. So the result does
    not depend on how fast the machine is. Ctrl-C ends the run early; everything done until then is written.
    """
    for session in sessions:
        with build_bar() as progress:
            session.build(progress)
        session.submit(Protocol(True))
    return run(sessions, in_step(sessions), steps, output)


def in_step(sessions: Sequence[Session]) -> Iterator[bool]:
    """One increment of every session that has something to do, at the same time; True for each round, until all are done."""
    with ThreadPoolExecutor(min(len(sessions), os.cpu_count() or 1)) as pool:
        while any(list(pool.map(_increment, sessions))):
            yield True


def _increment(session: Session) -> bool:
    """Finish an increment; False if there was nothing to do."""
    while not session.advance(SLICE):
        if session.idle:
            return False
    return True


class SideBySide:
    """The tables of several packings as one, with a column that says which."""

    def __init__(self, sessions: Sequence[Session]) -> None:
        self._sessions = sessions

    def header(self) -> list[str]:
        """As that of one, after the packing."""
        return ["packing", *self._sessions[0].history.header()]

    def rows(self) -> Iterator[tuple[object, ...]]:
        """Packing after packing."""
        for session in self._sessions:
            for row in session.history.rows():
                yield (session.packing, *row)

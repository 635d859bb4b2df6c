"""A log run again: the same commands after the same increments, hence the same state bits."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from core.errors import InputError
from sandbox.session.log import Log
from sandbox.session.session import Session, Tell


def session_of(log: Log) -> Session:
    """The session that a log began with. Raises InputError if there is none such."""
    if log.start is not None:
        return Session.from_file(log.start)
    return Session(log.scene, log.packing, log.seed, log.settings)


def replay(
    log: Log, progress: Tell | None = None, slice_iterations: int = 400
) -> Iterator[Session]:
    """Yield the session built, then again after each increment.

    Raises InputError if the log does not fit the scene.
    """
    session = session_of(log)
    session.build(progress)
    yield session
    for finished in repeated(log, session, slice_iterations):
        if finished:
            yield session


def repeated(log: Log, session: Session, slice_iterations: int) -> Iterator[bool]:
    """Command after command and slice after slice, so that Ctrl-C is heard between them; True where an increment was finished.

    Raises InputError if the log does not fit the scene.
    """
    waiting = deque(log.commands)
    work = session.slices(slice_iterations)
    while True:
        while waiting and waiting[0][0] == session.finished:
            session.submit(waiting.popleft()[1])
            session.settle()
            yield False
        if session.finished >= log.end:
            return
        finished = next(work, None)
        if finished is None:
            raise InputError(
                f"the log does not fit this program: nothing moves after increment {session.finished} of {log.end}"
            )
        yield finished

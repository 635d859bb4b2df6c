"""The solver in a thread of its own, so that the window never waits for it.

The thread owns the session: nobody else touches it while the thread lives. Commands go in through a
mailbox; a :class:`Snapshot` comes out by swapping one reference, which is atomic in Python. The
kernels release the interpreter's lock, so the window draws while they run.
"""

from __future__ import annotations

import contextlib
import logging
import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, Protocol

from core.errors import InputError
from sandbox.commands import Change, Command, Move, Reset
from sandbox.frame import Frame

log = logging.getLogger(__name__)

SLICE = 200  # iterations of the minimiser between two looks at the mailbox
PICTURE = 1.0 / 90.0  # pictures of an unfinished increment are taken no more often than this [s]

Progress = Callable[[str, float], None]
Phase = Literal["building", "running", "failed", "stopped"]


class SessionLike(Protocol):
    """What the thread asks of a session."""

    def build(self, progress: Progress | None = None) -> None:
        """Compile and pack."""

    def submit(self, command: Command) -> None:
        """Take a command for the start of the next increment."""

    def advance(self, max_iterations: int = 200) -> bool:
        """A slice of work; True when it finished an increment."""

    @property
    def idle(self) -> bool:
        """Is there nothing to do?"""

    @property
    def busy(self) -> bool:
        """Is an increment being relaxed?"""

    def frame(self) -> Frame:
        """A picture of the state."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What the window may know of the solver at one moment."""

    phase: Phase
    text: str = ""  # what is being built
    fraction: float = math.nan  # how much of that is done, 0 to 1; nan: nobody knows
    frame: Frame | None = None  # the latest picture; kept through a rebuild and a failure
    error: str = ""  # plain words, when failed
    serial: int = 0  # counts publications


class _Stopped(Exception):
    """Unwinds a build when the window is being closed."""


class SolverThread:
    """Runs a session until stopped."""

    def __init__(self, session: SessionLike, *, paused: bool = False) -> None:
        self._session = session
        self._mail: list[Command] = []
        self._paused = paused
        self._steps = 0
        self._stop = False
        self._changed = threading.Condition()
        self._snapshot = Snapshot("building")
        self._pictured = 0.0
        self._patience = 0.0  # with the increment at work when it is time to end [s]
        # A daemon, because a compilation cannot be broken off: the process may end without it.
        self._thread = threading.Thread(target=self._run, name="solver", daemon=True)

    # What the window calls. None of it waits.

    def start(self) -> None:
        """Begin to build."""
        self._thread.start()

    @property
    def snapshot(self) -> Snapshot:
        """The latest state."""
        return self._snapshot

    @property
    def paused(self) -> bool:
        """Is the solver held?"""
        return self._paused

    def submit(self, command: Command) -> None:
        """Send a command. Of moves that nothing has come between only the latest counts."""
        with self._changed:
            last = self._mail[-1] if self._mail else None
            if (
                isinstance(command, Move)
                and isinstance(last, Move)
                and command.handle == last.handle
            ):
                self._mail[-1] = command
            else:
                self._mail.append(command)
            self._changed.notify()

    def pause(self, on: bool) -> None:
        """Hold after the increment at work, or go on."""
        with self._changed:
            self._paused = on
            self._steps = 0
            self._changed.notify()

    def step(self) -> None:
        """Hold, but do one more increment."""
        with self._changed:
            self._paused = True
            self._steps += 1
            self._changed.notify()

    def stop(self, timeout: float = 5.0) -> bool:
        """End the thread; True when it has ended, after which its session may be used."""
        with self._changed:
            self._stop = True
            self._patience = 0.8 * timeout
            self._changed.notify()
        if self._thread.is_alive():
            self._thread.join(timeout)
        return not self._thread.is_alive()

    # What the thread does.

    def _run(self) -> None:
        try:
            self._session.build(self._report)
            self._publish("running")
            while self._wait():
                self._work()
            self._finish()
        except _Stopped:
            pass
        except InputError as error:
            self._fail(str(error))
        except Exception as error:
            log.exception("the solver stopped")
            self._fail(f"{type(error).__name__}: {error}" if str(error) else type(error).__name__)
        else:
            self._publish("stopped")

    def _report(self, text: str, fraction: float) -> None:
        """Progress of a build; also the place where a build can be broken off."""
        if self._stop:
            raise _Stopped
        now = self._snapshot
        self._snapshot = Snapshot("building", text, fraction, now.frame, "", now.serial + 1)

    def _fail(self, message: str) -> None:
        with contextlib.suppress(Exception):  # the last state helps to understand, if there is one
            self._publish("failed")
        now = self._snapshot
        self._snapshot = replace(now, phase="failed", error=message, serial=now.serial + 1)

    def _publish(self, phase: Phase) -> None:
        frame = self._session.frame()
        self._snapshot = Snapshot(phase, frame=frame, serial=self._snapshot.serial + 1)
        self._pictured = time.perf_counter()

    def _wait(self) -> bool:
        """Sleep until there is something to do; False when it is time to end."""
        with self._changed:
            while not (self._stop or self._due()):
                self._changed.wait()
            return not self._stop

    def _finish(self) -> None:
        """Bring the increment at work to its end: a log ends between increments."""
        end = time.perf_counter() + self._patience
        while self._session.busy and time.perf_counter() < end:
            self._session.advance(SLICE)

    def _due(self) -> bool:
        if self._session.busy or any(
            isinstance(command, (Reset, Change)) for command in self._mail
        ):
            return True
        if self._paused and not self._steps:
            return False
        if not self._mail and self._session.idle:
            self._steps = 0  # a step with nothing to do is done
            return False
        return True

    def _work(self) -> None:
        """Deliver the mail and do a slice of work."""
        with self._changed:
            mail, self._mail = self._mail, []
        for command in mail:
            if isinstance(command, Change):
                self._report("", math.nan)  # it is built anew, which takes a moment
            self._session.submit(command)
        finished = self._session.advance(SLICE)
        if finished:
            with self._changed:
                self._steps = max(self._steps - 1, 0)
        if not self._session.busy or time.perf_counter() - self._pictured >= PICTURE:
            self._publish("running")

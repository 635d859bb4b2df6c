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
from sandbox.session.beginning import Made
from sandbox.session.commands import Command
from sandbox.session.frame import Frame
from sandbox.session.log import Log
from sandbox.session.session import Tell
from sandbox.window.solvers.conductor import Conductor, Turn
from scenes.text import message

log = logging.getLogger(__name__)

SLICE = 200  # iterations of the minimiser between two looks at whether to end
CANCELLED = "cancelled: everything is as it was before"
PICTURE = 1.0 / 90.0  # pictures of an unfinished increment are taken no more often than this [s]

Phase = Literal["building", "catching up", "running", "failed", "stopped"]


class SessionLike(Protocol):
    """What the thread asks of a session."""

    def build(self, progress: Tell | None = None) -> None:
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

    def made(self) -> Made | None:
        """What there is to be kept in a file."""

    def log(self) -> Log:
        """What was done so far, between two increments."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What the window may know of the solver at one moment."""

    phase: Phase
    text: str = ""  # what is being built
    fraction: float = math.nan  # how much of that is done, or caught up, 0 to 1; nan: nobody knows
    frame: Frame | None = None  # the latest picture; kept through a rebuild and a failure
    error: str = ""  # plain words, when failed
    serial: int = 0  # counts publications
    made: Made | None = None  # what there is to be kept in a file
    ending: bool = False  # the build is broken off as soon as what is being compiled is compiled


class _Stopped(Exception):
    """Unwinds a build when the window is being closed."""


class SolverThread:
    """Runs a session until stopped, alone or in step with others."""

    def __init__(
        self,
        session: SessionLike,
        conductor: Conductor,
        keep_log: Callable[[Log], None] | None = None,
    ) -> None:
        """``keep_log`` is handed what was done after each turn."""
        self._session = session
        self._keep_log = keep_log
        self.conductor = conductor
        self._member = self.conductor.join()
        self._built = False
        self._cancel = False
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
        seen = self._snapshot
        return replace(seen, ending=True) if self._cancel and seen.phase == "building" else seen

    def cancel(self) -> None:
        """Break a build off: the first ends the thread, a later one leaves everything as it was."""
        self._cancel = True

    def stop(self, timeout: float = 5.0) -> bool:
        """End the thread; True when it has ended, after which its session may be used."""
        self._patience = 0.8 * timeout
        self.conductor.stop(self._member)
        if self._thread.is_alive():
            self._thread.join(timeout)
        else:
            self.conductor.leave(self._member)
        return not self._thread.is_alive()

    # What the thread does.

    def _run(self) -> None:
        try:
            self._build()
            advanced = False
            self._tell_log()
            while (turn := self._next_turn(advanced)) is not None:
                advanced = self._work(turn)
                self._tell_log()
            self._finish()
        except _Stopped:
            now = self._snapshot
            self._snapshot = replace(now, phase="stopped", serial=now.serial + 1)
        except InputError as error:
            self._fail(message(error))
        except Exception as error:
            log.exception("the solver stopped")
            self._fail(f"{type(error).__name__}: {error}" if str(error) else type(error).__name__)
        else:
            self._publish("stopped")
        finally:
            self.conductor.leave(self._member)

    def _build(self) -> None:
        self._session.build(self._report)
        self._built = True
        self._publish()

    def _report(self, text: str, fraction: float) -> None:
        """Progress of a build; also the place where a build can be broken off."""
        if self._member.stopping or (self._cancel and not self._built):
            raise _Stopped
        if self._cancel:
            self._cancel = False
            raise InputError(CANCELLED)
        now = self._snapshot
        self._snapshot = replace(
            now, phase="building", text=text, fraction=fraction, error="", serial=now.serial + 1
        )

    def _fail(self, message: str) -> None:
        with contextlib.suppress(Exception):  # the last state helps to understand, if there is one
            self._publish("failed")
        now = self._snapshot
        self._snapshot = replace(now, phase="failed", error=message, serial=now.serial + 1)

    def _publish(self, phase: Phase | None = None) -> None:
        """A picture of the state; without a phase: running, or catching up with the others."""
        share = self._member.caught_up
        if phase is None:
            phase = "running" if share == 1.0 else "catching up"
        frame, made = self._session.frame(), self._session.made()
        serial = self._snapshot.serial + 1
        self._snapshot = Snapshot(phase, "", share, frame, serial=serial, made=made)
        self._pictured = time.perf_counter()

    def _next_turn(self, advanced: bool) -> Turn | None:
        """Sleep until there is something to do; None when it is time to end."""
        wants = not self._session.idle
        return self.conductor.next_turn(self._member, wants=wants, advanced=advanced)

    def _work(self, turn: Turn) -> bool:
        """Deliver the commands and relax one increment, if there is one; True if it was finished."""
        self._cancel = False
        for command in turn:
            self._session.submit(command)
        finished = self._advance()
        while self._session.busy and not self._member.stopping:
            if time.perf_counter() - self._pictured >= PICTURE:
                self._publish()
            finished = self._advance()
        if not self._member.missed or time.perf_counter() - self._pictured >= PICTURE:
            self._publish()
        return finished

    def _advance(self) -> bool:
        """A slice of work, when a core is free for it."""
        with self.conductor.core:
            return self._session.advance(SLICE)

    def _tell_log(self) -> None:
        if self._keep_log is not None and not self._session.busy:
            self._keep_log(self._session.log())

    def _finish(self) -> None:
        """Bring the increment at work to its end: a log ends between increments."""
        end = time.perf_counter() + self._patience
        while self._session.busy and time.perf_counter() < end:
            self._session.advance(SLICE)

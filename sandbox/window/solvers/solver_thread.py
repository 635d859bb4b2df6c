"""The solver in a thread of its own, so that the window never waits for it.

The thread owns the session: nobody else touches it while the thread lives. Commands go in through a
mailbox; a :class:`Snapshot` comes out by swapping one reference, which is atomic in Python. The
kernels release the interpreter's lock, so the window draws while they run.
"""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Literal, Protocol

from core.errors import InputError
from sandbox.session.beginning import Made
from sandbox.session.commands import Command
from sandbox.session.frame import Frame
from sandbox.session.log import Log
from sandbox.session.mark import Mark
from sandbox.session.session import Tell
from sandbox.window.solvers.ahead import Ready
from sandbox.window.solvers.conductor import Conductor, Turn, Word
from sandbox.window.solvers.snapshot import Phase, Snapshot
from scenes.text import message

log = logging.getLogger(__name__)

SLICE = 200  # iterations of the minimiser between two looks at the world, at least
LONGEST_SLICE = 4000
LOOK = 8e-3  # [s] more of them where they take less: to take the interpreter's lock again may mean to wait for the window
CANCELLED = "cancelled: everything is as it was before"
PICTURE = 1.0 / 90.0  # pictures of an unfinished increment are taken no more often than this [s]


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

    def mark(self) -> Mark:
        """A place to come back to, between two increments."""

    def go_back(self, mark: Mark) -> None:
        """Be as at that mark, even from within an increment."""


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
        """``keep_log`` is handed what was done, up to what is seen."""
        self._session = session
        self._keep_log = keep_log
        self.conductor = conductor
        self._member = self.conductor.join(self._see)
        self._built = False
        self._cancel = False
        self._snapshot = Snapshot("building")
        self._pictured = 0.0
        self._advanced = False  # has the latest turn finished an increment?
        self._slice = SLICE
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
            while (turn := self._next_turn()) is not None:
                for _ in self._work(turn):
                    pass
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
        self._deliver()

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
        self.conductor.leave(self._member)  # nothing that is ready is shown over it
        with contextlib.suppress(Exception):  # the last state helps to understand, if there is one
            self._publish("failed")
        now = self._snapshot
        self._snapshot = replace(now, phase="failed", error=message, serial=now.serial + 1)

    def _publish(self, phase: Phase | None = None) -> None:
        """A picture of the state is seen from now on."""
        seen = self._picture(phase)
        self._snapshot = replace(seen, serial=self._snapshot.serial + 1)

    def _picture(self, phase: Phase | None = None) -> Snapshot:
        """A picture of the state; without a phase: running, or catching up with the others."""
        share = self._member.caught_up
        if phase is None:
            phase = "running" if share == 1.0 else "catching up"
        self._pictured = time.perf_counter()
        return Snapshot(phase, "", share, self._session.frame(), made=self._session.made())

    def _see(self, ready: Ready) -> None:
        """What was ready is seen from now on: the conductor says when, in whatever thread."""
        self._snapshot = replace(ready.snapshot, serial=self._snapshot.serial + 1)
        if self._keep_log is not None and ready.log is not None:
            self._keep_log(ready.log)

    def _deliver(self) -> None:
        """What the turn has come to."""
        session = self._session
        picture = self._picture()
        log = None if self._keep_log is None else session.log()
        mark = session.mark() if self.conductor.works_ahead else None
        self.conductor.deliver(self._member, Ready(self._member.turn, picture, log, mark))

    def _next_turn(self) -> Turn | Literal[Word.BACK] | None:
        """Sleep until there is something to do; None when it is time to end."""
        advanced, self._advanced = self._advanced, False
        wants = not self._session.idle
        return self.conductor.next_turn(self._member, wants=wants, advanced=advanced)

    def _work(self, turn: Turn | Literal[Word.BACK]) -> Iterator[None]:
        """Deliver the commands and relax one increment, if there is one, slice by slice; or go back to what is seen."""
        if turn is Word.BACK:
            self._go_back()
            return
        self._cancel = False
        for command in turn:
            self._session.submit(command)
        finished = self._advance()
        while self._session.busy and not self._member.stopping and not self._member.back:
            yield
            if time.perf_counter() - self._pictured >= PICTURE and self._may_be_seen():
                self._publish()
            finished = self._advance()
        due = not self._member.missed or time.perf_counter() - self._pictured >= PICTURE
        if due and not self._session.busy:
            self._deliver()
        self._advanced = finished

    def _may_be_seen(self) -> bool:
        return self.conductor.may_be_seen(self._member)

    def _go_back(self) -> None:
        """To what is seen: what was made ahead of it has never been."""
        mark = self._member.way_back
        if mark is not None:
            self._session.go_back(mark)
        self.conductor.gone_back(self._member)

    def _advance(self) -> bool:
        """A slice of work, when a core is free for it."""
        with self.conductor.core:
            begun = time.perf_counter()
            finished = self._session.advance(self._slice)
            if self._session.busy:  # all of the slice was used
                share = LOOK / max(time.perf_counter() - begun, 1e-9)
                self._slice = min(max(round(share * self._slice), SLICE), LONGEST_SLICE)
            return finished

    def _finish(self) -> None:
        """To what is seen, or bring the increment at work to its end: a log ends between increments."""
        self._go_back()
        end = time.perf_counter() + self._patience
        while self._session.busy and time.perf_counter() < end:
            self._session.advance(SLICE)

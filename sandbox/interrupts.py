"""Ctrl-C, and a request to end, at a moment when it does no harm.

A KeyboardInterrupt in the middle of a frame that is being piped to the encoder, or of an increment
that is being booked, leaves half of something. ``deferred`` puts it off to the end of a short
block.
"""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

# What a terminal, a scheduler and a closed terminal send. SIGHUP is unknown to Windows.
_STOP_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)
AGAIN = 0.05  # [s] until a stop that was lost is raised again, elsewhere


@contextmanager
def deferred() -> Iterator[None]:
    """Put off stop signals that arrive in the block until it has ended.

    May be nested. Does nothing in a thread, since Python gives signals to the main thread alone.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    pending: list[int] = []

    def remember(number: int, _frame: FrameType | None) -> None:
        pending.append(number)

    # A handler that was not set from Python is reported as None and cannot be put back.
    earlier = {
        number: handler
        for number in _STOP_SIGNALS
        if (handler := signal.getsignal(number)) not in (None, signal.SIG_IGN)
    }
    for number in earlier:
        signal.signal(number, remember)
    try:
        yield
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)
    if pending:
        signal.raise_signal(pending[0])


class Stopped(KeyboardInterrupt):
    """What stop signals raise under ``stop_like_ctrl_c``.

    Of a kind of its own: once the very KeyboardInterrupt has passed through ``exec`` of a text, of which Numba has some, Python
    ends a program that was started with -m by SIGINT, whatever its exit code.
    """


class _Stopping:
    """A handler: the first signal raises, and those that come while the program is ending change nothing any more."""

    def __init__(self) -> None:
        self.came = False

    def __call__(self, _number: int, _frame: FrameType | None) -> None:
        if not self.came:
            self.came = True
            raise Stopped

    def again(self) -> None:
        self.came = False
        _thread.interrupt_main()


@contextmanager
def stop_like_ctrl_c() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end the block as Ctrl-C does, so that files are finished properly; once, however many come.

    May be nested; the outermost counts.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    stopping = _Stopping()
    hook = sys.unraisablehook

    def unraisable(lost: sys.UnraisableHookArgs) -> None:
        # Nothing can be raised out of a finalizer, nor a callback from C, where LLVM spends a first start: it is raised again.
        if not issubclass(lost.exc_type, Stopped):
            hook(lost)
            return
        timer = threading.Timer(AGAIN, stopping.again)
        timer.daemon = True
        timer.start()

    earlier = {
        number: handler
        for number in _STOP_SIGNALS
        if (handler := signal.getsignal(number)) in (signal.SIG_DFL, signal.default_int_handler)
    }
    for number in earlier:
        signal.signal(number, stopping)
    if earlier:
        sys.unraisablehook = unraisable
    try:
        yield
    finally:
        for number, handler in earlier.items():
            if signal.getsignal(number) is stopping:
                signal.signal(number, handler)
        if earlier:
            sys.unraisablehook = hook


def hear_no_more() -> None:
    """All is done and told: stop signals that come while the interpreter ends change nothing."""
    for number in _STOP_SIGNALS:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def requests_to_end() -> Iterator[list[int]]:
    """SIGTERM and SIGHUP that come within the block are put into a list, for a program that looks at it and ends by itself."""
    came: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield came
        return
    earlier = {
        number: handler
        for number in _STOP_SIGNALS
        if number != signal.SIGINT
        and (
            (handler := signal.getsignal(number)) == signal.SIG_DFL
            or isinstance(handler, _Stopping)
        )
    }
    for number in earlier:
        signal.signal(number, lambda number, _frame: came.append(number))
    try:
        yield came
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)

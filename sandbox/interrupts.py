"""Ctrl-C, and a request to end, at a moment when it does no harm.

A KeyboardInterrupt in the middle of a frame that is being piped to the encoder, or of an increment
that is being booked, leaves half of something. ``deferred`` puts it off to the end of a short
block.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

# What a terminal, a scheduler and a closed terminal send. SIGHUP is unknown to Windows.
_STOP_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)


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


@contextmanager
def stop_like_ctrl_c() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end the block as Ctrl-C does, so that files are finished properly."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    earlier = {
        number: handler
        for number in _STOP_SIGNALS
        if (handler := signal.getsignal(number)) == signal.SIG_DFL
    }
    for number in earlier:
        signal.signal(number, signal.default_int_handler)
    try:
        yield
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)


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
        if number != signal.SIGINT and (handler := signal.getsignal(number)) == signal.SIG_DFL
    }
    for number in earlier:
        signal.signal(number, lambda number, _frame: came.append(number))
    try:
        yield came
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)

"""Ctrl-C at a harmless moment."""

from __future__ import annotations

import signal
import sys
import threading

import pytest

from sandbox.interrupts import deferred, stop_like_ctrl_c

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")


def test_an_interrupt_waits_for_the_end_of_the_block() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), deferred():
        signal.raise_signal(signal.SIGINT)
        with deferred():
            signal.raise_signal(signal.SIGINT)
            done.append("inner")
        done.append("outer")
    assert done == ["inner", "outer"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_error_in_the_block_is_not_hidden() -> None:
    with pytest.raises(ValueError, match="own"), deferred():
        signal.raise_signal(signal.SIGINT)
        raise ValueError("own")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_polite_requests_to_end_count_as_ctrl_c(number: signal.Signals) -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), stop_like_ctrl_c(), deferred():
        signal.raise_signal(number)
        done.append(number)
    assert done == [number]
    assert signal.getsignal(number) == signal.SIG_DFL


def test_a_thread_is_left_alone() -> None:
    done = []

    def work() -> None:
        with stop_like_ctrl_c(), deferred():
            done.append(threading.current_thread().name)

    thread = threading.Thread(target=work, name="worker")
    thread.start()
    thread.join()
    assert done == ["worker"]

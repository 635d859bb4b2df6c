"""Ctrl-C at a harmless moment."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

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


def test_others_that_come_while_it_ends_change_nothing() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), stop_like_ctrl_c():
        try:
            signal.raise_signal(signal.SIGTERM)
        finally:
            with deferred():
                signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGINT)
            done.append("finished")
    assert done == ["finished"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_one_that_came_where_nothing_can_be_raised_is_raised_elsewhere() -> None:
    class Finalizer:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGTERM)

    with pytest.raises(KeyboardInterrupt), stop_like_ctrl_c():
        Finalizer()
        for _ in range(1000):
            time.sleep(0.01)


def test_the_exit_code_is_that_of_the_program(tmp_path: Path) -> None:
    """Also where an interrupt has come through the execution of a text, of which Numba has some."""
    (tmp_path / "program.py").write_text("""
import signal
from sandbox.interrupts import stop_like_ctrl_c

with stop_like_ctrl_c():
    try:
        exec("signal.raise_signal(signal.SIGTERM)")
    except KeyboardInterrupt:
        raise SystemExit(130)
""")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    done = subprocess.run([sys.executable, "-m", "program"], env=environment, check=False)
    assert done.returncode == 130

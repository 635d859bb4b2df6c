"""A second process that compiles kernels side by side with this one: of threads the compiler serves one at a time."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from core import kernel_cache
from sandbox.environment import cores

ROOT = Path(__file__).parents[1]
LOWEST = 19  # niceness of what nobody waits for


@contextmanager
def beside(wanted: Sequence[str], niceness: int = 0) -> Iterator[None]:
    """Meanwhile another process compiles these parts of the kernels; at the end it is waited for. Not on a single core."""
    helper = start(wanted, niceness) if cores() > 1 else None
    try:
        yield
    except BaseException:
        if helper is not None:
            with helper:  # its pipe as well
                helper.kill()
        raise
    if helper is not None:
        helper.wait()  # whatever came of it: what it did not compile is compiled here
        with helper:
            pass


def start(wanted: Sequence[str], niceness: int) -> subprocess.Popen[bytes] | None:
    """A process that compiles these parts, so much after others; None if there are none, or nothing can be kept."""
    frozen = getattr(sys, "frozen", False)  # then there is no interpreter to start
    if not wanted or frozen or not kernel_cache.usable(kernel_cache.place(kernel_cache.CORE)):
        return None
    paths = [str(ROOT), os.environ.get("PYTHONPATH", "")]
    with suppress(OSError):  # no process is to be had: it is compiled where it is needed
        return subprocess.Popen(
            [sys.executable, "-m", "sandbox.preparation", str(niceness), *wanted],
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))},
            stdin=subprocess.PIPE,  # which ends with this process, however that ends
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    return None

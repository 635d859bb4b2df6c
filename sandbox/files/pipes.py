"""Pipes with names, to write into: opening one that nobody reads would wait for ever."""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from core.errors import InputError

PATIENCE = 1.0  # [s] for a reader that is started at the same time
_held: list[int] = []


@contextmanager
def with_reader(path: Path) -> Iterator[None]:
    """Within the block, what is written to ``path`` has a reader if it is a pipe. Raises InputError if there is none."""
    if not path.is_fifo():
        yield
        return
    descriptor = _opened(path)
    try:
        yield
    finally:
        os.close(descriptor)


def hold(path: Path) -> None:
    """Have a pipe's reader wait for what is to come, until ``let_go``. Raises InputError if there is none."""
    if path.is_fifo():
        _held.append(_opened(path))


def let_go() -> None:
    """Whoever waits for more is told that there is none."""
    while _held:
        os.close(_held.pop())


def _opened(path: Path) -> int:
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return os.open(path, os.O_WRONLY | os.O_NONBLOCK)
        except OSError as error:
            if error.errno != errno.ENXIO:
                raise
        if time.monotonic() > end:
            raise InputError(f"{path}: nobody reads this pipe; start its reader first")
        time.sleep(0.02)

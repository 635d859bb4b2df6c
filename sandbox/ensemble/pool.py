"""Processes that runs are carried out in: deaf to Ctrl-C, gone when this program is, replaced when one dies."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import connection
from multiprocessing.synchronize import Event
from typing import Any

from core.own_process import OWN
from sandbox.interrupts import deferred


class Pool:
    """Processes that hear no Ctrl-C, end when told so or when this one is gone, and are replaced if one dies."""

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs
        self._context = multiprocessing.get_context("spawn")
        self._stop = self._context.Event()
        self._executor: ProcessPoolExecutor | None = None

    def __enter__(self) -> Pool:
        return self

    def stop(self) -> None:
        """Tell the processes that what they do is not wanted any more; from any thread."""
        self._stop.set()

    def __exit__(self, *error: object) -> None:
        self.stop()
        if self._executor is not None:
            with deferred():
                self._executor.shutdown(wait=True, cancel_futures=True)

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        """Have ``function`` called in some process, as ``concurrent.futures.Executor`` does."""
        with _signals_blocked():  # a new process inherits that, and leaves Ctrl-C to this one
            try:
                return self._running().submit(function, *arguments)
            except BrokenProcessPool:
                self._executor = None
                return self._running().submit(function, *arguments)

    def _running(self) -> ProcessPoolExecutor:
        if self._executor is None:
            self._executor = ProcessPoolExecutor(
                self._jobs, self._context, _begin, (self._stop, os.getpid())
            )
        return self._executor


_stop: Event | None = None  # of this process, if it is one of a pool


def _begin(stop: Event, parent: int) -> None:
    """In a new process of the pool."""
    global _stop
    _stop = stop
    OWN.set()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    process = multiprocessing.parent_process()
    if process is not None and process.pid == parent:

        def end_with_parent() -> None:
            connection.wait([process.sentinel])
            os._exit(1)

        threading.Thread(target=end_with_parent, daemon=True).start()


class Stopped(Exception):
    """The runs are not wanted any more."""


def stopping() -> bool:
    """In a process of a pool: whether what it does is not wanted any more."""
    return _stop is not None and _stop.is_set()


@contextmanager
def _signals_blocked() -> Iterator[None]:
    """Ctrl-C waits until the end of the block. Windows knows no such mask; there ``_begin`` comes a little later."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)

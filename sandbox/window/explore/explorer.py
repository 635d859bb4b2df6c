"""Carries a sweep out beside the window, in processes of low priority, and shows what its cells have come to so far."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.errors import InputError
from sandbox.draw.pages.explore_page import MapCell
from sandbox.ensemble.batch import Batch, carry_out_all
from sandbox.ensemble.pool import Pool
from sandbox.extras import require_scipy
from sandbox.sweep.outcome import Found, carry_out
from sandbox.sweep.request import Job, Request
from sandbox.sweep.summary import Cell, cells
from sandbox.sweep.tables import Tables
from sandbox.window.solvers.conductor import cores

NICENESS = 10
EVERY = 0.25  # [s] between two looks at all cells
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Progress:
    """What the window may know of it at one moment."""

    cells: tuple[MapCell, ...] = ()
    done: int = 0
    error: str = ""
    at_work: bool = False


class Explorer:
    """At most one sweep at a time. Nothing here waits for a run."""

    def __init__(self) -> None:
        self.progress = Progress()
        self._gate: _Gate | None = None
        self._thread: threading.Thread | None = None

    def begin(self, request: Request, folder: Path) -> None:
        """Carry out what the folder does not hold yet."""
        self.stop()
        before = self._thread
        self._gate = gate = _Gate()
        self.progress = Progress(at_work=True)
        self._thread = threading.Thread(
            target=self._run, args=(request, folder, gate, before), name="explorer", daemon=True
        )
        self._thread.start()

    def stop(self) -> None:
        """Break the runs under way off; the finished ones are kept."""
        if self._gate is not None:
            self._gate.close()

    def forget(self) -> None:
        """Something else is going to be asked for: an empty map."""
        self.stop()
        self._gate, self.progress = None, Progress()

    # What the thread does.

    def _run(
        self, request: Request, folder: Path, gate: _Gate, before: threading.Thread | None
    ) -> None:
        if before is not None:
            before.join()  # it may be at work on the same folder
        error = ""
        try:
            require_scipy()
            tables = Tables(folder, request)
            try:
                self._carry_out(tables, gate)
            finally:
                tables.write_all()
                tables.close()
        except InputError as trouble:
            error = str(trouble)
        except Exception as trouble:
            log.exception("the explorer stopped")
            error = f"{type(trouble).__name__}: {trouble}"
        if self._gate is gate:  # nothing else has begun meanwhile
            now = self.progress
            self.progress = Progress(now.cells, now.done, error)

    def _carry_out(self, tables: Tables, gate: _Gate) -> None:
        def tell() -> None:
            if self._gate is gate:
                found = tuple(map(shown, cells(tables)))
                self.progress = Progress(found, len(tables.runs), at_work=True)

        due = 0.0

        def done(_: Job, found: Found) -> None:
            nonlocal due
            tables.add(found)
            if time.monotonic() >= due:
                tell()
                due = time.monotonic() + EVERY

        tell()
        missing = [job for job in tables.request.jobs() if job.row not in tables.runs]
        # A run that fails leaves its cell with fewer; it is tried again when the folder is gone on with.
        batch = Batch(carry_out_gently, missing, done, lambda _job, _reason: None)
        jobs = max(cores() - 1, 1)
        try:
            with Pool(jobs) as pool:
                gate.open(pool)
                carry_out_all(batch, gate, jobs, len(tables.runs))
        except KeyboardInterrupt:
            pass  # it was closed
        tell()


class _Gate:
    """Hands runs to a pool until it is closed."""

    def __init__(self) -> None:
        self._pool: Pool | None = None
        self._closed = False

    def open(self, pool: Pool) -> None:
        """Let runs through to that pool."""
        self._pool = pool

    def close(self) -> None:
        """Let no more through, and break off what is under way."""
        self._closed = True
        if self._pool is not None:
            self._pool.stop()

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        """As an executor does. Raises KeyboardInterrupt once it is closed, which ends a batch as Ctrl-C would."""
        if self._closed or self._pool is None:
            raise KeyboardInterrupt
        return self._pool.submit(function, *arguments)


def carry_out_gently(job: Job) -> Found:
    """A run in a process that lets all others go first."""
    if hasattr(os, "nice"):
        os.nice(max(NICENESS - os.nice(0), 0))
    return carry_out(job)


def shown(cell: Cell) -> MapCell:
    """What the map shows of a cell."""
    share = cell.stopped
    low, high = (0.0, 1.0) if share is None else share.interval()
    return MapCell(
        cell.values,
        None if share is None else share.value,
        high - low,
        len(cell.runs),
        int(cell.example["row"]),
    )

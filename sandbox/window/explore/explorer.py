"""Carries a sweep out beside the window, in processes of low priority, and shows what its cells have come to so far."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError
from sandbox.draw.pages.explore_page import MapCell
from sandbox.ensemble.batch import Batch, carry_out_all
from sandbox.ensemble.pool import Pool
from sandbox.environment import cores
from sandbox.session.frame import Frame
from sandbox.sweep.outcome import Found, carried_out
from sandbox.sweep.request import Job, Request
from sandbox.sweep.summary import Cell, cells
from sandbox.sweep.tables import Tables

NICENESS = 10
EVERY = 0.25  # [s] between two looks at all cells
AROUND = 1.0  # what a small picture shows [R]
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Progress:
    """What the window may know of it at one moment. ``frames``: how runs ended, by their rows."""

    cells: tuple[MapCell, ...] = ()
    done: int = 0
    error: str = ""
    at_work: bool = False
    frames: Mapping[int, Frame] = field(default_factory=dict)

    @property
    def unseen(self) -> bool:
        """Is there a cell whose run nobody knows the end of?"""
        return any(cell.row not in self.frames for cell in self.cells)


class Explorer:
    """At most one sweep at a time. Nothing here waits for a run."""

    def __init__(self) -> None:
        self.progress = Progress()
        self.pictures = False  # are the ends of runs wanted that were carried out before?
        self._gate: _Gate | None = None
        self._thread: threading.Thread | None = None

    def begin(self, request: Request, folder: Path) -> None:
        """Carry out what the folder does not hold yet."""
        self.stop()
        before = self._thread
        self._gate = gate = _Gate()
        self.progress = replace(self.progress, error="", at_work=True)
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
            self.progress = replace(self.progress, error=error, at_work=False)

    def _carry_out(self, tables: Tables, gate: _Gate) -> None:
        ends = Ends(dict(self.progress.frames))

        def tell() -> None:
            if self._gate is gate:
                found = tuple(map(shown, cells(tables)))
                self.progress = Progress(found, len(tables.runs), "", True, dict(ends.frames))

        due = 0.0

        def done(job: Job, ended: tuple[Found, Frame]) -> None:
            nonlocal due
            found, frame = ended
            if job.row not in tables.runs:
                tables.add(found)
            ends.keep(job.row, (*tables.request.place(job.row), str(found.run["outcome"])), frame)
            if time.monotonic() >= due:
                tell()
                due = time.monotonic() + EVERY

        def unseen() -> list[Job]:
            """Runs that are wanted again, for how they ended."""
            rows = [c.row for c in self.progress.cells if c.row not in ends.frames]
            return [tables.request.job(row) for row in rows] if self.pictures else []

        tell()
        missing = [job for job in tables.request.jobs() if job.row not in tables.runs]
        jobs = max(cores() - 1, 1)
        try:
            with Pool(jobs) as pool:
                gate.open(pool)
                # A run that fails leaves its cell with fewer; it is tried again when the folder is gone on with.
                runs = [*unseen(), *missing]
                batch = Batch(carry_out_gently, runs, done, lambda _job, _reason: None, silent=True)
                carry_out_all(batch, gate, jobs, len(tables.runs))
                tell()
                carry_out_all(replace(batch, runs=unseen()), gate, jobs)
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


class Ends:
    """How runs ended: of each cell and outcome the run with the least row, which is the one that a map opens."""

    def __init__(self, frames: dict[int, Frame]) -> None:
        self.frames = frames
        self._rows: dict[tuple[object, ...], int] = {}

    def keep(self, row: int, sort: tuple[object, ...], frame: Frame) -> None:
        """The end of a run; ``sort``: its cell and outcome."""
        before = self._rows.get(sort)
        if before is not None and before < row:
            return
        if before is not None:
            self.frames.pop(before, None)
        self.frames[row], self._rows[sort] = frame, row


def carry_out_gently(job: Job) -> tuple[Found, Frame]:
    """A run in a process that lets all others go first, and how it ended."""
    if hasattr(os, "nice"):
        os.nice(max(NICENESS - os.nice(0), 0))
    found, session = carried_out(job)
    return found, bare(session.frame())


def bare(frame: Frame) -> Frame:
    """A frame with no more than a small picture shows: without the empty parts above and below."""
    none = np.empty(0)
    left, bottom, right, top = frame.bounds
    heights = [frame.y - frame.p, frame.y + frame.p]
    for body in frame.bodies:
        heights += [body.segments[:, 1], body.segments[:, 3], body.discs[:, 1]]
        heights += [corners[:, 1] for corners in body.polygons]
    there = np.concatenate(heights)
    if len(there) and frame.box is None:
        bottom = max(bottom, float(there.min()) - AROUND)
        top = min(top, float(there.max()) + AROUND)
    return replace(
        frame,
        bounds=(left, bottom, right, top),
        notices=(),
        events=(),
        settings={},
        curve_stroke=none,
        curve_force=none,
    )


def shown(cell: Cell) -> MapCell:
    """What the map shows of a cell."""
    share = cell.stopped
    return MapCell(
        cell.values,
        None if share is None else share.value,
        (0.0, 1.0) if share is None else share.interval(),
        0 if share is None else share.count,
        len(cell.runs),
        int(cell.example["row"]),
        str(cell.example["outcome"]),
    )

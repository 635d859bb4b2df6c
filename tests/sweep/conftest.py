"""Runs that cost nothing."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import pytest

from sandbox.ensemble.batch import Workers
from sandbox.sweep import sweep
from sandbox.sweep.columns import AFTER
from sandbox.sweep.outcome import CLOGGED, EMPTIED, Found
from sandbox.sweep.request import Job


def fake(job: Job) -> Found:
    """The wider, the more leave."""
    wide = float(job.settings["orifice"]) > 2.0
    ended, out = (EMPTIED, 9) if wide else (CLOGGED, job.seed)
    return invented(job, ended, out)


def invented(job: Job, ended: str, out: int) -> Found:
    """A run of one avalanche that ended so."""
    row: dict[str, Any] = {"row": job.row, "seed": job.seed, "packing": job.packing}
    fall = {**row, "avalanche": 1, "size": out, "ended": ended, "arch": "", "increments": 5}
    row |= {**job.settings, **dict.fromkeys(AFTER, 0), "why": "", "arch": "", "avalanches": 1}
    return Found({**row, "outcome": ended, "out": out, "seconds": job.row}, (fall,))


@pytest.fixture
def in_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """By any executor: here of threads."""

    @contextmanager
    def threads(executor: str, jobs: int) -> Iterator[tuple[Workers, int]]:
        with ThreadPoolExecutor(jobs) as pool:
            yield pool, jobs

    monkeypatch.setattr(sweep, "workers", threads)
    monkeypatch.setattr(sweep, "carry_out", fake)
    monkeypatch.setattr(sweep, "compile_all", lambda _: None)

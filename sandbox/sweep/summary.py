"""What a sweep came to, cell by cell: how often the grains stopped, with Wilson's interval, and how many had left."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from sandbox.ensemble.estimates import Share
from sandbox.sweep.outcome import CENSORED, CLOGGED, DECIDED, FAILED, NEVER, STOPPED
from sandbox.sweep.request import Request
from sandbox.sweep.tables import Row, Tables
from scenes.parameter import Value

MOST_LINES = 60  # cells that are told of in a terminal
SHARES_OF = "Shares are of runs whose grains had started and whose outcome is known"


@dataclass(frozen=True)
class Cell:
    """All runs of one packing at one place along the axes. ``values``: of the axes, in their order."""

    packing: str
    values: tuple[Value, ...]
    runs: tuple[Row, ...]
    avalanches: tuple[Row, ...]

    @property
    def outcomes(self) -> Counter[str]:
        """How many came to what."""
        return Counter(str(row["outcome"]) for row in self.runs)

    @property
    def stopped(self) -> Share | None:
        """The share that the grains stopped, of those that had started and whose outcome is known; None of none."""
        known = [row["outcome"] for row in self.runs if row["outcome"] in DECIDED]
        return Share(sum(one in STOPPED for one in known), len(known)) if known else None

    @property
    def told(self) -> str:
        """The share in words, with its interval and of how many; where there is none, what most of the runs came to."""
        share = self.stopped
        if share is None:
            return str(self.example["outcome"])
        low, high = share.interval()
        return f"{share.value:.2f} ({low:.2f} to {high:.2f}), {share.count} runs"

    @property
    def example(self) -> Row:
        """A run that came to what most of them came to: the first of these."""
        most = max(self.outcomes.items(), key=lambda item: item[1])[0]
        return next(row for row in self.runs if row["outcome"] == most)

    def column(self, name: str) -> Floats:
        """A column of numbers, of the runs that have one, (S,)."""
        return np.array([float(row[name]) for row in self.runs if row[name] != ""])

    @property
    def clogs(self) -> int:
        """Avalanches that ended in one."""
        return sum(row["ended"] == CLOGGED for row in self.avalanches)

    @property
    def sizes(self) -> tuple[Floats, NDArray[np.bool_]]:
        """Sizes of avalanches (A,), and whether a clog ended each, (A,): others are lower bounds."""
        sizes = np.array([float(row["size"]) for row in self.avalanches])
        return sizes, np.array([row["ended"] == CLOGGED for row in self.avalanches], dtype=bool)


def cells(tables: Tables) -> list[Cell]:
    """All that have a run, in the order of the request."""
    request = tables.request
    known = [
        (packing, tuple(cell.values())) for packing in request.packings for cell in request.cells
    ]
    runs: dict[int, list[int]] = {}
    for row in sorted(tables.runs):
        runs.setdefault((row - 1) % len(known), []).append(row)
    return [
        Cell(
            *known[place],
            tuple(tables.runs[row] for row in rows),
            tuple(fall for row in rows for fall in tables.avalanches.get(row, ())),
        )
        for place, rows in sorted(runs.items())
    ]


def as_text(request: Request, found: Sequence[Cell]) -> str:
    """A line a cell, as many as fit a terminal."""
    names = [axis.name for axis in request.axes]
    header = [*names, "packing", "runs", "stopped", "interval", "out", "s/run", "outcomes"]
    lines = [header, *(_line(cell) for cell in found[:MOST_LINES])]
    widths = [max(len(line[k]) for line in lines) for k in range(len(header))]
    text = ["  ".join(w.ljust(n) for w, n in zip(line, widths, strict=True)) for line in lines]
    if len(found) > MOST_LINES:
        text.append(f"… and {len(found) - MOST_LINES} cells more")
    return "\n".join([*(line.rstrip() for line in text), *_totals(request, found)])


def _line(cell: Cell) -> list[str]:
    share = cell.stopped
    told, interval = "", ""
    if share is not None:
        low, high = share.interval()
        told, interval = f"{share.value:.2f}", f"{low:.2f} to {high:.2f}"
    counts = ", ".join(f"{count} {name}" for name, count in sorted(cell.outcomes.items()))
    return [
        *(f"{value:g}" for value in cell.values),
        cell.packing,
        str(len(cell.runs)),
        told,
        interval,
        _mean(cell.column("out")),
        _mean(cell.column("seconds")),
        counts,
    ]


def _mean(values: Floats) -> str:
    return f"{values.mean():.1f}" if len(values) else ""


def _totals(request: Request, found: Iterable[Cell]) -> Iterator[str]:
    rows = [row for cell in found for row in cell.runs]
    seconds = sum(float(row["seconds"]) for row in rows if row["seconds"] != "")
    took = f"{seconds:.0f} s" if seconds < 100.0 else f"{seconds / 60.0:.1f} minutes"
    yield f"{len(rows)} of {request.runs} runs, {took} of one core"
    for outcome, words in (
        (
            NEVER,
            "never started, at rest before a grain had left: no clogs, and not counted in the shares",
        ),
        (CENSORED, "were broken off before their outcome was known: not counted in the shares"),
        (FAILED, "failed: the same command tries them again"),
    ):
        count = sum(row["outcome"] == outcome for row in rows)
        if count:
            yield f"{count} {words}"

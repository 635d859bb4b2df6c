"""The table of a run: one row per increment, units in the header. It grows on the disk, so that a crash costs a moment."""

from __future__ import annotations

import csv
import io
import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import astuple
from pathlib import Path
from typing import Any, BinaryIO, Protocol

from core.errors import InputError
from core.files import atomic_write, followed, is_special
from sandbox.interrupts import deferred

EVERY = 0.5  # [s] between two looks at what is new


class Table(Protocol):
    """What can be written: columns with their units, and rows."""

    def header(self) -> list[str]: ...

    def rows(self) -> Iterable[Sequence[object]]: ...


class History(Table, Protocol):
    """A table that grows, or goes back and grows on from there. A row is a dataclass, and always the same object."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int) -> Any: ...


class SideBySide:
    """The tables of several packings as one, with a column that says which."""

    def __init__(self, tables: Sequence[tuple[str, Table]]) -> None:
        self._tables = tables

    def header(self) -> list[str]:
        """As that of one, after the packing."""
        return ["packing", *self._tables[0][1].header()]

    def rows(self) -> Iterator[tuple[object, ...]]:
        """Packing after packing."""
        for packing, table in self._tables:
            for row in table.rows():
                yield (packing, *row)


def write_csv(path: str | os.PathLike[str], history: Table) -> None:
    """Write ``history`` to ``path`` as CSV (RFC 4180, but with plain line ends), all or nothing.

    Floats are written so that they read back to the same bits.
    """
    try:
        with atomic_write(path) as file:
            file.write(_lines([history.header()]) + _lines(history.rows()))
    except OSError as error:
        raise _not_written(path, error) from error


class GrowingTable:
    """The histories of some packings on the disk while they grow: whole rows, written every half second.

    The file that stood there stays until the first row that is written. The rows of several packings come as they are made, and
    are put in order at the end. A pipe or a device gets all at the end. Raises InputError where something cannot be written;
    what had been written before then stays, whole rows.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        histories: Callable[[], Sequence[tuple[str, History]]],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """``histories`` says which they are now: packings and what is known of them."""
        self.path = Path(path)
        self.rows = 0  # that are in the file
        self._histories = histories
        self._clock = clock
        self._due = -float("inf")
        self._file: BinaryIO | None = None
        self._written: list[tuple[int, Any]] = []  # of each: how many rows, and the last of them

    def grow(self) -> None:
        """Write what is new, if it is time to."""
        if self._clock() < self._due or is_special(self.path):
            return
        with deferred():
            self._grow()
        self._due = self._clock() + EVERY

    def finish(self) -> None:
        """Write all that is left, and wait until the disk has it."""
        now = self._histories()
        if is_special(self.path):
            write_csv(self.path, _table(now))
            return
        with deferred():
            try:
                if len(now) > 1:
                    write_csv(self.path, _table(now))
                else:
                    self._grow()
                    if self._file is not None:
                        os.fsync(self._file.fileno())
            finally:
                self._close()

    def _grow(self) -> None:
        now = self._histories()
        try:
            if self._file is None or self._went_back(now):
                self._begin(now)
            for number, (packing, history) in enumerate(now):
                begin, end = self._written[number][0], len(history)
                if begin < end:
                    self._append(_lines(_named(packing, now, history, begin)))
                    self._written[number] = end, history[end - 1]
                    self.rows += end - begin
        except OSError as error:
            self._close()
            raise _not_written(self.path, error, self.rows) from error

    def _went_back(self, now: Sequence[tuple[str, History]]) -> bool:
        """Has somebody gone back behind the last row that was written?"""
        return any(
            len(history) < count or history[count - 1] is not last
            for (_, history), (count, last) in zip(now, self._written, strict=True)
        )

    def _begin(self, now: Sequence[tuple[str, History]]) -> None:
        """A new file with a header, and whatever there is already."""
        self._close()
        write_csv(self.path, _table(now))
        self._file = followed(self.path).open("ab", buffering=0)
        self._written = [(len(history), history[len(history) - 1]) for _, history in now]
        self.rows = sum(len(history) for _, history in now)

    def _append(self, lines: bytes) -> None:
        """Add whole lines, or nothing."""
        assert self._file is not None
        size = os.fstat(self._file.fileno()).st_size
        try:
            while lines:  # a disk that has room for a part takes that
                lines = lines[self._file.write(lines) :]
        except OSError:
            self._file.truncate(size)
            raise

    def _close(self) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None


def _table(histories: Sequence[tuple[str, Table]]) -> Table:
    return histories[0][1] if len(histories) == 1 else SideBySide(histories)


def _named(
    packing: str, now: Sequence[object], history: History, begin: int
) -> Iterator[tuple[object, ...]]:
    """The rows from ``begin`` on, with the packing where there are several."""
    name = (packing,) if len(now) > 1 else ()
    return ((*name, *astuple(history[i])) for i in range(begin, len(history)))


def _lines(rows: Iterable[Sequence[object]]) -> bytes:
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


def _not_written(path: str | os.PathLike[str], error: OSError, rows: int = 0) -> InputError:
    kept = "; the earlier file was kept" if Path(path).exists() else ""
    if rows:
        kept = f"; it holds the first {rows} rows"
    reason = (error.strerror or str(error)).lower()
    return InputError(f"cannot write {path}: {reason}{kept}")

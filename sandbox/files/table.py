"""Tables as CSV, units in the header. That of a run has a row an increment and grows on the disk: a crash costs a moment."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Protocol

from core.errors import InputError, reason_of
from core.files import atomic_write, followed, is_special
from sandbox.files import cells
from sandbox.files.lines import append
from sandbox.files.pipes import with_reader
from sandbox.interrupts import deferred

EVERY = 0.5  # [s] between two looks at what is new


class Table(Protocol):
    """What can be written: columns with their units, and rows."""

    def header(self) -> Sequence[str]: ...

    def rows(self) -> Iterable[Sequence[object]]: ...


class Growing(Table, Protocol):
    """A table that grows, or goes back and grows on from there. What a row is made from is always the same object."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int) -> Any: ...

    def rows(self, begin: int = 0) -> Iterable[Sequence[object]]: ...


@dataclass(frozen=True)
class Spelling:
    """How a table is written. The plain one is for programs: floats read back to the same bits (RFC 4180, plain line ends)."""

    separator: str = ","
    decimal: str = "."
    mark: bytes = b""  # before all else
    missing: str = "nan"  # a number that nobody knows
    say: Callable[[str], str] = str  # names of columns, as they are written

    def lines(self, rows: Iterable[Sequence[object]]) -> bytes:
        """Whole lines."""
        spelt = ([self._cell(value) for value in row] for row in rows)
        return cells.lines(spelt, self.separator).encode()

    def head(self, names: Iterable[str]) -> bytes:
        """How a file begins."""
        return self.mark + self.lines([[self.say(name) for name in names]])

    def _cell(self, value: object) -> object:
        if not isinstance(value, float):
            return value
        return self.missing if math.isnan(value) else repr(float(value)).replace(".", self.decimal)


PLAIN = Spelling()


def for_excel(decimal: str, say: Callable[[str], str]) -> Spelling:
    """As the Excel of a country reads it that writes ``decimal`` before decimals: where that is the comma, ; separates cells.

    The byte order mark says that it is UTF-8.
    """
    return Spelling(";" if decimal == "," else ",", decimal, b"\xef\xbb\xbf", "", say)


class SideBySide:
    """The tables of several packings as one, with a column that says which."""

    def __init__(self, tables: Sequence[tuple[str, Table]]) -> None:
        self._tables = tables

    def header(self) -> Sequence[str]:
        """As that of one, after the packing."""
        return ["packing", *self._tables[0][1].header()]

    def rows(self) -> Iterator[tuple[object, ...]]:
        """Packing after packing."""
        for packing, table in self._tables:
            for row in table.rows():
                yield (packing, *row)


def write_csv(path: str | os.PathLike[str], table: Table, spelling: Spelling = PLAIN) -> None:
    """Write ``table`` to ``path``, all or nothing. Raises InputError where it cannot be written."""
    try:
        with atomic_write(path) as file:
            file.write(spelling.head(table.header()) + spelling.lines(table.rows()))
    except OSError as error:
        raise _not_written(path, error) from error


class GrowingTable:
    """The tables of some packings on the disk while they grow: whole rows, written every half second.

    The file that stood there stays until the first row that is written. The rows of several packings come as they are made, and
    are put in order at the end. A pipe or a device gets all at the end. Raises InputError where something cannot be written;
    what had been written before then stays, whole rows.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        tables: Callable[[], Sequence[tuple[str, Growing]]],
        spelling: Spelling = PLAIN,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """``tables`` says which they are now: packings and what is known of them."""
        self.path = Path(path)
        self.rows = 0  # that are in the file
        self._tables = tables
        self._spelling = spelling
        self._clock = clock
        self._due = -float("inf")
        self._file: BinaryIO | None = None
        self._written: list[tuple[int, Any]] = []  # of each: how many rows, and the last of them
        self._header: Sequence[str] = ()

    def grow(self) -> None:
        """Write what is new, if it is time to."""
        if self._clock() < self._due or is_special(self.path):
            return
        with deferred():
            self._grow()
        self._due = self._clock() + EVERY

    def finish(self) -> None:
        """Write all that is left, and wait until the disk has it."""
        now = self._tables()
        if is_special(self.path):
            with with_reader(self.path):
                write_csv(self.path, _table(now), self._spelling)
            return
        with deferred():
            try:
                if len(now) > 1:
                    write_csv(self.path, _table(now), self._spelling)
                else:
                    self._grow()
                    if self._file is not None:
                        os.fsync(self._file.fileno())
            finally:
                self._close()

    def _grow(self) -> None:
        now = self._tables()
        try:
            if self._file is None or self._went_back(now):
                self._begin(now)
            for number, (packing, table) in enumerate(now):
                begin, end = self._written[number][0], len(table)
                if begin < end and self._file is not None:
                    append(self._file, self._spelling.lines(_named(packing, now, table, begin)))
                    self._written[number] = end, table[end - 1]
                    self.rows += end - begin
        except OSError as error:
            self._close()
            raise _not_written(self.path, error, self.rows) from error

    def _went_back(self, now: Sequence[tuple[str, Growing]]) -> bool:
        """Has somebody gone back behind the last row that was written, or is there another column?"""
        return self._header != _table(now).header() or any(
            len(table) < count or table[count - 1] is not last
            for (_, table), (count, last) in zip(now, self._written, strict=True)
        )

    def _begin(self, now: Sequence[tuple[str, Growing]]) -> None:
        """A new file with a header, and whatever there is already."""
        self._close()
        write_csv(self.path, _table(now), self._spelling)
        self._file = followed(self.path).open("ab", buffering=0)
        self._header = _table(now).header()
        self._written = [(len(table), table[len(table) - 1]) for _, table in now]
        self.rows = sum(len(table) for _, table in now)

    def _close(self) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None


def _table(tables: Sequence[tuple[str, Table]]) -> Table:
    return tables[0][1] if len(tables) == 1 else SideBySide(tables)


def _named(
    packing: str, now: Sequence[object], table: Growing, begin: int
) -> Iterator[tuple[object, ...]]:
    """The rows from ``begin`` on, with the packing where there are several."""
    name = (packing,) if len(now) > 1 else ()
    return ((*name, *row) for row in table.rows(begin))


def _not_written(path: str | os.PathLike[str], error: OSError, rows: int = 0) -> InputError:
    kept = "; the earlier file was kept" if Path(path).is_file() else ""
    if rows:
        kept = f"; it holds the first {rows} rows"
    reason = reason_of(error)
    return InputError(f"cannot write {path}: {reason}{kept}")

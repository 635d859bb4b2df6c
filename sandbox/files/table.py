"""The table of a run: one row per increment, units in the header."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Protocol

from core.errors import InputError
from core.files import atomic_write


class Table(Protocol):
    """What can be written: columns with their units, and rows."""

    def header(self) -> list[str]: ...

    def rows(self) -> Iterable[Sequence[object]]: ...


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
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(history.header())
    writer.writerows(history.rows())
    try:
        with atomic_write(path) as file:
            file.write(text.getvalue().encode())
    except OSError as error:
        kept = "; the earlier file was kept" if Path(path).exists() else ""
        reason = (error.strerror or str(error)).lower()
        raise InputError(f"cannot write {path}: {reason}{kept}") from error

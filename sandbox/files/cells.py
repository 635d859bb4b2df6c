"""Cells of CSV tables, for all who write some: what a spreadsheet would take for a formula goes into them as text."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable

END = "\r\n"  # asked of Python's writer, which puts cells with one of its signs between quotes
TEXT = "'"  # before all else in a cell: spreadsheets show what follows as it stands
_FORMULA = re.compile(f"{TEXT}*[=+\\-@\t\r]")  # how one may begin; our sign before it is doubled
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)(e[+-]?\d+)?|[+-]?inf|nan", re.IGNORECASE)


def lines(rows: Iterable[Iterable[object]], separator: str = ",") -> str:
    """Whole lines, plain ends. Texts are safe, and ``read`` gives them back."""
    text = io.StringIO(newline="")
    writer = csv.writer(_PlainEnds(text), delimiter=separator, lineterminator=END)
    writer.writerows([_safe(value) for value in row] for row in rows)
    return text.getvalue()


def read(text: str, separator: str = ",") -> list[list[str]]:
    """The rows of a table as they were before ``lines``. Raises csv.Error where it is none."""
    found = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    return [[original(cell) for cell in row] for row in found]


def original(cell: str) -> str:
    """The text that went into a cell."""
    marked = cell.startswith(TEXT) and _FORMULA.match(cell)
    return cell.removeprefix(TEXT) if marked else cell


class _PlainEnds:
    """Takes whole lines, and ends them plainly."""

    def __init__(self, text: io.StringIO) -> None:
        self._text = text

    def write(self, line: str) -> None:
        self._text.write(f"{line.removesuffix(END)}\n")


def _safe(value: object) -> object:
    if not isinstance(value, str) or _NUMBER.fullmatch(value):
        return value
    return TEXT + value if _FORMULA.match(value) else value

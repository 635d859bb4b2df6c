"""The table of a run."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from core.errors import InputError
from sandbox.files.table import write_csv


class Rows:
    """A small history."""

    def __init__(self, *rows: tuple[object, ...]) -> None:
        self._rows = rows

    def header(self) -> list[str]:
        return ["increment", "fx [k R]", "stop_reason"]

    def rows(self) -> Iterator[tuple[object, ...]]:
        yield from self._rows


def test_values_read_back_to_the_same_bits(tmp_path: Path) -> None:
    values = [0.1, 1 / 3, -5e-324, 1.7976931348623157e308, math.pi]
    path = tmp_path / "run.csv"
    write_csv(path, Rows(*((i, value, "iteration limit") for i, value in enumerate(values))))
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header == ["increment", "fx [k R]", "stop_reason"]
    assert [float(row[1]) for row in rows] == values
    assert {row[2] for row in rows} == {"iteration limit"}
    assert b"\r" not in path.read_bytes()


class Failing(Rows):
    """A history that breaks half way."""

    def rows(self) -> Iterator[tuple[object, ...]]:
        yield (0, 0.0, "converged")
        raise RuntimeError("half way")


def test_nothing_half_is_left(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("earlier")
    with pytest.raises(RuntimeError, match="half way"):
        write_csv(path, Failing())
    assert path.read_text() == "earlier"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_went_away_is_told_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "gone" / "run.csv"
    with pytest.raises(InputError, match=r"cannot write .*run\.csv: no such file"):
        write_csv(path, Rows())

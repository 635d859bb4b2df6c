"""The table of a run."""

from __future__ import annotations

import csv
import math
import os
import sys
import threading
from collections.abc import Iterator
from dataclasses import astuple, dataclass
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import InputError
from sandbox.files import table
from sandbox.files.table import EVERY, GrowingTable, for_excel, write_csv


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


@pytest.mark.parametrize(("decimal", "separator"), [(".", ","), (",", ";")])
def test_for_excel_every_country_has_its_own_signs(
    tmp_path: Path, decimal: str, separator: str
) -> None:
    values = [0.1, -1e-300, 1 / 3, math.nan]
    path = tmp_path / "run.csv"
    rows = Rows(*((i, value, "a; b, c") for i, value in enumerate(values)))
    write_csv(path, rows, for_excel(decimal, str.upper))
    assert path.read_bytes().startswith(b"\xef\xbb\xbf")
    with path.open(newline="", encoding="utf-8-sig") as file:
        header, *found = csv.reader(file, delimiter=separator)
    assert header == ["INCREMENT", "FX [K R]", "STOP_REASON"]
    assert [float(row[1].replace(decimal, ".") or "nan") for row in found[:-1]] == values[:-1]
    assert found[-1] == ["3", "", "a; b, c"]


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


@dataclass(frozen=True)
class Line:
    """A row that knows no other like it."""

    increment: int
    value: float


class Growing:
    """A history."""

    def __init__(self) -> None:
        self.lines = [Line(0, 0.5)]
        self.columns = 2

    def add(self) -> None:
        self.lines.append(Line(len(self.lines), 1.0 / 3.0))

    def header(self) -> list[str]:
        return ["increment", "value", "drawn"][: self.columns]

    def rows(self, begin: int = 0) -> Iterator[tuple[object, ...]]:
        return ((*astuple(line), 0.0)[: self.columns] for line in self.lines[begin:])

    def __len__(self) -> int:
        return len(self.lines)

    def __getitem__(self, index: int) -> Line:
        return self.lines[index]


class Clock:
    """Time that passes when it is told to."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def lines_of(path: Path) -> list[str]:
    return path.read_text().splitlines()


def test_a_table_on_the_disk_is_never_far_behind(tmp_path: Path) -> None:
    """Read while it grows, as after kill -9: whole rows, all but those of the last half second."""
    path, history, clock = tmp_path / "run.csv", Growing(), Clock()
    path.write_text("earlier")
    growing = GrowingTable(path, lambda: [("mixed", history)], clock=clock)
    assert path.read_text() == "earlier"
    for _ in range(40):
        history.add()
        growing.grow()
        assert all(line.count(",") == 1 for line in lines_of(path))
        clock.now += 0.1
        if clock.now > 1.0:
            assert growing.rows >= len(history) - 1 - EVERY / 0.1
    growing.finish()
    write_csv(tmp_path / "whole.csv", history)
    assert path.read_bytes() == (tmp_path / "whole.csv").read_bytes()
    assert len(list(tmp_path.iterdir())) == 2


@settings(max_examples=40, deadline=None)
@given(st.lists(st.integers(-3, 4), max_size=12), st.integers(1, 3))
def test_what_is_on_the_disk_is_the_history_wherever_it_goes_back(
    tmp_path_factory: pytest.TempPathFactory, moves: list[int], count: int
) -> None:
    """Rows are added, or somebody goes back some rows, or to the start, or a column is new: the same bytes as written at once."""
    path = tmp_path_factory.mktemp("table") / "run.csv"
    histories = [Growing() for _ in range(count)]
    now = [(f"packing {k}", history) for k, history in enumerate(histories)]
    clock = Clock()
    growing = GrowingTable(path, lambda: now, clock=clock)
    for move in moves:
        for history in histories:
            del history.lines[max(1, len(history) + min(move, 0)) :]
            for _ in range(move):
                history.add()
            history.columns = 2 + (move == -2)
        growing.grow()
        clock.now += 1.0
        assert len(lines_of(path)) - 1 == growing.rows == sum(len(h) for h in histories)
    growing.finish()
    whole = path.with_name("whole.csv")
    write_csv(whole, table.SideBySide(now) if count > 1 else now[0][1])
    assert path.read_bytes() == whole.read_bytes()


@pytest.mark.skipif(sys.platform == "win32", reason="a limit of POSIX")
def test_a_full_disk_leaves_whole_rows(tmp_path: Path) -> None:
    import resource
    import signal

    path, history, clock = tmp_path / "run.csv", Growing(), Clock()
    growing = GrowingTable(path, lambda: [("mixed", history)], clock=clock)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (500, hard))
    try:
        with pytest.raises(
            InputError, match=r"run\.csv: file too large; it holds the first \d+ rows"
        ):
            for _ in range(100):
                history.add()
                growing.grow()
                clock.now += 1.0
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, before)
    rows = lines_of(path)[1:]
    assert len(rows) == growing.rows > 10
    assert path.read_bytes().endswith(b"\n")
    assert [float(row.split(",")[1]) for row in rows] == [0.5] + [1.0 / 3.0] * (len(rows) - 1)


@pytest.mark.skipif(sys.platform == "win32", reason="pipes of POSIX")
def test_a_pipe_gets_all_at_the_end(tmp_path: Path) -> None:
    pipe, history = tmp_path / "pipe.csv", Growing()
    os.mkfifo(pipe)
    got: list[str] = []
    reader = threading.Thread(target=lambda: got.append(pipe.read_text()), daemon=True)
    reader.start()
    growing = GrowingTable(pipe, lambda: [("mixed", history)])
    for _ in range(3):
        history.add()
        growing.grow()
    growing.finish()
    reader.join(60)
    assert [len(text.splitlines()) for text in got] == [5]
    assert pipe.is_fifo()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no such device here")
def test_a_device_is_no_earlier_file(tmp_path: Path) -> None:
    full = tmp_path / "run.csv"
    full.symlink_to("/dev/full")
    with pytest.raises(InputError, match=r"no space left on device$"):
        write_csv(full, Growing())

"""The log of a run that goes on: at any moment there is a whole one on the disk, whatever becomes of the program or the disk."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from core.errors import InputError
from sandbox.files.growing_log import GrowingLog
from sandbox.files.log_file import last_line, read_log, write_log
from sandbox.session.commands import Command, Grab, Move, Protocol
from sandbox.session.log import Log

NEVER = 1e6  # [s] the thread does not write by itself
COMMANDS: list[tuple[int, Command]] = [
    (0, Grab("intruder")),
    *((k, Move("intruder", float(k), 1.0)) for k in range(200)),
    (300, Protocol(True)),
]


def until(end: int) -> Log:
    """What was done up to an increment."""
    done = tuple(entry for entry in COMMANDS if entry[0] < end)
    return Log("intruder", "mixed", 1, {}, done, end, f"{end:064d}")


@pytest.fixture
def growing(tmp_path: Path) -> Iterator[GrowingLog]:
    one = GrowingLog(tmp_path / "there" / "it.jsonl", NEVER)
    one.path.parent.mkdir()
    yield one
    one._stop.set()
    one._release()


def test_at_any_moment_there_is_a_whole_log(growing: GrowingLog) -> None:
    growing.path.write_text("earlier")
    growing.path.chmod(0o600)
    growing.write()
    assert growing.path.read_text() == "earlier"  # nothing has happened yet
    for end in (0, 1, 2, 7, 150, 299, 300, 10_000):
        growing.keep(until(end))
        growing.write()
        assert read_log(growing.path) == until(end)
        assert list(growing.path.parent.iterdir()) == [growing.path]
    growing.close()
    assert read_log(growing.path) == until(10_000)
    assert growing.path.stat().st_mode & 0o777 == 0o600


def test_the_thread_writes_by_itself(tmp_path: Path) -> None:
    one = GrowingLog(tmp_path / "it.jsonl", 0.01)
    for end in (3, 30):
        one.keep(until(end))
        patience = time.monotonic() + 30.0
        while not one.path.exists() or read_log(one.path).end != end:
            assert time.monotonic() < patience
            time.sleep(0.005)
    one.close()


@pytest.mark.parametrize("rest", ["of the file before", "zeros", "none"])
def test_after_a_power_cut_what_is_whole_is_read(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, rest: str
) -> None:
    """It may come at any byte of what is put in the place of the last line."""
    path = tmp_path / "it.jsonl"
    before, after = replace(until(3), hash="3"), replace(until(4), hash="4")
    write_log(path, before)
    old = path.read_bytes()
    write_log(path, after)
    new = path.read_bytes()
    behind = {"of the file before": old, "zeros": bytes(len(new)), "none": b""}[rest]
    begin = len(old) - len(last_line(before))
    commands = new[begin:].splitlines()[:-1]
    for place in range(begin, len(new)):
        path.write_bytes(new[:place] + behind[place:])
        caplog.clear()
        log = read_log(path)
        if not log.hash:
            assert len(caplog.messages) == 1
            whole = sum(line in commands for line in path.read_bytes()[begin:].splitlines())
            assert log.commands == after.commands[: len(before.commands) + whole]
            assert log.end == log.commands[-1][0]
        else:  # not yet begun, or but for the last line's end
            assert log == (before if place < begin + 3 else after)


class Full:
    """A file on a disk that has room for a few bytes more."""

    def __init__(self, file: Any, room: int) -> None:
        self.file, self.room = file, room

    def __getattr__(self, name: str) -> Any:
        return getattr(self.file, name)

    def write(self, data: bytes) -> int:
        growth = self.file.tell() + len(data) - os.fstat(self.file.fileno()).st_size
        if growth <= 0:
            return int(self.file.write(data))
        if not self.room:
            raise OSError(28, "No space left on device")
        part, self.room = data[: len(data) - max(growth - self.room, 0)], 0
        return int(self.file.write(part))


def test_a_disk_that_fills_keeps_the_log_as_it_was(growing: GrowingLog) -> None:
    growing.keep(until(5))
    growing.write()
    real = growing._file
    growing._file = Full(real, 40)  # type: ignore[assignment]
    growing.keep(until(150))
    with pytest.raises(OSError, match="No space"):
        growing.write()
    assert read_log(growing.path) == until(5)
    growing._file = real  # somebody has made room
    growing.write()
    assert read_log(growing.path) == until(150)
    growing._file = Full(real, 0)  # type: ignore[assignment]
    growing.keep(until(200))
    with pytest.raises(InputError, match=r"no space.*up to increment 150"):
        growing.close()
    assert read_log(growing.path) == until(150)


def test_a_log_that_was_taken_away_is_written_anew(growing: GrowingLog) -> None:
    growing.keep(until(5))
    growing.write()
    growing.path.unlink()
    growing.keep(until(6))
    growing.write()
    assert read_log(growing.path) == until(6)
    other = growing.path.with_name("other")
    other.write_text("of somebody else")
    other.replace(growing.path)
    growing.close()
    assert read_log(growing.path) == until(6)


@pytest.mark.parametrize("size", [0, -5, 5])
def test_a_log_that_somebody_has_cut_or_added_to_is_written_anew(
    growing: GrowingLog, size: int
) -> None:
    def disturb() -> None:
        os.truncate(growing.path, growing.path.stat().st_size + size if size else 0)

    growing.keep(until(5))
    growing.write()
    disturb()
    growing.keep(until(9))
    growing.write()
    assert read_log(growing.path) == until(9)
    disturb()
    growing.close()
    assert read_log(growing.path) == until(9)


def test_a_folder_that_vanishes_is_told(growing: GrowingLog) -> None:
    growing.keep(until(5))
    growing.write()
    shutil.rmtree(growing.path.parent)
    growing.keep(until(6))
    with pytest.raises(InputError, match=r"it\.jsonl: no such file"):
        growing.close()

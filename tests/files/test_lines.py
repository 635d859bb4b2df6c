"""Lines that are added to a file: whole, after what a kill has left of one, and not at all where there is no room."""

from __future__ import annotations

from pathlib import Path
from typing import Any, BinaryIO, cast

import pytest

from core.errors import InputError
from sandbox.files.lines import append, append_lines
from sandbox.studies.common import kept


def test_what_a_kill_has_left_of_a_line_takes_no_other_with_it(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    kept.keep(path, "a", {"n": 1})
    with path.open("ab") as file:
        file.write(b'{"key": "b", "n"')
    kept.keep(path, "c", {"n": 3})
    kept.keep(path, "d", {"n": 4})
    assert kept.read(path) == {"a": {"n": 1}, "c": {"n": 3}, "d": {"n": 4}}


class Full:
    """A disk with room for so many bytes, and ten at a time."""

    def __init__(self, file: BinaryIO, room: int) -> None:
        self._file, self._room = file, room

    def write(self, data: bytes) -> int:
        if not self._room:
            raise OSError(28, "No space left on device")
        some = data[: min(self._room, 10)]
        self._room -= len(some)
        return self._file.write(some)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)


@pytest.mark.parametrize("room", [3, 25, 100])
def test_all_of_it_or_nothing(tmp_path: Path, room: int) -> None:
    path = tmp_path / "rows"
    path.write_bytes(b"before\n")
    with path.open("ab", buffering=0) as file:
        disk = cast(BinaryIO, Full(cast(BinaryIO, file), room))
        if room < 60:
            with pytest.raises(OSError, match="space"):
                append(disk, 60 * b"x")
        else:
            append(disk, 60 * b"x")
    assert path.read_bytes() == b"before\n" + (b"" if room < 60 else 60 * b"x")


def test_where_nothing_can_be_written_it_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot write .*gone: no such file or directory"):
        append_lines(tmp_path / "no" / "gone", "a line\n")

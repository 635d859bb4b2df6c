"""The terminal is not needed for the result: closed, broken, full, or with few letters."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.end_to_end,
    pytest.mark.skipif(sys.platform == "win32", reason="a shell of POSIX"),
]

REPOSITORY = Path(__file__).parents[2]
RECORD = "record single_grain --steps 2 --size 320x240 --out last.png --data run.csv"


def shell(folder: Path, words: str, **extra: str) -> subprocess.CompletedProcess[bytes]:
    """The program as a shell starts it."""
    return subprocess.run(
        ["sh", "-c", f"exec '{sys.executable}' -m sandbox {words}"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(REPOSITORY), **extra},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=600,
    )


@pytest.mark.parametrize("page", ["cp1252", "ascii"])
@pytest.mark.parametrize("words", ["list", "record --help", "record höpper --data ν.csv"])
def test_every_command_works_under_every_code_page(tmp_path: Path, page: str, words: str) -> None:
    """Letters that a page lacks are replaced; all that it has are there."""
    done = shell(tmp_path, words, PYTHONIOENCODING=page)
    assert b"Traceback" not in done.stderr
    if "ν" in words:
        assert done.returncode == 2
        assert done.stderr.decode(page).startswith("error: no scene is called")
    else:
        assert done.returncode == 0, done.stderr
        plain = shell(tmp_path, words, PYTHONIOENCODING="utf-8").stdout.decode()
        assert done.stdout.decode(page) == plain.encode(page, "replace").decode(page)


@pytest.mark.parametrize("streams", ["2>&-", "<&- >&- 2>&-", "2>/dev/full"])
def test_record_needs_no_stream(tmp_path: Path, streams: str) -> None:
    done = shell(tmp_path, f"{RECORD} {streams}")
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["last.png", "run.csv"]
    assert len((tmp_path / "run.csv").read_text().splitlines()) == 4
    assert (tmp_path / "last.png").read_bytes().startswith(b"\x89PNG")


def test_record_goes_on_where_nobody_watches_the_bar(tmp_path: Path) -> None:
    """Standard error is a pipe whose reader is gone."""
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [sys.executable, "-m", "sandbox", *RECORD.split()],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(REPOSITORY)},
        stdout=subprocess.PIPE,
        stderr=writing,
        timeout=600,
    )
    os.close(writing)
    assert done.returncode == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["last.png", "run.csv"]


def test_what_was_printed_to_a_full_disk_is_missed(tmp_path: Path) -> None:
    """A list that did not arrive is told."""
    done = shell(tmp_path, "list >/dev/full")
    assert done.returncode == 2
    assert b"no room left" in done.stderr
    assert b"Traceback" not in done.stderr

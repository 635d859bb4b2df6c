"""What compiles while somebody looks at the window: one process, begun once, ended with the window."""

from __future__ import annotations

import subprocess
import sys

import pytest

from sandbox.beside import LOWEST
from sandbox.preparation import background, parts
from sandbox.preparation.background import Background


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    """The processes that were started; each would sleep for a minute."""
    processes: list[subprocess.Popen[bytes]] = []

    def start(wanted: list[str], niceness: int) -> subprocess.Popen[bytes] | None:
        assert niceness == LOWEST
        if not wanted:
            return None
        program = "import time; time.sleep(60.0)"
        processes.append(subprocess.Popen([sys.executable, "-c", program], stdin=subprocess.PIPE))
        return processes[-1]

    monkeypatch.setattr(background, "start", start)
    return processes


def test_it_begins_once_and_ends_with_the_window(
    started: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parts, "missing", lambda wanted: wanted[:1])
    work = Background()
    work.close()  # before it has begun
    work.begin()
    work.begin()
    (process,) = started
    assert process.poll() is None
    work.close()
    assert process.returncode is not None
    assert process.stdin is not None
    assert process.stdin.closed


def test_where_all_is_compiled_there_is_none(
    started: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parts, "missing", lambda wanted: [])
    work = Background()
    work.begin()
    work.close()
    assert started == []

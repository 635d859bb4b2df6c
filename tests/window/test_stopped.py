"""A request to end, as a system makes it that shuts down: the log is written, the work is found where it was."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from core.errors import InputError
from sandbox.files.autosave import Found, find
from sandbox.files.log_file import read_log
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import Protocol
from sandbox.session.replay import replay
from sandbox.session.session import Session
from tests.session.edited import built, do

REPOSITORY = Path(__file__).parents[2]
PATIENCE = 120.0  # [s]
# The real command, but its autosave is written soon, and a window that nobody sees is one.
PLAYS = """
import sys
from pathlib import Path
from sandbox import environment
from sandbox.cli.main import main
from sandbox.files import autosave

environment.require_display = lambda: None
autosave.begin = lambda: autosave.Autosave(Path("autosave"), every=0.05)
sys.exit(main(["play", "it.scene", "--log", "it.jsonl", "--size", "320x240"]))
"""


def saved(folder: Path, *, moving: bool) -> Session:
    """A session whose scene file lies there."""
    session = built(grains=5)
    do(session, *[Protocol(True)] * 2)
    if not moving:
        session.submit(Protocol(False))
        session.settle()
    write_scene(folder / "it.scene", session.made())
    return session


def window(folder: Path) -> subprocess.Popen[str]:
    """The real command with that file."""
    return subprocess.Popen(
        [sys.executable, "-c", PLAYS],
        cwd=folder,
        env={
            **os.environ,
            "PYTHONPATH": str(REPOSITORY),
            "SDL_VIDEODRIVER": "dummy",
            "SDL_AUDIODRIVER": "dummy",
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.end_to_end
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill -9 here")
def test_after_kill_9_log_and_autosave_are_there(tmp_path: Path) -> None:
    session = saved(tmp_path, moving=True)
    path = tmp_path / "it.jsonl"

    def has_grown() -> bool:
        try:
            return read_log(path).end >= 3
        except InputError:
            return False

    with window(tmp_path) as program:
        end = time.monotonic() + PATIENCE
        while not has_grown():
            assert program.poll() is None, program.communicate()
            assert time.monotonic() < end
            time.sleep(0.01)
        program.kill()
        program.communicate()
    log = read_log(path)
    assert list(replay(log))[-1].state_hash() == log.hash
    (leftover,) = find(tmp_path / "autosave").leftovers
    assert leftover.grains == len(session.run.setup.packing)


@pytest.mark.end_to_end
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_a_window_that_is_asked_to_end_saves(tmp_path: Path, name: str) -> None:
    if not hasattr(signal, name) or sys.platform == "win32":
        pytest.skip("no such request here")
    session = saved(tmp_path, moving=False)
    with window(tmp_path) as program:
        end = time.monotonic() + PATIENCE
        while not list((tmp_path / "autosave").glob("*.scene")):
            assert program.poll() is None, program.communicate()
            assert time.monotonic() < end
            time.sleep(0.05)
        number = getattr(signal, name)
        program.send_signal(number)
        _, said = program.communicate(timeout=PATIENCE)
    log = read_log(tmp_path / "it.jsonl")
    assert list(replay(log))[-1].state_hash() == log.hash == session.state_hash()
    assert "Traceback" not in said
    if name == "SIGINT":  # somebody at the terminal has had enough: as if the window was closed
        assert program.returncode == 0
        assert find(tmp_path / "autosave") == Found()
    else:
        assert program.returncode == 128 + number
        (leftover,) = find(tmp_path / "autosave").leftovers
        assert read_scene(leftover.path).grains.hash() == session.run.setup.packing.hash()

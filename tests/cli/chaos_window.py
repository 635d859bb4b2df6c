"""The window, stopped at random moments: what ``chaos.py`` does to the other commands, on a screen that nobody sees."""

from __future__ import annotations

import shutil
import signal
import time
from pathlib import Path

import imageio.v2

from core import files
from core.errors import InputError
from sandbox.files.autosave import find
from sandbox.files.log_file import read_log
from sandbox.session.replay import replay
from sandbox.window.film import found_films
from tests.window.screen import TOOLS, Person, invisible_screen, play

WORDS = ("hopper", "--set", "grains=60", "--set", "width=12", "--size", "640x480")
LOG, FILM = "run.jsonl", "sandbox-hopper-1.mp4"
PATIENCE = 120.0  # [s], of a machine that does other things too
CODES = {"SIGKILL": -9, "SIGTERM": 128 + 15, "SIGHUP": 128 + 1, "SIGINT": 0}

possible = all(map(shutil.which, TOOLS))


def once(folder: Path, fault: str, moment: float, token: str) -> str:
    """A script that is under way and filmed, until the fault; what was left, in words. Raises AssertionError as ``chaos.look``.

    A fault without a signal is a disk that has filled by then; a request to end follows.
    """
    with invisible_screen() as display:
        person = Person(display, folder)
        person.environment["CHAOS"] = token
        with play(person, *WORDS, "--log", LOG) as program:
            person.wait_for(lambda: end_of(folder) >= 0, PATIENCE, "a log")
            person.wait_for(person.find_window, PATIENCE, "the window")
            person.key("g")
            person.key("a")
            time.sleep(moment)
            program.send_signal(getattr(signal, fault, signal.SIGTERM))
            code, said = person.end(PATIENCE), person.said()
    assert "Traceback" not in said, said
    if fault in CODES:
        assert code == CODES[fault], (code, said)
    else:
        assert code in (2, 128 + signal.SIGTERM), (code, said)
    words = [_look_at_log(folder), _look_at_autosave(folder, fault)]
    return ", ".join([*words, *_look_at_film(folder, fault)])


def end_of(folder: Path) -> int:
    """How many increments the log has; -1 while there is none."""
    try:
        return read_log(folder / LOG).end
    except InputError:
        return -1


def _look_at_log(folder: Path) -> str:
    log = read_log(folder / LOG)
    *_, session = replay(log)
    assert session.state_hash() == log.hash, "the log lies"
    return f"a log of {log.end} increments"


def _look_at_autosave(folder: Path, fault: str) -> str:
    found = find(folder / "data" / "auxetic-sandbox" / "autosave")
    assert not found.set_aside, found
    if fault == "SIGINT":
        assert not found.leftovers, "an autosave after a clean end"
        return "no autosave"
    assert len(found.leftovers) <= 1, found
    # After a kill -9 at once there is none yet.
    assert found.leftovers or fault not in CODES or fault == "SIGKILL", "no autosave"
    for one in found.leftovers:
        assert one.file.state.going_on is not None
        return f"an autosave of {len(one.file.state.going_on.history)} rows"
    return "no autosave"


def _look_at_film(folder: Path, fault: str) -> list[str]:
    words = []
    if fault == "SIGKILL":
        time.sleep(files.SETTLED + 0.2)
        words = found_films(folder)
    elif (folder / FILM).exists():
        words = [FILM]
    hidden = [path.name for path in folder.iterdir() if path.name.startswith(".")]
    assert not hidden, hidden
    assert words or fault not in CODES, "no film"
    return [f"{len(imageio.v2.mimread(folder / name, memtest=False))} frames" for name in words]

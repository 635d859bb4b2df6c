"""The real program on a real X screen that nobody sees, with mouse and keys sent from outside."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pygame
import pytest
from numpy.typing import NDArray

from sandbox.draw.theme import HAND, channels

REPOSITORY = Path(__file__).parents[2]
TOOLS = ("Xvfb", "xdotool")

pytestmark = [
    pytest.mark.end_to_end,
    pytest.mark.skipif(
        not all(map(shutil.which, TOOLS)), reason=f"needs {' and '.join(TOOLS)} on the path"
    ),
]


@pytest.fixture
def display() -> Iterator[str]:
    """A screen of 1400 by 900 pixels."""
    reading, writing = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writing), "-screen", "0", "1400x900x24", "-nolisten", "tcp"],
        pass_fds=(writing,),
        stderr=subprocess.DEVNULL,
    )
    os.close(writing)
    with os.fdopen(reading) as pipe:
        number = pipe.readline().strip()
    yield f":{number}"
    server.terminate()
    server.wait(10)


def wait_for(condition: Callable[[], object], seconds: float, what: str) -> None:
    patience = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < patience, f"waited in vain for {what}"
        time.sleep(0.05)


class Person:
    """Sends keys and mouse to the one window of a screen, and looks at its screenshots."""

    def __init__(self, display: str, folder: Path) -> None:
        self.environment = {**os.environ, "DISPLAY": display}
        self.folder = folder

    def do(self, *words: object) -> str:
        done = subprocess.run(
            ["xdotool", *map(str, words)],
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
        )
        return done.stdout.strip()

    def find_window(self) -> bool:
        found = self.do("search", "--onlyvisible", "--class", ".").split()
        if found:
            self.do("windowfocus", "--sync", found[-1])
            shown = self.do("getwindowgeometry", "--shell", found[-1])
            numbers = dict(line.split("=") for line in shown.splitlines())
            self.corner = int(numbers["X"]), int(numbers["Y"])
        return bool(found)

    def key(self, name: str) -> None:
        self.do("key", name)

    def screenshot(self) -> NDArray[np.uint8]:
        before = set(self.folder.glob("sandbox*.png"))
        self.key("F12")
        wait_for(lambda: set(self.folder.glob("sandbox*.png")) - before, 20, "a screenshot")
        (path,) = set(self.folder.glob("sandbox*.png")) - before
        return pygame.surfarray.array3d(pygame.image.load(path))  # (width, height, 3)

    def knob(self) -> tuple[int, int] | None:
        """The middle of the largest orange thing, on the screen: not the thin arrow."""
        orange = (self.screenshot() == channels(HAND)).all(axis=-1)
        sums = np.pad(orange.astype(int).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
        size = 17
        boxes = (
            sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]
        )
        x, y = np.unravel_index(boxes.argmax(), boxes.shape)
        if boxes.max() < size * size // 4:
            return None
        return self.corner[0] + int(x) + size // 2, self.corner[1] + int(y) + size // 2


@pytest.fixture
def person(display: str, tmp_path: Path) -> Person:
    return Person(display, tmp_path)


@contextmanager
def play(person: Person, *words: str) -> Iterator[subprocess.Popen[str]]:
    """The program, ended in any case."""
    environment = {
        **person.environment,
        "SDL_VIDEODRIVER": "x11",
        "SDL_AUDIODRIVER": "dummy",
        "PYTHONPATH": str(REPOSITORY),
    }
    with subprocess.Popen(
        [sys.executable, "-m", "sandbox", "play", *words],
        cwd=person.folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as program:
        try:
            yield program
        finally:
            program.kill()


def test_open_drag_and_quit(person: Person) -> None:
    log = person.folder / "run.jsonl"
    with play(person, "intruder", "--set", "grains=150", "--log", str(log)) as program:
        wait_for(person.find_window, 60, "the window")
        person.key("f")  # nothing on the canvas is orange but handle and hand
        place: list[tuple[int, int]] = []

        def seen() -> bool:
            found = person.knob()
            place.extend([found] if found else [])
            return bool(place)

        wait_for(seen, 180, "the scene: the first start compiles")
        x, y = place[0]
        person.do("mousemove", x, y, "mousedown", 1)
        for step in range(1, 16):
            person.do("mousemove", x + 4 * step, y)
            time.sleep(0.03)
        time.sleep(2.0)
        moved = person.screenshot()
        person.do("mouseup", 1)
        person.key("h")
        assert not np.array_equal(person.screenshot(), moved)
        person.key("Escape")  # the page of keys
        person.key("Escape")  # to the menu
        menu = person.screenshot()
        assert not np.array_equal(menu, moved)
        person.key("Escape")  # out
        _, errors = program.communicate(timeout=30)
    assert program.returncode == 0, errors
    assert errors == ""
    lines = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    done = [line["command"] for line in lines if "command" in line]
    assert done[0] == "grab"
    assert done[-1] == "release"
    assert "move" in done
    assert lines[-1]["end"] > 0


def test_menu_to_a_scene_by_keyboard(person: Person) -> None:
    with play(person) as program:
        wait_for(person.find_window, 60, "the window")
        # The keys count once the menu is there; the splash lets them pass too.
        person.key("Right")
        person.key("Return")
        wait_for(lambda: person.knob() is not None, 180, "the scene")
        person.key("m")
        person.key("Escape")
        _, errors = program.communicate(timeout=30)
    assert program.returncode == 0, errors
    assert errors == ""

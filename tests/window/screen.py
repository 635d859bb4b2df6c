"""The real program on a real X screen that nobody sees, with mouse and keys sent from outside.

Programs of Debian's do it: Xvfb is the screen, xdotool the person's hands.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import numpy as np
import pygame
import pytest
from numpy.typing import NDArray

from sandbox.draw.theme import HAND, channels

REPOSITORY = Path(__file__).parents[2]
TOOLS = ("Xvfb", "xdotool")

needs_screen = pytest.mark.skipif(
    not all(map(shutil.which, TOOLS)), reason=f"needs {' and '.join(TOOLS)} on the path"
)


@contextmanager
def invisible_screen(width: int = 1400, height: int = 900) -> Iterator[str]:
    """The name of a screen of that many pixels."""
    reading, writing = os.pipe()
    server = subprocess.Popen(
        [
            "Xvfb",
            "-displayfd",
            str(writing),
            "-screen",
            "0",
            f"{width}x{height}x24",
            "-nolisten",
            "tcp",
            "-noreset",  # else it begins anew whenever xdotool was its only client, and lets nobody in meanwhile
        ],
        pass_fds=(writing,),
        stderr=subprocess.DEVNULL,
    )
    os.close(writing)
    with os.fdopen(reading) as pipe:
        number = pipe.readline().strip()
    try:
        yield f":{number}"
    finally:
        server.terminate()
        server.wait(10)


class Person:
    """Sends keys and mouse to the one window of a screen, looks at its screenshots, and waits for what is to be seen there."""

    program: subprocess.Popen[bytes]  # that is played, and what it writes to standard error
    errors: IO[bytes]

    def __init__(self, display: str, folder: Path) -> None:
        # A home of its own: nothing that an earlier program left behind is offered in the menu.
        own = {"XDG_DATA_HOME": str(folder / "data"), "XDG_CONFIG_HOME": str(folder / "config")}
        self.environment = {**os.environ, "DISPLAY": display, **own}
        self.folder = folder

    def wait_for(
        self,
        condition: Callable[[], object],
        seconds: float,
        what: str,
        seen: Callable[[], object] = str,
    ) -> None:
        """Says why it was in vain: that the program has ended, or where it is; what it wrote; and what was ``seen`` last."""
        patience = time.monotonic() + seconds
        while not condition():
            code = self.program.poll()
            assert code is None, f"ended with {code} before {what}: {self.said()}"
            assert time.monotonic() < patience, f"in vain for {what}: {seen()}\n{self._stopped()}"
            time.sleep(0.05)

    def said(self) -> str:
        """All that the program has written to standard error."""
        self.errors.seek(0)
        return self.errors.read().decode()

    def end(self, seconds: float) -> int:
        """The exit code, once the program has ended."""
        try:
            return self.program.wait(seconds)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"in vain for the end: {self._stopped()}") from None

    def _stopped(self) -> str:
        """What the program has said, and where each of its threads was; that ends it."""
        self.program.send_signal(signal.SIGABRT)
        self.program.wait(10)
        return self.said()

    def do(self, *words: object) -> str:
        done = subprocess.run(
            ["xdotool", *map(str, words)],
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
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
        self.wait_for(lambda: set(self.folder.glob("sandbox*.png")) - before, 20, "a screenshot")
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


@contextmanager
def play(person: Person, *words: str) -> Iterator[subprocess.Popen[bytes]]:
    """The program, ended in any case. What it says goes into a file: a pipe that nobody reads would stop it once it is full."""
    environment = {
        **person.environment,
        "SDL_VIDEODRIVER": "x11",
        "SDL_AUDIODRIVER": "dummy",
        "PYTHONPATH": str(REPOSITORY),
    }
    command = [sys.executable, "-X", "faulthandler", "-m", "sandbox", "play", *words]
    with (
        tempfile.TemporaryFile("a+b") as person.errors,  # at its end, wherever it is read meanwhile
        subprocess.Popen(
            command,
            cwd=person.folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=person.errors,
        ) as person.program,
    ):
        try:
            yield person.program
        finally:
            person.program.kill()

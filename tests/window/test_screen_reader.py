"""What a screen reader finds and can do: the real window, asked over a bus of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.window.bus import FOCUSED, PRESSED, SLIDER, At, Listener, needs_bus, private_bus
from tests.window.screen import (
    REPOSITORY,
    Person,
    invisible_screen,
    needs_screen,
    play,
)

pytestmark = [pytest.mark.end_to_end, needs_screen, needs_bus]

# A window that is busy while a reader comes, and then gets the keyboard, without a pause that would let AccessKit's thread in.
BUSY_WINDOW = """
import sys, time
from types import SimpleNamespace
import pygame
from sandbox.window.access.reader import Reader

pygame.display.init()
pygame.display.set_mode((300, 200))
reader = Reader(SimpleNamespace(stage=None, guide=None))
sys.setswitchinterval(60.0)
begun = time.perf_counter()
while time.perf_counter() < begun + 2.0:
    pass
for kind in (pygame.WINDOWSHOWN, pygame.WINDOWFOCUSGAINED):
    reader.watch(pygame.event.Event(kind))
while reader._reader is None:
    time.sleep(0.01)
"""


@pytest.fixture
def person(tmp_path: Path) -> Iterator[Person]:
    with invisible_screen() as display, private_bus(tmp_path) as environment:
        person = Person(display, tmp_path)
        person.environment.update(environment)
        yield person


def test_a_reader_that_comes_when_the_keyboard_does_stops_no_window(tmp_path: Path) -> None:
    with private_bus(tmp_path) as environment:
        reader = Listener(environment["DBUS_SESSION_BUS_ADDRESS"])
        driver = {"SDL_VIDEODRIVER": "dummy", "PYTHONPATH": str(REPOSITORY)}
        subprocess.run(
            [sys.executable, "-c", BUSY_WINDOW],
            env={**os.environ, **environment, **driver},
            check=True,
            timeout=120,
        )
        reader.close()


def test_controls_are_read_and_used_and_what_happens_is_said(person: Person) -> None:
    reader = Listener(person.environment["DBUS_SESSION_BUS_ADDRESS"])

    def find(name: str) -> At:
        found: list[At] = []

        def there() -> bool:
            found.extend(filter(None, [reader.named(name)]))
            return bool(found)

        person.wait_for(there, 180, name, lambda: reader.latest)
        return found[0]

    with reader.announcements(), play(person, "single_grain") as program:
        person.wait_for(person.find_window, 60, "the window")
        slider = find("grains/poisson_ratio")
        assert reader.get(slider, "Name") == "Poisson's ratio"
        assert reader.call(slider, "Accessible", "GetRole") == SLIDER
        ends = [reader.get(slider, f"{which}Value", "Value") for which in ("Minimum", "Maximum")]
        assert ends == [0.0, 0.99]
        reader.set_value(slider, 0.5)
        person.wait_for(lambda: reader.get(slider, "CurrentValue", "Value") == 0.5, 20, "the value")

        assert reader.call(slider, "Component", "GrabFocus") is True
        person.wait_for(lambda: reader.state(slider, FOCUSED), 20, "the keyboard")
        person.key("Right")
        person.wait_for(lambda: reader.get(slider, "CurrentValue", "Value") == 0.51, 20, "one step")

        reader.press(find("general/drive"))
        said: list[str] = []

        def heard() -> bool:
            said.extend(reader.heard())
            return "scripted drive on" in said

        person.wait_for(heard, 20, "what is said")

        brush = find("general/brush")  # which stays as it is put; the drive soon comes to its end
        assert not reader.state(brush, PRESSED)
        reader.press(brush)
        person.wait_for(lambda: reader.state(brush, PRESSED), 20, "the brush")

        reader.press(find("general/help"))
        find("help/close")
        assert reader.named("general/drive") is None  # the page lies over it
        program.kill()
    reader.close()

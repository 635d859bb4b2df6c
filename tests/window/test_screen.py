"""The smallest use of the real program on a real screen: open, drag, look, quit."""

from __future__ import annotations

import json
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.window.screen import Person, invisible_screen, needs_screen, play

pytestmark = [pytest.mark.end_to_end, needs_screen]


@pytest.fixture
def person(tmp_path: Path) -> Iterator[Person]:
    with invisible_screen() as display:
        yield Person(display, tmp_path)


def test_open_drag_and_quit(person: Person) -> None:
    log = person.folder / "run.jsonl"
    with play(person, "intruder", "--set", "grains=150", "--log", str(log)):
        person.wait_for(person.find_window, 60, "the window")
        person.key("f")  # nothing on the canvas is orange but handle and hand
        place: list[tuple[int, int]] = []

        def seen() -> bool:
            found = person.knob()
            place.extend([found] if found else [])
            return bool(place)

        person.wait_for(seen, 180, "the scene: the first start compiles")
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
        person.key("Escape")  # what is still said there
        person.key("Escape")  # out
        assert (person.end(30), person.said()) == (0, "")
    lines = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    done = [line["command"] for line in lines if "command" in line]
    assert done[0] == "grab"
    assert done[-1] == "release"
    assert "move" in done
    assert lines[-1]["end"] > 0


def test_menu_to_a_scene_by_keyboard(person: Person) -> None:
    with play(person):
        person.wait_for(person.find_window, 60, "the window")
        # The keys count once the menu is there; the splash lets them pass too.
        person.key("Right")
        person.key("Return")
        person.wait_for(lambda: person.knob() is not None, 180, "the scene")
        person.key("m")
        person.key("Escape")
        assert (person.end(30), person.said()) == (0, "")


# X keycodes of the keys for A and Z, by what is printed on them or stands in their place.
KEYBOARDS = {"de": (38, 29), "fr": (24, 25), "ru": (38, 52), "gr": (38, 52)}
CAPS_LOCK, CONTROL = 66, 37


@pytest.mark.skipif(not shutil.which("setxkbmap"), reason="needs setxkbmap on the path")
def test_keys_of_other_keyboards(person: Person) -> None:
    """The drive, undo with Caps Lock on and with Ctrl: on each keyboard the same commands."""
    log = person.folder / "run.jsonl"

    def told() -> tuple[list[str], int]:
        """Commands so far, and increments."""
        text = log.read_text(encoding="utf-8") if log.exists() else ""
        lines = [json.loads(line) for line in text.splitlines() if line.endswith("}")]
        increments = [line["end"] for line in lines if "end" in line]
        return [line["command"] for line in lines if "command" in line], max(increments, default=0)

    with play(person, "single_grain", "--log", str(log)) as program:
        person.wait_for(person.find_window, 60, "the window")
        person.wait_for(
            lambda: person.knob() is not None, 180, "the scene: the first start compiles"
        )
        wanted = 0
        for keyboard, (drive, undo) in KEYBOARDS.items():
            subprocess.run(["setxkbmap", keyboard], env=person.environment, check=True)
            for keys in ((CAPS_LOCK, undo, CAPS_LOCK), (f"{CONTROL}+{undo}",)):
                before = told()[1]
                person.key(str(drive))
                person.wait_for(
                    lambda before=before: told()[1] > before,  # type: ignore[misc]
                    20,
                    f"the drive on {keyboard}",
                )
                for key in keys:
                    person.key(str(key))
                wanted += 1
                person.wait_for(
                    lambda wanted=wanted: told()[0] == ["protocol", "undo"] * wanted,  # type: ignore[misc]
                    20,
                    f"undo on {keyboard}",
                )
        program.kill()

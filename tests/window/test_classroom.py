"""A lesson on a real screen: menu, hopper, piston, another Poisson's ratio, side by side, a film, the end.

The person's hands are Xvfb's and xdotool's. Where a control is, a twin of the window says, which has
the same size and no physics.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from pathlib import Path

import imageio.v2 as imageio
import numpy as np
import pygame
import pytest

from sandbox.draw.theme import HAND, channels
from tests.window.desk import Desk
from tests.window.screen import Person, invisible_screen, needs_screen, play

pytestmark = [pytest.mark.end_to_end, pytest.mark.slow, needs_screen]

WIDTH, HEIGHT = 1280, 720


@pytest.fixture
def person(tmp_path: Path) -> Iterator[Person]:
    with invisible_screen(WIDTH, HEIGHT) as display:
        yield Person(display, tmp_path)


@pytest.fixture
def twin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Desk]:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "no data"))
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setenv("SDL_AUDIODRIVER", "dummy")
    desk = Desk((WIDTH, HEIGHT))
    desk.app.stage.screen = pygame.Surface((WIDTH, HEIGHT))
    desk.app.stage.renderer.resize((WIDTH, HEIGHT))
    yield desk
    desk.app.close()


def drag(person: Person, start: tuple[int, int], way: tuple[int, int], seconds: float) -> None:
    """Press, move in steps, let go."""
    person.do("mousemove", *start, "mousedown", 1)
    for step in range(1, 13):
        x, y = (start[k] + way[k] * step // 12 for k in (0, 1))
        person.do("mousemove", x, y)
        time.sleep(seconds / 12)
    person.do("mouseup", 1)


def keys_to_the_hopper(twin: Desk) -> int:
    """How often Tab must be pressed in the menu."""
    twin.app.pages.open_menu()
    twin.until(lambda: not twin.app._splash)
    twin.app.tick()
    for presses in range(40):
        if twin.app.pages.menu.chosen == "scene/hopper":
            return presses
        twin.key(pygame.K_TAB)
    raise AssertionError("the menu has no hopper")


def control(twin: Desk, name: str) -> pygame.Rect:
    """Where a control of the panel is."""
    place = twin.app.panel.place_of(name)
    assert place is not None, name
    return place


def menu_is_there(person: Person) -> bool:
    """Is something ringed in orange? The splash has no such thing."""
    return int((person.screenshot() == channels(HAND)).all(axis=-1).sum()) > 500


def has_both_kinds(person: Person) -> bool:
    """Are there regular grains alone at the left of the canvases, auxetic ones alone at the right?"""
    shown = person.screenshot()[:960, 80:440].astype(int)
    blue = shown[..., 2] - shown[..., 0] > 60
    pink = shown[..., 0] - shown[..., 1] > 60
    pink &= shown[..., 2] > shown[..., 1]  # the hand is orange
    left, right = slice(0, 300), slice(660, 960)
    return bool(
        blue[left].sum() > max(3000, 20 * pink[left].sum())
        and pink[right].sum() > max(3000, 20 * blue[right].sum())
    )


def test_a_lesson(person: Person, twin: Desk) -> None:
    presses = keys_to_the_hopper(twin)
    twin.app.stage.start("hopper")
    twin.until(lambda: not twin.app._splash and not twin.app.stage.show_menu)
    twin.app.tick()
    log = person.folder / "lesson.jsonl"
    words = ["--size", f"{WIDTH}x{HEIGHT}", "--scale", "1", "--language", "en", "--log", str(log)]
    with play(person, *words) as program:
        person.wait_for(person.find_window, 60, "the window")
        person.wait_for(lambda: menu_is_there(person), 60, "the menu")
        for _ in range(presses):
            person.key("Tab")
        person.key("Return")
        person.wait_for(
            lambda: person.knob() is not None, 240, "the hopper: the first start compiles"
        )

        place = person.knob()
        assert place is not None
        before = person.screenshot()
        drag(person, place, (0, 40), 1.5)
        time.sleep(1.0)
        assert not np.array_equal(person.screenshot()[:900, 60:480], before[:900, 60:480])

        slider = control(twin, "grains/auxetic_poisson_ratio")
        person.do("mousemove", slider.left + 30, slider.bottom - 18, "click", 1)
        time.sleep(1.0)

        person.do("mousemove", *control(twin, "general/compare").center, "click", 1)
        person.wait_for(lambda: has_both_kinds(person), 120, "three packings side by side")

        person.key("g")
        place = person.knob()
        assert place is not None
        drag(person, place, (0, 30), 2.0)
        time.sleep(1.0)
        person.key("g")
        person.wait_for(lambda: list(person.folder.glob("*.mp4")), 60, "the film")

        for _ in range(5):  # what is open is closed first, then the scene, then the window
            if program.poll() is None:
                person.key("Escape")
                time.sleep(0.5)
        assert (person.end(60), person.said()) == (0, "")

    (film,) = person.folder.glob("*.mp4")
    frames = imageio.mimread(film, memtest=False)
    assert len(frames) > 30
    assert frames[10].shape == (HEIGHT, WIDTH, 3)
    done = [
        line
        for line in map(json.loads, log.read_text(encoding="utf-8").splitlines())
        if "command" in line
    ]
    kinds = [line["command"] for line in done]
    assert kinds.count("grab") >= 2
    assert kinds.count("release") >= 2
    changes = [line for line in done if line["command"] == "change"]
    assert {line["name"] for line in changes} == {"auxetic_poisson_ratio"}
    assert changes[-1]["value"] < -0.8

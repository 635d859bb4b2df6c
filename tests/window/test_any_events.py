"""Whatever a person does, in any order: the window goes on, and the keyboard is somewhere."""

from __future__ import annotations

import random
from pathlib import Path

import pygame
import pytest

from sandbox.window.explore.explorer import Explorer
from tests.window.desk import Desk

SPECIAL = (
    pygame.K_TAB,
    pygame.K_RETURN,
    pygame.K_LEFT,
    pygame.K_RIGHT,
    pygame.K_UP,
    pygame.K_DOWN,
    pygame.K_PAGEUP,
    pygame.K_PAGEDOWN,
    pygame.K_HOME,
    pygame.K_END,
    pygame.K_DELETE,
    pygame.K_BACKSPACE,
    pygame.K_ESCAPE,
)
SIGNS = " 0123456789abcefhiklmnprstvyz-,.[]+"  # no film, no sound, no scene file


@pytest.fixture(autouse=True)
def own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Explorer, "begin", lambda *_: None)  # no processes by chance


def some_key(chance: random.Random, desk: Desk) -> None:
    if chance.random() < 0.5:
        mod = chance.choice((0, 0, pygame.KMOD_LSHIFT, pygame.KMOD_LCTRL))
        desk.key(chance.choice(SPECIAL), mod=mod)
    else:
        sign = chance.choice(SIGNS)
        desk.key(ord(sign), sign, chance.choice((0, 0, 0, pygame.KMOD_LCTRL)))


def some_press(chance: random.Random, desk: Desk) -> None:
    width, height = desk.app.stage.renderer.size
    start = chance.randrange(width), chance.randrange(height)
    end = start[0] + chance.randrange(-60, 60), start[1] + chance.randrange(-60, 60)
    desk.point(start)
    desk.press(start)
    desk.point(end, pressed=True)
    desk.release(end)


def test_any_events_leave_the_window_in_order() -> None:
    chance = random.Random(1)
    desk = Desk((1024, 720))
    desk.start()
    for _ in range(160):
        if chance.random() < 0.6:
            some_key(chance, desk)
        else:
            some_press(chance, desk)
        app = desk.app
        if not app.stage.running or app.stage.show_menu or app.stage.show_help:
            app.stage.running, app.stage.show_help = True, False
            app.stage.start("intruder")
            desk.until(lambda: not desk.app._splash)
        assert app.stage.panes.snapshot.phase != "failed", app.stage.panes.snapshot.error
        app.tick()
        assert 0 <= app.panel.scroll <= max(app.panel._places.height - app.panel._view, 0)
        assert app.panel.edit is None or app.panel.edit.name == app.stage.focus.name
        app.stage.focus.move(1)
        assert app.stage.focus.name in app.stage.focus.stops()
        app.stage.focus.move(-1)
    desk.app.close()

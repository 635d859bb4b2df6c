"""What a person at the window waits for, and how the keyboard comes to a part of it."""

from __future__ import annotations

import pygame

from sandbox.session.commands import (
    Command,
)
from tests.window.desk import Desk


def sent(desk: Desk) -> list[Command]:
    return desk.session.commands


def increment(desk: Desk) -> int:
    frame = desk.app.stage.panes.snapshot.frame
    assert frame is not None
    return frame.increment


def some_increments(desk: Desk, count: int) -> None:
    """So many increments, then a pause."""
    desk.key(pygame.K_a)
    desk.until(lambda: increment(desk) >= count)
    desk.key(pygame.K_a)
    desk.key(pygame.K_SPACE)
    desk.until(lambda: not desk.session.busy and not desk.session.frame().protocol)
    desk.app.tick()


def tab_to(desk: Desk, name: str) -> None:
    for _ in range(60):
        if desk.app.stage.focus.ring == name:
            return
        desk.key(pygame.K_TAB)
    raise AssertionError(f"Tab never came to {name}")


def grain_place(desk: Desk, index: int) -> tuple[float, float]:
    frame, camera, _ = desk.app.stage.picture.panes()[0]
    return camera.to_screen(float(frame.x[index]), float(frame.y[index]))

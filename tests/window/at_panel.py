"""What a person at the window finds and waits for: a control by its name, by mouse and by Tab, a grain, increments."""

from __future__ import annotations

import pygame

from sandbox.draw.widgets.controls import (
    Slider,
    parts_of,
)
from sandbox.session.commands import Command
from tests.window.desk import Desk


def box(desk: Desk, name: str) -> pygame.Rect:
    """Where a control is, scrolled into view."""
    panel = desk.app.panel
    panel.scroll = panel._places.scroll_to(name, panel.scroll, panel._view, 0)
    desk.app.tick()
    rect = panel.place_of(name)
    assert rect is not None, name
    return rect


def control(desk: Desk, name: str) -> object:
    place = desk.app.panel._places.named(name)
    return None if place is None else place.control


def value(desk: Desk, name: str) -> float:
    found = control(desk, name)
    assert isinstance(found, Slider)
    return found.value


def track(desk: Desk, name: str) -> pygame.Rect:
    box(desk, name)
    place = desk.app.panel._places.named(name)
    assert place is not None
    parts = parts_of(place.control, place.rect, desk.app.stage.renderer.type)
    return parts.track.move(desk.app.panel.rect.left, -desk.app.panel.scroll)


def number(desk: Desk, name: str) -> tuple[int, int]:
    box(desk, name)
    place = desk.app.panel._places.named(name)
    assert place is not None
    parts = parts_of(place.control, place.rect, desk.app.stage.renderer.type)
    return parts.box.move(desk.app.panel.rect.left, -desk.app.panel.scroll).center


def go_to(desk: Desk, name: str) -> None:
    """By Tab alone."""
    for _ in range(90):
        if desk.app.stage.focus.ring == name:
            return
        desk.key(pygame.K_TAB)
    raise AssertionError(f"Tab never came to {name}")


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


def grain_place(desk: Desk, index: int) -> tuple[float, float]:
    frame, camera, _ = desk.app.stage.picture.panes()[0]
    return camera.to_screen(float(frame.x[index]), float(frame.y[index]))

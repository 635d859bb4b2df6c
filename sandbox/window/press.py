"""What a press or a key means to a control: the value that it asks for."""

from __future__ import annotations

from dataclasses import dataclass

import pygame

from sandbox.draw.widgets.controls import (
    Button,
    Choice,
    Heading,
    Parts,
    Place,
    Simple,
    Slider,
    Stepper,
    Switch,
    TextField,
    neighbour,
)
from sandbox.window.sections import Value

LESS = (pygame.K_LEFT, pygame.K_DOWN)
MORE = (pygame.K_RIGHT, pygame.K_UP)
ENTER = (pygame.K_RETURN, pygame.K_KP_ENTER)
PUSH = (*ENTER, pygame.K_SPACE)
ERASE = (pygame.K_DELETE, pygame.K_BACKSPACE)
NUMERIC = frozenset("0123456789-−")


@dataclass
class Press:
    """A button of the mouse that is down on the panel, or a finger."""

    start: tuple[int, int]
    scroll: int  # of the panel then
    place: Place | None  # the control under it
    slides: bool = False  # it moves a slider
    pans: bool = False  # it scrolls


@dataclass(frozen=True, slots=True)
class Asked:
    """What a key asks for. Not ``done``: more may come."""

    value: Value = True
    done: bool = True
    edits: bool = False  # begin to type
    sign: bool = False  # and the key is the first sign


def pressed(control: Simple, parts: Parts, at: tuple[int, int]) -> Value | None:
    """The value that a click asks for; None if that place means nothing."""
    match control:
        case Switch(on=on):
            return not on
        case Button(enabled=enabled):
            return True if enabled else None
        case Choice(options=options):
            for option, rect in zip(options, parts.options, strict=False):
                if rect.collidepoint(at):
                    return option.value
            if parts.arrows is not None:
                less = parts.arrows[0].collidepoint(at)
                return neighbour(control, -1 if less else 1)
        case Stepper(value=value, low=low, high=high):
            assert parts.arrows is not None
            for rect, way in zip(parts.arrows, (-1, 1), strict=True):
                if rect.collidepoint(at):
                    return min(max(value + way, low), high)
    return None


def keyed(control: Simple, event: pygame.event.Event) -> Asked | None:
    """What a KEYDOWN event asks of the control that has the keyboard; None: it is for others."""
    key = event.key
    if getattr(event, "mod", 0) & (pygame.KMOD_CTRL | pygame.KMOD_ALT | pygame.KMOD_META):
        return None
    match control:
        case Slider():
            return _keyed_slider(control, event)
        case Stepper(value=value, low=low, high=high):
            if key in (*LESS, *MORE):
                return Asked(min(max(value + (1 if key in MORE else -1), low), high))
            return _typing(event)
        case Switch(on=on, default=default):
            if key in PUSH:
                return Asked(not on)
            if key in (*LESS, *MORE):
                return Asked(key in MORE)
            if key in ERASE and default is not None:
                return Asked(default)
        case Choice():
            if key in (*LESS, *MORE):
                return Asked(
                    neighbour(control, 1 if key in (pygame.K_RIGHT, pygame.K_DOWN) else -1)
                )
        case Button(enabled=enabled):
            if key in PUSH and enabled:
                return Asked()
        case TextField():
            if key in ENTER:
                return Asked(edits=True)
        case Heading(open=is_open):
            if key in PUSH:
                return Asked(not is_open)
            if key in (pygame.K_LEFT, pygame.K_RIGHT):
                return Asked(key == pygame.K_RIGHT)
    return None


def _keyed_slider(slider: Slider, event: pygame.event.Event) -> Asked | None:
    key, range_, done = event.key, slider.range, slider.at_once
    if key in (*LESS, *MORE):
        return Asked(range_.stepped(slider.value, 1 if key in MORE else -1), done)
    if key in (pygame.K_PAGEUP, pygame.K_PAGEDOWN):
        steps = 1 if key == pygame.K_PAGEUP else -1
        return Asked(range_.stepped(slider.value, steps, pages=True), done)
    if key in (pygame.K_HOME, pygame.K_END):
        return Asked(slider.low if key == pygame.K_HOME else slider.high, done)
    if key in ERASE:
        return Asked(slider.default)
    return _typing(event)


def _typing(event: pygame.event.Event) -> Asked | None:
    """Enter, or the first sign of a number."""
    if event.key in ENTER:
        return Asked(edits=True)
    sign = getattr(event, "unicode", "")
    return Asked(edits=True, sign=True) if sign and sign in NUMERIC else None

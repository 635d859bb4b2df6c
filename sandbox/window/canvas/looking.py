"""Looking more closely: wheel, two fingers or keys bring the grains nearer, and the right or the middle button moves them.

The same part is seen of all packings side by side. Nothing of it is a command: what is looked at changes no run.
"""

from __future__ import annotations

import math

import pygame

from sandbox.draw.camera import ALL, Sight
from sandbox.draw.numbers import number
from sandbox.window.keys import Action
from sandbox.window.parts import Silent
from sandbox.window.stage import Stage
from sandbox.words import words

NOTCH = 1.2  # nearer with one notch of the wheel
PRESS = 1.5  # and with one press of a key
PINCH = 4.0  # the logarithm of nearer, for two fingers that part on a pad by as much as it is wide
STEP = 0.15  # of the canvas, that a press of an arrow key moves it
HOLDS = (pygame.BUTTON_MIDDLE, pygame.BUTTON_RIGHT)
WAYS = {
    Action.LOOK_LEFT: (1.0, 0.0),
    Action.LOOK_RIGHT: (-1.0, 0.0),
    Action.LOOK_UP: (0.0, 1.0),
    Action.LOOK_DOWN: (0.0, -1.0),
}

Point = tuple[float, float]


class Looking(Silent):
    """Which part of the picture is seen."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self._pointer = (-1, -1)
        self._held_in: int | None = None  # the pane in which the picture is held and moved
        self._touched = False  # is there a screen that is touched, and not a pad beside it?
        self._fingers: dict[int, Point] = {}  # on the screen [px]
        stage.at_new_scene(self.forget)

    def forget(self) -> None:
        """All is seen again."""
        self.stage.renderer.sight = ALL
        self._held_in = None

    def _nearer(self, factor: float, place: Point, pane: int) -> None:
        """So many times nearer, towards a place [px]."""
        renderer = self.stage.renderer
        whole, body = renderer.wholes[pane], renderer.bodies[pane]
        self._look(renderer.sight.towards(factor, place, whole, body))

    def _move(self, dx: float, dy: float, pane: int) -> None:
        """Push the picture by so many pixels."""
        renderer = self.stage.renderer
        whole, body = renderer.wholes[pane], renderer.bodies[pane]
        self._look(renderer.sight.moved(dx, dy, whole, body))

    def _look(self, sight: Sight) -> None:
        renderer = self.stage.renderer
        if sight.nearer != renderer.sight.nearer:
            times = words.NEARER.format(count=number(sight.nearer, 1))
            self.stage.toast(times if sight.nearer > 1.0 else words.WHOLE)
        renderer.sight = sight
        self.stage.redraw(True)

    # -- what a person does --

    def act(self, action: Action) -> bool:
        """Keys: nearer and farther from the middle, all of it, aside."""
        body = self.stage.renderer.bodies[0]
        if action in (Action.NEARER, Action.FARTHER):
            self._nearer(PRESS if action is Action.NEARER else 1.0 / PRESS, body.center, 0)
        elif action is Action.WHOLE:
            self._look(ALL)
        elif action in WAYS:
            x, y = WAYS[action]
            self._move(STEP * body.width * x, STEP * body.height * y, 0)
        else:
            return False
        return True

    def handle(self, event: pygame.event.Event) -> bool:
        """Wheel, buttons and fingers, where they are on a canvas."""
        if event.type in (pygame.FINGERDOWN, pygame.FINGERMOTION, pygame.FINGERUP):
            return self._finger(event)
        if event.type == pygame.MULTIGESTURE:
            return self._pad(event)
        if event.type == pygame.MOUSEWHEEL:
            pane = self.stage.picture.pane_at(self._pointer)
            if pane is not None:
                self._nearer(NOTCH**event.precise_y, self._pointer, pane)
            return pane is not None
        if event.type in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            if getattr(event, "touch", False):  # SDL makes a mouse of the first finger
                self._touched = True
                if len(self._fingers) > 1:
                    return True
            return self._mouse(event)
        return False

    def _mouse(self, event: pygame.event.Event) -> bool:
        before, self._pointer = self._pointer, event.pos
        if event.type == pygame.MOUSEBUTTONDOWN and event.button in HOLDS:
            self._held_in = self.stage.picture.pane_at(event.pos)
            return self._held_in is not None
        if self._held_in is None:
            return False
        if event.type == pygame.MOUSEMOTION:
            self._move(event.pos[0] - before[0], event.pos[1] - before[1], self._held_in)
            return True
        if event.type == pygame.MOUSEBUTTONUP and event.button in HOLDS:
            self._held_in = None
            return True
        return False

    def _finger(self, event: pygame.event.Event) -> bool:
        """Two fingers on a screen: what is under them stays under them."""
        width, height = self.stage.renderer.size
        there = event.x * width, event.y * height
        if event.type == pygame.FINGERUP:
            self._fingers.pop(event.finger_id, None)
            return False
        before = dict(self._fingers)
        if event.type == pygame.FINGERDOWN or event.finger_id in before:
            self._fingers[event.finger_id] = there
        if len(self._fingers) < 2 or not self._touched:
            return False
        if event.type == pygame.FINGERDOWN:
            self.stage.mouse.release(self.stage.send)  # what the first finger has taken
            return True
        pane = self.stage.picture.pane_at(_rounded(_between(before)))
        if pane is not None and len(before) == len(self._fingers) == 2:
            (x0, y0), (x1, y1) = _between(before), _between(self._fingers)
            self._move(x1 - x0, y1 - y0, pane)
            if _apart(before) > 0.0:
                self._nearer(_apart(self._fingers) / _apart(before), (x1, y1), pane)
        return True

    def _pad(self, event: pygame.event.Event) -> bool:
        """Two fingers on a pad, towards the pointer."""
        pane = self.stage.picture.pane_at(self._pointer)
        if pane is None or self._touched or not event.pinched:
            return False
        self._nearer(math.exp(PINCH * event.pinched), self._pointer, pane)
        return True

    def cursor(self) -> int | None:
        """A cross of arrows while the picture is moved."""
        return None if self._held_in is None else pygame.SYSTEM_CURSOR_SIZEALL


def _between(fingers: dict[int, Point]) -> Point:
    """The middle of some places."""
    x, y = zip(*fingers.values(), strict=True)
    return sum(x) / len(x), sum(y) / len(y)


def _apart(fingers: dict[int, Point]) -> float:
    """How far the first two of some places are from each other."""
    first, second = list(fingers.values())[:2]
    return math.dist(first, second)


def _rounded(place: Point) -> tuple[int, int]:
    return round(place[0]), round(place[1])

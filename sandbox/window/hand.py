"""The hand: from mouse events to Grab, Move and Release."""

from __future__ import annotations

import math
from collections.abc import Callable

import pygame

from sandbox.draw.camera import Camera
from sandbox.draw.overlays import Hand
from sandbox.session.commands import Command, Grab, Move, Release
from sandbox.session.frame import Frame, HandleState

REACH = 24.0  # a handle can be taken from at least this far at scale 1 [px]
STILL = 0.25  # of the reach: a press that moves less is a click

Send = Callable[[Command], None]


class Mouse:
    """What the mouse hovers over and holds: with its button down, or without where a click has picked it up."""

    def __init__(self) -> None:
        self.hover: HandleState | None = None
        self.carrying = False  # held without a button, until the next click
        self._pressed: tuple[int, int] | None = None  # where, until it has moved
        self._still = 0.0  # what is no more than a click [px]
        self._held: HandleState | None = None
        self._offset = (0.0, 0.0)  # from the cursor to the held body's handle [R]
        self._target: tuple[float, float] | None = None
        self._sent: tuple[float, float] | None = None

    @property
    def holding(self) -> bool:
        """Is a handle held?"""
        return self._held is not None

    @property
    def hand(self) -> Hand:
        """For drawing."""
        return Hand(
            hover=None if self.hover is None else self.hover.name,
            held=None if self._held is None else self._held.name,
            target=self._target,
        )

    def look(self, place: tuple[int, int], frame: Frame, camera: Camera, reach: float) -> None:
        """Find the handle under the cursor; ``reach`` [px]."""
        self.hover = handle_at(place, frame, camera, reach)

    def press(
        self,
        place: tuple[int, int],
        frame: Frame,
        camera: Camera,
        reach: float,
        send: Send,
    ) -> bool:
        """Take hold of the handle under the cursor; True if there is one."""
        self.look(place, frame, camera, reach)
        if self.hover is None:
            return False
        self._held, self._pressed, self._still = self.hover, place, STILL * reach
        x, y = camera.to_world(*place)
        self._offset = (self._held.x - x, self._held.y - y)
        self._target = (self._held.x, self._held.y)
        self._sent = None
        send(Grab(self._held.name))
        return True

    def click(self) -> bool:
        """The button is up: was it a click, which picks the handle up?"""
        self.carrying, self._pressed = self._pressed is not None, None
        return self.carrying

    def move(self, place: tuple[int, int], camera: Camera, bounds: pygame.Rect) -> None:
        """The cursor has moved; a held handle is to follow. Outside the canvas its edge counts."""
        if self._held is None:
            return
        if self._pressed is not None and math.dist(place, self._pressed) > self._still:
            self._pressed = None
        x = min(max(place[0], bounds.left), bounds.right)
        y = min(max(place[1], bounds.top), bounds.bottom)
        world = camera.to_world(x, y)
        target = (world[0] + self._offset[0], world[1] + self._offset[1])
        if self._held.axis is not None:
            along_x, along_y = self._held.axis
            here = (self._held.x, self._held.y)
            along = (target[0] - here[0]) * along_x + (target[1] - here[1]) * along_y
            target = (here[0] + along * along_x, here[1] + along * along_y)
        if all(map(math.isfinite, target)):
            self._target = target

    def send_move(self, send: Send) -> None:
        """Once a picture: tell the solver where the hand is now, if that has changed."""
        if self._held is not None and self._target is not None and self._target != self._sent:
            self._sent = self._target
            send(Move(self._held.name, *self._target))

    def release(self, send: Send) -> None:
        """Let go."""
        if self._held is not None:
            self.send_move(send)
            send(Release(self._held.name))
        self.forget()

    def forget(self) -> None:
        """Hold nothing, without a word to the solver."""
        self._held = self._target = self._sent = self._pressed = None
        self.carrying = False

    def cursor(self) -> int:
        """The system cursor that says what can be done here."""
        handle = self._held or self.hover
        if handle is None:
            return pygame.SYSTEM_CURSOR_ARROW
        if self._held is None:
            return pygame.SYSTEM_CURSOR_HAND
        if handle.axis is None:
            return pygame.SYSTEM_CURSOR_SIZEALL
        across, up = map(abs, handle.axis)
        if min(across, up) > 0.5 * max(across, up):
            rising = handle.axis[0] * handle.axis[1] > 0.0
            return pygame.SYSTEM_CURSOR_SIZENESW if rising else pygame.SYSTEM_CURSOR_SIZENWSE
        return pygame.SYSTEM_CURSOR_SIZENS if up > across else pygame.SYSTEM_CURSOR_SIZEWE


def handle_at(
    place: tuple[int, int], frame: Frame, camera: Camera, reach: float
) -> HandleState | None:
    """The nearest handle whose grab radius, or at least ``reach`` [px], holds the place."""
    x, y = camera.to_world(*place)
    best, nearest = None, math.inf
    for handle in frame.handles:
        distance = math.hypot(handle.x - x, handle.y - y)
        if distance <= max(handle.radius, reach / camera.scale) and distance < nearest:
            best, nearest = handle, distance
    return best

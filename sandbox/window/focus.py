"""Where the keyboard is: Tab goes through everything that can be used, and keys that are held repeat."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import pygame

from sandbox.window.keyboards import sign_of
from sandbox.window.parts import Silent

CANVAS = "canvas"  # names of stops on a canvas begin so; the keyboard is there at first
FIRST_REPEAT, REPEAT = 0.35, 0.05  # of a key that is held: after so long, then so often [s]
REPEATING = frozenset(
    {
        pygame.K_LEFT,
        pygame.K_RIGHT,
        pygame.K_UP,
        pygame.K_DOWN,
        pygame.K_PAGEUP,
        pygame.K_PAGEDOWN,
        pygame.K_BACKSPACE,
        pygame.K_DELETE,
        pygame.K_TAB,
    }
)
REPEATING_SIGNS = frozenset("[]s+=-")

Stops = Callable[[], Sequence[str]]


class Focus(Silent):
    """One place in the window has the keyboard. ``shown``: with a ring, once the keyboard has been used to go there."""

    def __init__(self, handle: Callable[[pygame.event.Event], None]) -> None:
        self.name = CANVAS
        self.shown = False
        self.groups: list[Stops] = []  # in the order of Tab
        self.busy: Callable[[], bool] = lambda: False  # does the solver lag behind?
        self._handle = handle  # where a repeated key goes
        self._index = 0
        self._held: pygame.event.Event | None = None
        self._due = 0.0

    @property
    def on_canvas(self) -> bool:
        """Is the keyboard at the grains, and not at a control?"""
        return self.name.startswith(CANVAS)

    @property
    def ring(self) -> str:
        """Name of what has the ring; empty if none is shown."""
        return self.name if self.shown else ""

    def stops(self) -> list[str]:
        """All places that Tab goes to, in its order."""
        return [name for group in self.groups for name in group()]

    def go(self, name: str, shown: bool) -> None:
        """Give the keyboard to something."""
        self.name, self.shown = name, shown
        stops = self.stops()
        if name in stops:
            self._index = stops.index(name)

    def leave(self) -> None:
        """Back to the canvas."""
        self.go(next(iter(self.stops()), CANVAS), False)

    def move(self, way: int) -> None:
        """To the next stop, or the one before; round at the ends."""
        stops = self.stops()
        if not stops:
            return
        if self.name in stops:
            # The first press of Tab shows where the keyboard is.
            step = way if self.shown or not self.on_canvas else 0
            self._index = (stops.index(self.name) + step) % len(stops)
        else:  # what had it is gone: go on from there
            self._index = min(self._index, len(stops) - 1)
        self.name, self.shown = stops[self._index], True

    def handle(self, event: pygame.event.Event) -> bool:
        """Tab, and Escape where the keyboard is at a control."""
        if event.type != pygame.KEYDOWN:
            return False
        if event.key == pygame.K_TAB:
            self.move(-1 if getattr(event, "mod", 0) & pygame.KMOD_SHIFT else 1)
            return True
        if event.key == pygame.K_ESCAPE and (self.shown or not self.on_canvas):
            self.leave()
            return True
        return False

    # -- keys that are held --

    def watch(self, event: pygame.event.Event) -> None:
        """See every key before anybody else does."""
        if event.type == pygame.KEYDOWN:
            repeats = event.key in REPEATING or sign_of(event).lower() in REPEATING_SIGNS
            if event is not self._held:
                self._held = event if repeats else None
                self._due = math.nan  # counted from the next picture: the latest may be long ago
        elif event.type in (pygame.KEYUP, pygame.WINDOWFOCUSLOST, pygame.MOUSEBUTTONDOWN):
            self._held = None

    def tick(self, now: float) -> bool:
        """A key that is held counts again."""
        if math.isnan(self._due):
            self._due = now + FIRST_REPEAT
        if self._held is None or now < self._due:
            return False
        if self._held.key not in REPEATING and self.busy():
            return False  # increments that are asked for faster than they can be made pile up
        self._due = now + REPEAT
        self._handle(self._held)
        return True

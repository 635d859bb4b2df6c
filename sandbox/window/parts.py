"""What the window is put together from: parts that see events first, do something each picture, and draw themselves."""

from __future__ import annotations

from typing import Protocol

import pygame

from sandbox.draw.painter import Painter
from sandbox.window.keys import Action


class Part(Protocol):
    """One part of the window while a scene runs. ``draw`` comes after the run itself is drawn."""

    def handle(self, event: pygame.event.Event) -> bool:
        """True if the event was meant for this part; nobody else sees it then."""

    def act(self, action: Action) -> bool:
        """True if a key's action was meant for this part."""

    def tick(self, now: float) -> bool:
        """Once a picture, at ``now`` [s]; True if there is something new to draw."""

    def draw(self, painter: Painter) -> None:
        """Draw onto the renderer's surface."""

    def cursor(self) -> int | None:
        """The system cursor that it wants where the mouse is now; None: that is not its place."""


class Silent:
    """A part that does nothing: the beginning of one that does little."""

    def handle(self, event: pygame.event.Event) -> bool:
        """Takes no event."""
        del event
        return False

    def act(self, action: Action) -> bool:
        """Takes no action."""
        del action
        return False

    def tick(self, now: float) -> bool:
        """Has nothing to do."""
        del now
        return False

    def draw(self, painter: Painter) -> None:
        """Draws nothing."""
        del painter

    def cursor(self) -> int | None:
        """Wants no cursor."""
        return None

"""The page of keys in the window: how far it is scrolled."""

from __future__ import annotations

from sandbox.draw.pages.help_page import HelpLayout, draw_help
from sandbox.draw.painter import Painter
from sandbox.window.keys import Action


class HelpPage:
    """All keys; arrows and wheel scroll where not all of them fit."""

    def __init__(self) -> None:
        self.scroll = 0
        self._places: HelpLayout | None = None

    def act(self, action: Action, step: int) -> bool:
        """Scroll by ``step`` pixels; True if that is what the key means."""
        ways = {Action.UP: 1.0, Action.DOWN: -1.0}
        if action in ways:
            self.wheel(ways[action], step)
        return action in ways

    def wheel(self, notches: float, step: int) -> None:
        """Scroll by notches of ``step`` pixels, up where they are positive."""
        most = 0 if self._places is None else self._places.most_scroll
        self.scroll = max(0, min(round(self.scroll - notches * step), most))

    def draw(self, painter: Painter) -> None:
        """Draw the page over the picture."""
        self._places = draw_help(painter, self.scroll)
        self.scroll = min(self.scroll, self._places.most_scroll)

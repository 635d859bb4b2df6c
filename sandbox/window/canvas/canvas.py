"""The mouse on the canvases: it takes a handle in one packing, and the hand pulls in all of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pygame

from sandbox.window.hand import REACH
from sandbox.window.parts import Silent

if TYPE_CHECKING:
    from sandbox.window.app import App


class Canvas(Silent):
    """What is left of the mouse when no other part wants it."""

    def __init__(self, app: App) -> None:
        self.app = app
        self._held_in = 0  # the pane in which the mouse holds something

    def handle(self, event: pygame.event.Event) -> bool:
        """Move, press and release."""
        if event.type not in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            return False
        app, mouse = self.app, self.app.mouse
        panes, reach = app.panes(), REACH * app.renderer.scale
        if not panes or app.run.snapshot.phase == "failed":
            mouse.forget()
            return True
        there = app.picture.pane_at(event.pos)
        index = self._held_in if mouse.holding or there is None else there
        frame, camera, canvas = panes[min(index, len(panes) - 1)]
        if event.type == pygame.MOUSEMOTION:
            mouse.move(event.pos, camera, canvas)
            if not mouse.holding:
                mouse.look(event.pos, frame, camera, reach)
        elif event.button != 1:
            pass
        elif event.type == pygame.MOUSEBUTTONUP:
            mouse.move(event.pos, camera, canvas)
            mouse.release(app.send)
            mouse.look(event.pos, frame, camera, reach)
        elif there is not None and mouse.press(event.pos, frame, camera, reach, app.send):
            self._held_in = there
            app.has_begun()
        return True

    def cursor(self) -> int | None:
        """What can be done where the mouse is."""
        return self.app.mouse.cursor()

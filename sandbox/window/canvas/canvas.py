"""The mouse on the canvases: it takes a handle in one packing, and the hand pulls in all of them."""

from __future__ import annotations

import pygame

from sandbox.window.hand import REACH
from sandbox.window.parts import Silent
from sandbox.window.stage import Stage


class Canvas(Silent):
    """What is left of the mouse when no other part wants it."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self._held_in = 0  # the pane in which the mouse holds something

    def handle(self, event: pygame.event.Event) -> bool:
        """Move, press and release."""
        if event.type not in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            return False
        stage, mouse = self.stage, self.stage.mouse
        panes, reach = stage.picture.panes(), REACH * stage.renderer.scale
        if not panes or stage.panes.snapshot.phase == "failed":
            mouse.forget()
            return True
        there = stage.picture.pane_at(event.pos)
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
            mouse.release(stage.send)
            mouse.look(event.pos, frame, camera, reach)
        elif there is not None and mouse.press(event.pos, frame, camera, reach, stage.send):
            self._held_in = there
            stage.has_begun()
        return True

    def cursor(self) -> int | None:
        """What can be done where the mouse is."""
        return self.stage.mouse.cursor()

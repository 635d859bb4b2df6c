"""The mouse on the canvases: it takes a handle in one packing, and the hand pulls in all of them.

A handle is dragged; or a click picks it up, the mouse leads it with no button down, and another click or Escape puts it down.
"""

from __future__ import annotations

import pygame

from sandbox.window.hand import REACH
from sandbox.window.parts import Silent
from sandbox.window.stage import Stage
from sandbox.words import words


class Canvas(Silent):
    """What is left of the mouse when no other part wants it."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self._held_in = 0  # the pane in which the mouse holds something

    def handle(self, event: pygame.event.Event) -> bool:
        """Move, press and release; Escape puts down what is carried."""
        if event.type == pygame.KEYDOWN:
            return event.key == pygame.K_ESCAPE and self._put_down()
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
            if not mouse.holding:
                pass
            elif mouse.click():
                stage.toast(words.CARRYING)
            else:
                mouse.release(stage.send)
            mouse.look(event.pos, frame, camera, reach)
        elif mouse.carrying:
            mouse.move(event.pos, camera, canvas)
            self._put_down()
        elif there is not None and mouse.press(event.pos, frame, camera, reach, stage.send):
            self._held_in = there
            stage.has_begun()
        return True

    def tick(self, now: float) -> bool:
        """What is put down is carried no more, and it is no longer said."""
        del now
        notices = self.stage.notices
        stale = notices.latest == words.CARRYING and not self.stage.mouse.carrying
        if stale:
            notices.forget()
        return stale

    def _put_down(self) -> bool:
        """What is carried; False if nothing is."""
        mouse = self.stage.mouse
        if not mouse.carrying:
            return False
        mouse.release(self.stage.send)
        return True

    def cursor(self) -> int | None:
        """What can be done where the mouse is."""
        return self.stage.mouse.cursor()

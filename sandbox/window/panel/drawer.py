"""Where the panel is: beside the canvas, over it where there is no room, or folded away."""

from __future__ import annotations

import pygame

from sandbox.draw.layout import PANEL
from sandbox.window.guide import Guide
from sandbox.window.stage import Stage

WIDEST = 0.92  # of the window's width, for a panel that lies over the canvas


class Drawer:
    """The panel's place, which K opens and shuts."""

    def __init__(self, stage: Stage, guide: Guide) -> None:
        self.stage, self.guide = stage, guide
        self.folded = False
        self.over = False  # opened over the canvas

    @property
    def rect(self) -> pygame.Rect:
        """Where it is in the window [px]; of no width when it is not to be seen."""
        own = self.stage.renderer.layout.panel
        if own.width or not self.over:
            taken = self.guide.taken  # the card of a tour stands above it
            return pygame.Rect(own.left, own.top + taken, own.width, own.height - taken)
        width, _ = self.stage.renderer.size
        wide = round(min(PANEL * self.stage.renderer.scale, WIDEST * width))
        return pygame.Rect(width - wide, 0, wide, self.stage.renderer.layout.status.top)

    @property
    def tab(self) -> pygame.Rect:
        """What opens it by mouse or finger when it is not to be seen, at the right of the words under the canvases [px]."""
        said, wide = self.stage.renderer.layout.said, self.stage.renderer.end_of_words
        return pygame.Rect(said.right - wide, said.top, wide, said.height)

    @property
    def shown(self) -> bool:
        """Can it be seen?"""
        return self.rect.width > 0 and self.rect.height > 0

    def switch(self) -> None:
        """Fold it away, or open it: over the canvas if there is no room beside it."""
        opened = not self.shown
        self.folded, self.over = not opened, False
        self.stage.arrange(panel=not self.folded)
        self.over = opened and not self.stage.renderer.layout.panel.width

"""Small pictures of how runs of the map ended, drawn when they are asked for: a few in each picture of the window."""

from __future__ import annotations

import time
from collections.abc import Mapping

import pygame

from sandbox.draw.pages.explore_page import MapCell
from sandbox.draw.pages.thumbnail import drawn
from sandbox.session.frame import Frame

MARGIN = 3.0  # round the scene [px]
MOST = 400
PATIENCE = 0.004  # for new ones, in one picture of the window [s]


class Ends:
    """Holds what is drawn as long as theme and size stay."""

    def __init__(self) -> None:
        self.waiting = False  # is there one that is still to be drawn?
        self._theme = ""
        self._frames: Mapping[int, Frame] = {}
        self._drawn: dict[tuple[int, tuple[int, int]], pygame.Surface] = {}
        self._spent = 0.0  # on new ones, in this picture of the window [s]

    def begin(self, theme: str, frames: Mapping[int, Frame]) -> None:
        """Another picture of the window begins. ``frames``: by rows."""
        if theme != self._theme:
            self.forget()
        self._theme, self._frames = theme, frames
        self.waiting, self._spent = False, 0.0

    def picture(self, cell: MapCell, size: tuple[int, int]) -> pygame.Surface | None:
        """How the run of a cell ended; None if nobody knows, or it is the turn of others."""
        found = self._drawn.get((cell.row, size))
        frame = self._frames.get(cell.row)
        if found is not None or frame is None:
            return found
        if self._spent > PATIENCE:
            self.waiting = True
            return None
        if len(self._drawn) >= MOST:  # of windows of other sizes
            self._drawn.clear()
        begun = time.perf_counter()
        found = self._drawn[cell.row, size] = drawn(frame, self._theme, size, MARGIN)
        self._spent += time.perf_counter() - begun
        return found

    def forget(self) -> None:
        """Other runs, or other looks."""
        self._drawn.clear()
        self.waiting = False

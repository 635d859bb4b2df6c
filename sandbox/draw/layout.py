"""Which part of the window belongs to what: header, canvas, plot strip, status line.

The canvas takes what is left. In a small window or at a large UI scale the plot strip gives way
first, then the header; the status line, which says whether the picture can be believed, stays.
"""

from __future__ import annotations

from dataclasses import dataclass

import pygame

HEADER = 44.0  # heights at scale 1 [px]
STATUS = 34.0
PLOT_LEAST = 104.0
PLOT_MOST = 190.0
PLOT_SHARE = 0.20  # of the window's height
CANVAS_SHARE = 0.45  # the canvas never gets less than this
PLOT_WIDTH = 300.0  # a narrower strip could not hold its labels


@dataclass(frozen=True, slots=True)
class Layout:
    """Rectangles that don't overlap and fill the window; of no height when left out."""

    header: pygame.Rect
    canvas: pygame.Rect
    plot: pygame.Rect
    status: pygame.Rect

    def rects(self) -> tuple[pygame.Rect, ...]:
        """All four, from the top."""
        return self.header, self.canvas, self.plot, self.status


def layout(size: tuple[int, int], scale: float) -> Layout:
    """Divide a window of that size [px]."""
    width, height = size
    status = min(round(STATUS * scale), height)
    header = round(HEADER * scale)
    plot = round(min(max(PLOT_SHARE * height, PLOT_LEAST * scale), PLOT_MOST * scale))
    least = CANVAS_SHARE * height
    if height - status - header - plot < least or width < PLOT_WIDTH * scale:
        plot = 0
    if height - status - header - plot < least:
        header = 0
    canvas = max(height - status - header - plot, 0)
    return Layout(
        header=pygame.Rect(0, 0, width, header),
        canvas=pygame.Rect(0, header, width, canvas),
        plot=pygame.Rect(0, header + canvas, width, plot),
        status=pygame.Rect(0, height - status, width, status),
    )

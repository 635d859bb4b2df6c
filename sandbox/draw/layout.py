"""Which part of the window belongs to what: header, canvases, panel, plot strip, time line, status line.

The canvases take what is left. In a small window or at a large UI scale the panel gives way first, then the time line,
the plot strip and the header; the status line, which says whether the picture can be believed, stays.
"""

from __future__ import annotations

from dataclasses import dataclass

import pygame

HEADER = 44.0  # heights at scale 1 [px]
STATUS = 34.0
TIMELINE = 38.0
PLOT_LEAST = 104.0
PLOT_MOST = 190.0
PLOT_SHARE = 0.20  # of the window's height
PLOT_SHARE_OF_MANY = 0.24  # the same side by side: the curves are what it is about
CANVAS_SHARE = 0.45  # the canvases never get less than this
PLOT_WIDTH = 300.0  # a narrower strip could not hold its labels
PANEL = 316.0  # width at scale 1 [px]
PANEL_SHARE = 0.45  # of the window's width, at most
SEAM = 2.0  # between canvases side by side, at scale 1 [px]


@dataclass(frozen=True, slots=True)
class Layout:
    """Rectangles that don't overlap; of no width or no height when left out."""

    header: pygame.Rect
    canvases: tuple[pygame.Rect, ...]  # from the left, one a packing
    panel: pygame.Rect  # at the right, from the top to the status line
    plot: pygame.Rect
    timeline: pygame.Rect
    status: pygame.Rect

    @property
    def canvas(self) -> pygame.Rect:
        """The first canvas."""
        return self.canvases[0]

    def rects(self) -> tuple[pygame.Rect, ...]:
        """All of them, from the top."""
        return self.header, *self.canvases, self.panel, self.plot, self.timeline, self.status


def layout(
    size: tuple[int, int],
    scale: float,
    *,
    panes: int = 1,
    panel: bool = False,
    timeline: bool = False,
) -> Layout:
    """Divide a window of that size [px]; ``panel`` and ``timeline``: are they wanted?"""
    width, height = size
    status = min(round(STATUS * scale), height)
    header = round(HEADER * scale)
    line = round(TIMELINE * scale) if timeline else 0
    share = PLOT_SHARE if panes == 1 else PLOT_SHARE_OF_MANY
    plot = round(min(max(share * height, PLOT_LEAST * scale), PLOT_MOST * scale))
    least = CANVAS_SHARE * height
    side = round(PANEL * scale) if panel else 0
    if side > PANEL_SHARE * width:
        side = 0
    if height - status - line - header - plot < least:
        line = 0
    if height - status - line - header - plot < least or width - side < PLOT_WIDTH * scale:
        plot = 0
    if height - status - line - header - plot < least:
        header = 0
    canvas = max(height - status - line - header - plot, 0)
    free = width - side
    return Layout(
        header=pygame.Rect(0, 0, free, header),
        canvases=_side_by_side(pygame.Rect(0, header, free, canvas), panes, round(SEAM * scale)),
        panel=pygame.Rect(free, 0, side, height - status),
        plot=pygame.Rect(0, header + canvas, free, plot),
        timeline=pygame.Rect(0, header + canvas + plot, free, line),
        status=pygame.Rect(0, height - status, width, status),
    )


def _side_by_side(whole: pygame.Rect, panes: int, seam: int) -> tuple[pygame.Rect, ...]:
    """Equal parts of a rectangle; what does not divide goes to the last."""
    each = max((whole.width - (panes - 1) * seam) // panes, 0)
    lefts = [whole.left + index * (each + seam) for index in range(panes)]
    return tuple(
        pygame.Rect(
            left, whole.top, (whole.right - left if left == lefts[-1] else each), whole.height
        )
        for left in lefts
    )

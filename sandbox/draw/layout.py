"""Which part of the window belongs to what: header, canvases, words below them, panel, plot strip, time line, status line.

The canvases take what is left. In a small window or at a large UI scale the panel gives way first, then the time line,
the plot strip and the header; the status line, which says whether the picture can be believed, stays. What is said about
the picture has a place of its own, so that it covers nothing of it.
"""

from __future__ import annotations

import math
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
LINE = 21.0  # height of a line of words at scale 1 [px]
LINES_PAD = 8.0  # and of what is around all of them
LINES, MOST_LINES = 2, 4  # under one canvas
SENTENCES = 1700.0  # length of what is said at most at scale 1 [px]: a narrow canvas has more lines
SMALLEST = 0.875  # scale of letters that can be read
LEAST_WORDS = 38.0  # height of their place at scale 1 [px]: what is pressed there can be hit
WORDS_SHARE = 0.25  # of what they take from the canvases, at most


@dataclass(frozen=True, slots=True)
class Layout:
    """Rectangles that don't overlap; of no width or no height when left out."""

    header: pygame.Rect
    canvases: tuple[pygame.Rect, ...]  # from the left, one a packing
    said: pygame.Rect  # under all canvases: what is said about them
    panel: pygame.Rect  # at the right, from the top to the status line
    card: pygame.Rect  # there too, where the panel is not: the card of a tour
    plot: pygame.Rect
    timeline: pygame.Rect
    status: pygame.Rect

    @property
    def canvas(self) -> pygame.Rect:
        """The first canvas."""
        return self.canvases[0]

    def rects(self) -> tuple[pygame.Rect, ...]:
        """All of them, from the top."""
        below = self.panel, self.card, self.plot, self.timeline, self.status
        return self.header, *self.canvases, self.said, *below


def layout(
    size: tuple[int, int],
    scale: float,
    *,
    panes: int = 1,
    panel: bool = False,
    timeline: bool = False,
    card: int = 0,
) -> Layout:
    """Divide a window of that size [px]; ``panel`` and ``timeline``: are they wanted? ``card``: how wide, without a panel."""
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
    beside = 0 if side else min(card, round(PANEL_SHARE * width))
    if height - status - line - header - plot < least:
        line = 0
    if height - status - line - header - plot < least or width - side - beside < PLOT_WIDTH * scale:
        plot = 0
    if height - status - line - header - plot < least:
        header = 0
    free = width - side - beside
    upper = max(height - status - line - header - plot, 0)
    said = round(min(_words(free, scale, panes, timeline), WORDS_SHARE * upper))
    canvas = upper - said
    return Layout(
        header=pygame.Rect(0, 0, free, header),
        canvases=_side_by_side(pygame.Rect(0, header, free, canvas), panes, round(SEAM * scale)),
        said=pygame.Rect(0, header + canvas, free, said),
        panel=pygame.Rect(free, 0, side, height - status),
        card=pygame.Rect(free, 0, beside, height - status),
        plot=pygame.Rect(0, header + upper, free, plot),
        timeline=pygame.Rect(0, header + upper + plot, free, line),
        status=pygame.Rect(0, height - status, width, status),
    )


def _words(width: int, scale: float, panes: int, window: bool) -> float:
    """Height for words under the canvases [px]. Each of several has a foot of its own: the window's own words are left."""
    scale = max(scale, SMALLEST)
    lines = min(max(math.ceil(SENTENCES * scale / max(width, 1)), LINES), MOST_LINES)
    if panes > 1:
        lines = 1 if window else 0
    return max(lines * LINE + LINES_PAD, LEAST_WORDS) * scale if lines else 0.0


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

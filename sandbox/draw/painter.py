"""A drawing surface: shapes at once by the compiled kernels, texts on top of them at the end.

The pixels are borrowed from the pygame surface while shapes are drawn (it is locked meanwhile);
``flush`` gives them back and writes the waiting texts. Drawing may go on after a flush: that makes
the next layer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
import pygame
import pygame.surfarray

from core.arrays import Floats
from sandbox.draw import raster
from sandbox.draw.text import BODY, Type
from sandbox.draw.theme import Theme

Anchor = Literal["left", "centre", "right"]

NO_EDGE = 0.0


def floats(values: Floats) -> Floats:
    """The values as the kernels were compiled for: float64, contiguous, writable."""
    if values.dtype == np.float64 and values.flags.carray:  # as nearly always, and asked quickly
        return values
    return np.require(values, dtype=np.float64, requirements=["C", "A", "W"])


class Painter:
    """Draws into one 32-bit surface in pixel coordinates."""

    def __init__(self, surface: pygame.Surface, theme: Theme, type_: Type) -> None:
        self.surface = surface
        self.theme = theme
        self.type = type_
        self.scale = type_.scale
        self.everything = surface.get_rect()
        self._pixels: raster.Pixels | None = None
        self._texts: list[tuple[pygame.Surface, tuple[int, int], pygame.Rect | None]] = []

    @property
    def pixels(self) -> raster.Pixels:
        """The surface's pixels, uint32 (height, width)."""
        if self._pixels is None:
            self._pixels = pygame.surfarray.pixels2d(self.surface).T.view(np.uint32)
        return self._pixels

    def canvas(
        self, clip: pygame.Rect | None = None, to_screen: raster.ToScreen | None = None
    ) -> raster.Canvas:
        """What the kernels draw into. Without ``to_screen``, y must be given as minus pixels."""
        inside = self.everything if clip is None else clip.clip(self.everything)
        bounds = (inside.left, inside.top, inside.right, inside.bottom)
        return self.pixels, bounds, (1.0, 0.0, 0.0) if to_screen is None else to_screen

    def fill(self, rect: pygame.Rect, colour: int) -> None:
        """A plain rectangle."""
        inside = rect.clip(self.everything)
        self.pixels[inside.top : inside.bottom, inside.left : inside.right] = colour

    def box(
        self,
        rect: pygame.Rect,
        colour: int,
        *,
        radius: float = 0.0,
        edge: int | None = None,
        edge_width: float = 1.0,
        alpha: float = 1.0,
    ) -> None:
        """A rectangle with rounded corners."""
        corner = min(radius, 0.5 * rect.width, 0.5 * rect.height)
        x0, x1 = rect.left + corner, rect.right - corner
        y0, y1 = rect.top + corner, rect.bottom - corner
        corners = np.array([[x0, -y0], [x1, -y0], [x1, -y1], [x0, -y1]])
        self.hull(corners, corner, colour, edge=edge, edge_width=edge_width, alpha=alpha)

    def hull(
        self,
        corners: Floats,
        radius: float,
        colour: int,
        *,
        edge: int | None = None,
        edge_width: float = 1.0,
        alpha: float = 1.0,
        clip: pygame.Rect | None = None,
        to_screen: raster.ToScreen | None = None,
    ) -> None:
        """A convex outline inflated by ``radius`` [px]."""
        raster.draw_hull(
            self.canvas(clip, to_screen),
            floats(corners),
            float(radius),
            int(colour),
            int(colour if edge is None else edge),
            NO_EDGE if edge is None else float(edge_width),
            float(alpha),
        )

    def disc(
        self,
        x: float,
        y: float,
        radius: float,
        colour: int,
        *,
        edge: int | None = None,
        edge_width: float = 1.0,
        alpha: float = 1.0,
        clip: pygame.Rect | None = None,
    ) -> None:
        """A filled circle."""
        place = np.array([[x, -y]])
        self.hull(place, radius, colour, edge=edge, edge_width=edge_width, alpha=alpha, clip=clip)

    def ring(
        self,
        x: float,
        y: float,
        radius: float,
        width: float,
        colour: int,
        alpha: float = 1.0,
        clip: pygame.Rect | None = None,
    ) -> None:
        """A circle's outline."""
        raster.draw_ring(
            self.canvas(clip),
            float(x),
            -float(y),
            float(radius),
            0.5 * width,
            int(colour),
            float(alpha),
        )

    def lines(
        self,
        ends: tuple[Floats, Floats, Floats, Floats],
        width: float,
        colour: int,
        alpha: float = 1.0,
        clip: pygame.Rect | None = None,
    ) -> None:
        """Straight lines (x0, y0, x1, y1) of one look."""
        x0, y0, x1, y1 = (floats(part) for part in ends)
        count = x0.shape[0]
        raster.draw_few_lines(
            self.canvas(clip),
            (x0, -y0, x1, -y1),
            np.full(count, 0.5 * width),
            np.full(count, colour, dtype=np.uint32),
            np.full(count, float(alpha)),
        )

    def line(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        width: float,
        colour: int,
        alpha: float = 1.0,
        clip: pygame.Rect | None = None,
    ) -> None:
        """One straight line."""
        places = np.array([[*start, *end]], dtype=np.float64).T.copy()
        self.lines((places[0], places[1], places[2], places[3]), width, colour, alpha, clip)

    def polyline(
        self,
        x: Floats,
        y: Floats,
        width: float,
        colour: int,
        clip: pygame.Rect | None = None,
        dash: Sequence[float] = (),
    ) -> None:
        """A line through points; ``dash``: lengths on, off [px]."""
        if x.shape[0] < 2:
            return
        ends = (x[:-1].copy(), y[:-1].copy(), x[1:].copy(), y[1:].copy())
        if dash:
            ends = dashed(ends, dash[0], dash[1])
        self.lines(ends, width, colour, clip=clip)

    def text(
        self,
        text: str,
        x: float,
        y: float,
        *,
        size: float = BODY,
        colour: int | None = None,
        bold: bool = False,
        anchor: Anchor = "left",
        clip: pygame.Rect | None = None,
    ) -> pygame.Rect:
        """A line of text with its middle height at y; returns the place it takes."""
        shown = self.type.render(text, size, self.theme.text if colour is None else colour, bold)
        width, height = shown.get_size()
        shift = {"left": 0.0, "centre": 0.5 * width, "right": float(width)}[anchor]
        # Rounded to the same side always: lines of a paragraph keep their distance.
        corner = math.floor(x - shift + 0.5), math.floor(y - 0.5 * height + 0.5)
        place = pygame.Rect(corner, (width, height))
        if text:
            self._texts.append((shown, place.topleft, clip))
        return place

    def picture(self, picture: pygame.Surface, place: tuple[int, int]) -> None:
        """A picture on top of the shapes drawn so far."""
        self._texts.append((picture, place, None))

    def flush(self) -> None:
        """Give the pixels back to the surface and write the waiting texts."""
        self._pixels = None
        for shown, place, clip in self._texts:
            self.surface.set_clip(clip)
            self.surface.blit(shown, place)
        self.surface.set_clip(None)
        self._texts.clear()


def dashed(
    ends: tuple[Floats, Floats, Floats, Floats], on: float, off: float
) -> tuple[Floats, Floats, Floats, Floats]:
    """Cut a chain of lines into dashes by the length along it."""
    x0, y0, x1, y1 = ends
    length = np.hypot(x1 - x0, y1 - y0)
    before = np.concatenate(([0.0], np.cumsum(length)))
    total = float(before[-1])
    if not np.isfinite(total) or total <= 0.0:
        return ends
    starts = np.arange(0.0, total, on + off)
    cuts = np.unique(np.concatenate((before, starts, np.minimum(starts + on, total))))
    middles = 0.5 * (cuts[1:] + cuts[:-1])
    drawn = middles % (on + off) < on
    x = np.interp(cuts, before, np.concatenate((x0, x1[-1:])))
    y = np.interp(cuts, before, np.concatenate((y0, y1[-1:])))
    return x[:-1][drawn], y[:-1][drawn], x[1:][drawn], y[1:][drawn]

"""World coordinates [R] and screen coordinates [px]: one uniform scale, y up against y down."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import pygame

from sandbox.draw.raster import ToScreen

NEAREST = 40.0  # times as near as where all is seen


@dataclass(frozen=True, slots=True)
class Camera:
    """``screen x = offset_x + scale x``; ``screen y = offset_y - scale y``."""

    scale: float  # [px / R]
    offset_x: float  # [px]
    offset_y: float  # [px]

    @classmethod
    def fit(
        cls,
        bounds: tuple[float, float, float, float],
        rect: pygame.Rect,
        margin: float,
        most: float = math.inf,
    ) -> Camera:
        """Show all of the bounds (xmin, ymin, xmax, ymax) centred in a rectangle; no larger than ``most`` [px / R]."""
        xmin, ymin, xmax, ymax = bounds
        if not all(math.isfinite(bound) for bound in bounds) or xmax <= xmin or ymax <= ymin:
            xmin, ymin, xmax, ymax = -1.0, -1.0, 1.0, 1.0
        room_x = max(rect.width - 2.0 * margin, 1.0)
        room_y = max(rect.height - 2.0 * margin, 1.0)
        scale = min(room_x / (xmax - xmin), room_y / (ymax - ymin), most)
        return cls(
            scale,
            rect.left + 0.5 * rect.width - 0.5 * scale * (xmin + xmax),
            rect.top + 0.5 * rect.height + 0.5 * scale * (ymin + ymax),
        )

    @classmethod
    def fit_all(
        cls,
        views: Sequence[tuple[tuple[float, float, float, float], pygame.Rect]],
        margin: float,
    ) -> tuple[Camera, ...]:
        """One for each pair of bounds and rectangle, all of the same scale, so that sizes can be compared."""
        each = [cls.fit(bounds, rect, margin) for bounds, rect in views]
        least = min((camera.scale for camera in each), default=1.0)
        return tuple(cls.fit(bounds, rect, margin, least) for bounds, rect in views)

    @property
    def transform(self) -> ToScreen:
        """As the kernels want it."""
        return self.scale, self.offset_x, self.offset_y

    def to_screen(self, x: float, y: float) -> tuple[float, float]:
        """Pixels of a place in the world."""
        return self.offset_x + self.scale * x, self.offset_y - self.scale * y

    def to_world(self, x: float, y: float) -> tuple[float, float]:
        """The place in the world under a pixel."""
        return (x - self.offset_x) / self.scale, (self.offset_y - y) / self.scale


@dataclass(frozen=True, slots=True)
class Sight:
    """Which part of a whole picture is looked at: how much nearer, and how far its middle is from that of the whole."""

    nearer: float = 1.0
    x: float = 0.0  # [R]
    y: float = 0.0  # [R]

    def camera(self, whole: Camera, rect: pygame.Rect) -> Camera:
        """A camera that shows this part in the rectangle that ``whole`` fills."""
        middle_x, middle_y = whole.to_world(
            rect.left + 0.5 * rect.width, rect.top + 0.5 * rect.height
        )
        scale = self.nearer * whole.scale
        return Camera(
            scale,
            rect.left + 0.5 * rect.width - scale * (middle_x + self.x),
            rect.top + 0.5 * rect.height + scale * (middle_y + self.y),
        )

    def moved(self, dx: float, dy: float, whole: Camera, rect: pygame.Rect) -> Sight:
        """The picture pushed by so many pixels, not beyond the edges of the whole."""
        scale = self.nearer * whole.scale
        return self._within(self.nearer, self.x - dx / scale, self.y + dy / scale, whole, rect)

    def towards(
        self, factor: float, place: tuple[float, float], whole: Camera, rect: pygame.Rect
    ) -> Sight:
        """So many times nearer, and what is at a place of the screen stays there as far as that is possible."""
        nearer = min(max(self.nearer * factor, 1.0), NEAREST)
        away_x = (place[0] - rect.left - 0.5 * rect.width) / whole.scale
        away_y = (rect.top + 0.5 * rect.height - place[1]) / whole.scale
        grown = 1.0 / self.nearer - 1.0 / nearer
        return self._within(nearer, self.x + away_x * grown, self.y + away_y * grown, whole, rect)

    @staticmethod
    def _within(nearer: float, x: float, y: float, whole: Camera, rect: pygame.Rect) -> Sight:
        most_x = 0.5 * rect.width / whole.scale * (1.0 - 1.0 / nearer)
        most_y = 0.5 * rect.height / whole.scale * (1.0 - 1.0 / nearer)
        return Sight(nearer, min(max(x, -most_x), most_x), min(max(y, -most_y), most_y))


ALL = Sight()

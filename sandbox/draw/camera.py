"""World coordinates [R] and screen coordinates [px]: one uniform scale, y up against y down."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import pygame

from sandbox.draw.raster import ToScreen


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

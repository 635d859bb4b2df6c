"""Grains that take part in an event light up for a moment: a ring round each that widens and fades, once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw.camera import Camera
from sandbox.draw.painter import Painter
from sandbox.draw.theme import EVENT
from sandbox.session.frame import Frame, IntArray

FADE = 0.3  # until nothing is left of it [s]
WIDTH = 3.0  # of the ring at scale 1 [px]
WIDENS = 0.7  # by so many radii until it is gone
MOST = 60  # grains; of more nobody could tell which


@dataclass(frozen=True, slots=True, eq=False)
class Flash:
    """The grains of one event in one pane, and how much of the light is left."""

    pane: int
    labels: IntArray  # of the grains
    strength: float  # 1 at the beginning, 0 at the end


class Flashes:
    """Notices new events in the frames that are shown, and lets each light up once."""

    def __init__(self) -> None:
        self._seen: dict[int, int] = {}  # events of a pane that are known already
        self._lit: list[tuple[float, int, IntArray]] = []  # since when, in which pane, which grains
        self.new: tuple[str, ...] = ()  # kinds of the events noticed in the latest call

    def follow(self, frames: Sequence[Frame | None], now: float) -> list[Flash]:
        """What is to be drawn at the time ``now`` [s]."""
        new = []
        for pane, frame in enumerate(frames):
            if frame is None:
                continue
            known = self._seen.get(pane, len(frame.events))
            self._seen[pane] = len(frame.events)
            fresh = frame.events[known:]
            new += [event.kind for event in fresh]
            if fresh and frame.highlight is not None:
                self._lit.append((now, pane, frame.label[frame.highlight][:MOST]))
        self.new = tuple(new)
        self._lit = [each for each in self._lit if 0.0 <= now - each[0] < FADE]
        return [Flash(pane, labels, 1.0 - (now - at) / FADE) for at, pane, labels in self._lit]

    def forget(self) -> None:
        """Other runs begin."""
        self._seen.clear()
        self._lit.clear()


def draw_flash(
    painter: Painter, rect: pygame.Rect, camera: Camera, frame: Frame, flash: Flash
) -> None:
    """A ring round every grain of the flash that is still there."""
    reach = camera.scale * (frame.p + np.hypot(frame.q1, frame.q2))
    width = WIDTH * painter.scale
    for index in np.flatnonzero(np.isin(frame.label, flash.labels)):
        x, y = camera.to_screen(float(frame.x[index]), float(frame.y[index]))
        radius = float(reach[index]) * (1.0 + WIDENS * (1.0 - flash.strength)) + width
        if np.isfinite(x + y + radius):
            painter.ring(x, y, radius, width, EVENT, flash.strength, rect)

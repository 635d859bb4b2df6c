"""Where it happens on a canvas, and places for words beside that."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pygame

from sandbox.draw.camera import Camera
from sandbox.session.frame import BodyShape, Frame

Bounds = tuple[float, float, float, float]  # xmin, ymin, xmax, ymax [R]

FEW = 16  # grains: so many are looked at one by one
LARGE = 0.3  # of the picture: a body that takes more is not a place but what all is in
ROUND = 0.5  # what is around a held body belongs to it [R]
FAR = 1e6  # what is farther off is not on any screen [px]


def places_of_interest(
    frame: Frame, camera: Camera, rect: pygame.Rect, knob: float
) -> list[pygame.Rect]:
    """What words must not cover [px]: what the scene says, what a hand holds or can take, and grains where there are few.

    ``knob``: how much a handle takes, from its middle outwards [px].
    """
    places = [_on_screen(bounds, camera) for bounds in frame.focus]
    for handle in frame.handles:
        places.append(_around(camera.to_screen(handle.x, handle.y), knob))
        places += [_on_screen(bounds, camera) for bounds in held_bodies(frame, handle.name)]
    if frame.grains <= FEW:
        reach = frame.p + np.hypot(frame.q1, frame.q2)
        for x, y, r in zip(frame.x, frame.y, reach, strict=True):
            places.append(_on_screen((x - r, y - r, x + r, y + r), camera))
    seen = [place.clip(rect) for place in places if place is not None]
    return [place for place in seen if place.width and place.height]


def held_bodies(frame: Frame, name: str) -> list[Bounds]:
    """What a body takes that can be held, unless it is what all is in: one of these, or none."""
    xmin, ymin, xmax, ymax = frame.bounds
    found = []
    for body in frame.bodies:
        if body.name == name:
            x0, y0, x1, y1 = _extent(body)
            if (x1 - x0) * (y1 - y0) < LARGE * (xmax - xmin) * (ymax - ymin):
                found.append((x0 - ROUND, y0 - ROUND, x1 + ROUND, y1 + ROUND))
    return found


def free_place(
    size: tuple[int, int],
    wanted: Sequence[tuple[float, float]],
    taken: Sequence[pygame.Rect],
    within: pygame.Rect,
) -> tuple[pygame.Rect, int]:
    """The first of the wanted middles [px], moved inwards, where it covers nothing that is taken; else where it covers least.

    Returns the place, and how much it covers [px²].
    """
    best, least = pygame.Rect(within.topleft, size), -1
    for x, y in wanted:
        place = pygame.Rect((0, 0), size)
        place.center = round(x), round(y)
        place.clamp_ip(within)
        parts = [place.clip(other) for other in taken]
        covered = sum(part.width * part.height for part in parts)
        if least < 0 or covered < least:
            best, least = place, covered
        if not covered:
            break
    return best, least


def _extent(body: BodyShape) -> Bounds:
    """The outer bounds of a body."""
    lows, highs = [np.empty((0, 2))], [np.empty((0, 2))]
    for ends, radius in (
        (body.discs[:, :2], body.discs[:, 2:]),
        (body.segments[:, :2], body.segments[:, 4:]),
        (body.segments[:, 2:4], body.segments[:, 4:]),
        *((corners, np.zeros((len(corners), 1))) for corners in body.polygons),
    ):
        lows.append(ends - radius)
        highs.append(ends + radius)
    low, high = np.concatenate(lows), np.concatenate(highs)
    if not len(low):
        return 0.0, 0.0, 0.0, 0.0
    (x0, y0), (x1, y1) = low.min(axis=0), high.max(axis=0)
    return float(x0), float(y0), float(x1), float(y1)


def _on_screen(bounds: Bounds, camera: Camera) -> pygame.Rect | None:
    left, bottom = camera.to_screen(bounds[0], bounds[1])
    right, top = camera.to_screen(bounds[2], bounds[3])
    return _rect(left, top, right, bottom)


def _around(place: tuple[float, float], reach: float) -> pygame.Rect | None:
    x, y = place
    return _rect(x - reach, y - reach, x + reach, y + reach)


def _rect(left: float, top: float, right: float, bottom: float) -> pygame.Rect | None:
    if not np.isfinite((left, top, right, bottom)).all():
        return None
    left, top, right, bottom = np.clip((left, top, right, bottom), -FAR, FAR)
    return pygame.Rect(
        round(left), round(top), max(round(right - left), 1), max(round(bottom - top), 1)
    )

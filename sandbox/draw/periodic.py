"""Periodic cells: what leaves the cell at one side is drawn coming in at the other."""

from __future__ import annotations

import math

import numpy as np
import pygame
from numpy.typing import NDArray

from core.arrays import Floats
from sandbox.draw.camera import Camera
from sandbox.draw.painter import Painter, dashed
from sandbox.session.frame import Frame

Cell = tuple[float, float, float]  # width and height, inf where open, and shift of the row above


def images(
    cell: Cell, left: Floats, bottom: Floats, right: Floats, top: Floats
) -> tuple[NDArray[np.intp], Floats, Floats]:
    """All images that reach into the cell of things with these outer bounds (N,) [R].

    Returns the index of each image's original, and how far it is moved in x and y [R]; the
    originals themselves come first.
    """
    width, height, shift = cell
    count = left.shape[0]
    index, move_x, move_y = [np.arange(count)], [np.zeros(count)], [np.zeros(count)]
    rows = (-1, 0, 1) if math.isfinite(height) else (0,)
    # A shifted row can need one more column.
    columns = (-2, -1, 0, 1, 2) if math.isfinite(width) else (0,)
    for row in rows:
        for column in columns:
            if row == 0 and column == 0:
                continue
            dx = (column * width if column else 0.0) + row * (math.fmod(shift, width) if row else 0)
            dy = row * height if row else 0.0
            seen = np.ones(count, dtype=np.bool_)
            if math.isfinite(width):
                seen &= (right + dx > 0.0) & (left + dx < width)
            if math.isfinite(height):
                seen &= (top + dy > 0.0) & (bottom + dy < height)
            found = np.flatnonzero(seen)
            index.append(found)
            move_x.append(np.full(found.shape[0], dx))
            move_y.append(np.full(found.shape[0], dy))
    return np.concatenate(index), np.concatenate(move_x), np.concatenate(move_y)


def cell_rect(rect: pygame.Rect, camera: Camera, cell: Cell | None) -> pygame.Rect:
    """The part of the canvas that the cell takes; all of it without a cell."""
    if cell is None:
        return rect
    width, height, _ = cell
    left, bottom = camera.to_screen(0.0, 0.0)
    seen = rect.copy()
    if math.isfinite(width):
        right = camera.to_screen(width, 0.0)[0]
        seen = seen.clip(pygame.Rect(round(left), rect.top, round(right - left), rect.height))
    if math.isfinite(height):
        top = camera.to_screen(0.0, height)[1]
        seen = seen.clip(pygame.Rect(rect.left, round(top), rect.width, round(bottom - top)))
    return seen


def draw_cell(painter: Painter, rect: pygame.Rect, camera: Camera, frame: Frame) -> None:
    """Dashes along the sides at which the picture continues on the other side."""
    if frame.box is None:
        return
    width, height, _ = frame.box
    scale = painter.scale
    inside = cell_rect(rect, camera, frame.box)
    sides = []
    left, bottom = camera.to_screen(0.0, 0.0)
    if math.isfinite(width):  # a side that is out of sight is not drawn at the canvas' edge
        ends = (left, inside.left), (camera.to_screen(width, 0.0)[0], inside.right - 1)
        seen = [x for at, x in ends if rect.left - 1 <= at <= rect.right + 1]
        sides += [(x, inside.top, x, inside.bottom) for x in seen]
    if math.isfinite(height):
        ends = (bottom, inside.bottom - 1), (camera.to_screen(0.0, height)[1], inside.top)
        seen = [y for at, y in ends if rect.top - 1 <= at <= rect.bottom + 1]
        sides += [(inside.left, y, inside.right, y) for y in seen]
    if not sides:
        return
    for side in sides:
        x0, y0, x1, y1 = np.array([side], dtype=np.float64).T
        pieces = dashed((x0, y0, x1, y1), 9.0 * scale, 6.0 * scale)
        painter.lines(pieces, 2.0 * scale, painter.theme.soft_text, clip=rect)

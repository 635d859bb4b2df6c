"""Is what a scene file says something that this program would have written? Nothing of it is believed before."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.errors import InputError
from core.friction import Friction
from core.packing import UNREADABLE, Packing
from core.rigid import Point
from sandbox.session.beginning import Placement
from sandbox.session.editing import FARTHEST, MOST_GRAINS, MOST_PIECES, MOST_WALLS

MOST_BODIES = 200
RADII = (0.05, 50.0)  # [R] of grains at rest
CROWD = 12  # grains whose centres lie in one square with sides of the smallest grain's radius


def check_grains(grains: Packing) -> None:
    """Raises InputError for grains that this program would not have made: too many, flat, of odd sizes, or in one heap."""
    if len(grains) > MOST_GRAINS:
        raise InputError(f"{len(grains)} grains are more than a scene holds ({MOST_GRAINS})")
    if not len(grains):
        return
    low, high = RADII
    radius = grains.rest_radius
    if np.any((radius < low) | (radius > high)):
        raise InputError(f"rest radii of grains must lie between {low:g} and {high:g} R")
    longer, shorter = grains.semi_axes
    if np.any(shorter < 0.01 * radius) or np.any(longer > 10.0 * radius):
        raise InputError("a grain is flatter or longer than any grain of this program")
    if np.any(np.abs(grains.state[:2]) > FARTHEST):
        raise InputError("a grain lies far outside the scene")
    squares = np.floor(np.array(grains.folded()) / float(radius.min()))
    _, crowd = np.unique(squares, axis=1, return_counts=True)
    if crowd.max() > CROWD:
        raise InputError("the grains lie on top of one another")


def numbers(settings: Mapping[str, object]) -> dict[str, object]:
    """Settings as a person cannot have typed them: no text, and nothing that a float does not hold."""
    for key, value in settings.items():
        if not isinstance(value, bool) and not _finite(value):
            raise InputError(f"setting {key!r} must be a finite number or a switch")
    return dict(settings)


def _finite(value: object) -> TypeGuard[float]:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return abs(value) <= 1e15


def placements_of(rows: list[Any]) -> dict[str, Placement]:
    """Where the bodies are, by name."""
    if len(rows) > MOST_BODIES:
        raise InputError("more bodies than any scene has")
    placements: dict[str, Placement] = {}
    for row in rows:
        if not isinstance(row, dict) or set(row) != {"name", "x", "y", "angle"}:
            raise InputError("each of bodies must have name, x, y and angle, and nothing else")
        numbers = [row[key] for key in ("x", "y", "angle")]
        if not isinstance(row["name"], str) or row["name"] in placements:
            raise InputError("each of bodies must have a name of its own")
        if not all(_finite(v) and abs(v) <= FARTHEST for v in numbers):
            raise InputError(f"body {row['name']!r}: x, y and angle must be finite numbers")
        placements[row["name"]] = (float(numbers[0]), float(numbers[1]), float(numbers[2]))
    return placements


def walls_of(rows: list[Any]) -> tuple[tuple[Point, ...], ...]:
    """Lines of the drawn walls."""
    if len(rows) > MOST_WALLS:
        raise InputError(f"more drawn walls than {MOST_WALLS}")
    walls = []
    for row in rows:
        if not isinstance(row, dict) or set(row) != {"points"}:
            raise InputError("each of walls must have points, and nothing else")
        points = row["points"]
        if not isinstance(points, list) or not 1 <= len(points) <= MOST_PIECES + 1:
            raise InputError(f"a drawn wall must have from 1 to {MOST_PIECES + 1} points")
        for point in points:
            pair = isinstance(point, list) and len(point) == 2
            if not pair or not all(_finite(v) and abs(v) <= FARTHEST for v in point):
                raise InputError("each point of a drawn wall must be two finite numbers")
        line = tuple((float(x), float(y)) for x, y in points)
        for a, b in pairwise(line):
            if math.dist(a, b) < 1e-6:
                raise InputError("a drawn wall has the same point twice in a row")
        walls.append(line)
    if sum(len(line) - 1 for line in walls) > MOST_PIECES:
        raise InputError(f"the drawn walls have more than {MOST_PIECES} straight pieces")
    return tuple(walls)


def friction_of(
    data: bytes, grains: int
) -> tuple[Floats | None, tuple[NDArray[np.int64], Floats] | None]:
    """Spins and contact memory beside the packing, if there are any."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
            if "spin" not in arrays:
                return None, None
            spin, keys, slips = (arrays[k] for k in ("spin", "contact_keys", "contact_slips"))
    except UNREADABLE:
        raise InputError("the frictional memory of the grains cannot be read") from None
    if (spin.dtype, slips.dtype, keys.dtype) != (np.float64, np.float64, np.int64):
        raise InputError("the frictional memory of the grains has arrays of another kind")
    if spin.shape != (grains,) or keys.ndim != 1 or len(keys) > 20 * max(grains, 1):
        raise InputError("the frictional memory is not that of these grains")
    Friction(1.0, grains).remember(spin, keys, slips)
    return spin, (keys, slips)

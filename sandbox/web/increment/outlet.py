"""Grains that have left: ``scenes.scene.Outlet`` and ``core.quasistatic.Quasistatic.remove`` as kernels."""

from __future__ import annotations

import numpy as np

from core.jit import kernel
from sandbox.web.increment.memory import (
    PART,
    ROW,
    SIZES,
    floats_at,
    ints_at,
    row_of,
)


@kernel(allocates=True)
def inside(corners, x, y):
    """``core.generate.inside`` for one point; ``corners`` (K, 2)."""
    result = False
    for k in range(corners.shape[0]):
        after = k + 1 if k + 1 < corners.shape[0] else 0
        x0, y0, x1, y1 = corners[k, 0], corners[k, 1], corners[after, 0], corners[after, 1]
        if y0 != y1 and (y0 > y) != (y1 > y) and x < x0 + (y - y0) * (x1 - x0) / (y1 - y0):
            result = not result
    return result


@kernel(allocates=True)
def shrink(values, rows, grains, gone):
    """Close the gaps in ``rows`` rows of so many numbers each."""
    at = 0
    for row in range(rows):
        for i in range(grains):
            if not gone[i]:
                values[at] = values[row * grains + i]
                at += 1


@kernel(allocates=True)
def remove_gone(kept):
    """Take the grains out that have left. Returns how many."""
    row, ints = row_of(kept), kept.ints
    corners = floats_at(kept, PART.corners, 2 * ints[SIZES.corners])
    if not corners.shape[0]:
        return 0
    n = ints[SIZES.grains]
    state = floats_at(kept, PART.state, 5 * n)
    below = corners.reshape(-1, 2)
    gone = np.zeros(n, np.bool_)
    count = 0
    for i in range(n):
        x, y = state[i], state[n + i]
        aside = abs(x) > row[ROW.beside] and inside(below, x, y)
        gone[i] = aside or y < row[ROW.outlet]
        count += 1 if gone[i] else 0
    if not count:
        return 0
    shrink(state, 5, n, gone)
    shrink(floats_at(kept, PART.last, 5 * n), 5, n, gone)
    shrink(floats_at(kept, PART.rest_radius, n), 1, n, gone)
    shrink(floats_at(kept, PART.poisson_ratio, n), 1, n, gone)
    shrink(floats_at(kept, PART.contact_stiffness, n), 1, n, gone)
    shrink(floats_at(kept, PART.spin, n), 1, n, gone)
    shrink(ints_at(kept, PART.label, n), 1, n, gone)
    ints[SIZES.grains] = n - count
    return count

"""The nearest periodic image, for kernels."""

from __future__ import annotations

import numpy as np

from core.jit import kernel

# [R²] keeps 1/r finite for coincident centres, and products of a few of them; far below rounding for all others
COINCIDENT = 1e-60


@kernel
def nearest(dx, dy, box):
    """The vector (dx, dy) [R] between two points, from the one to the nearest image of the other.

    ``box`` is ``PeriodicBox.kernel_form()``, or None where nothing is periodic.
    """
    if box is not None:
        rows = np.rint(dy * box[3])
        dx -= rows * box[4]
        dy -= rows * box[2]
        dx -= box[0] * np.rint(dx * box[1])
    return dx, dy

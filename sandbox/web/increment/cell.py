"""The cell that grains are in, open or periodic from left to right: which of both kernels are compiled for.

Whoever compiles them says so first, by ``PERIODIC``. So what is made for open cells knows of no images, and is as fast as ever.
"""

from __future__ import annotations

import numpy as np

from core.jit import kernel

PERIODIC = False
CELL = 5  # numbers of a periodic one, as ``PeriodicBox.kernel_form`` has them


@kernel
def box_of(cell):
    """The cell as kernels of core have it, of its numbers (CELL,) [R]: all of them, or None where it is open."""
    if PERIODIC:
        return cell[0], cell[1], cell[2], cell[3], cell[4]
    return None


@kernel
def nearest_image(box, here, x):
    """Of all places that look like ``x`` [R] the one nearest to ``here``."""
    if box is None:
        return x
    return x + np.rint((here - x) / box[0]) * box[0]

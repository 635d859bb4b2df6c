"""Whether an increment has taken a grain into a body or through one of its faces: what such an increment leads to is no answer.

A contact is a spring, and springs can be overpowered: by a hand stronger than they are, by friction coefficients of 10. A grain
whose centre has come past a face is pushed on to the other side.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats, Indices
from core.jit import kernel, shared
from core.rigid_contacts import EDGE


@shared
def deep_grains(state: Floats, grain: Indices, overlap: Floats, step: float) -> NDArray[np.bool_]:
    """True for the grains (N,) so deep in a body that one more step [R] could take its face past their centre.

    ``state`` is (5, N); ``grain`` and ``overlap`` (K,) [R] are of the contacts with bodies.
    """
    shorter = state[2] - np.sqrt(state[3] * state[3] + state[4] * state[4])
    deep = np.zeros(state.shape[1], np.bool_)
    deep[grain[overlap + step >= shorter[grain]]] = True
    return deep


@kernel
def pass_faces(grain, primitive, image_x, image_y, start, state, rows_then, rows_now, crossed):
    """Mark in ``crossed`` (N, M) the grains that have crossed a face that they touched, on a straight way.

    ``grain`` to ``image_y`` (K,) are of the contacts with bodies before, ``start`` and ``state`` (5, N) the grains before and
    after, ``rows_then`` and ``rows_now`` (M, 8) the primitives. For small moves only: after a long one nobody can tell a way
    through from one around.
    """
    for k in range(grain.shape[0]):
        i, m = grain[k], primitive[k]
        if rows_now[m, 0] != EDGE:
            continue
        ix, iy = image_x[k], image_y[k]
        ux, uy = rows_then[m, 3], rows_then[m, 4]
        dx, dy = start[0, i] + ix - rows_then[m, 1], start[1, i] + iy - rows_then[m, 2]
        along, beyond = dx * ux + dy * uy, ux * dy - uy * dx
        ux, uy = rows_now[m, 3], rows_now[m, 4]
        dx, dy = state[0, i] + ix - rows_now[m, 1], state[1, i] + iy - rows_now[m, 2]
        along_now, beyond_now = dx * ux + dy * uy, ux * dy - uy * dx
        length = (rows_now[m, 5] - rows_now[m, 1]) * ux + (rows_now[m, 6] - rows_now[m, 2]) * uy
        if (beyond >= 0.0) != (beyond_now >= 0.0):
            crossing = along + (along_now - along) * beyond / (beyond - beyond_now)
            if crossing >= 0.0 and crossing <= length:
                crossed[i, m] = True

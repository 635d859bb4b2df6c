"""Where grains will probably go: the guess that an increment is relaxed from."""

from __future__ import annotations

import numpy as np

from core.arrays import Floats
from core.jit import shared


@shared
def carry_on(state: Floats, last: Floats, held: Floats, share: float, reach: float) -> None:
    """Let grains in ``state`` (5, N) go on by a ``share`` of their displacement ``last`` (5, N) [R], those that are ``held``.

    ``held`` (N,) is 1 for a grain that touches something, else 0: one that a body left free has no reason to fly on.
    A rearrangement is not going to happen twice: no grain is sent further than ``reach`` [R], which is as far as the bodies move.
    """
    x, y = last[0] * share, last[1] * share
    weight = held * np.minimum(1.0, reach / np.maximum(np.sqrt(x * x + y * y), 1e-12))
    for row in range(5):
        state[row] += last[row] * share * weight

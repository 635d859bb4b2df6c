"""Where grains leave a scene, and which of them have."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from core.generate import inside
from core.packing import Packing
from core.rigid import Point


@dataclass(frozen=True)
class Outlet:
    """Grains whose centre has come below ``y`` [R] have left; ``opening`` [R] is the width of the orifice.

    In an avalanche a dozen grains come out in one increment. Nobody takes them away before it has ended: some push others
    around a lip and up again under the funnel's side, where nothing would ever move them on. Those have left as well.
    """

    y: float
    opening: float
    # Closed: the space under the funnel, from its outer faces and its lips down to ``y`` [R]. Only the orifice leads there, since
    # an increment in which a grain crosses a wall's face is taken back (core.passage).
    below: tuple[Point, ...] = ()
    beside: float = math.inf  # who lies in it further from the middle than this has left [R]

    @cached_property
    def _top(self) -> float:
        return max((y for _, y in self.below), default=-math.inf)

    def gone(self, packing: Packing) -> NDArray[np.bool_]:
        """True for the grains that have left, (N,)."""
        gone: NDArray[np.bool_] = packing.y < self.y
        if self.below and self.beside < math.inf:
            gone |= self._below(packing, np.abs(packing.x) > self.beside)
        return gone

    def has_come_out(self, packing: Packing) -> NDArray[np.bool_]:
        """True for the grains that are in the space under the funnel, (N,)."""
        return self._below(packing, np.ones(len(packing), dtype=np.bool_))

    def _below(self, packing: Packing, asked: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """True for those of the grains that are asked for (N,) that are in that space: mostly none of them is low enough."""
        low: NDArray[np.bool_] = asked & (packing.y < self._top)
        found = np.flatnonzero(low)
        if len(found):
            low[found] = inside(list(self.below), packing.x[found], packing.y[found])
        return low

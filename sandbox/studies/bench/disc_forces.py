"""Soft-disc energy and forces for minimisers that bring none: compiled, with a neighbour list that is rebuilt when due."""

from __future__ import annotations

import math

import numba
import numpy as np

from core import neighbors
from core.arrays import Floats
from core.packing import PeriodicBox
from sandbox.studies.bench.soft_discs import SoftDiscs

SKIN = 0.5  # [R]


@numba.njit(cache=True, error_model="numpy")
def disc_forces(x, y, radius, side, first, second, pairs, fx, fy):
    """Forces of overlapping discs into fx, fy (N,) [k R]; returns the energy Σ ½ k overlap² [k R²], k = 1."""
    fx[:] = 0.0
    fy[:] = 0.0
    energy = 0.0
    for k in range(pairs):
        i = first[k]
        j = second[k]
        dx = x[j] - x[i]
        dy = y[j] - y[i]
        dx -= side * np.rint(dx / side)
        dy -= side * np.rint(dy / side)
        r2 = dx * dx + dy * dy
        reach = radius[i] + radius[j]
        if r2 < reach * reach:
            r = math.sqrt(r2)
            overlap = reach - r
            energy += 0.5 * overlap * overlap
            push = overlap / r
            fx[i] -= push * dx
            fy[i] -= push * dy
            fx[j] += push * dx
            fy[j] += push * dy
    return energy


class DiscForces:
    """Energy and forces at any places of the discs. ``evaluations`` counts how often they were asked for."""

    def __init__(self, discs: SoftDiscs) -> None:
        count = len(discs.x)
        self._discs = discs
        self._box = PeriodicBox(discs.side, discs.side).kernel_form()
        self._lists = neighbors.allocate(count, 12 * count, 1)
        self._state = np.zeros((5, count))
        self._state[2] = discs.radius
        self._pairs = -1
        self.evaluations = 0

    def __call__(self, x: Floats, y: Floats) -> tuple[float, Floats, Floats]:
        """(energy [k R²], fx, fy [k R])."""
        self.evaluations += 1
        moved = (x - self._state[0]) ** 2 + (y - self._state[1]) ** 2
        if self._pairs < 0 or float(moved.max()) > (0.5 * SKIN) ** 2:
            self._state[0], self._state[1] = x, y
            self._pairs = neighbors.find_pairs(self._state, SKIN, self._lists, self._box)
            if self._pairs < 0:
                raise RuntimeError("the neighbour lists are too short for these discs")
        fx, fy = np.empty_like(x), np.empty_like(y)
        lists, discs = self._lists, self._discs
        energy = disc_forces(
            x, y, discs.radius, discs.side, lists.first, lists.second, self._pairs, fx, fy
        )
        return float(energy), fx, fy

"""Packings and bodies that many tests share: random, strained, of mixed material."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation
from core.rigid import RigidBody, RigidWorld

Floats = NDArray[np.float64]

INFINITE = math.inf
BOXES = {
    "open": None,
    "periodic": PeriodicBox(9.0, 9.5),
    "sheared": PeriodicBox(9.0, 9.5, 2.3),
    "sheared by more than its width": PeriodicBox(9.0, 9.5, -31.7),
    "periodic in x": PeriodicBox(9.0),
    "periodic in y": PeriodicBox(INFINITE, 9.5, 1.7),
}


def random_grains(
    count: int, size: float, seed: int, box: PeriodicBox | None = None, strain: float = 0.2
) -> Packing:
    """Overlapping grains anywhere in a square, of all sizes, shapes, tilts and materials."""
    random = np.random.default_rng(seed)
    packing = Packing(
        random.uniform(0.0, size, count),
        random.uniform(0.0, size, count),
        random.uniform(0.5, 1.0, count),
        random.uniform(-0.95, 0.95, count),
        random.uniform(5.0, 200.0, count),
        box=box,
    )
    a, b = packing.rest_radius * random.uniform(1.0 - strain, 1.0 + strain, (2, count))
    packing.set_axes(a, b, random.uniform(-4.0, 4.0, count))
    return packing


def bodies() -> RigidWorld:
    """A body of every kind of primitive, tilted and shifted, and a plain wall."""
    odd = RigidBody(
        "odd",
        "body",
        position=(4.0, 4.0),
        angle=0.3,
        discs=[(1.0, 1.0, 0.5)],
        segments=[(-3.0, -3.0, -2.0, 0.0, 0.2), (-2.0, 0.0, -1.0, -3.0, 0.2)],
        polygons=[(((0.0, 0.0), (1.0, 0.0), (1.0, 2.0)), 0.3)],
    )
    return RigidWorld([odd, RigidBody("floor", segments=[(-3.0, 0.3, 12.0, 0.3, 0.1)])])


def forces(packing: Packing, primitives: Floats | None = None) -> tuple[float, Floats]:
    """Energy [k R²] and forces (5, N) [k R] from the kernels, by one evaluation."""
    relaxation = Relaxation(packing, primitives)
    report = relaxation.run(1)
    return report.energy, relaxation.forces()


def energy(packing: Packing, primitives: Floats | None = None) -> float:
    """Energy from the kernels [k R²]."""
    return forces(packing, primitives)[0]

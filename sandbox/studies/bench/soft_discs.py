"""Soft discs, the problem that other programs can solve too, and this program's own answer to it.

Discs in a square periodic box repel with the energy Σ ½ k (R_i + R_j − r)² over the pairs that overlap, k = 1, large radius 1,
half of them smaller by 1.4, packing fraction 0.90, from random places to max |F| < 1e-8 k R.

This program has no rigid grains: it takes the shapes' degrees of freedom along and makes them so heavy that they stay as they
are. So it solves the same problem with the kernels of every day, and does the work of five degrees of freedom a grain for two.
"""

from __future__ import annotations

import math
import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from core import fire, neighbors
from core.arrays import Floats
from core.errors import InputError
from core.files import atomic_write
from core.minimizer import fresh_control, relist
from core.packing import PeriodicBox

SIZE_RATIO, PACKING_FRACTION = 1.4, 0.90
TOLERANCE = 1e-8  # [k R], on every component of every force
MOST_ITERATIONS = 100_000
SKIN = 0.5  # [R], the fastest of 0.1 … 0.6 here
IMMOVABLE = 1e-100  # an inverse mass: squares of what it leads to are lost, and 0/0 does not arise
SLICE = 50


@dataclass(frozen=True)
class SoftDiscs:
    """Centres x, y (N,) in a square of ``side``, radii (N,) [R]; k = 1."""

    x: Floats
    y: Floats
    radius: Floats
    side: float


@dataclass(frozen=True)
class Relaxed:
    """One minimisation: who did it, energies per disc [k R²], largest force component [k R], work and time."""

    who: str
    start_energy: float
    energy: float
    largest_force: float
    iterations: int
    evaluations: int
    seconds: float

    def data(self) -> dict[str, Any]:
        """For a report; the time per iteration too."""
        per = 1e6 * self.seconds / max(self.iterations, 1)
        return {**asdict(self), "iteration_us": per}


def random_discs(count: int, seed: int) -> SoftDiscs:
    """Discs at random places."""
    random = np.random.default_rng(seed)
    radius = np.ones(count)
    radius[: count // 2] = 1.0 / SIZE_RATIO
    side = math.sqrt(math.pi * float(np.sum(radius**2)) / PACKING_FRACTION)
    x, y = random.uniform(0.0, side, (2, count))
    return SoftDiscs(x, y, random.permutation(radius), side)


def write(path: str | os.PathLike[str], discs: SoftDiscs) -> None:
    """Plain arrays in an NPZ file."""
    with atomic_write(path) as file:
        np.savez(file, allow_pickle=False, **asdict(discs))


def read(path: str | os.PathLike[str]) -> SoftDiscs:
    """What ``write`` wrote. Raises InputError if it is not that."""
    try:
        with np.load(Path(path), allow_pickle=False) as data:
            x, y, radius = (np.array(data[name], dtype=np.float64) for name in ("x", "y", "radius"))
            side = float(data["side"])
    except (OSError, KeyError, ValueError, TypeError) as error:
        raise InputError(f"{path}: not a file of soft discs ({error})") from None
    if not x.shape == y.shape == radius.shape == (x.size,):
        raise InputError(f"{path}: not a file of soft discs (arrays of different lengths)")
    return SoftDiscs(x, y, radius, side)


def minimizer(discs: SoftDiscs) -> fire.Minimizer:
    """The arrays of a relaxation in which the discs move and their shapes do not."""
    count = len(discs.x)
    state = np.zeros((5, count))
    state[0], state[1], state[2] = discs.x, discs.y, discs.radius
    inverse_mass = np.full((5, count), IMMOVABLE)
    inverse_mass[:2] = 1.0
    arrays = [np.zeros((5, count)) for _ in range(3)]
    return fire.Minimizer(
        state=state,
        velocity=arrays[0],
        force=arrays[1],
        inverse_mass=inverse_mass,
        reference=arrays[2],
        support=np.zeros((3, count)),
        grains=fire.Grains(np.ones(count), discs.radius**2, np.zeros(count), np.zeros(count)),
        lists=neighbors.allocate(count, 12 * count, 48),
        identity=np.arange(count),
        scratch=np.zeros(count),
        scratch_identity=np.zeros(count, dtype=np.int64),
        control=fresh_control(fire.DT_FACTOR),
    )


def relax(discs: SoftDiscs) -> Relaxed:
    """Minimise with the program's own FIRE."""
    from sandbox.ensemble.clock import clock

    start = clock()
    m = minimizer(discs)
    box = PeriodicBox(discs.side, discs.side).kernel_form()
    # The tolerance looks at shapes too, whose forces do not vanish here: the discs' own are looked at between slices.
    limits = fire.Limits(1e-30, 1.0, fire.DT_FACTOR, 0.1 / SIZE_RATIO, SKIN)
    iterations, largest, due = 0, math.inf, 0
    while largest > TOLERANCE and iterations < MOST_ITERATIONS:
        due += SLICE
        while iterations < due:
            code, used = fire.run(m, box, None, None, None, limits, due - iterations, None)
            iterations += used
            if code == fire.LISTS_STALE:
                if relist(m, box, None, SKIN) != neighbors.FIT:
                    raise RuntimeError("the neighbour lists are too short for these discs")
            elif code != fire.BUDGET:
                raise RuntimeError(f"the relaxation of soft discs ended with {code}")
        largest = float(np.abs(m.force[:2]).max())
    return Relaxed(
        "this program",
        float(m.control["start_energy"][0]) / len(discs.x),
        float(m.control["energy"][0]) / len(discs.x),
        largest,
        iterations,
        iterations,
        clock() - start,
    )

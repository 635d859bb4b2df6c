"""The guard that keeps a grain from vanishing: not felt above its threshold, smooth at it, without bound below."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import ArrayLike

from core import fire
from core.elasticity import GUARD_AREA, LEAST_AREA, add_guard
from core.packing import Packing
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidWorld, wall


def guard(shape: ArrayLike, rest_area: float) -> tuple[float, np.ndarray]:
    """Energy [k R²] of one grain with p, q1, q2 in ``shape`` [R], and the forces on them [k R]."""
    force = np.zeros((3, 1))
    p, q1, q2 = np.asarray(shape, dtype=np.float64).reshape(3, 1)
    return float(add_guard(p, q1, q2, np.array([rest_area]), *force)), force[:, 0]


@pytest.mark.parametrize("share", [0.5 * LEAST_AREA, 0.01, 0.03])
@pytest.mark.parametrize("rest_area", [0.51, 1.0, 4.0])
def test_forces_are_those_of_the_energy(share: float, rest_area: float) -> None:
    p = math.sqrt(share * rest_area + 0.0025 + 0.0009)
    shape = np.array([p, 0.05, -0.03])
    _, force = guard(shape, rest_area)
    h = 1e-7
    for k in range(3):
        up, down = shape.copy(), shape.copy()
        up[k] += h
        down[k] -= h
        slope = (guard(up, rest_area)[0] - guard(down, rest_area)[0]) / (2.0 * h)
        # Rounding: energies of order 10 over 2e-7; truncation: third derivatives of order 1e6 times h²/6.
        assert force[k] == pytest.approx(-slope, rel=1e-5, abs=1e-6)


def test_nothing_above_the_threshold_and_no_jump_at_it() -> None:
    radius = math.sqrt(GUARD_AREA)
    energy, force = guard((radius * (1.0 + 1e-12), 0.0, 0.0), 1.0)
    assert energy == 0.0
    assert not force.any()
    energy, force = guard((radius * (1.0 - 1e-9), 0.0, 0.0), 1.0)
    assert 0.0 < energy < 1e-17
    # dV/dp = 2 p ln(share / threshold) / share with ln = -2e-9.
    assert force[0] == pytest.approx(2.0 * radius * 2e-9 / GUARD_AREA, rel=1e-5)


def test_a_crushed_auxetic_grain_stays_a_grain() -> None:
    """Four plates press with more than the area can bear; without the guard the grain is gone at p = 0."""
    half = 0.15
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    world = RigidWorld([wall("walls", corners, 0.2, closed=True)])
    packing = Packing([0.0], [0.0], 1.0, -0.8)
    packing.state[2] = 0.3
    relaxation = Relaxation(packing, world.primitives()[0], tolerance=1e-6)
    report = relaxation.run(20_000)
    assert report.reason is StopReason.CONVERGED
    relaxation.write_back()
    a, b = packing.semi_axes
    assert b[0] > 0.1
    assert a[0] * b[0] < GUARD_AREA


def test_squeezed_beyond_what_the_area_bears_a_grain_does_not_vanish() -> None:
    """At ν = −0.8, C = 50 the area bears Σ f = 0.89 k R at most; here 2 k R press on it, dead weight from four sides."""
    packing = Packing([0.0], [0.0], 1.0, -0.8)
    relaxation = Relaxation(packing, tolerance=1e-9, force_floor=1.0)
    minimizer = relaxation._minimizer
    p = np.linspace(0.05, 1.0, 2000)
    total = []
    for value in p:
        minimizer.state[2] = value
        relaxation._relist()
        total.append(float(fire.evaluate(minimizer, None, None, None, None, None)) + 2.0 * value)
    energy = np.array(total)
    lowest = int(np.argmin(energy))
    assert 0.1 < p[lowest] < math.sqrt(GUARD_AREA)

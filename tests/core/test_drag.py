"""Drag: an increment under gravity is a step of slow motion, and at rest it leaves no trace."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from core.packing import Packing
from core.quasistatic import Quasistatic
from core.relaxation import Relaxation, StopReason
from core.rigid import RigidWorld, wall
from core.settings import Settings
from core.system import System

GRAVITY, FALL = 0.01, 0.1


def fall(count: int) -> tuple[Quasistatic, list[float]]:
    """A grain above a floor, ``count`` increments; where it was after each."""
    floor = wall("floor", [(-5.0, 0.0), (5.0, 0.0)], 0.5)
    packing = Packing([0.0, 30.0], [1.45, 50.0], [1.0, 0.7], [0.5, -0.5])
    settings = Settings(tolerance=1e-8)
    engine = Quasistatic(
        System(packing, RigidWorld([floor]), settings, gravity=(0.0, -GRAVITY), drag=GRAVITY / FALL)
    )
    heights = []
    for _ in range(count):
        engine.begin({})
        increment = engine.relax(100_000)
        assert increment is not None
        assert increment.report.reason is StopReason.CONVERGED
        heights.append(float(packing.y[0]))
    return engine, heights


def test_a_free_grain_falls_as_far_as_said_whatever_its_size() -> None:
    engine, heights = fall(3)
    assert heights == pytest.approx([1.35, 1.25, 1.15], abs=1e-6)
    assert engine.packing.y[1] == pytest.approx(50.0 - 3 * FALL, abs=1e-6)


def test_at_rest_drag_is_gone() -> None:
    engine, heights = fall(12)
    assert abs(heights[-1] - heights[-2]) < 1e-6
    engine.system.packing = engine.packing.select(np.array([True, False]))
    still = Relaxation(
        engine.packing, engine.world.primitives()[0], None, (0.0, -GRAVITY), tolerance=1e-8
    )
    assert still.run(10_000).reason is StopReason.CONVERGED
    still.write_back()
    assert engine.packing.y[0] == pytest.approx(heights[-1], abs=1e-6)
    assert engine.reactions[0, 1] == pytest.approx(-GRAVITY, rel=1e-4)


def test_each_grain_is_held_back_from_its_own_start() -> None:
    """Many grains, sorted by the minimiser in its own order: each is held back from its own start."""
    x, y = np.meshgrid(np.arange(6) * 1.9, np.arange(6) * 1.9 + 100.0)
    packing = Packing(x.ravel(), y.ravel())
    before = packing.y.mean()
    relaxation = Relaxation(packing, gravity=(0.0, -GRAVITY), drag=GRAVITY / FALL, tolerance=1e-6)
    assert relaxation.run(50_000).reason is StopReason.CONVERGED
    relaxation.write_back()
    assert packing.y.mean() == pytest.approx(before - FALL, abs=1e-5)


def test_negative_drag_is_refused() -> None:
    with pytest.raises(InputError, match="drag"):
        Relaxation(Packing([0.0], [0.0]), drag=-1.0)

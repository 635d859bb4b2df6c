"""Grains drawn as they are made: against a slow twin, areas, symmetry, bad numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from core import squeezed
from sandbox.draw import raster
from sandbox.draw.raster import made_grains
from tests.draw import slow_raster as slow

SHAPE = (64, 64)
NO_TOOTH, TOOTH = 1e9, 0.0

Floats = NDArray[np.float64]


def drawn(
    x: float,
    y: float,
    p: float,
    q1: float = 0.0,
    q2: float = 0.0,
    *,
    rest: float | None = None,
    turn: float = 0.0,
    openness: float | None = None,
    tooth: float = NO_TOOTH,
    shape: tuple[int, int] = SHAPE,
    clip: tuple[int, int, int, int] | None = None,
) -> Floats:
    """Share of every pixel that one grain covers; an auxetic one with an openness, else a ring."""
    pixels = np.zeros(shape, dtype=np.uint32)
    canvas = (pixels, clip or (0, 0, shape[1], shape[0]), (1.0, 0.0, 0.0))
    white = np.full(1, 255, dtype=np.uint32)
    raster.draw_made_grains(
        canvas,
        tuple(np.array([value], dtype=float) for value in (x, -y, p, q1, q2)),
        np.array([p if rest is None else rest], dtype=float),
        np.array([turn], dtype=float),
        np.array([0.0 if openness is None else openness]),
        np.array([openness is not None]),
        (white, white),
        1.0,
        tooth,
    )
    return pixels / 255.0


@settings(max_examples=25, deadline=None)
@given(
    p=st.floats(14, 24),
    share=st.floats(0, 0.25),
    angle=st.floats(0, 6.3),
    turn=st.floats(-4, 4),
    openness=st.floats(0.35, 1),
)
def test_hole_is_that_of_the_slow_twin(
    p: float, share: float, angle: float, turn: float, openness: float
) -> None:
    q1, q2 = share * p * np.cos(angle), share * p * np.sin(angle)
    seen = drawn(32.3, 31.6, p, q1, q2, turn=turn, openness=openness)
    wanted = slow.made_share(SHAPE, (32.3, 31.6, p, q1, q2), p, turn, openness)
    difference = np.abs(seen - wanted)
    # In the corners of the hole the nearest edge alone does not say how much of a pixel is covered.
    assert np.quantile(difference, 0.97) < 0.15
    assert difference.mean() < 0.02
    # The slits that a screen needs are about a pixel wide, from the notch to the rim.
    assert seen.sum() == pytest.approx(wanted.sum(), rel=0.05)


@settings(max_examples=10, deadline=None)
@given(p=st.floats(12, 24), share=st.floats(0, 0.25), angle=st.floats(0, 6.3))
def test_ring_is_that_of_the_slow_twin(p: float, share: float, angle: float) -> None:
    q1, q2 = share * p * np.cos(angle), share * p * np.sin(angle)
    seen = drawn(32.3, 31.6, p, q1, q2)
    wanted = slow.made_share(SHAPE, (32.3, 31.6, p, q1, q2), p, 0.0, None)
    difference = np.abs(seen - wanted)
    assert difference.mean() < 0.015
    # The distance is of first order, and a wall's depth inside a slender grain is not small.
    assert seen.sum() == pytest.approx(wanted.sum(), rel=0.04)


@pytest.mark.parametrize("squeeze", [0.0, 0.1, 0.2])
def test_wall_of_the_ring_stays_as_thick(squeeze: float) -> None:
    """Within 2 % of Steiner's formula: perimeter x wall - pi wall^2, for any shape."""
    p = 50.0
    a, b, wall = p * (1 + squeeze), p * (1 - squeeze), raster.WALL * p
    h = ((a - b) / (a + b)) ** 2
    perimeter = np.pi * (a + b) * (1 + 3 * h / (10 + np.sqrt(4 - 3 * h)))
    seen = drawn(70.2, 69.7, p, squeeze * p, shape=(140, 140))
    assert seen.sum() == pytest.approx(perimeter * wall - np.pi * wall**2, rel=0.02)
    row, column = seen[69], seen[:, 70]
    assert row.sum() == pytest.approx(2 * wall, rel=0.05)
    assert column.sum() == pytest.approx(2 * wall, rel=0.05)


@pytest.mark.parametrize("tooth", [NO_TOOTH, TOOTH])
def test_hole_closes_as_the_grain_shrinks(tooth: float) -> None:
    def hole(openness: float) -> float:
        body = drawn(50.0, 50.0, 40.0, openness=openness, tooth=tooth, shape=(100, 100))
        return np.pi * 40.0**2 - float(body.sum())

    areas = [hole(openness) for openness in (0.0, 0.25, 0.5, 0.75, 1.0)]
    assert areas == sorted(areas)
    assert areas[0] < 0.5 * areas[-1]
    assert areas[-1] > 0.15 * np.pi * 40.0**2


@pytest.mark.parametrize("tooth", [NO_TOOTH, TOOTH])
def test_what_is_drawn_is_what_the_limits_were_derived_from(tooth: float) -> None:
    """Ring and open hole have the area of the material that ``core.squeezed`` says is left when there is no hole any more."""
    p, shape = 200.0, (420, 420)
    for openness, area in ((None, squeezed.RING_AREA), (1.0, squeezed.AUXETIC_AREA)):
        seen = drawn(210.0, 210.0, p, openness=openness, tooth=tooth, shape=shape)
        assert seen.sum() / (np.pi * p**2) == pytest.approx(area, abs=0.006)
    assert (squeezed.RING_WALL, squeezed.TIP, squeezed.MOUTH) == (
        made_grains.WALL,
        made_grains.TIP,
        made_grains.MOUTH,
    )
    assert squeezed.WING == made_grains.WING_U
    assert squeezed.NOTCH == made_grains.NOTCH_OPEN
    assert pytest.approx(made_grains.NOTCH_OPEN - made_grains.HINGE) == squeezed.APEX


def test_hole_is_cut_to_the_rim_and_a_tooth_bars_the_way() -> None:
    """From the notch down to the rim nothing is in the way, but for the tooth."""
    open_, barred = (
        drawn(50.0, 50.0, 40.0, openness=1.0, tooth=tooth, shape=(100, 100))
        for tooth in (NO_TOOTH, TOOTH)
    )
    below = slice(10, 40)  # the tip is at the foot of the picture, the cut at the top
    assert open_[below, 50].max() == 0.0
    assert barred[10:15, 50].min() > 0.99
    assert barred[18:40, 50].max() == 0.0
    # Beside the tooth a narrow cut remains: the grain is not closed.
    rim = barred[12:14, 30:50].mean(axis=0)
    assert rim.min() == 0.0


def test_without_its_tooth_a_grain_is_symmetric() -> None:
    seen = drawn(32.0, 32.0, 25.0, openness=0.8)
    assert np.abs(seen - seen[:, ::-1]).max() <= 1 / 255
    turned = drawn(32.0, 32.0, 25.0, openness=0.8, turn=np.pi)
    assert np.abs(seen - turned[::-1]).max() <= 2 / 255
    quarter = drawn(32.0, 32.0, 25.0, openness=0.8, turn=0.5 * np.pi)
    # Positive angles turn against the clock: what was at the foot comes to the right.
    assert np.abs(np.rot90(seen) - quarter).max() <= 2 / 255


@pytest.mark.parametrize("openness", [None, 0.7])
def test_nothing_outside_the_ellipse_or_the_clip(openness: float | None) -> None:
    x, y, p, q1, q2 = 30.3, 29.1, 20.0, 4.0, -3.0
    seen = drawn(x, y, p, q1, q2, openness=openness, turn=1.1, tooth=TOOTH)
    outside = slow.ellipse_distance(SHAPE, x, y, p, q1, q2) > 0.5
    assert seen[outside].max() == 0.0
    clip = (20, 18, 40, 36)
    cut = drawn(x, y, p, q1, q2, openness=openness, turn=1.1, tooth=TOOTH, clip=clip)
    assert np.array_equal(cut[18:36, 20:40], seen[18:36, 20:40])
    cut[18:36, 20:40] = 0.0
    assert cut.max() == 0.0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e300])
@pytest.mark.parametrize("openness", [None, 0.7])
@pytest.mark.parametrize("which", ["x", "y", "p", "q1", "q2", "rest", "turn"])
def test_bad_grain_is_left_out(which: str, openness: float | None, bad: float) -> None:
    values: dict[str, Any] = {"x": 30.0, "y": 30.0, "p": 20.0, which: bad}
    assert drawn(**values, openness=openness).max() == 0.0
    assert drawn(30.0, 30.0, 8.0, 8.0, openness=openness).max() == 0.0


def test_a_grain_of_any_size_can_be_drawn() -> None:
    for p in (0.01, 0.4, 1.0, 2.0, 5.0, 300.0):
        for openness in (None, 0.0, 1.0, np.nextafter(1.0, 2.0)):
            seen = drawn(32.0, 32.0, p, 0.3 * p, openness=openness, tooth=TOOTH)
            assert np.isfinite(seen).all()

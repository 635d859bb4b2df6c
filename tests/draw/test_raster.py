"""The compiled rasteriser against its slow twin, areas, symmetries and bad numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sandbox.draw import raster
from sandbox.draw.warmup import compile_kernels
from tests.draw import slow_raster as slow

GROUND, FILL, EDGE = 0x101418, 0xEE3377, 0x0077BB
SHAPE = (48, 64)
LEVELS = 2.5  # rounding of two blends of 256 parts

Pixels = NDArray[np.uint32]


def blank(shape: tuple[int, int] = SHAPE) -> Pixels:
    return np.full(shape, GROUND, dtype=np.uint32)


def canvas(pixels: Pixels, clip: tuple[int, int, int, int] | None = None) -> Any:
    height, width = pixels.shape
    return pixels, (0, 0, width, height) if clip is None else clip, (1.0, 0.0, 0.0)


def grain(x: float, y: float, p: float, q1: float = 0.0, q2: float = 0.0) -> Any:
    """One grain at pixel (x, y): the kernels have y up."""
    return tuple(np.array([value], dtype=float) for value in (x, -y, p, q1, q2))


def colour(value: int, count: int = 1) -> NDArray[np.uint32]:
    return np.full(count, value, dtype=np.uint32)


def draw_grain(
    pixels: Pixels, one: Any, edge_width: float = 1.5, alpha: float = 1.0, **more: Any
) -> None:
    raster.draw_ellipses(canvas(pixels, **more), one, colour(FILL), colour(EDGE), edge_width, alpha)


def white_share(pixels: Pixels) -> float:
    """Area of what was drawn in white on black [px]."""
    return float((pixels & 255).sum() / 255.0)


shapes = st.tuples(
    st.floats(-8, 72), st.floats(-8, 56), st.floats(1.0, 25.0), st.floats(0, 0.6), st.floats(0, 6.3)
)


@settings(max_examples=60, deadline=None)
@given(shape=shapes, edge_width=st.floats(0, 4), alpha=st.floats(0.2, 1))
def test_ellipse_is_that_of_the_slow_twin(
    shape: tuple[float, ...], edge_width: float, alpha: float
) -> None:
    x, y, p, share, angle = shape
    q1, q2 = share * p * np.cos(angle), share * p * np.sin(angle)
    pixels = blank()
    draw_grain(pixels, grain(x, y, p, q1, q2), edge_width, alpha)
    distance = slow.ellipse_distance(SHAPE, x, y, p, q1, q2)
    expected = slow.filled(slow.unpacked(blank()), distance, FILL, EDGE, edge_width, alpha)
    assert np.abs(slow.unpacked(pixels) - expected).max() <= LEVELS


@settings(max_examples=40, deadline=None)
@given(
    x=st.floats(10, 54),
    y=st.floats(10, 38),
    p=st.floats(8, 20),
    share=st.floats(0, 0.4),
    angle=st.floats(0, 6.3),
    turn=st.floats(-4, 4),
    openness=st.floats(0, 1),
)
def test_bow_tie_is_that_of_the_slow_twin(
    x: float, y: float, p: float, share: float, angle: float, turn: float, openness: float
) -> None:
    q1, q2 = share * p * np.cos(angle), share * p * np.sin(angle)
    pixels = blank()
    raster.draw_bow_ties(
        canvas(pixels),
        grain(x, y, p, q1, q2),
        np.array([turn]),
        np.array([openness]),
        np.array([True]),
        FILL,
        1.0,
    )
    distance = slow.bow_tie_distance(SHAPE, (x, y, p, q1, q2), turn, openness)
    share_drawn = slow.coverage(distance) * min((p - np.hypot(q1, q2) - 1.5) / 3.0, 1.0)
    expected = slow.blend(slow.unpacked(blank()), slow.channels(FILL), share_drawn)
    difference = np.abs(slow.unpacked(pixels) - expected).max(axis=-1)
    # On the line where the two folds meet either side's slope may be taken.
    assert np.quantile(difference, 0.99) <= LEVELS
    assert difference.mean() < 1.0


@settings(max_examples=60, deadline=None)
@given(ends=st.tuples(*[st.floats(-10, 70)] * 4), half=st.floats(0.5, 9), alpha=st.floats(0.1, 1))
def test_line_is_that_of_the_slow_twin(
    ends: tuple[float, float, float, float], half: float, alpha: float
) -> None:
    ax, ay, bx, by = ends
    pixels = blank()
    one = tuple(np.array([value]) for value in (ax, -ay, bx, -by))
    raster.draw_lines(canvas(pixels), one, np.array([half]), colour(FILL), np.array([alpha]))
    distance = slow.segment_distance(SHAPE, ax, ay, bx, by) - half
    ground = slow.unpacked(blank())
    expected = slow.blend(ground, slow.channels(FILL), slow.coverage(distance) * alpha)
    assert np.abs(slow.unpacked(pixels) - expected).max() <= LEVELS


@settings(max_examples=60, deadline=None)
@given(ends=st.tuples(*[st.floats(-10, 70)] * 4), half=st.floats(0.5, 9), rim=st.floats(0.1, 4))
def test_what_is_hidden_under_a_line_is_not_missed(
    ends: tuple[float, float, float, float], half: float, rim: float
) -> None:
    one = tuple(np.array([value]) for value in (ends[0], -ends[1], ends[2], -ends[3]))
    pictures = []
    for hidden in ([half], [0.0]):
        pixels = blank()
        raster.draw_lines(
            canvas(pixels), one, np.array([half + rim]), colour(EDGE), np.ones(1), np.array(hidden)
        )
        raster.draw_lines(canvas(pixels), one, np.array([half]), colour(FILL), np.ones(1))
        pictures.append(pixels)
    assert np.array_equal(pictures[0], pictures[1])


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("radius", [0.0, 1.0, 6.0])
@pytest.mark.parametrize("way", [1, -1])
def test_hull_is_that_of_the_slow_twin(count: int, radius: float, way: int) -> None:
    angle = way * (np.arange(count) * 2 * np.pi / count + 0.3)
    corners = np.stack([32 + 17 * np.cos(angle), 24 + 13 * np.sin(angle)], axis=-1)
    pixels = blank()
    flipped = corners * [1.0, -1.0]
    raster.draw_hull(canvas(pixels), flipped, radius, FILL, EDGE, 2.0, 0.9)
    distance = slow.hull_distance(SHAPE, corners) - radius
    expected = slow.filled(slow.unpacked(blank()), distance, FILL, EDGE, 2.0, 0.9)
    assert np.abs(slow.unpacked(pixels) - expected).max() <= LEVELS


def test_large_disc_is_round() -> None:
    # x y - x y need not be 0 where the compiler fuses multiply and add: once a disc came out square.
    pixels = np.zeros((400, 400), dtype=np.uint32)
    raster.draw_hull(canvas(pixels), np.array([[200.3, -199.1]]), 150.0, 255, 255, 0.0, 1.0)
    assert white_share(pixels) == pytest.approx(np.pi * 150.0**2, rel=1e-4)


@pytest.mark.parametrize("radius", [5.0, 20.0, 45.0])
def test_ring_has_the_area_of_a_ring(radius: float) -> None:
    pixels = np.zeros((120, 120), dtype=np.uint32)
    raster.draw_ring(canvas(pixels), 60.2, -59.7, radius, 2.0, 255, 1.0)
    assert white_share(pixels) == pytest.approx(2 * np.pi * radius * 4.0, rel=0.02)


@settings(max_examples=40, deadline=None)
@given(p=st.floats(6, 30), share=st.floats(0, 0.4), angle=st.floats(0, 6.3))
def test_ellipse_covers_its_area(p: float, share: float, angle: float) -> None:
    # Coverage by distance is first order: the blur of half a pixel is symmetric about the outline,
    # so the error of the area is of the order of curvature x blur^2, well below 1 % from 6 px on.
    q = share * p
    pixels = np.zeros((100, 100), dtype=np.uint32)
    one = grain(50.37, 49.81, p, q * np.cos(angle), q * np.sin(angle))
    raster.draw_ellipses(canvas(pixels), one, colour(255), colour(255), 0.0, 1.0)
    assert white_share(pixels) == pytest.approx(np.pi * (p + q) * (p - q), rel=0.01)


@pytest.mark.parametrize("axis", [0, 1])
def test_mirrored_grain_is_the_mirrored_picture(axis: int) -> None:
    size = 64
    here, there = blank((size, size)), blank((size, size))
    x, y, q1, q2 = 30.25, 28.5, 4.0, 3.0
    draw_grain(here, grain(x, y, 14.0, q1, q2))
    mirrored = (size - x, y) if axis else (x, size - y)
    draw_grain(there, grain(*mirrored, 14.0, q1, -q2))
    assert np.abs(slow.unpacked(here) - slow.unpacked(np.flip(there, axis))).max() <= 1.0


def test_nothing_is_drawn_outside_the_clip() -> None:
    clip = (10, 8, 40, 30)
    outside = np.ones(SHAPE, dtype=bool)
    outside[clip[1] : clip[3], clip[0] : clip[2]] = False
    pixels = blank()
    one = grain(25.0, 19.0, 40.0, 5.0, 2.0)
    draw_grain(pixels, one, clip=clip)
    small = (*grain(12.0, 9.0, 9.0)[:2], *one[2:])
    raster.draw_bow_ties(
        canvas(pixels, clip), small, np.zeros(1), np.ones(1), np.ones(1, bool), 1, 1.0
    )
    ends = tuple(np.array([value]) for value in (-900.0, 700.0, 900.0, -700.0))
    raster.draw_lines(canvas(pixels, clip), ends, np.array([9.0]), colour(FILL), np.ones(1))
    raster.draw_hull(canvas(pixels, clip), np.array([[9.0, -9.0]]), 30.0, FILL, EDGE, 2.0, 1.0)
    raster.draw_ring(canvas(pixels, clip), 20.0, -20.0, 18.0, 3.0, FILL, 1.0)
    assert np.all(pixels[outside] == GROUND)
    assert not np.all(pixels[~outside] == GROUND)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e300, -1e300])
@pytest.mark.parametrize("which", range(5))
def test_bad_grain_is_left_out_and_the_others_drawn(bad: float, which: int) -> None:
    good = grain(40.0, 24.0, 10.0)
    two = [np.concatenate((values, values)) for values in good]
    two[which][0] = bad
    pixels, alone = blank(), blank()
    grains = tuple(two)
    raster.draw_ellipses(canvas(pixels), grains, colour(FILL, 2), colour(EDGE, 2), 1.5, 1.0)
    raster.draw_bow_ties(canvas(pixels), grains, np.zeros(2), np.ones(2), np.ones(2, bool), 1, 1.0)
    draw_grain(alone, good)
    raster.draw_bow_ties(canvas(alone), good, np.zeros(1), np.ones(1), np.ones(1, bool), 1, 1.0)
    assert np.array_equal(pixels, alone)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_bad_lines_and_outlines_are_left_out(bad: float) -> None:
    pixels = blank()
    for which in range(4):
        ends = [np.array([value]) for value in (5.0, -5.0, 30.0, -20.0)]
        ends[which][0] = bad
        raster.draw_lines(canvas(pixels), tuple(ends), np.ones(1), colour(FILL), np.ones(1))
    raster.draw_lines(
        canvas(pixels),
        tuple(np.ones(1) for _ in range(4)),
        np.array([np.nan]),
        colour(1),
        np.ones(1),
    )
    corners = np.array([[5.0, -5.0], [30.0, -5.0], [20.0, bad]])
    raster.draw_hull(canvas(pixels), corners, 1.0, FILL, EDGE, 1.0, 1.0)
    raster.draw_ring(canvas(pixels), bad, -5.0, 9.0, 1.0, FILL, 1.0)
    assert np.all(pixels == GROUND)


def test_a_flat_grain_is_left_out() -> None:
    pixels = blank()
    draw_grain(pixels, grain(30.0, 20.0, 8.0, 8.0))
    draw_grain(pixels, grain(30.0, 20.0, 8.0, -9.0))
    draw_grain(pixels, grain(30.0, 20.0, -8.0))
    assert np.all(pixels == GROUND)


def test_thin_line_gets_fainter_not_broken() -> None:
    def total(half: float) -> float:
        pixels = np.zeros((40, 80), dtype=np.uint32)
        ends = tuple(np.array([value]) for value in (10.0, -20.0, 70.0, -20.5))
        raster.draw_lines(canvas(pixels), ends, np.array([half]), colour(255), np.ones(1))
        return white_share(pixels)

    assert total(0.1) == pytest.approx(total(0.5) / 5, rel=0.05)
    assert total(0.5) == pytest.approx(61.0, rel=0.03)  # a pixel wide, and two half round ends


def test_mark_closes_as_the_grain_shrinks() -> None:
    def hole(openness: float) -> int:
        pixels = blank((60, 60))
        one = grain(30.0, 30.0, 24.0)
        draw_grain(pixels, one)
        raster.draw_bow_ties(
            canvas(pixels), one, np.zeros(1), np.array([openness]), np.ones(1, bool), 0, 1.0
        )
        return int((pixels == 0).sum())

    areas = [hole(openness) for openness in (0.0, 0.25, 0.5, 0.75, 1.0)]
    assert areas == sorted(areas)
    assert areas[0] < 0.15 * areas[-1]
    # Two trapezia of the bow-tie: 4 x height x mean half width x R^2, inside an outline of blur.
    assert areas[-1] == pytest.approx(4 * 0.52 * 0.28 * 24.0**2, rel=0.15)


def test_same_input_same_pixels() -> None:
    first, second = blank(), blank()
    for pixels in (first, second):
        draw_grain(pixels, grain(30.3, 20.1, 15.7, 3.0, 2.0))
    assert np.array_equal(first, second)


def test_warmup_compiles_what_drawing_uses() -> None:
    """A second signature would be compiled in the middle of a run: a frozen picture."""
    compile_kernels()
    kernels = [
        raster.draw_ellipses,
        raster.draw_bow_ties,
        raster.draw_made_grains,
        raster.draw_lines,
        raster.draw_hull,
        raster.draw_ring,
    ]
    before = [len(kernel.signatures) for kernel in kernels]
    from sandbox.draw.render import Renderer
    from sandbox.words.words import VIEWS
    from tests.draw.frames import hopper_frame, intruder_frame, periodic_frame

    for frame in (intruder_frame(8), hopper_frame(), periodic_frame()):
        for view in VIEWS:
            Renderer((640, 400), scale=2, view=view).draw(frame, notices=("a notice",))
    assert [len(kernel.signatures) for kernel in kernels] == before

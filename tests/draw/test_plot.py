"""The force-stroke strip: axes, thinning, odd curves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pygame
import pytest
from numpy.typing import NDArray

from sandbox.draw.painter import dashed
from sandbox.draw.plot import Curve, PlotBox, draw_plot, finite_part, limits, thinned, value_digits
from sandbox.draw.render import Renderer
from sandbox.session.frame import Ahead, Frame
from sandbox.session.history import Event
from tests.draw.frames import curve, intruder_frame


def test_thinning_keeps_every_peak_and_the_ends() -> None:
    rng = np.random.default_rng(0)
    x = np.linspace(0.0, 300.0, 200_000)
    y = rng.normal(size=x.size)
    y[12_345], y[54_321] = 99.0, -99.0
    kept_x, kept_y = thinned(x, y)
    assert kept_x.size <= 4 * 302
    assert kept_y.max() == 99.0
    assert kept_y.min() == -99.0
    assert (kept_x[0], kept_x[-1]) == (x[0], x[-1])
    assert np.all(np.diff(kept_x) >= 0)
    columns = np.floor(x).astype(int)
    for column in (0, 17, 150, 299):  # the drawn extent of a column is that of the data
        inside = columns == column
        drawn = np.floor(kept_x).astype(int) == column
        assert kept_y[drawn].max() == y[inside].max()
        assert kept_y[drawn].min() == y[inside].min()


def test_thinning_follows_a_drive_that_turns_back() -> None:
    x = np.concatenate((np.linspace(0, 50, 5000), np.linspace(50, 20, 5000)))
    y = np.concatenate((np.ones(5000), np.full(5000, 2.0)))
    kept_x, kept_y = thinned(x, y)
    assert kept_x.size < 400
    assert kept_x[kept_y == 2.0].min() == pytest.approx(20.0)


def test_short_curve_is_left_alone() -> None:
    x, y = np.arange(7.0), np.arange(7.0)
    assert thinned(x, y)[0] is x


def test_what_is_no_number_is_left_out() -> None:
    stroke, force = finite_part(
        Curve(np.array([0.0, 1.0, np.nan, 3.0]), np.array([1.0, np.inf, 2.0, 4.0]), 0)
    )
    assert stroke.tolist() == [0.0, 3.0]
    assert force.tolist() == [1.0, 4.0]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_axes_hold_the_curve_and_zero(sign: float) -> None:
    stroke, force = curve(200)
    low, high, bottom, top = limits([(stroke, sign * force)])
    assert low <= 0.0
    assert high == stroke[-1]
    assert bottom <= min((sign * force).min(), 0.0) + 1e-9
    assert top >= max((sign * force).max(), 0.0) - 1e-9
    assert limits([]) == (0.0, 1.0, 0.0, 0.01)


def test_what_is_counted_has_no_decimals() -> None:
    whole, broken = np.array([0.0, 2.0]), np.array([0.0, 2.5])
    assert value_digits("grains that have left", [whole, whole], 2.0) == 0
    assert value_digits("grains that have left", [whole, broken], 2.0) == 2
    assert value_digits("force on the piston [k R]", [whole], 2.0) == 2


def test_axes_of_counts_have_whole_numbers(texts: list[tuple[str, pygame.Rect]]) -> None:
    """One grain that has left in three increments: no half grain and no half increment on the axes."""
    frame = replace(
        intruder_frame(6),
        curve_stroke=np.array([0.0, 1.0, 2.0, 3.0]),
        curve_force=np.array([0.0, 0.0, 1.0, 1.0]),
        curve_label="grains that have left",
        stroke_label="increments",
    )
    renderer = Renderer((1280, 720), chains=False)
    renderer.draw(frame)
    plot = renderer.layout.plot
    seen = [
        text for text, rect in texts if plot.colliderect(rect) and text.strip("−0123456789.") == ""
    ]
    assert seen == ["1", "0", "1", "0", "1", "2"]  # the latest value, then both axes


@pytest.mark.parametrize("points", [0, 1, 2, 3, 5000])
def test_any_number_of_points_can_be_drawn(points: int) -> None:
    Renderer((640, 400)).draw(intruder_frame(6, points=points))


def test_a_curve_of_bad_numbers_can_be_drawn() -> None:
    bad = np.array([np.nan, np.inf, -np.inf, 1.0])
    Renderer((640, 400)).draw(intruder_frame(6, curve_stroke=bad, curve_force=bad[::-1].copy()))


def test_what_lies_ahead_of_a_recalled_state_stays_in_sight_and_recedes() -> None:
    renderer = Renderer((640, 400))
    whole = intruder_frame(6, points=200)
    assert whole.curve_stroke.shape == (200,)

    def strip(frame: Frame) -> NDArray[np.int64]:
        left, top, width, height = renderer.layout.plot
        return renderer.image(frame)[top : top + height, left : left + width].astype(np.int64)

    early = replace(
        whole,
        curve_stroke=whole.curve_stroke[:80],
        curve_force=whole.curve_force[:80],
        ahead=Ahead(whole.curve_stroke[80:], whole.curve_force[80:], ()),
    )
    bad = replace(early, ahead=Ahead(np.array([np.nan, 1.0]), np.array([1.0, np.inf]), ()))
    renderer.draw(bad)
    drawn, before, alone = strip(early), strip(whole), strip(replace(early, ahead=None))
    # Axes and what is past look as with the whole curve; what is ahead is drawn, and fainter.
    third = slice(60, drawn.shape[1] // 3)
    assert np.array_equal(drawn[40:, third], before[40:, third])
    assert not np.array_equal(alone[40:, third], before[40:, third])
    last = slice(2 * drawn.shape[1] // 3, drawn.shape[1] - 40)
    background = drawn[45, 65]
    faint, strong = (
        np.abs(image[40:-40, last] - background).sum(axis=2).max(axis=0).mean()
        for image in (drawn, before)
    )
    assert 0.0 < faint < strong


def test_dashes_have_the_asked_length() -> None:
    x = np.array([0.0, 30.0, 60.0])
    ends = (x[:-1], np.zeros(2), x[1:], np.zeros(2))
    x0, _, x1, _ = dashed(ends, 8.0, 4.0)
    assert (x1 - x0).sum() == pytest.approx(40.0)
    assert x0.min() == 0.0


def drawn_plot(*curves: Curve, limit: float | None = None) -> PlotBox:
    painter = Renderer((700, 300)).painter()
    box = draw_plot(painter, pygame.Rect(0, 0, 700, 220), curves, "force [k R]", limit=limit)
    assert box is not None
    return box


@pytest.mark.parametrize("shape", ["early", "late", "low", "both"])
def test_how_strong_the_hand_is_stands_where_no_curve_runs(
    shape: str, texts: list[tuple[str, pygame.Rect]]
) -> None:
    stroke = np.linspace(0.0, 10.0, 500)
    force = {
        "early": np.where(stroke < 3.0, 2.8 * stroke, 1.0),
        "late": np.where(stroke > 7.0, 2.8 * (stroke - 7.0), 1.0),
        "low": 0.1 * stroke,
        "both": np.full(500, 8.8) - 1.6 * (np.arange(500) % 2),
    }[shape]
    box = drawn_plot(
        Curve(stroke, force, 0),
        Curve(np.array([0.0, 10.0]), np.array([0.0, 9.5]), 0, faint=True),
        limit=8.0,
    )
    ((_, place),) = [(text, rect) for text, rect in texts if text.startswith("the hand")]
    covered = [
        place.collidepoint(float(box.x(x)), float(box.y(y)))
        for x, y in zip(stroke, force, strict=True)
    ]
    assert any(covered) == (shape == "both")  # where there is no such place it stands at the left
    assert box.rect.contains(place)


def test_marks_on_one_curve_are_named_too(texts: list[tuple[str, pygame.Rect]]) -> None:
    """Beside its latest value, and shortened away where the label of the axis needs the room."""
    frame = replace(intruder_frame(6), events=(Event("arch", 3, 1.0, 0.1, "an arch"),))
    for width, named in ((1280, True), (330, False)):
        texts.clear()
        renderer = Renderer((width, 600))
        renderer.draw(frame)
        plot = renderer.layout.plot
        seen = {text: rect for text, rect in texts if plot.colliderect(rect)}
        assert ("arch" in seen) == named
        assert len({tuple(rect) for rect in seen.values()}) == len(seen)

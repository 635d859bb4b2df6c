"""What the views show: values against closed forms, colours, legends, bad numbers."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pygame
import pytest

from core.errors import InputError
from sandbox.draw.layout import layout
from sandbox.draw.legend import draw_header
from sandbox.draw.render import Renderer
from sandbox.draw.theme import DARK, LIGHT, Theme, channels
from sandbox.draw.views import KIND, VIEWS, area_lost, motion, shape, view_after, view_named
from sandbox.draw.world import Look, made_angle
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from sandbox.words import words
from tests.draw.contrast import contrast
from tests.draw.frames import empty_frame, hopper_frame, intruder_frame, periodic_frame

MEASURED = [name for name, view in VIEWS.items() if view.measure is not None]
SIZES = [(480, 360), (640, 480), (1280, 720), (1920, 1080), (3840, 2160)]


def test_names_are_those_of_the_command_line() -> None:
    assert list(VIEWS) == list(words.VIEWS)
    view = KIND
    for _ in VIEWS:
        view = view_after(view)
    assert view is KIND
    with pytest.raises(InputError, match="choose kind, skin"):
        view_named("nothing")


def test_shape_and_area_of_an_ellipse() -> None:
    """a = 1.2, b = 0.8 turned by 0.3 rad, at rest a circle of radius 1.1; and a circle that has grown."""
    frame = replace(
        intruder_frame(6),
        p=np.array([1.0, 1.5]),
        q1=np.array([0.2 * np.cos(0.6), 0.0]),
        q2=np.array([0.2 * np.sin(0.6), 0.0]),
        rest_radius=np.array([1.1, 1.0]),
    )
    assert shape(frame) == pytest.approx([0.2, 0.0])
    assert area_lost(frame) == pytest.approx([100.0 * (1.0 - 0.96 / 1.21), 0.0])


def test_motion_is_against_the_mean_of_all() -> None:
    own = np.array([[1.0, 3.0, 1.0, 3.0], [0.0, 0.0, 2.0, 2.0]])
    assert motion(replace(intruder_frame(6), motion=own)) == pytest.approx([np.sqrt(2.0)] * 4)
    shared = np.repeat([[0.3], [-0.2]], 4, axis=1)
    assert motion(replace(intruder_frame(6), motion=shared)) == pytest.approx(np.zeros(4))


@pytest.mark.parametrize("four_plates", [False, True])
def test_pressure_in_a_grain_between_plates(four_plates: bool) -> None:
    """p = Σ F h / 2A, and with plates along its axes the principal stresses are F h / A, one a pair."""
    session = Session("single_grain", "regular", 1, {"four_plates": four_plates})
    session.build()
    session.submit(Protocol(True))
    done = 0
    while done < 8:
        done += session.advance(2000)
    frame = session.frame()
    contacts = frame.contacts
    for grain in range(frame.grains):
        mine = np.hypot(contacts.x0 - frame.x[grain], contacts.y0 - frame.y[grain]) < 1e-9
        dx, dy = contacts.x1 - contacts.x0, contacts.y1 - contacts.y0
        work = (contacts.force * np.hypot(dx, dy))[mine]
        upright = (abs(dy) > abs(dx))[mine]
        area = np.pi * (frame.p[grain] ** 2 - frame.q1[grain] ** 2 - frame.q2[grain] ** 2)
        assert frame.pressure[grain] == pytest.approx(work.sum() / (2.0 * area), rel=1e-6)
        difference = abs(work[upright].sum() - work[~upright].sum()) / area
        assert frame.stress_difference[grain] == pytest.approx(difference, rel=1e-6, abs=1e-9)
        assert frame.pressure[grain] > 0.0


@pytest.mark.parametrize("name", VIEWS)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e300])
def test_bad_values_are_grey_and_hide_no_others(name: str, bad: float) -> None:
    frame = intruder_frame(8)
    view = VIEWS[name]
    fields = {
        field: np.array(getattr(frame, field))
        for field in ("pressure", "stress_difference", "motion", "q1", "rest_radius")
    }
    for values in fields.values():
        values[..., 0] = bad
    broken = replace(frame, **fields)  # type: ignore[arg-type]
    for chains in (False, True):
        Renderer((640, 400), view=name, chains=chains).draw(broken)
    if view.measure is not None:
        values = view.measure(broken)
        colours = view.colours(DARK, values, 1.0)
        assert np.all(colours[~np.isfinite(values)] == DARK.hairline)
        if name != "motion":
            assert np.array_equal(colours[1:], view.colours(DARK, view.measure(frame), 1.0)[1:])


@pytest.mark.parametrize("name", VIEWS)
@pytest.mark.parametrize("theme", ["dark", "light"])
def test_every_view_of_every_frame(name: str, theme: str) -> None:
    pictures = []
    for frame in (intruder_frame(8), hopper_frame(), periodic_frame(), empty_frame()):
        renderer = Renderer((640, 400), theme=theme, view=name)
        pictures.append(renderer.image(frame))
        assert np.array_equal(
            pictures[-1], Renderer((640, 400), theme=theme, view=name).image(frame)
        )
    assert not np.array_equal(pictures[0], pictures[1])


@pytest.mark.parametrize("name", MEASURED)
@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
def test_the_mark_shows_on_every_colour_of_a_scale(name: str, theme: Theme) -> None:
    share = np.linspace(0.0, 1.0, 65)
    colours = VIEWS[name].colours(theme, share, 1.0)
    assert min(contrast(int(colour), theme.ground) for colour in colours) > 1.8


def test_scales_are_in_order_and_fringes_come_back() -> None:
    share = np.linspace(0.0, 1.0, 65)
    for theme, way in ((DARK, 1.0), (LIGHT, -1.0)):
        rising = VIEWS["pressure"].colours(theme, share, 1.0)
        luminance = [sum(np.array([0.3, 0.6, 0.1]) * channels(int(colour))) for colour in rising]
        assert np.all(way * np.diff(luminance) > -2.0)
    fringes = VIEWS["fringes"].colours(DARK, np.array([0.0, 0.25, 0.5, 0.75, 1.0]), 1.0)
    assert fringes[0] == fringes[2] == fringes[4]
    assert fringes[1] == fringes[3] != fringes[0]


def test_scale_grows_at_once_and_is_forgotten() -> None:
    frame = intruder_frame(8)
    renderer = Renderer((640, 400), view="pressure")
    first = renderer.image(frame)
    renderer.draw(replace(frame, pressure=3.0 * frame.pressure))
    assert not np.array_equal(first, renderer.image(frame))
    renderer.forget()
    assert np.array_equal(first, renderer.image(frame))


@pytest.mark.parametrize("chains", [False, True])
@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("name", VIEWS)
def test_legends_fit(
    texts: list[tuple[str, pygame.Rect]], name: str, scale: float, chains: bool
) -> None:
    view = VIEWS[name]
    frame = intruder_frame(6)
    for size in SIZES:
        rect = layout(size, scale).header
        if not rect.height:
            continue
        for title in ("Hopper", "A title that is longer than that of any scene of this program"):
            texts.clear()
            painter = Renderer((size[0], rect.height), scale).painter()
            values = None if view.measure is None else view.measure(frame)
            look = Look(view, chains or view.only_chains, values, 0.0125)
            shown = replace(frame, title=title)
            draw_header(painter, rect, [shown], look, 12.5 if look.chains else None)
            for _, place in texts:
                assert rect.contains(place)
            for (_, place), (_, other) in combinations(texts, 2):
                assert not place.colliderect(other)
            said = [text for text, _ in texts]
            if size[0] >= 640 * scale and view is not KIND:
                assert any(view.title in text for text in said) or view.made, said
            if size[0] >= 500 * scale and view.measure is not None:
                assert (
                    f"0.013 {view.unit}".rstrip() in said or f"0.0125 {view.unit}".rstrip() in said
                )


def test_made_grains_lie_in_all_directions_and_keep_theirs() -> None:
    angles = made_angle(np.arange(400))
    assert np.histogram(angles, 8, (0.0, 2.0 * np.pi))[0].min() > 40
    assert made_angle(np.array([7, 3]))[0] == made_angle(np.array([7]))[0]
    frame = intruder_frame(8)
    order = np.arange(frame.grains)[::-1]
    turned = replace(
        frame,
        **{
            field: getattr(frame, field)[order]
            for field in (
                "x", "y", "p", "q1", "q2", "rest_radius", "poisson_ratio", "label",
                "pressure", "stress_difference",
            )
        },
    )  # fmt: skip
    pictures = [Renderer((640, 400), view="skin").image(one) for one in (frame, turned)]
    # Where grains overlap the order of drawing shows, nowhere else.
    assert (pictures[0] != pictures[1]).any(axis=-1).mean() < 0.02

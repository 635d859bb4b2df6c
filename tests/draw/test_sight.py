"""Looking more closely: a place stays where it is, and what is seen is never beyond the whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pygame
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.draw.camera import ALL, NEAREST, Camera, Sight
from sandbox.draw.overlays import Hand
from sandbox.draw.render import Renderer
from sandbox.draw.theme import channels
from sandbox.draw.views import VIEWS
from tests.draw.frames import hopper_frame, intruder_frame, periodic_frame

RECT = pygame.Rect(30, 50, 900, 400)
WHOLE = Camera.fit((-5.0, -4.0, 35.0, 30.0), RECT, 14.0)

places = st.tuples(st.floats(30, 929), st.floats(50, 449))
acts = st.lists(
    st.one_of(
        st.tuples(st.just("towards"), st.floats(0.05, 20.0), places),
        st.tuples(st.just("moved"), st.floats(-2000, 2000), st.floats(-2000, 2000)),
    ),
    max_size=8,
)


@given(acts)
def test_what_is_seen_is_part_of_the_whole(acts: list[tuple[object, ...]]) -> None:
    sight = ALL
    for name, *arguments in acts:
        sight = getattr(sight, str(name))(*arguments, WHOLE, RECT)
        assert 1.0 <= sight.nearer <= NEAREST
        camera = sight.camera(WHOLE, RECT)
        for corner in (RECT.topleft, RECT.bottomright):
            x, y = WHOLE.to_screen(*camera.to_world(*corner))
            assert RECT.left - 1e-6 <= x <= RECT.right + 1e-6
            assert RECT.top - 1e-6 <= y <= RECT.bottom + 1e-6
    assert sight.towards(1e-9, RECT.center, WHOLE, RECT) == ALL


@given(places, st.floats(1.0, 6.0), st.floats(1.0, 6.0))
def test_the_place_under_the_pointer_stays(
    place: tuple[float, float], first: float, second: float
) -> None:
    there = WHOLE.to_world(*place)
    sight = ALL.towards(first, place, WHOLE, RECT).towards(second, place, WHOLE, RECT)
    assert sight.camera(WHOLE, RECT).to_screen(*there) == pytest.approx(place, abs=1e-6)


def test_the_picture_follows_the_hand() -> None:
    sight = ALL.towards(3.0, RECT.center, WHOLE, RECT)
    before = sight.camera(WHOLE, RECT).to_screen(15.0, 13.0)
    after = sight.moved(20.0, -10.0, WHOLE, RECT).camera(WHOLE, RECT).to_screen(15.0, 13.0)
    assert after == pytest.approx((before[0] + 20.0, before[1] - 10.0))


@pytest.mark.parametrize("nearer", [1.0, 3.0, NEAREST])
@pytest.mark.parametrize("view", VIEWS)
def test_nothing_is_drawn_beside_the_canvas(view: str, nearer: float) -> None:
    """However near: the strips around the canvas are as they are when all is seen."""
    for frame in (intruder_frame(8), hopper_frame(), periodic_frame()):
        frame = replace(frame, protocol=False)
        pictures = []
        for sight in (ALL, Sight(nearer, 0.4, -0.3)):
            renderer = Renderer((900, 600), view=view)
            renderer.arrange(panel=True, timeline=True)
            renderer.sight = sight
            picture = renderer.draw(frame, hand=Hand()).copy()
            picture.fill(0, renderer.layout.canvas)
            pictures.append(pygame.surfarray.array3d(picture))
        assert np.array_equal(pictures[0], pictures[1])


def test_sides_of_a_cell_that_are_out_of_sight_are_not_drawn() -> None:
    renderer = Renderer((900, 600), chains=False)
    renderer.sight = Sight(10.0)
    frame = periodic_frame()
    none = np.full(frame.grains, 1e-6)
    renderer.draw(replace(frame, p=none, q1=0 * none, q2=0 * none, highlight=None))
    canvas = renderer.layout.canvas
    edge = [
        renderer.surface.get_at((canvas.left + 1, y))[:3] for y in range(canvas.top, canvas.bottom)
    ]
    assert set(edge) == {channels(renderer.theme.ground)}


def test_all_is_seen_in_films() -> None:
    assert Renderer((640, 400)).sight == ALL

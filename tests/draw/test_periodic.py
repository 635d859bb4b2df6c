"""Periodic cells: every image that can be seen, none twice, and both sides fit together."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sandbox.draw.periodic import images
from sandbox.draw.render import Renderer
from sandbox.draw.theme import EVENT, channels
from tests.draw.frames import intruder_frame, periodic_frame


def around(x: float, y: float, reach: float) -> tuple[np.ndarray, ...]:
    return tuple(np.array([v]) for v in (x - reach, y - reach, x + reach, y + reach))


@pytest.mark.parametrize(
    ("place", "count"),
    [((5.0, 5.0), 1), ((0.5, 5.0), 2), ((5.0, 9.5), 2), ((0.5, 0.5), 4), ((9.9, 9.9), 4)],
)
def test_number_of_images(place: tuple[float, float], count: int) -> None:
    index, move_x, move_y = images((10.0, 10.0, 0.0), *around(*place, 1.0))
    assert index.size == count
    assert len(set(zip(move_x, move_y, strict=True))) == count
    assert (move_x[0], move_y[0]) == (0.0, 0.0)


def test_open_directions_have_no_images() -> None:
    assert images((math.inf, math.inf, 0.0), *around(0.0, 0.0, 1.0))[0].size == 1
    index, move_x, _ = images((10.0, math.inf, 0.0), *around(0.2, 500.0, 1.0))
    assert index.size == 2
    assert move_x.tolist() == [0.0, 10.0]


@pytest.mark.parametrize("shift", [0.0, 3.0, -3.0, 9.9, 23.0])
def test_images_of_a_sheared_cell_are_those_of_the_plane(shift: float) -> None:
    width, height = 10.0, 8.0
    rng = np.random.default_rng(5)
    for _ in range(50):
        x, y, reach = rng.uniform(0, width), rng.uniform(0, height), rng.uniform(0.2, 2.0)
        _, move_x, move_y = images((width, height, shift), *around(x, y, reach))
        found = {
            (round(x + dx, 6), round(y + dy, 6)) for dx, dy in zip(move_x, move_y, strict=True)
        }
        expected = {(round(x, 6), round(y, 6))}
        for row in range(-1, 2):
            for column in range(-9, 10):
                px, py = x + column * width + row * shift, y + row * height
                over_x = -reach < px < width + reach
                over_y = -reach < py < height + reach
                if over_x and over_y:
                    expected.add((round(px, 6), round(py, 6)))
        assert found == expected


def test_sides_fit_together() -> None:
    """In a cell that is not sheared, moving all grains by half a cell moves the picture by it."""
    renderer = Renderer((900, 760), chains=True)
    frame = periodic_frame(shift=0.0, highlight=None)
    image = renderer.image(frame)
    camera = renderer.camera
    left, bottom = (round(v) for v in camera.to_screen(0.0, 0.0))
    right, top = (round(v) for v in camera.to_screen(20.0, 16.0))
    half = 0.5 * (right - left) / camera.scale
    inside = (slice(top + 4, bottom - 4), slice(left, right))

    def moved(values: np.ndarray) -> np.ndarray:
        return (values + half) % ((right - left) / camera.scale)

    contacts = frame.contacts
    x0 = moved(contacts.x0)
    shifted = replace(
        frame,
        box=((right - left) / camera.scale, 16.0, 0.0),
        x=moved(frame.x),
        contacts=replace(contacts, x0=x0, x1=x0 + contacts.x1 - contacts.x0),
    )
    frame = replace(frame, box=shifted.box)
    image = renderer.image(frame)[inside].astype(int)
    other = np.roll(renderer.image(shifted)[inside].astype(int), (right - left) // 2, axis=1)
    differing = (np.abs(image - other).max(axis=-1) > 24).mean()
    assert differing < 0.02  # where the dashes along the sides were rolled to, and the rounding


def test_grains_pointed_at_have_a_bright_rim() -> None:
    frame = intruder_frame(10)
    chosen = np.zeros(frame.grains, dtype=bool)
    plain = Renderer((900, 700)).image(frame)
    chosen[:5] = True
    ringed = Renderer((900, 700)).image(replace(frame, highlight=chosen))
    event = np.array(channels(EVENT))
    assert not (plain == event).all(axis=-1).any()
    assert (ringed == event).all(axis=-1).any()


def test_spin_of_images_is_drawn() -> None:
    frame = periodic_frame()
    Renderer((640, 400)).draw(replace(frame, spin=np.linspace(0, 6, frame.grains)))

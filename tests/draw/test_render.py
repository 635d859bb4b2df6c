"""The whole picture: what it shows, few golden frames, how long it takes.

The golden frames hold the canvas only: text depends on the version of the font renderer. To make
them anew after a wanted change, set SANDBOX_REGENERATE_GOLDEN=1, run this file, and look at them.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pygame
import pytest
from numpy.typing import NDArray

from sandbox.draw.lamp import lamp
from sandbox.draw.overlays import Hand
from sandbox.draw.render import Renderer
from sandbox.draw.text import Type
from sandbox.draw.theme import DARK, HAND, LIGHT, Theme, channels, kind_colour
from sandbox.draw.views import VIEWS
from sandbox.session.frame import Contacts, Frame
from sandbox.words import words
from tests.draw.contrast import EYES, contrast_of_light
from tests.draw.frames import empty_frame, hopper_frame, intruder_frame

GOLDEN = Path(__file__).parent / "golden"
LEVELS = 2  # a processor may round the last bit of a distance differently


def silent(frame: Frame) -> Frame:
    """The frame with no force at the handles, so that no text stands on the canvas."""
    return replace(frame, handles=tuple(replace(h, fx=0.0, fy=0.0) for h in frame.handles))


def canvas_of(renderer: Renderer, frame: Frame) -> NDArray[np.uint8]:
    image = renderer.image(frame)
    rect = renderer.layout.canvas
    return image[rect.top : rect.bottom, rect.left : rect.right]


@pytest.mark.parametrize(
    ("name", "view", "chains"),
    [
        ("chains-dark", "kind", True),
        ("kinds-light", "kind", False),
        ("hopper-dark", "kind", False),
        ("skin-dark", "skin", False),
    ],
)
def test_golden_frame(name: str, view: str, chains: bool) -> None:
    frame = hopper_frame() if name.startswith("hopper") else intruder_frame(14)
    theme = name.partition("-")[2]
    renderer = Renderer((480, 420), theme=theme, view=view, chains=chains)
    seen = canvas_of(renderer, silent(frame))
    path = GOLDEN / f"{name}.png"
    if os.environ.get("SANDBOX_REGENERATE_GOLDEN"):
        GOLDEN.mkdir(exist_ok=True)
        pygame.image.save(pygame.surfarray.make_surface(seen.transpose(1, 0, 2)), str(path))
    wanted = pygame.surfarray.array3d(pygame.image.load(str(path))).transpose(1, 0, 2)
    assert wanted.shape == seen.shape
    difference = np.abs(wanted.astype(int) - seen.astype(int)).max(axis=-1)
    assert difference.max() <= LEVELS, f"{(difference > LEVELS).sum()} pixels differ from {path}"


def test_image_is_what_is_drawn() -> None:
    renderer = Renderer((640, 400))
    frame = intruder_frame(8)
    image = renderer.image(frame)
    assert image.shape == (400, 640, 3)
    assert image.dtype == np.uint8
    assert image.flags.c_contiguous
    surface = renderer.draw(frame)
    assert tuple(image[123, 321]) == tuple(surface.get_at((321, 123)))[:3]


def test_same_frames_same_pictures() -> None:
    frames = [intruder_frame(8, seed=seed) for seed in (1, 2)]
    first, second = Renderer((640, 400)), Renderer((640, 400))
    for frame in frames:
        assert np.array_equal(first.image(frame), second.image(frame))


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_a_cross_marks_a_grain_that_is_squeezed_too_far(theme: Theme, view: str) -> None:
    """By its form, and in the colour of the text on that of the ground: legible on every view's colours."""
    frame = silent(intruder_frame(8, "regular"))
    frame = replace(frame, handles=(), contacts=Contacts.none(), spin=None)
    frame = replace(frame, q1=0.0 * frame.q1, q2=0.0 * frame.q2, p=frame.rest_radius)
    assert not frame.squeezed.any()
    p = frame.rest_radius.copy()
    p[np.argmax(frame.rest_radius)] *= 0.7
    plain, marked = (
        canvas_of(Renderer((640, 400), theme=theme.name, view=view), each)
        for each in (frame, replace(frame, p=p))
    )
    ink = np.array(channels(theme.text))
    new = (marked == ink).all(axis=-1) & (plain != ink).any(axis=-1)
    rows, columns = np.nonzero(new)
    assert len(rows) > 15
    across, up = columns - columns.mean(), rows - rows.mean()
    assert np.abs(np.abs(across) - np.abs(up)).max() < 4.0  # along the two diagonals


def test_the_status_line_counts_the_squeezed_of_all_packings(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    said: list[str] = []
    render = Type.render

    def spy(self: Type, text: str, *rest: Any, **more: Any) -> Any:
        said.append(text)
        return render(self, text, *rest, **more)

    monkeypatch.setattr(Type, "render", spy)
    frame = intruder_frame(8, "auxetic")
    rest = replace(frame, q1=0.0 * frame.q1, q2=0.0 * frame.q2, p=frame.rest_radius)
    shrunk = replace(rest, p=np.where(np.arange(frame.grains) < 3, 0.85, 1.0) * rest.rest_radius)
    Renderer((1280, 720)).image(rest)
    assert not [text for text in said if "squeezed" in text]
    Renderer((1280, 720)).image(shrunk)
    assert "× 3 squeezed too far" in said
    Renderer((1280, 720)).image([shrunk, rest, shrunk])
    assert "× 6 squeezed too far" in said


@pytest.mark.parametrize("theme", ["dark", "light"])
@pytest.mark.parametrize("packing", ["regular", "auxetic", "mixed"])
def test_kinds_have_their_colours(packing: str, theme: str) -> None:
    renderer = Renderer((640, 400), theme=theme, chains=False)
    seen = {
        tuple(pixel) for pixel in canvas_of(renderer, intruder_frame(8, packing)).reshape(-1, 3)
    }
    own = renderer.theme
    assert (channels(own.regular) in seen) == (packing != "auxetic")
    assert (channels(own.auxetic) in seen) == (packing != "regular")


@pytest.mark.parametrize("eyes", EYES)
@pytest.mark.parametrize("theme", ["dark", "light"])
@pytest.mark.parametrize("chains", [False, True])
def test_kinds_differ_from_the_back_row(chains: bool, theme: str, eyes: str) -> None:
    """Where all grains of a kind run together in one colour, under chains too; the legend has the very colours of the picture."""
    light = []
    for packing in ("regular", "auxetic"):
        renderer = Renderer((1280, 720), theme=theme, chains=chains)
        frame = silent(replace(intruder_frame(12, packing), handles=()))
        image = renderer.image(frame).reshape(720, 1280, 3)
        own = channels(kind_colour(renderer.theme, packing))
        header, canvas = renderer.layout.header, renderer.layout.canvas
        for rect in (header, canvas):
            part = image[rect.top : rect.bottom, rect.left : rect.right]
            assert (part == own).all(axis=-1).sum() > 100, (packing, rect)
        left, top = renderer.camera.to_screen(frame.bounds[0], frame.bounds[3])
        right, bottom = renderer.camera.to_screen(frame.bounds[2], frame.bounds[1])
        grains = image[int(top) : int(bottom), int(left) : int(right)].reshape(-1, 3) / 255.0
        linear = np.where(grains <= 0.04045, grains / 12.92, ((grains + 0.055) / 1.055) ** 2.4)
        light.append(linear.mean(axis=0))
    assert contrast_of_light(light[0], light[1], eyes) >= 1.15


def test_auxetic_grains_can_be_told_without_colour() -> None:
    renderer = Renderer((640, 400), chains=False)
    marked = canvas_of(renderer, intruder_frame(8, "auxetic"))
    plain = canvas_of(renderer, intruder_frame(8, "regular"))
    holes = [(image == channels(DARK.ground)).all(axis=-1).sum() for image in (marked, plain)]
    assert holes[0] > holes[1]
    luminance = [image.astype(float).std() for image in (marked, plain)]
    assert luminance[0] != luminance[1]


def test_empty_and_broken_frames_are_drawn() -> None:
    renderer = Renderer((640, 400))
    renderer.draw(empty_frame())
    frame = intruder_frame(8)
    nan = np.full(frame.grains, np.nan)
    contacts = replace(frame.contacts, force=np.full(len(frame.contacts), np.nan))
    handle = replace(frame.handles[0], x=float("nan"), fx=float("inf"))
    renderer.draw(replace(frame, x=nan, q1=nan, contacts=contacts, handles=(handle,)))
    renderer.draw(replace(frame, spin=nan, bounds=(0.0, 0.0, 0.0, 0.0)))


def test_read_only_arrays_can_be_drawn() -> None:
    frame = hopper_frame()
    for name in ("x", "y", "p", "q1", "q2", "rest_radius", "poisson_ratio", "spin"):
        getattr(frame, name).flags.writeable = False
    Renderer((640, 400)).draw(frame)


def test_hand_that_runs_ahead_is_shown() -> None:
    frame = silent(intruder_frame(8))
    handle = replace(frame.handles[0], target=None)
    frame = replace(frame, handles=(handle,))
    renderer = Renderer((1280, 720), chains=False)
    target = (handle.x + 4.0, handle.y)
    renderer.draw(frame, hand=Hand(held="intruder", target=target))
    middle = renderer.camera.to_screen(handle.x + 2.0, handle.y)
    row = renderer.surface.subsurface((int(middle[0]), int(middle[1]) - 3, 1, 6))
    seen = {tuple(row.get_at((0, k)))[:3] for k in range(6)}
    assert channels(HAND) in seen


def test_what_is_said_leaves_the_canvas_as_it_is() -> None:
    frame, renderer = silent(intruder_frame(8)), Renderer((1280, 720))
    still, whole = canvas_of(renderer, frame).copy(), renderer.image(frame)
    told = replace(frame, notices=("clogged: nothing left",) * 3)
    assert np.array_equal(still, canvas_of(renderer, told))
    assert not np.array_equal(whole, renderer.image(told))


def test_resize_and_theme_need_no_new_renderer() -> None:
    renderer = Renderer((640, 400))
    frame = intruder_frame(8)
    renderer.resize((1000, 700), 2.0)
    assert renderer.draw(frame).get_size() == (1000, 700)
    assert renderer.scale == 2.0
    renderer.set_theme("light")
    assert tuple(renderer.draw(frame).get_at((2, 120)))[:3] == channels(LIGHT.ground)


def test_chain_scale_follows_and_forgets() -> None:
    renderer = Renderer((1280, 720))
    frame = intruder_frame(8)
    strong = replace(frame, contacts=replace(frame.contacts, force=40.0 * frame.contacts.force))
    first = renderer.image(frame)
    renderer.draw(strong)
    renderer.forget()
    assert np.array_equal(first, renderer.image(frame))


@pytest.mark.parametrize(
    ("changes", "colour", "state"),
    [
        ({}, DARK.good, words.SETTLED),
        ({"busy": True, "residual": 0.3}, DARK.working, words.SETTLING),
        ({"stop_reason": "budget", "residual": 0.05}, DARK.working, words.STOPPED["budget"]),
        ({"stop_reason": "iteration limit", "residual": 0.5}, DARK.bad, "iteration limit"),
        ({"stop_reason": "not finite", "residual": float("nan")}, DARK.bad, "numbers went bad"),
        ({"stop_reason": "collapsed"}, DARK.bad, "crushed flat"),
        ({"stop_reason": "something new"}, DARK.working, "something new"),
    ],
)
def test_lamp_says_what_can_be_believed(
    changes: dict[str, object], colour: int, state: str
) -> None:
    shown = lamp(replace(intruder_frame(6), **changes), DARK)  # type: ignore[arg-type]
    assert state in shown.words
    assert shown.colour == colour


def test_lamp_bounds_the_force_error() -> None:
    frame = intruder_frame(6)
    assert lamp(replace(frame, residual=0.0082), DARK).error == "forces balance within 1 %"
    assert lamp(replace(frame, residual=3.0), DARK).error == words.UNKNOWN_FORCES
    assert lamp(replace(frame, residual=float("nan")), DARK).error == words.NO_FORCES

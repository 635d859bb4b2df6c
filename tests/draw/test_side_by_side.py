"""Packings side by side: one scale for all, texts that fit, the honest lamp, flashes, names at the ends of curves."""

from __future__ import annotations

import os
from dataclasses import replace
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pygame
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.draw.flashes import FADE, Flashes
from sandbox.draw.lamp import worst
from sandbox.draw.marks import marks
from sandbox.draw.painter import Painter
from sandbox.draw.plot_marks import spread
from sandbox.draw.render import Renderer
from sandbox.draw.theme import DARK, EVENT, channels
from sandbox.session.frame import Frame
from sandbox.session.history import Event
from sandbox.window.picture import kept_curve
from sandbox.window.solvers.kept_curves import Curves
from sandbox.words import words
from tests.draw.frames import curve, empty_frame, hopper_frame, intruder_frame
from tests.draw.test_layout import SCALES, SIZES, check
from tests.draw.test_render import GOLDEN, LEVELS, silent

PACKINGS = ("regular", "mixed", "auxetic")
KINDS = ("avalanche", "arch", "clog")


def side_by_side(make: Any = intruder_frame, count: int = 3, **changes: Any) -> list[Frame]:
    """Frames of a run each, with an event of each kind."""
    frames = []
    for index, packing in enumerate(PACKINGS[:count]):
        stroke, force = curve(160 + 20 * index, seed=index)
        force = (1.0 - 0.25 * index) * force
        frame = make(packing=packing, seed=2)
        at = (50, 90, 150)
        events = tuple(
            Event(kind, k, float(stroke[k]), float(force[k]), "clogged: nothing left, held by 5")  # type: ignore[arg-type]
            for kind, k in zip(KINDS, at, strict=True)
        )
        changed = {"curve_stroke": stroke, "curve_force": force, "events": events, **changes}
        frames.append(replace(frame, increment=160, grains_out=12 * index, **changed))
    return frames


def earlier(count: int) -> list[Any]:
    """Curves of earlier runs."""
    curves = Curves()
    for index in range(count):
        stroke, force = curve(200, seed=40 + index)
        packing = PACKINGS[index % 3]
        frame = intruder_frame(6, packing, seed=index)
        curves.keep(replace(frame, curve_stroke=stroke, curve_force=0.3 * force + 0.05 * index))
    return [kept_curve(kept) for kept in curves.entries]


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("panel", [False, True])
def test_texts_fit_and_do_not_lie_on_one_another(
    texts: list[tuple[str, pygame.Rect]],
    panel: bool,
    count: int,
    scale: float,
    size: tuple[int, int],
) -> None:
    renderer = Renderer(size, scale)
    renderer.arrange(panel=panel, timeline=True)
    frames = side_by_side(hopper_frame, count)
    frames[-1] = replace(frames[-1], busy=True, residual=0.2)
    renderer.draw(frames, kept=earlier(5), rate="60 frames/s · 12 ms", paused=True)
    places = renderer.layout
    assert len(places.canvases) == len(renderer.bodies) == count
    parts = [places.header, places.plot, places.status]
    for canvas, body in zip(places.canvases, renderer.bodies, strict=True):
        parts.append(pygame.Rect(canvas.topleft, (canvas.width, body.top - canvas.top)))
        if body.bottom < canvas.bottom:
            parts.append(pygame.Rect(body.bottomleft, (canvas.width, canvas.bottom - body.bottom)))
    for part in parts:
        check([(text, place) for text, place in texts if part.colliderect(place)], part)
    for text, place in texts:
        assert any(rect.contains(place) for rect in (*parts, *renderer.bodies)), (text, place)


def test_sizes_and_forces_can_be_compared() -> None:
    renderer = Renderer((1280, 720))
    frames = side_by_side()
    wide = replace(frames[1], bounds=(-40.0, -10.0, 80.0, 60.0))
    contacts = replace(frames[2].contacts, force=9.0 * frames[2].contacts.force)
    renderer.draw([frames[0], wide, replace(frames[2], contacts=contacts)])
    assert len({camera.scale for camera in renderer.cameras}) == 1
    alone = Renderer((1280, 720))
    alone.draw(frames[0])
    assert renderer._chain_scale.top > 5.0 * alone._chain_scale.top
    for canvas, camera in zip(renderer.bodies, renderer.cameras, strict=True):
        x, y = camera.to_screen(20.0, 20.0)
        assert canvas.collidepoint(x, y)


def test_a_canvas_waits_for_its_grains() -> None:
    renderer = Renderer((1280, 720))
    frame = intruder_frame(8)
    renderer.draw([None, frame, None], told=[("packing the grains · 40 %",), (), ("",)])
    assert len(renderer.bodies) == 3
    body = renderer.bodies[2]
    assert tuple(renderer.surface.get_at(body.center))[:3] == channels(DARK.ground)
    renderer.draw(frame)
    assert len(renderer.layout.canvases) == 1
    renderer.draw([empty_frame(), empty_frame(bounds=(0.0, 0.0, 0.0, 0.0))])


def test_the_status_line_is_about_the_worst(texts: list[tuple[str, pygame.Rect]]) -> None:
    frames = side_by_side()
    assert worst(frames, DARK) in frames
    busy = replace(frames[0], busy=True, residual=0.5)
    broken = replace(frames[2], stop_reason="collapsed")
    assert worst([busy, frames[1], frames[2]], DARK) is busy
    assert worst([busy, frames[1], broken], DARK) is broken
    Renderer((1280, 720)).draw([busy, frames[1], frames[2]])
    said = [text for text, _ in texts]
    assert any(text.startswith(f"regular: {words.SETTLING}") for text in said)


def test_a_flash_comes_once_and_fades() -> None:
    frames = side_by_side(highlight=None)
    chosen = np.arange(frames[1].grains) < 4
    flashes = Flashes()
    assert flashes.follow(frames, 0.0) == []  # what was there before is no news
    news = Event("clog", 160, 1.0, 1.0, "clogged")
    frames[1] = replace(frames[1], highlight=chosen, events=(*frames[1].events, news))
    (flash,) = flashes.follow(frames, 1.0)
    assert "clog" in flashes.new
    assert (flash.pane, flash.strength, flash.labels.tolist()) == (1, 1.0, [0, 1, 2, 3])
    (flash,) = flashes.follow(frames, 1.0 + 0.5 * FADE)
    assert not flashes.new
    assert flash.strength == pytest.approx(0.5)
    assert flashes.follow(frames, 1.01 + FADE) == []
    frames[1] = replace(frames[1], events=())  # a reset
    assert flashes.follow(frames, 2.0) == []


def test_a_flash_is_seen_where_the_grains_are() -> None:
    frames = [silent(frame) for frame in side_by_side()]
    flashes = Flashes()
    flashes.follow(frames, 0.0)
    news = Event("arch", 160, 1.0, 1.0, "an arch")
    marked = replace(
        frames[2], events=(*frames[2].events, news), highlight=np.arange(frames[2].grains) == 3
    )
    frames[2] = marked
    lit = flashes.follow(frames, 1.0)
    renderer = Renderer((1280, 720), chains=False)
    plain = renderer.image(frames)
    bright = renderer.image(frames, flashes=lit)
    changed = np.argwhere((plain != bright).any(axis=-1))
    camera = renderer.cameras[2]
    x, y = camera.to_screen(float(marked.x[3]), float(marked.y[3]))
    away = np.hypot(changed[:, 1] + 0.5 - x, changed[:, 0] + 0.5 - y)
    assert changed.size
    assert away.max() < 2.5 * camera.scale + 8.0
    assert (bright == channels(EVENT)).all(axis=-1).sum() > (plain == channels(EVENT)).all(
        axis=-1
    ).sum()


@given(
    wanted=st.lists(st.floats(-50.0, 250.0), max_size=8),
    least=st.floats(5.0, 20.0),
)
def test_names_never_lie_on_one_another(wanted: list[float], least: float) -> None:
    low, high = 0.0, 160.0
    places = spread(sorted(wanted), least, low, high)
    assert all(b - a >= least - 1e-9 for a, b in pairwise(places))
    assert all(low - 1e-9 <= y <= high + 1e-9 for y in places)
    if len(wanted) == 1:
        assert places[0] == min(max(wanted[0], low), high)


def test_every_packing_has_a_colour_and_a_dash_of_its_own(
    texts: list[tuple[str, pygame.Rect]],
) -> None:

    looks = [(each.colour, each.dash) for each in marks(side_by_side())]
    for (colour, dash), (other, others) in combinations(looks, 2):
        assert colour != other
        assert dash != others
    Renderer((1280, 720)).draw(side_by_side(), kept=earlier(1))
    said = [text for text, _ in texts]
    assert all(any(text.startswith(f"{packing} 0.") for text in said) for packing in PACKINGS)
    assert {words.EVENTS[kind] for kind in KINDS} <= set(said)


def without_text(painter: Painter) -> None:
    """Text depends on the version of the font renderer."""
    painter._pixels = None
    painter._texts.clear()


@pytest.mark.parametrize("name", ["side-by-side-light", "plot-dark"])
def test_golden_picture(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Painter, "flush", without_text)
    frames = [silent(frame) for frame in side_by_side(lambda **more: intruder_frame(9, **more))]
    renderer = Renderer((900, 600), theme=name.rpartition("-")[2])
    image = renderer.image(frames) if name.startswith("side") else None
    if image is None:
        renderer.draw(frames, kept=earlier(3))
        rect = renderer.layout.plot
        whole = pygame.surfarray.array3d(renderer.surface).transpose(1, 0, 2)
        image = np.ascontiguousarray(whole[rect.top : rect.bottom, rect.left : rect.right])
    path = Path(GOLDEN) / f"{name}.png"
    if os.environ.get("SANDBOX_REGENERATE_GOLDEN"):
        pygame.image.save(pygame.surfarray.make_surface(image.transpose(1, 0, 2)), str(path))
    wanted = pygame.surfarray.array3d(pygame.image.load(str(path))).transpose(1, 0, 2)
    assert wanted.shape == image.shape
    difference = np.abs(wanted.astype(int) - image.astype(int)).max(axis=-1)
    assert difference.max() <= LEVELS, f"{(difference > LEVELS).sum()} pixels differ from {path}"


def test_runs_of_one_packing_are_told_apart_by_what_is_set() -> None:
    frames = [
        intruder_frame(packing="mixed", seed=seed, settings={"grains": 200, "friction": friction})
        for seed, friction in ((2, 0.25), (3, 0.5))
    ]
    assert [mark.name for mark in marks(frames)] == [
        "friction 0.25 · seed 2",
        "friction 0.5 · seed 3",
    ]
    assert len({mark.dash for mark in marks(frames)}) == 2
    others = [*frames, intruder_frame(packing="regular", seed=2, settings=frames[0].settings)]
    names = [mark.name for mark in marks(others)]
    assert names[0] == "mixed · friction 0.25 · seed 2"
    assert names[2].startswith("regular · ")
    picture = Renderer((900, 500)).image(frames)
    same = Renderer((900, 500)).image([frames[0], replace(frames[1], settings={}, seed=2)])
    assert (picture != same).any()

"""What is said covers neither where it happens nor other words: in all scenes, at all usual sizes and scales."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from itertools import combinations, product

import pygame
import pytest

from sandbox.draw.interest import free_place, places_of_interest
from sandbox.draw.overlays import KNOB, Hand, draw_handles, mark_scale
from sandbox.draw.render import Renderer
from sandbox.session.commands import Protocol
from sandbox.session.frame import Frame
from sandbox.session.session import Session
from sandbox.words import language, words
from scenes import registry

SIZES = [(800, 600), (1280, 720), (1920, 1080), (2560, 1440), (3840, 2160)]
SCALES = [1.0, 1.5, 2.0, 3.0]
PUSHES = [(0.0, -3.0), (2.0, 1.0), (-0.5, 0.0)]  # of a hand that is free [k R]


@cache
def frame_of(scene: str) -> Frame:
    """A scene after two increments of its script, with fewer grains where it has many."""
    known = registry.get(scene)
    grains = [parameter for parameter in known.parameters if parameter.name == "grains"]
    few = {parameter.name: int(parameter.low) for parameter in grains}
    session = Session(
        scene, known.packings[-1], 1, {} if "hopper" in scene or scene == "intruder" else few
    )
    session.build()
    session.submit(Protocol(True))
    made = session.increments(400)
    next(made)
    next(made)
    return session.frame()


def pushed(frame: Frame) -> Iterator[Frame]:
    """The frame under hands that push its handles one way and another."""
    for fx, fy in PUSHES:
        handles = []
        for handle in frame.handles:
            x, y = fx, fy
            if handle.axis is not None:
                along = math.copysign(math.hypot(fx, fy), fx + fy)
                x, y = along * handle.axis[0], along * handle.axis[1]
            handles.append(replace(handle, fx=x, fy=y))
        yield replace(frame, handles=tuple(handles))


@pytest.mark.parametrize("panes", [1, 3])
@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("scene", registry.names())
def test_nothing_covers_where_it_happens(scene: str, size: tuple[int, int], panes: int) -> None:
    frame = frame_of(scene)
    for scale in SCALES:
        renderer = Renderer(size, scale)
        renderer.arrange(panes=panes, panel=True, timeline=True)
        renderer.draw([frame] * panes, notices=[words.HINT])
        painter = renderer.painter()
        for camera, rect in zip(renderer.cameras, renderer.bodies, strict=True):
            assert not rect.colliderect(renderer.layout.said)
            for each in pushed(frame):
                labels = draw_handles(painter, rect, camera, each, Hand(), 4.0)
                places = places_of_interest(
                    each, camera, rect, 1.4 * KNOB * mark_scale(painter, rect)
                )
                # Three numbers of one packing among three in a small window may find no place.
                assert len(labels) == len(frame.handles) or (panes, size) == (3, SIZES[0])
                for label, place in product(labels, places):
                    assert not label.colliderect(place), scale
                for first, second in combinations(labels, 2):
                    assert not first.colliderect(second), scale


@pytest.mark.parametrize("scene", ["hopper", "gravity_hopper"])
def test_the_orifice_is_where_it_happens(scene: str) -> None:
    frame = frame_of(scene)
    ((x0, y0, x1, y1),) = frame.focus
    assert min(-x0, x1) > 1.0  # a gap wider than a grain
    assert min(-y0, y1) > 2.0  # what falls out, and the arch above


@pytest.mark.parametrize("code", language.available())
@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("panel", [False, True])
def test_words_under_the_picture_are_whole(
    texts: list[tuple[str, pygame.Rect]], panel: bool, size: tuple[int, int], code: str
) -> None:
    """The longest that a scene says with what the window says, and how to begin: smaller where it must be, but all of it."""
    language.use(code)
    frame = frame_of("single_grain")
    assert len(frame.notices) == 2
    for scale, telling in product(SCALES, (True, False)):
        texts.clear()
        renderer = Renderer(size, scale)
        renderer.arrange(panel=panel, timeline=True)
        shown = frame if telling else replace(frame, notices=())
        own = words.SPEED_TOAST_MOST if telling else words.HINT
        renderer.draw(shown, notices=[own])
        said = [(text, rect) for text, rect in texts if renderer.words_place.colliderect(rect)]
        assert all(renderer.layout.said.contains(rect) for _, rect in said)
        whole = [*map(words.say, shown.notices), own]
        assert _signs(text for text, _ in said) == _signs(whole), scale


def _signs(texts: Iterable[str]) -> str:
    return re.sub(r"[\s·]", "", "".join(texts))


def test_a_place_is_sought_in_order() -> None:
    within, taken = pygame.Rect(0, 0, 100, 100), [pygame.Rect(0, 0, 50, 100)]
    assert free_place((20, 20), [(10, 10), (90, 50)], taken, within)[0].center == (90, 50)
    assert free_place((20, 20), [(500, 50)], taken, within)[0].right == 100
    least, covered = free_place((80, 20), [(40, 50), (90, 50)], taken, within)
    assert (least.right, covered) == (100, 30 * 20)

"""Wheel, buttons, fingers and keys look more closely; what is picked, held and made stays right; no run hears of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pygame
import pytest

from sandbox.draw.camera import ALL, Sight
from sandbox.session.commands import Grab, Place
from tests.window.desk import Desk


@pytest.fixture
def desk() -> Iterator[Desk]:
    desk = Desk((1280, 720))
    desk.start()
    yield desk
    desk.app.close()


def sight(desk: Desk) -> Sight:
    return desk.app.stage.renderer.sight


def sent(desk: Desk) -> list[Any]:
    return desk.session.commands


def wheel(desk: Desk, place: tuple[float, float], notches: float) -> None:
    desk.point(place)
    desk.post(pygame.MOUSEWHEEL, x=0, y=round(notches), precise_x=0.0, precise_y=notches)
    desk.app.tick()


def shown(desk: Desk) -> tuple[float, float, float, float]:
    """What is seen of the world."""
    camera, rect = desk.app.stage.renderer.camera, desk.app.stage.renderer.bodies[0]
    return (*camera.to_world(*rect.bottomleft), *camera.to_world(*rect.topright))


def test_the_wheel_goes_towards_the_pointer(desk: Desk) -> None:
    place = desk.app.stage.renderer.bodies[0].move(60, 40).center
    there = desk.app.stage.renderer.camera.to_world(*place)
    wheel(desk, place, 4.0)
    assert sight(desk).nearer > 2.0
    assert desk.app.stage.renderer.camera.to_screen(*there) == pytest.approx(place, abs=1e-6)
    wheel(desk, place, -9.0)
    assert sight(desk) == ALL
    panel = desk.app.panel.rect.center
    wheel(desk, panel, 3.0)  # it scrolls there
    assert sight(desk) == ALL
    assert not sent(desk)


def test_a_button_moves_the_picture(desk: Desk) -> None:
    middle = desk.app.stage.renderer.bodies[0].center
    wheel(desk, middle, 6.0)
    for button in (pygame.BUTTON_RIGHT, pygame.BUTTON_MIDDLE):
        before = desk.app.stage.renderer.camera.to_screen(0.0, 0.0)
        desk.post(pygame.MOUSEBUTTONDOWN, pos=middle, button=button)
        desk.point((middle[0] + 30, middle[1] - 20), pressed=False)
        desk.app.tick()
        after = desk.app.stage.renderer.camera.to_screen(0.0, 0.0)
        assert after == pytest.approx((before[0] + 30, before[1] - 20))
        desk.post(pygame.MOUSEBUTTONUP, pos=(middle[0] + 30, middle[1] - 20), button=button)
        desk.point(middle)
        desk.app.tick()
        assert desk.app.stage.renderer.camera.to_screen(0.0, 0.0) == pytest.approx(after)
    assert not sent(desk)


def test_keys_look_and_letters_have_keys_of_their_own(desk: Desk) -> None:
    desk.key(pygame.K_PLUS, "+")
    desk.key(pygame.K_EQUALS, "=")
    assert sight(desk).nearer == pytest.approx(2.25)
    desk.app.tick()
    before = shown(desk)
    desk.key(pygame.K_RIGHT, mod=pygame.KMOD_LCTRL)
    desk.app.tick()
    assert shown(desk)[0] > before[0]
    desk.key(pygame.K_MINUS, "-")
    assert sight(desk).nearer == pytest.approx(1.5)
    desk.key(pygame.K_0, "0")
    assert sight(desk) == ALL
    desk.key(pygame.K_PLUS, mod=pygame.KMOD_LCTRL)
    assert desk.app.stage.renderer.scale == 1.25
    desk.key(pygame.K_MINUS, mod=pygame.KMOD_LCTRL)
    assert desk.app.stage.renderer.scale == 1.0
    desk.key(pygame.K_F1)
    desk.key(pygame.K_PLUS, "+")  # on a page there is nothing to look at more closely
    assert (desk.app.stage.renderer.scale, sight(desk)) == (1.25, ALL)
    assert not sent(desk)


def finger(desk: Desk, kind: int, name: int, place: tuple[float, float]) -> None:
    width, height = desk.app.stage.renderer.size
    desk.post(kind, finger_id=name, x=place[0] / width, y=place[1] / height, touch_id=1)


def test_two_fingers(desk: Desk) -> None:
    x, y = desk.handle_place()
    desk.post(pygame.MOUSEBUTTONDOWN, pos=(round(x), round(y)), button=1, touch=True)
    finger(desk, pygame.FINGERDOWN, 1, (x, y))
    assert desk.app.stage.mouse.hand.held
    finger(desk, pygame.FINGERDOWN, 2, (x + 50, y))
    holding: bool = desk.app.stage.mouse.holding
    assert not holding  # a hand does not pull while one looks
    finger(desk, pygame.FINGERMOTION, 2, (x + 150, y))
    assert sight(desk).nearer == pytest.approx(3.0, rel=1e-3)
    finger(desk, pygame.FINGERUP, 1, (x, y))
    finger(desk, pygame.FINGERMOTION, 2, (x + 300, y))
    assert sight(desk).nearer == pytest.approx(3.0, rel=1e-3)


def test_two_fingers_on_a_pad(desk: Desk) -> None:
    desk.point(desk.app.stage.renderer.bodies[0].center)
    desk.post(pygame.MULTIGESTURE, pinched=0.1, rotated=0.0, x=0.5, y=0.5, num_fingers=2)
    assert 1.3 < sight(desk).nearer < 1.7


def test_grains_handles_and_brush_are_where_they_are_seen(desk: Desk) -> None:
    stage = desk.app.stage
    x, y = desk.handle_place()
    wheel(desk, (x, y), 6.0)
    frame = stage.panes.snapshot.frame
    assert frame is not None
    handle = frame.handles[0]
    desk.press(desk.handle_place())
    assert stage.mouse.holding
    desk.release((x + 30, y))
    desk.until(lambda: any(isinstance(command, Grab) for command in sent(desk)))
    rect = stage.renderer.bodies[0]
    seen = [
        k
        for k in range(frame.grains)
        if rect.inflate(-80, -80).collidepoint(
            stage.renderer.camera.to_screen(frame.x[k], frame.y[k])
        )
    ]
    far = max(seen, key=lambda k: abs(frame.x[k] - handle.x) + abs(frame.y[k] - handle.y))
    place = stage.renderer.camera.to_screen(frame.x[far], frame.y[far])
    desk.click(place)
    assert desk.app.inspector.label == frame.label[far]
    desk.key(pygame.K_b)
    desk.click(place)
    desk.until(lambda: any(isinstance(command, Place) for command in sent(desk)))
    made = next(command for command in sent(desk) if isinstance(command, Place))
    assert (made.x, made.y) == pytest.approx((frame.x[far], frame.y[far]), abs=0.1)


def test_another_scene_is_seen_whole(desk: Desk) -> None:
    desk.key(pygame.K_PLUS, "+")
    assert sight(desk) != ALL
    desk.start()
    assert sight(desk) == ALL

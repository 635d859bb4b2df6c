"""How large the window and its letters are on which screen, and all of a screen taken and given back."""

from __future__ import annotations

from collections.abc import Iterator

import pygame
import pytest

from core.errors import InputError
from sandbox.cli.main import main
from sandbox.window import display
from sandbox.window.display import Looks, window_of
from tests.window.desk import Desk


@pytest.fixture
def desk() -> Iterator[Desk]:
    desk = Desk()
    yield desk
    desk.app.close()


@pytest.mark.parametrize(
    ("desktop", "size", "scale"),
    [
        ((1024, 768), (922, 691), 1.0),
        ((1920, 1080), (1280, 720), 1.0),
        ((2560, 1440), (1920, 1080), 1.5),
        ((3840, 2160), (2560, 1440), 2.0),
        ((2160, 3840), (1944, 1440), 1.5),  # upright: letters that the window has room for
    ],
)
def test_window_and_letters_go_together(
    desktop: tuple[int, int], size: tuple[int, int], scale: float
) -> None:
    assert window_of(Looks(), desktop) == (size, scale)


def test_what_is_asked_for_wins() -> None:
    large = (3840, 2160)
    assert window_of(Looks(scale=1.0), large) == ((1280, 720), 1.0)
    assert window_of(Looks(scale=3.0), (1920, 1080)) == ((1728, 972), 3.0)
    # A small window on a large screen has letters of its own size, so that the panel has its place.
    assert window_of(Looks(size=(1280, 720)), large) == ((1280, 720), 1.0)
    assert window_of(Looks(size=(1280, 720), scale=2.0), large) == ((1280, 720), 2.0)
    assert window_of(Looks(size=(3840, 2160)), large) == ((3840, 2160), 2.0)
    assert window_of(Looks(size=(9999, 10)), large) == ((3840, display.SMALLEST[1]), 1.0)


def test_a_screen_that_is_not_there_is_one_plain_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pygame.display, "get_desktop_sizes", lambda: [(1920, 1080)] * 2)
    with pytest.raises(InputError, match="--display 3: there are 2 screens; the first is 1"):
        display.open_display(Looks(display=3))


def test_options_reach_the_window(monkeypatch: pytest.MonkeyPatch) -> None:
    from sandbox import environment
    from sandbox.window import app

    seen: list[Looks] = []
    monkeypatch.setattr(environment, "require_display", lambda: None)

    def run(*_: object, looks: Looks, **__: object) -> int:
        seen.append(looks)
        return 0

    monkeypatch.setattr(app, "run", run)
    for options in ([], ["--display", "2", "--fullscreen"], ["--size", "900x700"]):
        assert main(["play", "workshop", *options]) == 0
    assert seen == [Looks(), Looks(display=2, fullscreen=True), Looks(size=(900, 700))]


def test_all_of_the_screen_and_back(desk: Desk) -> None:
    desk.start()
    desktop = pygame.display.get_desktop_sizes()[0]
    for key, mod in ((pygame.K_F11, 0), (pygame.K_RETURN, pygame.KMOD_LALT)):
        desk.key(key, mod=mod)
        desk.app.tick()
        assert pygame.display.is_fullscreen()
        assert desk.app.stage.screen.get_size() == desk.app.stage.renderer.size == desktop
        assert desk.app.stage.screen is pygame.display.get_surface()
        desk.key(key, mod=mod)
        desk.app.tick()
        assert not pygame.display.is_fullscreen()
        assert desk.app.stage.renderer.size == (800, 600)


def test_all_of_the_screen_while_something_is_typed(desk: Desk) -> None:
    desk.start()
    place = next(name for name in desk.app.panel.stops() if name.startswith("general/seed"))
    desk.app.stage.focus.go(place, True)
    desk.key(pygame.K_RETURN)
    assert desk.app.panel.edit is not None
    desk.key(pygame.K_RETURN, mod=pygame.KMOD_LALT)
    assert desk.app.panel.edit is not None
    assert pygame.display.is_fullscreen()


def test_all_of_the_screen_from_the_start() -> None:
    screen, _ = display.open_display(Looks(fullscreen=True))
    assert screen.get_size() == pygame.display.get_desktop_sizes()[0]
    pygame.display.quit()

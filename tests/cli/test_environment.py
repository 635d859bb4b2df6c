"""What the machine must offer, and how it is said when it does not."""

from __future__ import annotations

import sys
from types import ModuleType

import pytest

from core.errors import InputError
from sandbox import environment

linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="screens of Linux")


def pretend_installed(monkeypatch: pytest.MonkeyPatch, *distributions: str) -> None:
    monkeypatch.setattr(environment, "_installed", lambda name: name in distributions)


def test_pygame_ce_alone_is_fine(monkeypatch: pytest.MonkeyPatch) -> None:
    environment.require_pygame_ce()
    pretend_installed(monkeypatch, "pygame-ce")
    environment.require_pygame_ce()


@pytest.mark.parametrize("installed", [["pygame"], ["pygame", "pygame-ce"]])
def test_pygame_in_the_way_is_told(monkeypatch: pytest.MonkeyPatch, installed: list[str]) -> None:
    pretend_installed(monkeypatch, *installed)
    with pytest.raises(InputError, match="uninstall -y pygame, then") as caught:
        environment.require_pygame_ce()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("found", [None, ModuleType("pygame")], ids=["none", "another"])
def test_missing_pygame_ce_is_told(
    monkeypatch: pytest.MonkeyPatch, found: ModuleType | None
) -> None:
    pretend_installed(monkeypatch)
    monkeypatch.setitem(sys.modules, "pygame", found)
    with pytest.raises(InputError, match="pip install --force-reinstall pygame-ce"):
        environment.require_pygame_ce()


def test_a_program_without_lists_of_what_is_installed_asks_pygame_itself(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As one that was packed for machines without Python."""
    pretend_installed(monkeypatch)
    environment.require_pygame_ce()


@linux
@pytest.mark.parametrize("driver", ["dummy", "offscreen", ""])
def test_no_screen_is_told_with_what_to_do(monkeypatch: pytest.MonkeyPatch, driver: str) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", driver)
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(InputError, match=r"record SCENE --out film\.mp4"):
        environment.require_display()


@linux
def test_a_screen_that_does_not_answer_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SDL_VIDEODRIVER", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("DISPLAY", "127.0.0.1:97")
    with pytest.raises(InputError, match=r"no display.*record SCENE --out film\.mp4"):
        environment.require_display()

"""What the program needs from the machine: one pygame, processors, and for a window a screen."""

from __future__ import annotations

import os
import sys
from importlib.metadata import PackageNotFoundError, version

from core.errors import InputError

# Drivers of SDL that take drawing and show it to nobody.
_BLIND_DRIVERS = {"dummy", "offscreen", "evdev"}
_RECORD_INSTEAD = "record a film instead: python -m sandbox record SCENE --out film.mp4"


def require_pygame_ce() -> None:
    """Raise InputError unless pygame-ce alone provides ``import pygame``.

    pygame and pygame-ce write the same files, so with both installed neither is whole, and
    uninstalling one takes files from the other.
    """
    reinstall = "run: python -m pip install --force-reinstall pygame-ce"
    if _installed("pygame"):
        raise InputError(
            "pygame and pygame-ce overwrite each other and pygame is installed: "
            f"run: python -m pip uninstall -y pygame, then {reinstall}"
        )
    hide_greeting()
    # Not what is said to be installed: a program packed for machines without Python has no list of that.
    try:
        import pygame
    except ImportError as error:
        raise InputError(f"pygame-ce is not installed: {reinstall}") from error
    if not getattr(pygame, "IS_CE", False):
        raise InputError(f"pygame-ce is not installed, but another pygame: {reinstall}")


def cores() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def prepare_headless() -> None:
    """Let pygame draw without a screen or a sound device. Call it before pygame is imported."""
    os.environ["SDL_VIDEODRIVER"] = "dummy"
    os.environ["SDL_AUDIODRIVER"] = "dummy"
    hide_greeting()


def hide_greeting() -> None:
    """Keep pygame from printing its version to standard output when it is imported."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")


def require_display() -> None:
    """Raise InputError unless a window can be opened where a person sees it."""
    driver = os.environ.get("SDL_VIDEODRIVER", "")
    if driver in _BLIND_DRIVERS:
        raise InputError(
            f"SDL_VIDEODRIVER={driver} shows no window: unset it, or {_RECORD_INSTEAD}"
        )
    no_server = not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    if sys.platform.startswith("linux") and no_server and not driver:
        raise InputError(f"no display (DISPLAY and WAYLAND_DISPLAY are not set): {_RECORD_INSTEAD}")
    if not driver:
        os.environ.pop("SDL_VIDEODRIVER", None)  # pygame takes the empty word for Windows' driver
    hide_greeting()
    import pygame

    try:
        pygame.display.init()
    except pygame.error as error:
        raise InputError(f"no display ({error}): {_RECORD_INSTEAD}") from error
    if pygame.display.get_driver() in _BLIND_DRIVERS:
        pygame.display.quit()
        raise InputError(f"no display was found: {_RECORD_INSTEAD}")


def _installed(distribution: str) -> bool:
    try:
        version(distribution)
    except PackageNotFoundError:
        return False
    return True

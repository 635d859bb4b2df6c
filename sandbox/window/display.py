"""The screen: opening a window on it, a picture of it in a file, how fast it is drawn."""

from __future__ import annotations

import io
import os
import sys
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import pygame

from core.errors import InputError, reason_of
from core.files import atomic_write
from sandbox.words import words

FRAMES = 60  # pictures a second, at most
SMALLEST = (480, 360)  # window [px]
SLOW = 0.8  # fewer than this share of FRAMES is explained
NO_DISPLAY = "no display to open a window on: record a film with record SCENE --out FILE.mp4"


USUAL_SIZE = (1280, 720)  # of a window whose letters have scale 1 [px]
MOST_OF_DESKTOP = 0.9  # of its width and its height, for a window of no size that was asked for
SCALES = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0)  # to choose from


@dataclass(frozen=True)
class Looks:
    """How the window looks at first."""

    size: tuple[int, int] | None = None  # [px]; None: by the desktop's size
    scale: float | None = None  # of letters and controls; None: by the size of desktop and window
    theme: str = "dark"
    view: str = "kind"
    display: int = 1  # which of the screens, counted from 1
    fullscreen: bool = False


USUAL = Looks()


def open_display(looks: Looks) -> tuple[pygame.Surface, float]:
    """A resizable window no larger than the screen, and the scale of its letters.

    Raises InputError where there is no display, or not the one that was asked for.
    """
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform.startswith("linux") and not display and not os.environ.get("SDL_VIDEODRIVER"):
        raise InputError(NO_DISPLAY)
    # Pixels are pixels: no blurred enlargement on high-resolution screens.
    os.environ.setdefault("SDL_WINDOWS_DPI_AWARENESS", "permonitorv2")
    os.environ.setdefault("SDL_IME_SHOW_UI", "1")  # what an input method offers to choose from
    try:
        pygame.display.init()
        if pygame.display.get_driver() == "x11":
            # Shared memory shows a picture in 0.1 ms; the way through OpenGL took up to 13 ms.
            os.environ.setdefault("SDL_FRAMEBUFFER_ACCELERATION", "0")
        desktop = _desktop(looks.display, pygame.display.get_desktop_sizes())
        size, scale = window_of(looks, desktop)
        flags = pygame.RESIZABLE | (pygame.HIDDEN if shown_later() else 0)
        screen = pygame.display.set_mode(size, flags, display=looks.display - 1)
    except (pygame.error, IndexError) as error:
        raise InputError(f"{NO_DISPLAY} ({error})") from None
    pygame.display.set_caption(words.SPLASH_TITLE)
    if looks.fullscreen:
        switch_fullscreen(True)
        screen = pygame.display.get_surface() or screen
    return screen, scale


def _desktop(number: int, sizes: Sequence[tuple[int, int]]) -> tuple[int, int]:
    """The size of one of the desktops [px]. Raises InputError, and IndexError where there is none at all."""
    if 0 < len(sizes) < number:
        there = "is one screen" if len(sizes) == 1 else f"are {len(sizes)} screens"
        raise InputError(f"--display {number}: there {there}; the first is 1")
    return sizes[number - 1]


def window_of(looks: Looks, desktop: tuple[int, int]) -> tuple[tuple[int, int], float]:
    """Size of the window [px], and scale of its letters, which go together where not both were asked for."""
    natural = natural_scale(desktop[1])
    if looks.size is None:
        scale = looks.scale or natural
        size = tuple(
            round(min(wanted * scale, MOST_OF_DESKTOP * most))
            for wanted, most in zip(USUAL_SIZE, desktop, strict=True)
        )
    else:
        size = tuple(min(wanted, most) for wanted, most in zip(looks.size, desktop, strict=True))
    width, height = (max(wanted, least) for wanted, least in zip(size, SMALLEST, strict=True))
    if looks.scale is not None:
        return (width, height), looks.scale
    room = min(width / USUAL_SIZE[0], height / USUAL_SIZE[1])
    fitting = [scale for scale in SCALES if scale <= min(natural, room + 0.1)]
    return (width, height), max(fitting, default=SCALES[0])


def shown_later() -> bool:
    """Is the window hidden at first? Windows and macOS look for what a screen reader needs when it is shown."""
    return sys.platform in ("win32", "darwin") and find_spec("accesskit") is not None


def show_display() -> None:
    """Show the window, if it is still hidden."""
    if shown_later():
        _window().show()


def _window() -> pygame.Window:
    """The window as an object."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        return pygame.Window.from_display_module()


def natural_scale(height: int) -> float:
    """The UI scale that suits a desktop of that height [px]: larger on one with many pixels."""
    return 2.0 if height >= 2000 else 1.5 if height >= 1400 else 1.0


def switch_fullscreen(on: bool | None = None) -> None:
    """Take all of the screen that the window is on, or go back to the window; None: the other of the two."""
    # The other way, pygame.display.toggle_fullscreen, makes another window and tells wrong sizes afterwards.
    window = _window()
    if not is_fullscreen() if on is None else on:
        window.set_fullscreen(True)  # as large as the desktop: no other mode of the screen
    else:
        window.set_windowed()


def is_fullscreen() -> bool:
    """Does the window take all of the screen?"""
    return pygame.display.is_fullscreen()


def save_picture(surface: pygame.Surface, stem: str) -> str:
    """Write a PNG whole or not at all into the current folder, under a name that is still free.

    Returns what to tell the person.
    """
    number = 1
    while (path := Path(f"{stem}-{number}.png")).exists():
        number += 1
    picture = io.BytesIO()
    pygame.image.save(surface, picture, "picture.png")
    try:
        with atomic_write(path) as file:
            file.write(picture.getvalue())
    except OSError as error:
        return words.NOT_SAVED.format(name=path.name, reason=reason_of(error))
    return words.SAVED.format(name=path.name)


class Rate:
    """Pictures a second in words, renewed twice a second, with what holds them up if they are few."""

    def __init__(self) -> None:
        self.text = ""
        self._drawing = 0.0  # time that one picture takes, smoothed [s]
        self._renewed = 0.0

    def drew(self, seconds: float) -> None:
        """A picture took so long."""
        self._drawing += 0.1 * (seconds - self._drawing)

    def renew(self, now: float, rate: float) -> None:
        """``rate``: turns of the loop a second; 0 while that is not known."""
        if now - self._renewed < 0.5:
            return
        self._renewed = now
        milliseconds = 1e3 * self._drawing
        if rate >= SLOW * FRAMES or rate == 0.0:
            self.text = words.RATE.format(fps=rate or FRAMES, ms=milliseconds)
        elif self._drawing > 0.5 / FRAMES:
            reason = words.SLOW_DRAWING.format(ms=milliseconds)
            self.text = words.RATE_SLOW.format(fps=rate, reason=reason)
        else:
            self.text = words.RATE_SLOW.format(fps=rate, reason=words.SLOW_MACHINE)

"""The screen: opening a window on it, a picture of it in a file, how fast it is drawn."""

from __future__ import annotations

import io
import os
import sys
from dataclasses import dataclass
from pathlib import Path

import pygame

from core.errors import InputError
from core.files import atomic_write
from sandbox.words import words

FRAMES = 60  # pictures a second, at most
SMALLEST = (480, 360)  # window [px]
SLOW = 0.8  # fewer than this share of FRAMES is explained
NO_DISPLAY = "no display to open a window on: record a film with record SCENE --out FILE.mp4"


@dataclass(frozen=True)
class Looks:
    """How the window looks at first."""

    size: tuple[int, int] = (1280, 720)  # [px]
    scale: float | None = None  # of letters and controls; None: by the screen's size
    theme: str = "dark"
    view: str = "kind"


USUAL = Looks()


def open_display(size: tuple[int, int]) -> pygame.Surface:
    """A resizable window no larger than the screen. Raises InputError where there is no display."""
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
        desktop = pygame.display.get_desktop_sizes()[0]
        fitting = tuple(
            max(min(wanted, most), least)
            for wanted, most, least in zip(size, desktop, SMALLEST, strict=True)
        )
        screen = pygame.display.set_mode(fitting, pygame.RESIZABLE)
    except (pygame.error, IndexError) as error:
        raise InputError(f"{NO_DISPLAY} ({error})") from None
    pygame.display.set_caption(words.SPLASH_TITLE)
    return screen


def natural_scale() -> float:
    """The UI scale that suits the screen: larger on one with many pixels."""
    sizes = pygame.display.get_desktop_sizes()
    height = sizes[0][1] if sizes else 1080
    return 2.0 if height >= 2000 else 1.5 if height >= 1400 else 1.0


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
        return words.NOT_SAVED.format(name=path.name, reason=error.strerror or str(error))
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

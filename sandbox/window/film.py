"""A film of the window while one plays: encoded in a thread of its own, at a constant number of frames a second."""

from __future__ import annotations

import contextlib
import logging
import queue
import threading
import time
from pathlib import Path

import numpy as np
import pygame
import pygame.surfarray

from core.errors import InputError
from core.files import clear_beginning
from sandbox.draw.text import SMALL, Type
from sandbox.draw.theme import Theme, channels
from sandbox.record.video import VideoWriter
from sandbox.window.export import free_stem
from sandbox.words import words
from scenes.text import message

log = logging.getLogger(__name__)

FPS = {".mp4": 30.0, ".gif": 20.0}  # a GIF stores whole hundredths of a second
WAITING = 12  # pictures that the encoder may be behind; then it repeats the last one
PATIENCE = 60.0  # with the encoder when the window is closed [s]
RED = 0xE5322D
PREFIX = "sandbox-"  # of a film's name


class Film:
    """One film being made. ``offer`` never waits for the encoder."""

    def __init__(self, name: str, size: tuple[int, int]) -> None:
        """Raises InputError where no film can be made."""
        suffix = name[name.rindex(".") :]
        self.name = name
        self.size = size[0] - size[0] % 2, size[1] - size[1] % 2
        self.fps = FPS[suffix]
        self.error = ""
        self.begun = time.perf_counter()
        self._writer = VideoWriter(name, self.size, self.fps)
        self._sent = 0
        self._ending = threading.Event()
        self._pictures: queue.Queue[tuple[pygame.Surface, int]] = queue.Queue(WAITING)
        self._thread = threading.Thread(target=self._run, name="film", daemon=True)
        self._thread.start()

    @property
    def done(self) -> bool:
        """Is the file whole, or has it failed?"""
        return not self._thread.is_alive()

    @property
    def ending(self) -> bool:
        """Has it been told to end?"""
        return self._ending.is_set()

    def offer(self, surface: pygame.Surface, now: float) -> None:
        """What the window shows from now on; as many frames as the time since the last one takes."""
        due = int((now - self.begun) * self.fps) + 1
        if due <= self._sent or self.ending:
            return
        picture = surface.subsurface((0, 0), self.size).copy()
        with contextlib.suppress(queue.Full):  # then the next one makes up for it
            self._pictures.put_nowait((picture, due - self._sent))
            self._sent = due

    def end(self) -> None:
        """No more pictures; the file is finished in the background."""
        self._ending.set()

    def join(self, timeout: float) -> bool:
        """Wait for the file; True when it is done."""
        self._thread.join(timeout)
        return self.done

    def _run(self) -> None:
        try:
            with self._writer as writer:
                last: np.ndarray | None = None
                while (item := self._next()) is not None:
                    surface, frames = item
                    image = np.ascontiguousarray(
                        pygame.surfarray.array3d(surface).transpose(1, 0, 2)
                    )
                    for _ in range(frames - 1):  # so long the window showed what was before
                        writer.write(image if last is None else last)
                    writer.write(image)
                    last = image
        except InputError as error:
            self.error = message(error)
        except Exception as error:
            log.exception("the film stopped")
            self.error = str(error) or type(error).__name__

    def _next(self) -> tuple[pygame.Surface, int] | None:
        while True:
            with contextlib.suppress(queue.Empty):
                return self._pictures.get(timeout=0.05)
            if self.ending:
                return None


def found_films(folder: Path) -> list[str]:
    """What windows that were killed had filmed there, no longer hidden: names."""
    return [path.name for path in clear_beginning(folder, PREFIX)]


class Recorder:
    """The recording key: begins a film of the window, ends it, says its name."""

    def __init__(self) -> None:
        self._film: Film | None = None
        self._second = -1

    @property
    def recording(self) -> bool:
        """Is a film being made of what is shown?"""
        return self._film is not None and not self._film.ending

    def switch(self, scene: str, size: tuple[int, int], suffix: str = ".mp4") -> str:
        """Begin or end; returns what to say."""
        if self._film is not None:
            if self._film.ending:
                return words.FILM_BUSY.format(name=self._film.name)
            self._film.end()
            return words.FILM_ENDING.format(name=self._film.name)
        name = free_stem(f"{PREFIX}{scene}", tuple(FPS)) + suffix
        try:
            self._film = Film(name, size)
        except InputError as error:
            return words.say(message(error))
        return words.FILM_BEGUN.format(name=name)

    def tick(self, surface: pygame.Surface, now: float) -> str:
        """Once a picture, with what is shown; returns what to say, if anything."""
        film = self._film
        if film is None:
            return ""
        if film.done:
            self._film = None
            return words.say(film.error) if film.error else words.SAVED.format(name=film.name)
        if not film.ending:
            size = surface.get_size()
            if (size[0] - size[0] % 2, size[1] - size[1] % 2) != film.size:
                film.end()  # a film has one size
                return words.FILM_ENDING.format(name=film.name)
            film.offer(surface, now)
        return ""

    def second_passed(self, now: float) -> bool:
        """Does the indicator show another time than in the last call?"""
        second = int(now - self._film.begun) if self._film is not None else -1
        changed, self._second = second != self._second, second
        return changed

    def draw(self, screen: pygame.Surface, place: pygame.Rect, theme: Theme, type_: Type) -> None:
        """The indicator: a red disc and the time below it, in its place. It is not in the film."""
        if not self.recording or self._film is None:
            return
        minutes, seconds = divmod(int(time.perf_counter() - self._film.begun), 60)
        size = type_.fitting("00:00", SMALL, place.width, True)
        text = type_.render(f"{minutes}:{seconds:02d}", size, theme.text, True)
        plate = place.inflate(-2, -2)
        pygame.draw.rect(screen, channels(theme.panel), plate, border_radius=plate.width // 6)
        edge = max(round(1.5 * type_.scale), 1)
        pygame.draw.rect(screen, channels(RED), plate, edge, border_radius=plate.width // 6)
        free = plate.height - text.get_height()
        radius = min(7 * type_.scale, 0.4 * free)
        middle = plate.centerx, plate.top + round(0.5 * free + edge)
        pygame.draw.circle(screen, channels(RED), middle, radius)
        screen.blit(text, text.get_rect(midbottom=(plate.centerx, plate.bottom - edge)))

    def close(self) -> str:
        """Finish the film, if there is one; returns what to say."""
        film = self._film
        if film is None:
            return ""
        film.end()
        if not film.join(PATIENCE):
            return words.FILM_BUSY.format(name=film.name)
        self._film = None
        return words.say(film.error) if film.error else words.SAVED.format(name=film.name)

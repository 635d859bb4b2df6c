"""Short synthesised ticks for events. Off until asked for, and silent where there is no sound device."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable

import numpy as np
import pygame
from numpy.typing import NDArray

RATE = 44_100  # samples a second
LENGTH = 0.09  # of a tick [s]
LOUDNESS = 0.35  # of full scale
# Pitch at the beginning and at the end [Hz], and how fast a tick dies away [1/s].
TICKS = {
    "locked": (140.0, 90.0, 20.0),
    "clog": (180.0, 120.0, 30.0),
    "arch": (520.0, 660.0, 45.0),
    "avalanche": (900.0, 300.0, 60.0),
}


def tick(kind: str) -> NDArray[np.int16]:
    """The samples of an event's tick, int16 (n,)."""
    low, high, decay = TICKS.get(kind, TICKS["arch"])
    time = np.arange(round(LENGTH * RATE)) / RATE
    phase = 2.0 * np.pi * (low * time + 0.5 * (high - low) / LENGTH * time**2)
    attack = np.minimum(time / 0.003, 1.0)
    close = np.minimum((LENGTH - time) / 0.01, 1.0)  # no click at the end
    wave = np.sin(phase) * np.exp(-decay * time) * attack * close
    return np.rint(LOUDNESS * 32767.0 * wave).astype(np.int16)


def open_device() -> bool:
    """Have sounds played; False if there is no sound device."""
    try:
        pygame.mixer.init(RATE, -16, 1, 512)
    except (pygame.error, NotImplementedError):
        return False
    return True


class Sound:
    """Plays ticks when it is on."""

    def __init__(self) -> None:
        self.on = False
        self._sounds: dict[str, pygame.mixer.Sound] = {}

    def switch(self) -> bool:
        """On or off; False if there is no sound device."""
        if not self.on and not self._sounds:
            if not open_device():
                return False
            self._sounds = {kind: pygame.mixer.Sound(buffer=tick(kind).tobytes()) for kind in TICKS}
        self.on = not self.on
        return True

    def play(self, kinds: Iterable[str]) -> None:
        """One tick for each kind of event."""
        if self.on:
            for kind in set(kinds) & set(self._sounds):
                with contextlib.suppress(pygame.error):  # the device has been unplugged
                    self._sounds[kind].play()

    def close(self) -> None:
        """Give the device back."""
        self.on = False
        self._sounds.clear()
        with contextlib.suppress(pygame.error, NotImplementedError):
            pygame.mixer.quit()

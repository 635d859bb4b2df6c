"""The force as a tone, for the ear: four times the force is an octave. Off until asked for."""

from __future__ import annotations

import contextlib
import math

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.session.frame import Frame
from sandbox.window.sound import RATE, open_device

BASE = 220.0  # pitch of a force of 1 [Hz]
OCTAVES = 0.5  # a factor of 2 in force is so many
LOWEST, HIGHEST = 80.0, 1760.0  # [Hz]
STEP = 24  # pitches an octave: between two of them nobody hears a step
LEAST = 0.02  # force that is heard: what is smaller is silent
LOUDNESS = 0.12  # of full scale
LENGTH = 0.2  # of a wave that is repeated, about [s]
FADE = 40  # from one pitch to the next [ms]
STILL = 0.4  # with nothing new for so long it falls silent [s]


def pitch(force: float) -> float:
    """The pitch of a force [Hz], one of a scale of quarter tones; 0: silent."""
    size = abs(force)
    if not math.isfinite(size) or size < LEAST:
        return 0.0
    wanted = min(max(BASE * size**OCTAVES, LOWEST), HIGHEST)
    return float(BASE * 2.0 ** (round(STEP * math.log2(wanted / BASE)) / STEP))


def wave(hertz: float) -> NDArray[np.int16]:
    """A sine of whole periods, to be repeated without a seam: int16 (n,)."""
    periods = max(round(LENGTH * hertz), 1)
    samples = round(periods * RATE / hertz)
    phase = 2.0 * np.pi * periods * np.arange(samples) / samples
    return np.rint(LOUDNESS * 32767.0 * np.sin(phase)).astype(np.int16)


class Tone:
    """Follows the latest force of the plot while something moves."""

    def __init__(self) -> None:
        self.on = False
        self.pitch = 0.0  # that sounds now [Hz]
        self._waves: dict[float, pygame.mixer.Sound] = {}
        self._seen: tuple[int, float] = (
            -1,
            -math.inf,
        )  # the latest increment, and when it came [s]

    def switch(self) -> bool:
        """On or off; False if there is no sound device."""
        if not self.on and not open_device():
            return False
        self.on = not self.on
        if not self.on:
            self._sound(0.0)
        return True

    def follow(self, frame: Frame | None, now: float) -> None:
        """Sound as that frame has it at ``now`` [s]; None: be silent."""
        if not self.on:
            return
        if frame is not None and frame.increment != self._seen[0]:
            self._seen = frame.increment, now
        silent = frame is None or now - self._seen[1] > STILL or not len(frame.curve_force)
        self._sound(0.0 if silent or frame is None else pitch(float(frame.curve_force[-1])))

    def _sound(self, hertz: float) -> None:
        if hertz == self.pitch:
            return
        with contextlib.suppress(pygame.error):  # the device has been unplugged
            if self.pitch:
                self._waves[self.pitch].fadeout(FADE)
            if hertz:
                if hertz not in self._waves:
                    self._waves[hertz] = pygame.mixer.Sound(buffer=wave(hertz).tobytes())
                self._waves[hertz].play(loops=-1, fade_ms=FADE)
        self.pitch = hertz

    def close(self) -> None:
        """Be silent for good."""
        if self.on:
            self._sound(0.0)
        self.on = False
        self._waves.clear()

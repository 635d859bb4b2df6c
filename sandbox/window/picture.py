"""The picture of the runs in the window: which frame is where, what is said to each, what lights up."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pygame

from sandbox.draw.camera import Camera
from sandbox.draw.flashes import Flash, Flashes
from sandbox.draw.overlays import Hand
from sandbox.draw.plot import Curve
from sandbox.draw.render import Renderer
from sandbox.draw.theme import packing_colour, packing_dash
from sandbox.session.frame import Frame
from sandbox.window.solvers.kept_curves import Kept
from sandbox.window.solvers.panes import Panes
from sandbox.window.solvers.snapshot import Snapshot
from sandbox.words import words

Drawn = tuple[Frame, Camera, pygame.Rect]


class Picture:
    """Draws what the solvers have published."""

    def __init__(self, panes: Panes, renderer: Renderer) -> None:
        self._panes, self._renderer = panes, renderer
        self._flashes = Flashes()
        self._lit = False
        self.still = False  # no flashes
        self.events: tuple[str, ...] = ()  # kinds of those that were new in the latest picture
        self.drawn: tuple[Frame | None, ...] = ()  # in it

    @property
    def moving(self) -> bool:
        """Does the picture change by itself?"""
        busy = any(seen.phase in ("building", "catching up") for seen in self._panes.snapshots)
        return busy or self._lit

    @property
    def serials(self) -> tuple[int, ...]:
        """Changes when there is something new to show."""
        return tuple(seen.serial for seen in self._panes.snapshots)

    def forget(self) -> None:
        """Other runs begin."""
        self._flashes.forget()

    def panes(self) -> tuple[Drawn, ...]:
        """What is drawn where, from the left."""
        places = zip(
            self._panes.snapshots, self._renderer.cameras, self._renderer.bodies, strict=False
        )
        return tuple(
            (seen.frame, camera, rect) for seen, camera, rect in places if seen.frame is not None
        )

    def pane_at(self, place: tuple[int, int]) -> int | None:
        """Which of them is there."""
        for index, (_, _, rect) in enumerate(self.panes()):
            if rect.collidepoint(place):
                return index
        return None

    def draw(self, *, hand: Hand, rate: str, notices: Sequence[str], now: float) -> None:
        """All panes; at least one of them must have a frame."""
        snapshots = self._panes.snapshots
        frames = [seen.frame for seen in snapshots]
        self.drawn = tuple(frames)
        lit = self._lights(frames, now)
        first = next(frame for frame in frames if frame is not None)
        several = len(snapshots) > 1
        # Curves of earlier runs would tell what is to be sketched.
        sketching = self._renderer.plot_least is not None
        kept = () if sketching else self._panes.curves.shown(first)
        self._renderer.draw(
            frames,
            hand=hand,
            rate=rate,
            paused=self._panes.paused,
            notices=notices,
            told=[told_of(seen) for seen in snapshots] if several else (),
            kept=[kept_curve(curve) for curve in kept],
            flashes=lit,
        )

    def _lights(self, frames: Sequence[Frame | None], now: float) -> list[Flash]:
        """What lights up at ``now`` [s], and which events are new."""
        lit = self._flashes.follow(frames, now)
        self.events = self._flashes.new
        if self.still:
            lit = []
        self._lit = bool(lit)
        return lit


def progress_of(snapshot: Snapshot) -> str:
    """What is being built or caught up with; empty when nothing is."""
    if snapshot.phase == "catching up":
        text = words.CATCHING_UP
    elif snapshot.phase == "building":
        text = words.say(snapshot.text) or words.SPLASH_STEP
    else:
        return ""
    text = text[:1].upper() + text[1:]
    if snapshot.ending:
        return words.ENDING.format(text=text)
    if math.isfinite(snapshot.fraction):
        text = words.BUILDING.format(text=text, percent=100.0 * snapshot.fraction)
    return text


def kept_curve(kept: Kept) -> Curve:
    """The curve of an earlier run."""
    colour, dash = packing_colour(kept.packing), packing_dash(kept.packing)
    return Curve(kept.stroke, kept.force, colour, dash, kept.name, faint=True, events=kept.events)


def told_of(snapshot: Snapshot) -> tuple[str, ...]:
    """What the window says in a pane of its own."""
    if snapshot.phase == "failed":
        return (words.PANE_FAILED.format(error=words.say(snapshot.error)),)
    text = progress_of(snapshot)
    return (text,) if text else ()

"""The run so far, as the window has shown it, to be saved as a page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from core.files import atomic_write
from sandbox.player.tape import Tape, increment_of, spaced
from sandbox.session.frame import Frame
from sandbox.window.export import free_stem
from sandbox.window.parts import Silent
from sandbox.window.stage import Stage
from sandbox.words import words

MOST = 300  # moments
MOST_GRAINS = 90_000  # grains times moments: some 25 MB

Moment = tuple[Frame, ...]  # side by side


class Reel(Silent):
    """Holds on to frames that are there anyway, and makes nothing of them until it is asked to."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self._moments: list[Moment] = []
        self._every = 1
        self._serials: tuple[int, ...] = ()

    def tick(self, now: float) -> bool:
        """Take in what is new, once all packings have come as far."""
        del now
        serials = self.stage.picture.serials
        if serials != self._serials:
            self._serials = serials
            self.follow([seen.frame for seen in self.stage.panes.snapshots])
        return False

    def follow(self, frames: Sequence[Frame | None]) -> None:
        """The frames of the moment; what is under way, or is looked at again, does not count."""
        moment = tuple(frame for frame in frames if frame is not None)
        if len(moment) < len(frames) or any(f.busy or f.ahead is not None for f in moment):
            return
        if len({frame.increment for frame in moment}) != 1:
            return
        if self._moments and _run_of(moment) != _run_of(self._moments[-1]):
            self._moments.clear()
        while self._moments and increment_of(self._moments[-1]) >= increment_of(moment):
            self._moments.pop()
        if not self._moments:
            self._every = 1
        self._moments.append(moment)
        grains = sum(frame.grains for frame in moment)
        while len(self._moments) > max(min(MOST, MOST_GRAINS // max(grains, 1)), 2):
            self._every *= 2
            self._moments = [*spaced(self._moments[:-1], self._every, increment_of), moment]

    def save(self) -> str:
        """Write the page into the current folder, under a name that is still free; returns what to tell the person."""
        from sandbox.player.page import Look, page

        if not self._moments:
            return words.NOTHING_KEPT
        tape = Tape()
        for moment in self._moments:
            tape.add(moment)
        look = Look(self.stage.renderer.theme.name, self.stage.renderer.view.name)
        name = free_stem(f"sandbox-{tape.last[0].scene}", (".html",)) + ".html"
        try:
            with atomic_write(Path(name)) as file:
                file.write(page(tape, look).encode())
        except OSError as error:
            return words.NOT_SAVED.format(name=name, reason=error.strerror or str(error))
        return words.SAVED.format(name=name)


def _run_of(moment: Moment) -> tuple[tuple[str, str, int], ...]:
    return tuple((frame.scene, frame.packing, frame.seed) for frame in moment)

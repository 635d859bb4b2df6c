"""The run so far, as the window has shown it, to be saved as a page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from core.errors import reason_of
from core.files import atomic_write
from sandbox.player.tape import Tape, Thinning
from sandbox.session.frame import Frame
from sandbox.window.export import free_stem
from sandbox.window.parts import Silent
from sandbox.window.stage import Stage
from sandbox.words import words
from scenes import registry
from scenes.scene import Values

MOST = 300  # moments
MOST_GRAINS = 90_000  # grains times moments: some 25 MB

Moment = tuple[Frame, ...]  # side by side


class Reel(Silent):
    """Holds on to frames that are there anyway, and makes nothing of them until it is asked to."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self._thinning = Thinning[Moment](MOST, MOST_GRAINS)
        self._run: list[tuple[str, str, int, Values]] = []
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
        run = [(f.scene, f.packing, f.seed, built_from(f)) for f in moment]
        if run != self._run:
            self._run = run
            self._thinning.clear()
        self._thinning.add(moment, sum(frame.grains for frame in moment))

    def save(self) -> str:
        """Write the page into the current folder, under a name that is still free; returns what to tell the person."""
        from sandbox.player.page import Look, page

        moments = self._thinning.moments
        if not moments:
            return words.NOTHING_KEPT
        tape = Tape()
        for moment in moments:
            tape.add(moment)
        look = Look(self.stage.renderer.theme.name, self.stage.renderer.view.name)
        name = free_stem(f"sandbox-{tape.last[0].scene}", (".html",)) + ".html"
        try:
            with atomic_write(Path(name)) as file:
                file.write(page(tape, look).encode())
        except OSError as error:
            return words.NOT_SAVED.format(name=name, reason=reason_of(error))
        return words.SAVED.format(name=name)


def built_from(frame: Frame) -> Values:
    """The settings that make another run of it."""
    return registry.get(frame.scene).built_from(frame.settings)

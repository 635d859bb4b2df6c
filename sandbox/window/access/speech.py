"""What is read out when it happens: notices, events, and what a lesson says next."""

from __future__ import annotations

import time
from collections.abc import Iterator

from sandbox.draw.marks import marks
from sandbox.window.guide import Guide
from sandbox.window.stage import Stage
from sandbox.words import words

LONG = 1.0  # a wait that is told of [s]


class Speech:
    """Hears the window; ``new`` is asked ten times a second while somebody listens."""

    def __init__(self, stage: Stage, guide: Guide) -> None:
        self.stage, self.guide = stage, guide
        self._notices = 0
        self._events: dict[int, int] = {}  # of a pane that are known
        self._card: tuple[str, ...] = ()
        self._build: tuple[str, float] = ("", 0.0)  # what is being built, and since when [s]
        self._told = ""  # what has been said of it

    def begin(self) -> None:
        """Somebody listens from now on: what was before is not said."""
        for _ in self.new():
            pass

    def new(self) -> Iterator[str]:
        """What is to be said, in the order in which it came."""
        yield from self._from_the_card()
        yield from self._from_the_runs()
        yield from self._from_the_build(time.perf_counter())
        notices = self.stage.notices
        fresh, self._notices = notices.count - self._notices, notices.count
        if fresh:
            yield from list(notices.said)[-fresh:]

    def _from_the_card(self) -> Iterator[str]:
        """What was not on it before."""
        card: tuple[str, ...] = ()
        if self.guide.on:
            page = self.guide.page
            card = page.say, page.ask, page.hint, page.do, page.why
        before, self._card = self._card, card
        yield from (text for text in card if text and text not in before)

    def _from_the_build(self, now: float) -> Iterator[str]:
        """What one waits for, if it takes long; and then that it is there."""
        snapshot = self.stage.panes.snapshot
        text = words.say(snapshot.text) if snapshot.phase == "building" else ""
        if text != self._build[0]:
            self._build = text, now
        if text and text != self._told and now - self._build[1] > LONG:
            self._told = text
            yield text
        elif not text and self._told and snapshot.frame is not None:
            self._told = ""
            yield words.title(snapshot.frame.scene, snapshot.frame.title)

    def _from_the_runs(self) -> Iterator[str]:
        frames = [pane[0] for pane in self.stage.picture.panes()]
        names = [mark.name for mark in marks(frames)] if len(frames) > 1 else [""]
        for pane, (frame, name) in enumerate(zip(frames, names, strict=False)):
            known = self._events.get(pane, len(frame.events))
            self._events[pane] = len(frame.events)
            for event in frame.events[known:]:
                said = words.say(event.text)
                yield f"{name}: {said}" if name else said

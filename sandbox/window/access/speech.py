"""What is read out when it happens: notices, events, readings where a run comes to rest, a sketch, what a lesson says."""

from __future__ import annotations

import time
from collections.abc import Iterator

from sandbox.window.access.readings import frames_of, names_of, reading
from sandbox.window.guide import Guide
from sandbox.window.sketched import pen, told
from sandbox.window.stage import Stage
from sandbox.words import words

LONG = 1.0  # a wait that is told of [s]
REST = 0.7  # what has stayed the same for so long has come to rest [s]


class Settled:
    """Something that changes, and is told when it has stopped to."""

    def __init__(self, rest: float) -> None:
        self._rest = rest  # [s]
        self._now: object = None
        self._since = 0.0
        self._taken: object = None

    def settles(self, now: object, time: float) -> bool:
        """Has it come to rest at something that has not been told? Asked again and again; then it has."""
        if now != self._now:
            self._now, self._since = now, time
        if self._now == self._taken or time - self._since < self._rest:
            return False
        self._taken = self._now
        return True

    def take(self) -> None:
        """What there is now need not be told."""
        self._taken = self._now


class Speech:
    """Hears the window; ``new`` is asked ten times a second while somebody listens."""

    def __init__(self, stage: Stage, guide: Guide) -> None:
        self.stage, self.guide = stage, guide
        self._notices = 0
        self._events: dict[int, int] = {}  # of a pane that are known
        self._card: tuple[str, ...] = ()
        self._build: tuple[str, float] = ("", 0.0)  # what is being built, and since when [s]
        self._told = ""  # what has been said of it
        self._notes: frozenset[str] = frozenset()  # that stand under the canvases
        self._happened: set[str] = set()  # said since a run was at rest, and perhaps a note now
        self._run = Settled(REST)
        self._sketch, self._pen = Settled(REST), Settled(REST)
        self._compared = False  # has it been said how far the sketch is off?

    def begin(self) -> None:
        """Somebody listens from now on: what was before is not said."""
        for _ in self.new():
            pass
        if not frames_of(self.stage):
            self._card = ()  # which nobody can have read yet
        self._run.take()
        self._sketch.take()
        self._pen.take()

    def new(self) -> Iterator[str]:
        """What is to be said, in the order in which it came."""
        yield from self._from_the_card()
        now = time.perf_counter()
        yield from self._from_the_runs()
        yield from self._from_the_readings(now)
        yield from self._from_the_sketch(now)
        yield from self._from_the_build(now)
        notices = self.stage.notices
        fresh, self._notices = notices.count - self._notices, notices.count
        if fresh:
            yield from list(notices.said)[-fresh:]

    def _from_the_card(self) -> Iterator[str]:
        """What was not on it before."""
        card: tuple[str, ...] = ()
        if self.guide.on:
            page = self.guide.page
            step = words.TOUR_STEP.format(step=page.step + 1, steps=page.steps)
            done = words.TOUR_DONE if page.done and page.do else ""
            card = page.title, step, page.say, page.ask, page.hint, page.do, done, page.why
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
        """Events."""
        frames = frames_of(self.stage)
        for pane, (frame, name) in enumerate(zip(frames, names_of(frames), strict=True)):
            known = self._events.get(pane, len(frame.events))
            self._events[pane] = len(frame.events)
            for event in frame.events[known:]:
                self._happened.add(text := f"{name}{words.say(event.text)}")
                yield text

    def _from_the_readings(self, now: float) -> Iterator[str]:
        """Force, way, and what stands under a canvas, once a run has come to rest: while it moves they would drown all else."""
        frames = frames_of(self.stage)
        state = tuple((f.scene, f.packing, f.increment, f.notices) for f in frames)
        missing = any(seen.frame is None for seen in self.stage.panes.snapshots)
        if missing or any(f.busy for f in frames) or not self._run.settles(state, now):
            return
        notes = []
        for frame, name in zip(frames, names_of(frames), strict=True):
            yield f"{name}{reading(self.stage, frame)}"
            notes += [f"{name}{words.say(notice)}" for notice in frame.notices]
        yield from (note for note in notes if note not in self._notes | self._happened)
        self._notes = frozenset(notes)
        self._happened.clear()

    def _from_the_sketch(self, now: float) -> Iterator[str]:
        """Where the pen has stopped, what has been drawn; and how far it lies from what was measured in the end."""
        asking, frames = self.guide.asking, frames_of(self.stage)
        if asking.sketch is None or not frames:
            self._compared = False
            return
        if asking.on:
            if self._pen.settles(text := pen(asking.sketch), now) and text:
                yield text
            if self._sketch.settles(text := told(asking.sketch, frames[0]), now):
                yield text
        elif self.guide.done and not self._compared:
            self._compared = True
            yield from (each.text for each in asking.measured)

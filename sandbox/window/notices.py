"""What the window itself has to say: a notice for a moment, and how to begin as long as nobody has."""

from __future__ import annotations

import time
from collections import deque

from sandbox.words import words

STAY = 2.5  # of a notice [s]
MOST = 20  # notices that are kept


class Notices:
    """The latest notice, and the hint."""

    def __init__(self) -> None:
        self.latest = ""
        self.hints = True  # has nobody found out how to begin?
        self._until = 0.0
        self.said: deque[str] = deque(maxlen=MOST)  # the latest, for who hears them
        self.count = 0  # of all

    def say(self, text: str) -> None:
        """Say something for a moment."""
        self.latest, self._until = text, time.perf_counter() + STAY
        self.said.append(text)
        self.count += 1

    def forget(self) -> None:
        """Who has read it, or what it was about, is gone."""
        self.latest = ""

    def tick(self, now: float) -> bool:
        """True when the notice has been there long enough."""
        if not self.latest or now <= self._until:
            return False
        self.latest = ""
        return True

    def lines(self, progress: str) -> tuple[str, ...]:
        """What stands on the canvas; ``progress`` of a build, if there is one."""
        said = [text for text in (self.latest, progress) if text]
        return tuple(said or ([words.HINT] if self.hints else []))

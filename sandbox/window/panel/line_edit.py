"""Typing a line of text or a number, key by key."""

from __future__ import annotations

from dataclasses import dataclass

import pygame

LONGEST = 80  # characters


@dataclass
class Edit:
    """What is being typed into the control of that name. ``fresh``: the first key replaces all of it."""

    name: str
    text: str
    caret: int
    fresh: bool = False

    @classmethod
    def of(cls, name: str, text: str) -> Edit:
        """Begin with a text: the first sign replaces it, moving the caret keeps it."""
        return cls(name, text, len(text), fresh=True)

    def key(self, event: pygame.event.Event) -> bool:
        """A KEYDOWN event; True if it belongs to typing."""
        ends = {pygame.K_HOME: 0, pygame.K_END: len(self.text)}
        if event.key in ends:
            self.caret = ends[event.key]
        elif event.key in (pygame.K_LEFT, pygame.K_RIGHT):
            step = 1 if event.key == pygame.K_RIGHT else -1
            self.caret = min(max(self.caret + step, 0), len(self.text))
        elif event.key == pygame.K_BACKSPACE:
            self._cut(0 if self.fresh else self.caret - 1, self.caret)
        elif event.key == pygame.K_DELETE:
            self._cut(0 if self.fresh else self.caret, self.caret if self.fresh else self.caret + 1)
        else:
            sign = getattr(event, "unicode", "")
            commanding = getattr(event, "mod", 0) & (pygame.KMOD_CTRL | pygame.KMOD_META)
            if commanding or len(sign) != 1 or not sign.isprintable():
                return False
            if self.fresh:
                self.text, self.caret = "", 0
            if len(self.text) < LONGEST:
                self.text = self.text[: self.caret] + sign + self.text[self.caret :]
                self.caret += 1
        self.fresh = False
        return True

    def _cut(self, start: int, end: int) -> None:
        start, end = max(start, 0), min(end, len(self.text))
        self.text = self.text[:start] + self.text[end:]
        self.caret = start

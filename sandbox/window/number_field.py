"""The field of a number that a lesson asks for: what may be written in it, and what it comes to."""

from __future__ import annotations

import math
import re

import pygame

from sandbox.draw.numbers import MINUS
from sandbox.draw.pages.tour_card import FIELD
from sandbox.window.keys import Action, action_of
from sandbox.window.panel.line_edit import Edit

LONGEST = 12  # signs of a number
SIGNS = frozenset(f"0123456789+-{MINUS}.,% ")
OTHERS = (pygame.K_RETURN, pygame.K_KP_ENTER, pygame.K_TAB, pygame.K_ESCAPE)  # go on from here
FUNCTIONS = range(pygame.K_F1, pygame.K_F12 + 1)
SIZES = (Action.LARGER, Action.SMALLER)  # of letters
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)) ?(%?)")


class NumberField:
    """A number as it is typed; ``unit``: in which it is asked for."""

    def __init__(self, unit: str = "") -> None:
        self.unit = unit
        self.edit = Edit.of(FIELD, "")

    @property
    def text(self) -> str:
        """What stands in it."""
        return self.edit.text

    @property
    def value(self) -> float | None:
        """In its unit; None where nothing is written, or nothing that can be read."""
        found = _NUMBER.fullmatch(self.text.strip().replace(MINUS, "-").replace(",", "."))
        if found is None:
            return None
        value, percent = float(found[1]), bool(found[2])
        if percent and self.unit not in ("", "%"):
            return None
        value /= 100.0 if percent and not self.unit else 1.0
        return value if math.isfinite(value) else None

    @property
    def unreadable(self) -> bool:
        """Does something stand there that is no number?"""
        return bool(self.text.strip()) and self.value is None

    def write(self, text: str) -> bool:
        """What was typed, without signs that no number has; False if there was one."""
        fitting = "".join(sign for sign in text if sign in SIGNS)
        self.edit.write(fitting)
        self._shorten()
        return fitting == text

    def key(self, event: pygame.event.Event) -> bool:
        """A KEYDOWN event; False for one that is no matter of typing."""
        if event.key in OTHERS or event.key in FUNCTIONS or action_of(event) in SIZES:
            return False
        self.edit.key(event)
        self._shorten()
        return True

    def fill(self, text: str) -> None:
        """All of it anew, as a screen reader does."""
        self.edit.select_all()
        self.edit.write(text)
        self._shorten()

    def _shorten(self) -> None:
        self.edit.text = self.edit.text[:LONGEST]
        self.edit.caret = min(self.edit.caret, LONGEST)
        self.edit.anchor = min(self.edit.anchor, LONGEST)

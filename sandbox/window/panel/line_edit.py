"""Typing a line of text or a number: caret, selection, clipboard, and letters that an input method puts together."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field

import pygame
import pygame.scrap

from sandbox.window.keyboards import letter_of

LONGEST = 80  # characters


@dataclass
class Edit:
    """What is being typed into the control of that name. What lies between ``anchor`` and ``caret`` is selected."""

    name: str
    text: str
    caret: int
    anchor: int
    composed: str = ""  # of an input method, and not yet decided
    _first: str = field(init=False)

    def __post_init__(self) -> None:
        self._first = self.text

    @classmethod
    def of(cls, name: str, text: str) -> Edit:
        """Begin with a text, all of it selected: the first sign replaces it, moving the caret keeps it."""
        return cls(name, text, len(text), 0)

    @property
    def changed(self) -> bool:
        """Is it another text than at first?"""
        return self.text != self._first

    @property
    def selected(self) -> tuple[int, int]:
        """From which character to before which."""
        return min(self.caret, self.anchor), max(self.caret, self.anchor)

    def select_all(self) -> None:
        """What is written next replaces all of it."""
        self.anchor, self.caret = 0, len(self.text)

    def put_caret(self, place: int) -> None:
        """Before that character; nothing is selected."""
        self.caret = self.anchor = place

    def write(self, text: str) -> None:
        """In place of what is selected, as far as there is room; what cannot be printed is left out."""
        start, end = self.selected
        room = LONGEST - len(self.text) + end - start
        text = "".join(sign for sign in text if sign.isprintable())[:room]
        self.text = self.text[:start] + text + self.text[end:]
        self.caret = self.anchor = start + len(text)
        self.composed = ""

    def compose(self, text: str) -> None:
        """What an input method shows of what is being put together."""
        self.composed = text

    def key(self, event: pygame.event.Event) -> None:
        """A KEYDOWN event: keys that move, erase or command. What letters write comes as text."""
        mod = getattr(event, "mod", 0)
        commanding = mod & (pygame.KMOD_CTRL | pygame.KMOD_META)
        if commanding and not mod & pygame.KMOD_ALT and (letter := letter_of(event)):
            self._command(letter)
        elif event.key in (pygame.K_BACKSPACE, pygame.K_DELETE):
            if self.caret == self.anchor:
                self._move(self._step(event.key == pygame.K_DELETE, bool(commanding)), True)
            self.write("")
        elif event.key in (pygame.K_HOME, pygame.K_END):
            end = len(self.text) if event.key == pygame.K_END else 0
            self._move(end, bool(mod & pygame.KMOD_SHIFT))
        elif event.key in (pygame.K_LEFT, pygame.K_RIGHT):
            onward, selecting = event.key == pygame.K_RIGHT, bool(mod & pygame.KMOD_SHIFT)
            if self.caret != self.anchor and not selecting and not commanding:
                self._move(self.selected[onward], False)
            else:
                self._move(self._step(onward, bool(commanding)), selecting)

    def _command(self, letter: str) -> None:
        start, end = self.selected
        if letter == "a":
            self.select_all()
        elif letter in "cx" and start < end:
            with contextlib.suppress(pygame.error):  # no clipboard
                pygame.scrap.put_text(self.text[start:end])
                if letter == "x":
                    self.write("")
        elif letter == "v":
            with contextlib.suppress(pygame.error):
                self.write(pygame.scrap.get_text())

    def _move(self, place: int, selecting: bool) -> None:
        self.caret = place
        if not selecting:
            self.anchor = place

    def _step(self, onward: bool, word: bool) -> int:
        """Where the caret is after a step of a character, or of a word."""
        place = self.caret
        way, ahead = (1, 0) if onward else (-1, -1)
        while 0 <= place + ahead < len(self.text):
            place += way
            inside = 0 <= place + ahead < len(self.text)
            if not word or (inside and not self.text[place + ahead].isalnum()):
                break
        return place

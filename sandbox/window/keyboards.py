"""What a key writes as far as shortcuts are concerned, on any keyboard.

Letters go by what is printed on the key; where that is no letter from a to z, by what a keyboard with Latin letters has in that
place. A letter is a capital with Shift, and not because Caps Lock is on. Signs go by what is written.
"""

from __future__ import annotations

import string
import unicodedata

import pygame

SIGNS = frozenset(" 0123456789[],.+-=?")  # that mean something whichever key writes them

_LETTERS = {pygame.KSCAN_A + rank: letter for rank, letter in enumerate(string.ascii_lowercase)}
_DIGITS = {pygame.KSCAN_1 + rank: digit for rank, digit in enumerate("1234567890")}
_OTHERS = {
    pygame.KSCAN_LEFTBRACKET: "[",
    pygame.KSCAN_RIGHTBRACKET: "]",
    pygame.KSCAN_COMMA: ",",
    pygame.KSCAN_PERIOD: ".",
}
_ASCII = 128


def letter_of(event: pygame.event.Event) -> str:
    """The letter from a to z of a KEYDOWN event, whatever is held with it; empty if it has none."""
    if pygame.K_a <= event.key <= pygame.K_z:
        return chr(event.key)
    return _LETTERS.get(_place(event), "") if event.key >= _ASCII else ""


def sign_of(event: pygame.event.Event) -> str:
    """The letter, capital with Shift, or the sign of a KEYDOWN event without Ctrl and Alt; empty if that means nothing."""
    shift = getattr(event, "mod", 0) & pygame.KMOD_SHIFT
    written = getattr(event, "unicode", "") or (chr(event.key) if 0 < event.key < _ASCII else "")
    letter = letter_of(event)
    if not letter and written.isascii() and written.isalpha():
        letter = written.lower()  # a Hebrew keyboard writes Latin capitals with Shift
    if letter:
        return letter.upper() if shift else letter
    if written in SIGNS:
        return written
    if not shift and _place(event) in _DIGITS:  # which some keyboards write with Shift only
        return _DIGITS[_place(event)]
    return _OTHERS.get(_place(event), "") if _of_another_script(written) else ""


def _place(event: pygame.event.Event) -> int:
    """Of the key, as a scancode."""
    return int(getattr(event, "scancode", 0))


def _of_another_script(sign: str) -> bool:
    return sign.isalpha() and not unicodedata.name(sign[0], "LATIN").startswith("LATIN")

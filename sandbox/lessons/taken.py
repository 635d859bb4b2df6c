"""A table of a TOML file taken apart key by key: what is of the wrong type, too long or left over is one line of InputError."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from core.errors import InputError, did_you_mean
from sandbox.lessons.lesson import Said
from sandbox.words import language
from scenes.parameter import shown

T = TypeVar("T")
MISSING = object()
FIRM = "\u00a0"  # a space where no line is broken
CODE = 2  # letters of a language's code


class Taken:
    """What is left of a table. ``where`` names it in messages."""

    def __init__(self, table: object, where: str) -> None:
        self.where = where
        if not isinstance(table, dict):
            raise InputError(f"{where} must be a table, not {shown(table)}")
        self._left = dict(table)
        self._asked: list[str] = []

    def take(self, key: str, default: Any = MISSING) -> Any:
        """A value as it is. Raises InputError where it is missing and has no default."""
        self._asked.append(key)
        if key in self._left:
            return self._left.pop(key)
        if default is MISSING:
            raise InputError(f"{self.at(key)} is missing; add it")
        return default

    def end(self, hint: str = "") -> None:
        """Raise InputError if a key is left that nobody has asked for; ``hint`` is what else may have been meant."""
        for key in self._left:
            near = did_you_mean(key, self._asked)
            known = near or f"; there are: {', '.join(self._asked)}"
            raise InputError(f"{self.at(shown(key))}: nobody knows this key{known}{hint}")

    def at(self, key: str) -> str:
        """A key of this table, for a message."""
        return f"{self.where} {key}".strip()

    def text(self, key: str, most: int, default: Any = MISSING) -> str:
        """A line of text of at most so many letters."""
        value = self.take(key, default)
        return default if value is default else line_of(value, most, self.at(key))

    def one_of(self, key: str, choices: Sequence[str], default: Any = MISSING) -> str:
        """One of some words."""
        found = self.take(key, default)
        return found if found is default else known(found, choices, self.at(key))

    def whole(self, key: str, low: int, high: int, default: Any = MISSING) -> Any:
        """A whole number in a range."""
        value = self.take(key, default)
        if value is default:
            return value
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise InputError(
                f"{self.at(key)} must be a whole number from {low} to {high}, not {shown(value)}"
            )
        return value

    def number(self, key: str, low: float, high: float, default: Any = MISSING) -> Any:
        """A number in a range, as a float."""
        value = self.take(key, default)
        return value if value is default else number_of(value, low, high, self.at(key))

    def said(self, key: str, most: int, *, optional: bool = False) -> Said:
        """A text in English and perhaps in other languages; a plain one is English."""
        value = self.take(key, None if optional else MISSING)
        return Said() if value is None else said_of(value, most, self.at(key))

    def each(
        self, key: str, most: int, one: Callable[[object, str], T], *, least: int = 0
    ) -> tuple[T, ...]:
        """A list of at most so many things, each made by ``one`` from the value and where it stands."""
        values = self.take(key, MISSING if least else ())
        if not isinstance(values, (list, tuple)):
            raise InputError(f"{self.at(key)} must be a list, not {shown(values)}")
        if not least <= len(values) <= most:
            raise InputError(f"{self.at(key)} has {len(values)} entries: give {least} to {most}")
        return tuple(one(value, f"{self.at(key)} {n}") for n, value in enumerate(values, 1))


def line_of(value: object, most: int, where: str) -> str:
    """A text without control characters, of at most so many letters."""
    if not isinstance(value, str):
        raise InputError(f"{where} must be a text in quotes, not {shown(value)}")
    odd = next((sign for sign in value if not (sign.isprintable() or sign == FIRM)), None)
    if odd is not None:
        raise InputError(
            f"{where} has a line break or another sign that cannot be shown, {odd!r}; take it out"
        )
    if not value.strip():
        raise InputError(f"{where} is empty; write something or leave the key out")
    if len(value) > most:
        raise InputError(f"{where} has {len(value)} letters: use {most} at most")
    return value


def known(value: object, choices: Sequence[str], where: str) -> str:
    """One of some words."""
    if not isinstance(value, str) or value not in choices:
        near = did_you_mean(value, choices) if isinstance(value, str) else ""
        raise InputError(f"{where} {shown(value)} is none of {', '.join(choices)}{near}")
    return value


def number_of(value: object, low: float, high: float, where: str) -> float:
    """A number in a range."""
    sound = not isinstance(value, bool) and isinstance(value, (int, float))
    if not sound or not low <= value <= high or not math.isfinite(value):  # type: ignore[operator, arg-type]
        raise InputError(f"{where} must be a number from {low:g} to {high:g}, not {shown(value)}")
    return float(value)  # type: ignore[arg-type]


def said_of(value: object, most: int, where: str) -> Said:
    """A text, or a table of texts by the codes of languages."""
    if isinstance(value, str):
        return Said({language.SOURCE: line_of(value, most, where)})
    if not isinstance(value, Mapping):
        raise InputError(f"{where} must be a text, or texts by language such as {where}.en")
    texts = {}
    for code, text in value.items():
        if len(code) != CODE or not (code.isascii() and code.islower()):
            raise InputError(
                f"{where}.{shown(code)}: a language has a code of two small letters, such as de"
            )
        texts[code] = line_of(text, most, f"{where}.{code}")
    if language.SOURCE not in texts:
        raise InputError(f"{where}.{language.SOURCE} is missing; every text is needed in English")
    return Said(texts)

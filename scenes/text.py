"""Texts with numbers in them, for a person at the window: English here, and translatable where they are drawn."""

from __future__ import annotations

import string
from collections.abc import Callable, Mapping
from typing import Any, Self

Plural = Callable[[int], int]  # which form a word has after a number, counted from 0


class Text(str):
    """An English text that remembers what it was made from: a template and its values.

    ``Text("{label}: end of travel", label="piston")`` is the plain string "piston: end of travel" for everyone who does not
    ask further. Minus signs of numbers are true ones. Forms of a word that follow a number are written
    ``{grains} {grains:grain|grains}``.
    """

    template: str
    values: Mapping[str, object]

    def __new__(cls, template: str, **values: object) -> Self:
        text = super().__new__(cls, filled(template, values))
        text.template, text.values = template, values
        return text


def one_or_many(count: int) -> int:
    """Which form an English word has: 0 after one, 1 after any other number."""
    return int(count != 1)


def counted(count: int, noun: str) -> str:
    """So many of something in English: 1 grain, 2 grains."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def filled(
    template: str,
    values: Mapping[str, object],
    decimal: str = ".",
    plural: Plural = one_or_many,
) -> str:
    """The template with its values; ``decimal`` is the sign before the decimals of a number, ``plural`` chooses among forms."""
    return _Filler(decimal, plural).vformat(template, (), values)


class _Filler(string.Formatter):
    def __init__(self, decimal: str, plural: Plural) -> None:
        self._decimal, self._plural = decimal, plural

    def format_field(self, value: Any, format_spec: str) -> str:
        if "|" in format_spec:
            forms = format_spec.split("|")
            # A range, "1–2", has the form that goes with its end.
            count = abs(int(value.rpartition("–")[2] if isinstance(value, str) else value))
            return forms[min(self._plural(count), len(forms) - 1)]
        text = format(value, format_spec)
        if isinstance(value, (int, float)):
            text = text.replace("-", "−").replace(".", self._decimal)
        return text


def message(error: Exception) -> str:
    """What an error says, as it was given: a ``Text`` stays one."""
    given = error.args[0] if error.args else ""
    return given if isinstance(given, str) else str(error)

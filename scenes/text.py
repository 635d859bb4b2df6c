"""Texts with numbers in them, for a person at the window: English here, and translatable where they are drawn."""

from __future__ import annotations

import string
from collections.abc import Mapping
from typing import Any, Self


class Text(str):
    """An English text that remembers what it was made from: a template and its values.

    ``Text("{label}: end of travel", label="piston")`` is the plain string "piston: end of travel" for everyone who does not
    ask further. Minus signs of numbers are true ones.
    """

    template: str
    values: Mapping[str, object]

    def __new__(cls, template: str, **values: object) -> Self:
        text = super().__new__(cls, filled(template, values))
        text.template, text.values = template, values
        return text


def filled(template: str, values: Mapping[str, object], decimal: str = ".") -> str:
    """The template with its values; ``decimal`` is the sign before the decimals of a number."""
    return _Filler(decimal).vformat(template, (), values)


class _Filler(string.Formatter):
    def __init__(self, decimal: str) -> None:
        self._decimal = decimal

    def format_field(self, value: Any, format_spec: str) -> str:
        text = format(value, format_spec)
        if isinstance(value, (int, float)):
            text = text.replace("-", "−").replace(".", self._decimal)
        return text


def message(error: Exception) -> str:
    """What an error says, as it was given: a ``Text`` stays one."""
    given = error.args[0] if error.args else ""
    return given if isinstance(given, str) else str(error)

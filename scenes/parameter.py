"""A number that a person may set: its unit, its range and one line of help."""

from __future__ import annotations

import math
import reprlib
import sys
from dataclasses import dataclass

from core.errors import InputError

Value = float | int | bool

LARGEST_SEED = 2**63 - 1
HAIR = 1e-9  # of a number that was calculated
DIGITS = 3


def whole_above(value: float) -> int:
    """The least whole number that is not below ``value``."""
    return math.ceil(value * (1.0 - HAIR))


def round_up(value: float) -> float:
    """``value``, above 0, in three digits that are not below it."""
    power = 10.0 ** (math.floor(math.log10(value)) - DIGITS + 1)
    return float(f"{math.ceil(value / power * (1.0 - HAIR)) * power:.{DIGITS}g}")


def round_down(value: float) -> float:
    """``value``, above 0, in three digits that are not above it."""
    power = 10.0 ** (math.floor(math.log10(value)) - DIGITS + 1)
    return float(f"{math.floor(value / power * (1.0 + HAIR)) * power:.{DIGITS}g}")


def shown(value: object) -> str:
    """What somebody gave, for a message: in full if it is short."""
    try:
        return reprlib.repr(value)
    except ValueError:  # a whole number of more digits than Python writes out
        return "a number without end"


def check_seed(seed: object) -> int:
    """A seed is a whole number from 0 to 2⁶³ − 1. Raises InputError otherwise."""
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= LARGEST_SEED:
        raise InputError(
            f"the seed must be 0 or a positive whole number below 2^63, not {shown(seed)}"
        )
    return seed


@dataclass(frozen=True)
class Parameter:
    """One setting of a scene. Its type is that of ``default``; ``low`` and ``high`` are allowed values.

    ``live``: a change acts on the grains where they stand; without, the scene is built anew. ``top``: what the highest value
    means, if more than itself: a word that may be typed for it.
    """

    name: str
    default: Value
    unit: str
    low: Value
    high: Value
    help: str
    live: bool = False
    top: str = ""

    @property
    def kind(self) -> str:
        """ "switch", "whole number" or "number"."""
        if isinstance(self.default, bool):
            return "switch"
        return "whole number" if isinstance(self.default, int) else "number"

    def check(self, value: object) -> Value:
        """``value`` as this parameter's type. Raises InputError if it has another type or is out of range."""
        if isinstance(self.default, bool):
            if not isinstance(value, bool):
                raise InputError(f"{self.name} is a switch: give true or false, not {shown(value)}")
            return value
        if (
            isinstance(value, bool)
            or not isinstance(value, (int, float))
            or not abs(value) <= sys.float_info.max  # isfinite gives up on longer whole numbers
        ):
            word = f" or the word {self.top}" if self.top else ""
            raise InputError(f"{self.name} must be a {self.kind}{word}, not {shown(value)}")
        if isinstance(self.default, int):
            if value != int(value):
                raise InputError(f"{self.name} must be a whole number, not {shown(value)}")
            value = int(value)
        else:
            value = float(value)
        if not self.low <= value <= self.high:
            unit = f" {self.unit}" if self.unit else ""
            word = f", or be the word {self.top}" if self.top else ""
            raise InputError(
                f"{self.name} must lie between {self.low:g} and {self.high:g}{unit}{word}; {value:.10g} does not"
            )
        return value

    def parse(self, text: str) -> Value:
        """The value that a person typed. Raises InputError as ``check`` does."""
        plain = text.strip().lower()
        if isinstance(self.default, bool):
            words = {
                "true": True,
                "on": True,
                "yes": True,
                "1": True,
                "false": False,
                "off": False,
                "no": False,
                "0": False,
            }
            if plain not in words:
                raise InputError(f"{self.name} is a switch: give true or false, not {shown(text)}")
            return words[plain]
        if self.top and plain == self.top:
            return self.high
        try:
            number = float(plain)
        except ValueError:
            word = f" or the word {self.top}" if self.top else ""
            raise InputError(
                f"{self.name} must be a {self.kind}{word}, not {shown(text)}"
            ) from None
        return self.check(number)

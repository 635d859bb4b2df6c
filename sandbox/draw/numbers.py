"""Round numbers for axes and scales, and numbers as text."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sandbox.words.language import decimal_sign

MINUS = "−"
ONE_TWO_FIVE = (1.0, 2.0, 5.0, 10.0)
ONE_DIGIT = (1.0, 2.0, 3.0, 5.0, 7.0, 10.0)
FINER = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


def nice_ceiling(value: float, steps: tuple[float, ...] = ONE_TWO_FIVE) -> float:
    """Smallest of the steps times a power of ten that is not below a positive value."""
    if not (math.isfinite(value) and value > 0.0):
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    for step in steps:
        if value <= step * power * (1.0 + 1e-9):
            return step * power
    return 10.0 * power


def are_counts(unit: str, *values: NDArray[np.float64]) -> bool:
    """Whole numbers of no unit: things are counted. They have no decimals, on axes and wherever else they are written."""
    return not unit and all(np.array_equal(one, np.rint(one)) for one in values)


def ticks(low: float, high: float, most: int, counts: bool = False) -> list[float]:
    """Round numbers within [low, high], at most about ``most`` intervals apart; of counts whole ones."""
    if not (math.isfinite(low) and math.isfinite(high) and high > low):
        return []
    step = nice_ceiling((high - low) / max(most, 1))
    step = max(step, 1.0) if counts and high - low >= 1.0 else step
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def decimals_for(step: float) -> int:
    """How many decimals tell numbers apart that differ by one step."""
    if not (math.isfinite(step) and step > 0.0):
        return 0
    return min(max(0, -math.floor(math.log10(step) + 1e-9)), 9)


def number(value: float, decimals: int) -> str:
    """A number as the present language writes it, with a true minus sign, and no minus on zero."""
    if not math.isfinite(value):
        return "—"
    text = f"{value:.{decimals}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return text.replace("-", MINUS).replace(".", decimal_sign())


def short_number(value: float, digits: int = 4) -> str:
    """A number in no more digits than it has, whole ones in full, as the present language writes it: 0.8, −0.35, 20000, 1e−8."""
    if not math.isfinite(value):
        return "—"
    if value == int(value) and abs(value) < 1e7:
        return str(int(value)).replace("-", MINUS)
    mantissa, _, power = f"{value:.{digits}g}".partition("e")
    text = f"{mantissa}e{int(power)}" if power else mantissa
    return text.replace("-", MINUS).replace(".", decimal_sign())


def percent(share: float, steps: tuple[float, ...] = ONE_TWO_FIVE) -> str:
    """An upper bound in words: 0.008 -> '1 %', 0.0004 -> '0.05 %'."""
    bound = 100.0 * nice_ceiling(share, steps)
    return f"{number(bound, decimals_for(bound))} %"


class RoundScale:
    """The round top of a scale that follows its data without nervous jumps.

    It grows at once when the data outgrow it, and shrinks only when they have become less than a
    fifth of it, so that a picture and the next one can be compared.
    """

    def __init__(self, least: float) -> None:
        self.least = least  # a smaller top would make a show of rounding noise
        self.top = least

    def follow(self, largest: float) -> float:
        """Take in the largest value of the moment; returns the top."""
        if math.isfinite(largest) and largest > 0.0:
            wanted = nice_ceiling(max(largest, self.least), FINER)
            if wanted > self.top or largest < 0.2 * self.top:
                self.top = wanted
        return self.top


def typical_largest(values: NDArray[np.float64]) -> float:
    """The largest value but for a few outliers: the 99th percentile; 0 without values."""
    finite = values[np.isfinite(values)]
    return float(np.percentile(finite, 99.0)) if finite.size else 0.0

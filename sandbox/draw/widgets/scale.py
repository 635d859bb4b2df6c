"""The scale of a slider: from a number to a place on the track and back, in round steps."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sandbox.draw.numbers import MINUS, nice_ceiling, short_number

MANY_DECADES = 50.0  # a range with such a ratio of its ends goes by its logarithm
WIDE = 5.0  # a range from zero to at least this is finer near zero
FINEST = 200  # places on a linear track
STEPS, PAGES = 100, 10  # arrow keys and page keys need so many presses for all of a linear track
LOG_STEPS, LOG_PAGES = 20, 4  # and so many for one decade
CUBIC_STEP, CUBIC_PAGE = 0.02, 0.1  # and of a track that is finer near zero, this share


@dataclass(frozen=True, slots=True)
class Range:
    """Numbers that may be set. Wide ranges are not linear, so that every usual value can be hit."""

    low: float
    high: float
    whole: bool = False

    @property
    def logarithmic(self) -> bool:
        """Equal steps are equal ratios."""
        return self.low > 0.0 and self.high / self.low >= MANY_DECADES

    @property
    def cubic(self) -> bool:
        """Finer near zero: value = high · share³."""
        return self.low == 0.0 and self.high >= WIDE and not self.whole

    def share(self, value: float) -> float:
        """Where on the track a value is, 0 to 1."""
        if self.high <= self.low:
            return 0.0
        value = min(max(value, self.low), self.high)
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        if self.cubic:
            return math.cbrt(value / self.high)
        return (value - self.low) / (self.high - self.low)

    def value(self, share: float) -> float:
        """The round value at a place of the track."""
        share = min(max(share, 0.0), 1.0)
        if share in (0.0, 1.0):
            return self.high if share else self.low
        if self.logarithmic:
            return self._within(float(f"{self.low * (self.high / self.low) ** share:.2g}"))
        if self.cubic:
            return self._rounded(self.high * share**3, 1e-3 * self.high)
        width = self.high - self.low
        return self._rounded(self.low + share * width, nice_ceiling(width / FINEST))

    def stepped(self, value: float, steps: int, *, pages: bool = False) -> float:
        """Some presses of an arrow key or a page key on; it always changes, but at the ends."""
        way = 1.0 if steps > 0 else -1.0
        for _ in range(abs(steps)):
            value = self._next(value, way, pages)
        return value

    def _next(self, value: float, way: float, pages: bool) -> float:
        width = self.high - self.low
        if self.logarithmic:
            ratio = 10.0 ** (way / (LOG_PAGES if pages else LOG_STEPS))
            wanted = float(f"{value * ratio:.2g}")
            least = 10.0 ** (math.floor(math.log10(value)) - 1)
        elif self.cubic:
            least = 1e-3 * self.high
            share = self.share(value) + way * (CUBIC_PAGE if pages else CUBIC_STEP)
            wanted = self.value(share)
        else:
            least = nice_ceiling(width / STEPS)
            if self.whole:
                least = max(round(least), 1)
            step = least * (STEPS / PAGES if pages else 1.0)
            wanted = self._rounded(value + way * step, least)
        if self.whole:
            least = max(least, 1.0)
        if (self._within(wanted) - value) * way < 0.5 * least:
            wanted = float(f"{value + way * least:.12g}")
        return self._within(wanted)

    def _rounded(self, value: float, step: float) -> float:
        return self._within(float(f"{round(value / step) * step:.12g}"))

    def _within(self, value: float) -> float:
        if self.whole:
            value = round(value)
        return min(max(value, self.low), self.high)


def shown(value: float) -> str:
    """A number as it stands in a box: see ``short_number``."""
    return short_number(value)


def typed(text: str) -> str:
    """What a person typed, as Python writes numbers: a comma and a true minus sign count too."""
    return text.strip().replace(MINUS, "-").replace(",", ".")

"""Scripted drives: one way in whole steps, where one that is shorter than a step is a single shorter one, and there and back."""

from __future__ import annotations

import math

HAIR = 1e-9  # [R] by which rounding may miss the end


def steps_to(end: float, step: float) -> int:
    """How many increments a drive of length ``end`` [R] takes in steps [R]: one at least."""
    return max(1, math.floor(end / step + 1e-6))


def depth_after(increment: int, step: float, end: float) -> float | None:
    """How far a drive of length ``end`` is to come in an increment, counted from 0, in steps [R]; None where it is over."""
    depth = (increment + 1) * step
    if depth <= end + HAIR:
        return depth
    return None if increment else end


def there_and_back(quarters: float) -> float:
    """A triangular wave between −1 and 1 after so many quarters of a cycle: it begins at 0 and first rises."""
    phase = quarters % 4.0
    return phase if phase <= 1.0 else 2.0 - phase if phase <= 3.0 else phase - 4.0

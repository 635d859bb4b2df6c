"""Pure functions of the study of accuracy: fronts, extrapolation, and bifurcations."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from core.arrays import Floats

Point = tuple[float, float]  # cost, error


def front(points: Sequence[Point]) -> list[int]:
    """Indices of the points that no other beats in both cost and error, in the order of cost.

    Points with an error that is not finite, or without cost, are left out; of equals the first stays.
    """
    order = sorted(
        (k for k, (cost, error) in enumerate(points) if cost > 0.0 and math.isfinite(error)),
        key=lambda k: points[k],
    )
    kept: list[int] = []
    least = math.inf
    for k in order:
        if points[k][1] < least:
            kept.append(k)
            least = points[k][1]
    return kept


def cost_at(points: Sequence[Point], error: float) -> float:
    """Cost at which the front through ``points`` (cost rising, error falling) reaches ``error``: straight in the logarithms.

    Beyond the front's most precise point: nan. An error that its cheapest point beats: that point's cost.
    """
    if not points or error < points[-1][1]:
        return math.nan
    if error >= points[0][1]:
        return points[0][0]
    for (cheap, coarse), (dear, fine) in itertools.pairwise(points):
        if fine <= error <= coarse:
            if fine <= 0.0:
                return dear
            share = math.log(coarse / error) / math.log(coarse / fine)
            return float(cheap * (dear / cheap) ** share)
    return math.nan


def lead(ours: Sequence[Point], theirs: Sequence[Point]) -> tuple[float, float]:
    """(least, middle) ratio of their cost to ours at their errors: above 1 our front is ahead. nan where they do not meet."""
    ratios = [cost / cost_at(ours, error) for cost, error in theirs]
    known = [ratio for ratio in ratios if math.isfinite(ratio)]
    if not known:
        return math.nan, math.nan
    return min(known), float(np.exp(np.mean(np.log(known))))


def extrapolate(stiffness: Sequence[float], value: Sequence[float]) -> tuple[float, float]:
    """(value at infinite stiffness, uncertainty): a parabola in 1/C through the three stiffest, and how far a line is from it."""
    if len(stiffness) < 3:
        raise ValueError("three stiffnesses are needed")
    stiffest = np.argsort(stiffness)[-3:]
    x, y = 1.0 / np.array(stiffness)[stiffest], np.array(value)[stiffest]
    parabola = float(np.polyfit(x, y, 2)[-1])
    line = float(np.polyfit(x[1:], y[1:], 1)[-1])
    return parabola, abs(parabola - line)


def first_beyond(places: Sequence[float], distances: Sequence[float], most: float) -> float | None:
    """The first place at which two walks are further apart than ``most``, or not comparable (nan); None if never."""
    for place, distance in zip(places, distances, strict=True):
        if not distance <= most:
            return float(place)
    return None


def rms(values: Sequence[float] | Floats) -> float:
    """Root of the mean square; nan of nothing."""
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else math.nan


def slope(x: Sequence[float], y: Sequence[float]) -> float:
    """Slope of log y over log x by least squares; nan for fewer than two positive points."""
    pairs = [(a, b) for a, b in zip(x, y, strict=True) if a > 0.0 and b > 0.0]
    if len(pairs) < 2:
        return math.nan
    a, b = np.log(np.array(pairs)).T
    return float(np.polyfit(a, b, 1)[0])

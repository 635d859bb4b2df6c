"""Kinds of grains compared at equal volume and at equal pressure, and what a quantity does as the pressure grows."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.arrays import Floats
from sandbox.ensemble.estimates import Student
from sandbox.studies.common.verdicts import Demand
from sandbox.studies.paper.claims import (
    SAME,
    SUBLINEAR,
    Measure,
    Measured,
    Part,
    Reading,
    Threshold,
    Unmeasurable,
    Variation,
    by_seed,
    mean_of,
    number,
    over_seeds,
    ratio,
    where,
)
from sandbox.studies.paper.conditions import AUXETIC, LAMBDAS, REGULAR, label, lambdas, of_lam
from sandbox.studies.paper.runs import Result
from sandbox.studies.paper.shear.cell import (
    COMMON,
    POSITIVE,
    common_fractions,
    judged,
    pressure,
    regular_over_auxetic,
)

LOW, MIDDLE_OF, HIGH = 0.035, 0.045, 0.06  # [k] pressures at which kinds are compared
DENSE = f"packing fraction {COMMON[-1]:g}"
Value = Callable[[Result], float]
Chosen = Callable[[Sequence[Result]], list[Result]]


def at_equal_volume(value: Value, chosen: Chosen = judged) -> Measure:
    """Regular over auxetic at the highest packing fraction that both have."""

    def measure(results: Sequence[Result]) -> Reading:
        rows = chosen(results)
        fractions = common_fractions(rows)
        dense = where(rows, packing_fraction=fractions[-1])
        reading = regular_over_auxetic(dense, lambda some: by_seed(some, value))
        others = []
        for fraction in fractions[:-1]:
            loose = where(rows, packing_fraction=fraction)
            means = [
                float(np.mean(over_seeds(of_lam(loose, lam), value))) for lam in (REGULAR, AUXETIC)
            ]
            if means[1] > 0.0:
                others.append(f"{number(means[0] / means[1], 2)} at {fraction:g}")
        remark = (
            f"regular / auxetic at lower packing fractions: {', '.join(others)}" if others else ""
        )
        return Reading(reading.estimate, reading.measured, remark)

    return measure


def growth(value: Value) -> Measure:
    """Regular over auxetic of what the quantity grows by from the lowest to the highest packing fraction that both have."""

    def measure(results: Sequence[Result]) -> Reading:
        rows = judged(results)
        fractions = common_fractions(rows)
        if len(fractions) < 2:
            raise Unmeasurable("one packing fraction only")

        def grown(some: list[Result]) -> list[tuple[int, float]]:
            low, high = (
                dict(by_seed(where(some, packing_fraction=f), value))
                for f in (fractions[0], fractions[-1])
            )
            return [(seed, high[seed] - low[seed]) for seed in sorted(low.keys() & high.keys())]

        return regular_over_auxetic(rows, grown)

    return measure


def _seeds(results: Sequence[Result]) -> list[int]:
    return sorted({r.request.seed for r in results})


def _of_seed(results: Sequence[Result], seed: int) -> tuple[Floats, list[Result]]:
    """Pressures of a seed's packings that bear one, in their order, and the packings."""
    mine = [r for r in results if r.request.seed == seed and pressure(r) > POSITIVE]
    mine.sort(key=pressure)
    return np.array([pressure(r) for r in mine]), mine


def at_pressure(results: Sequence[Result], value: Value, place: float) -> list[tuple[int, float]]:
    """(seed, value where the pressure is ``place`` [k]): between that seed's packings, in the logarithms."""
    rows = []
    for seed in _seeds(results):
        pressures, mine = _of_seed(results, seed)
        values = np.array([value(r) for r in mine])
        if len(mine) > 1 and pressures[0] <= place <= pressures[-1] and values.min() > 0.0:
            at = np.interp(np.log(place), np.log(pressures), np.log(values))
            rows.append((seed, float(np.exp(at))))
    return rows


def at_equal_pressure(
    value: Value,
    place: float,
    chosen: Chosen = judged,
    lams: tuple[float, float] = (REGULAR, AUXETIC),
    unit: str = "k",
) -> Measure:
    """The one λ over the other where both are under the pressure ``place`` [k]."""

    def measure(results: Sequence[Result]) -> Reading:
        rows = chosen(results)
        both = [at_pressure(of_lam(rows, lam), value, place) for lam in lams]
        if min(map(len, both)) < 1:
            raise Unmeasurable(f"not all kinds reach {number(place)} k")
        above, below = (
            Measured.of(label(lam), unit, [v for _, v in row])
            for lam, row in zip(lams, both, strict=True)
        )
        return ratio(above, below, tuple(both))

    return measure


def exponent(value: Value, lam: float) -> Measure:
    """n in value ∝ Pⁿ, one a seed."""

    def measure(results: Sequence[Result]) -> Reading:
        rows = of_lam(judged(results), lam)
        found = []
        for seed in _seeds(rows):
            pressures, mine = _of_seed(rows, seed)
            values = np.array([value(r) for r in mine])
            if len(mine) > 2 and values.min() > 0.0:
                found.append(Student.exponent(pressures, values).value)
        if not found:
            raise Unmeasurable(f"too few packings with {label(lam)} bear a pressure")
        span = [pressure(r) for r in rows if pressure(r) > POSITIVE]
        return mean_of(
            Measured.of(label(lam), "", found),
            f"{label(lam)} between {number(min(span), 2)} and {number(max(span), 2)} k",
        )

    return measure


def over_lambdas(value: Value, place: float) -> Measure:
    """n in value ∝ λⁿ at equal pressure over all λ, one a seed."""

    def measure(results: Sequence[Result]) -> Reading:
        rows = judged(results)
        tables = {lam: dict(at_pressure(of_lam(rows, lam), value, place)) for lam in lambdas(rows)}
        tables = {lam: table for lam, table in tables.items() if table}
        if len(tables) < len(LAMBDAS):
            raise Unmeasurable(f"only {len(tables)} of {len(LAMBDAS)} λ reach {number(place)} k")
        common = sorted(set.intersection(*(set(table) for table in tables.values())))
        lams = sorted(tables)
        slopes = [
            Student.exponent(lams, [tables[lam][seed] for lam in lams]).value for seed in common
        ]
        if not slopes:
            raise Unmeasurable(f"no seed reaches {number(place)} k with every λ")
        return mean_of(
            Measured.of("n", "", slopes),
            "; ".join(str(Measured.of(label(lam), "", list(tables[lam].values()))) for lam in lams),
        )

    return measure


def collapse(name: str, value: Value, place: float, *variations: tuple[str, Chosen]) -> Part:
    """Kinds do not differ in ``value`` under the pressure ``place`` [k]; ``variations``: other runs that say so too, or not."""
    return Part(
        "collapse",
        f"one curve for all at equal pressure, at {place:g} k",
        f"{name} at P = {place:g} k, regular / auxetic",
        SAME,
        at_equal_pressure(value, place),
        tuple(
            Variation(words, at_equal_pressure(value, place, chosen))
            for words, chosen in variations
        ),
    )


def sublinear(name: str, value: Value) -> tuple[Part, ...]:
    """``value`` grows less than in proportion to the pressure, for each kind."""
    return tuple(
        Part(
            "trend",
            f"grows sublinearly with the pressure, {words}",
            f"n in {name} ∝ Pⁿ, {words}",
            SUBLINEAR,
            exponent(value, lam),
        )
        for words, lam in (("regular", REGULAR), ("auxetic", AUXETIC))
    )


def all_lambdas(name: str, value: Value) -> Part:
    """As ``collapse``, over all λ."""
    bound = float(np.log(1.0 / 0.75) / np.log(LAMBDAS[-1] / LAMBDAS[0]))
    threshold = Threshold(
        Demand(-bound, bound),
        "over four decades of λ that is a factor of 4/3, as for a pair of kinds",
    )
    return Part(
        "collapse",
        "one curve for λ from 0.01 to 100",
        f"n in {name} ∝ λⁿ at P = {MIDDLE_OF:g} k",
        threshold,
        over_lambdas(value, MIDDLE_OF),
    )

"""Claims about shear, Figs. 3 and 4 of the paper: a cell between serrated plates."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from core.arrays import Floats
from core.shear import dilatancy, shear_modulus, yield_stress
from sandbox.studies.common.statistics import Demand, Student
from sandbox.studies.paper.claims import (
    MORE,
    MUCH,
    RISES,
    SAME,
    SUBLINEAR,
    TWICE,
    Claim,
    Figure,
    Line,
    Measured,
    Panel,
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
from sandbox.studies.paper.conditions import (
    AUXETIC,
    EXTREMES,
    LAMBDAS,
    NEUTRAL,
    REGULAR,
    SYSTEMS,
    colour,
    label,
    lambdas,
    material,
    of_lam,
    packing,
    seeds,
)
from sandbox.studies.paper.runs import Request, Result

GRAINS, QUICK_GRAINS = 800, 320
COMMON = (0.86, 0.88, 0.91, 0.94)  # packing fractions of all kinds
# And more, so that all reach the pressures at which they are compared.
FRACTIONS = {
    0.01: (0.94, 1.0, 1.06),  # what ``MIDDLE_OF`` needs: they take four times as long
    0.1: (*COMMON, 1.0, 1.06, 1.12),
    1.0: (*COMMON, 0.98),
    10.0: (0.85, *COMMON),
    100.0: (0.845, 0.85, 0.855),
}
AROUND_HIGH = {0.1: (0.94, 1.06, 1.12), 10.0: (0.86, 0.88, 0.94)}  # what a variation needs
QUICK_FRACTIONS = {0.1: (0.86, 0.94, 1.06, 1.12), 10.0: (0.85, 0.86, 0.88, 0.94)}
LOW, MIDDLE_OF, HIGH = 0.035, 0.045, 0.06  # [k] pressures at which kinds are compared
STEADY, SMALL, MIDDLE = 0, 1, 2  # protocols of the scene
STEP = 0.05  # [R] of the steady shear: a shear strain of 2.5e-3
FINE_STEP = 0.01
CYCLE_STEP = 0.005  # [R] of the small cycles: a shear strain of 2e-4
PAPER_STEP = 0.002  # [R] in the small cycles: a shear strain of 1e-4, the paper's
FEW = 8  # seeds of a variation, and of λ = 1
FEWEST = 6  # of the costliest kinds
FLOWS = 0.3  # shear strain after which the flow counts as steady
FAR = 0.03  # shear strain that is far from the middle of a cycle of 0.04
POSITIVE = 1e-4  # [k] a smaller pressure is none: the plates do not feel each other
MIDDLE_FRACTION = 0.92  # packing fraction of the middle cycles
ALIKE = Threshold(
    Demand(1.0 / 1.2, 1.2),
    "“the same” coefficient is read as 1 within a fifth: the scatter of points in the paper's plot",
)
NO_STRONG = Threshold(
    Demand(0.5, 2.0), "“no strong difference” is read as less than a factor of two"
)


def _cell(
    quick: bool,
    protocol: int,
    fractions: Mapping[float, Sequence[float]],
    extra: Mapping[str, float],
    count: int = SYSTEMS,
) -> list[Request]:
    """Runs of the shear cell for the packing fractions of each λ."""
    settings = {"grains": GRAINS, **extra}
    if quick:
        settings["grains"] = min(settings["grains"], QUICK_GRAINS)
    return [
        Request(
            "couette",
            packing(lam),
            seed,
            (
                *settings.items(),
                ("packing_fraction", fraction),
                ("protocol", protocol),
                *material(lam),
            ),
            probe="plate",
        )
        for lam, each in fractions.items()
        for fraction in each
        for seed in seeds(count, quick)
    ]


def _of(*lams: float) -> dict[float, tuple[float, ...]]:
    return {lam: FRACTIONS[lam] for lam in lams}


def small_cycles(quick: bool) -> list[Request]:
    """Fig. 3: cycles of shear strain 0.002; some in a cell of another size, some in the paper's strain steps."""
    careful = {"cycles": 2 if quick else 3, "tolerance": 1e-4, "max_iterations": 50_000}
    plain = {**careful, "step": CYCLE_STEP}
    if quick:
        return _cell(quick, SMALL, QUICK_FRACTIONS, plain)
    return [
        *_cell(quick, SMALL, _of(REGULAR, AUXETIC), plain),
        *_cell(quick, SMALL, _of(NEUTRAL), plain, FEW),
        *_cell(quick, SMALL, _of(*EXTREMES), plain, FEWEST),
        *_cell(quick, SMALL, AROUND_HIGH, {**plain, "grains": GRAINS // 2}, FEW),
        *_cell(quick, SMALL, AROUND_HIGH, {**careful, "step": PAPER_STEP}, FEW),
    ]


def steady_shears(quick: bool) -> list[Request]:
    """Fig. 4: shear until the stress is steady; some in finer steps."""
    if quick:
        return _cell(quick, STEADY, QUICK_FRACTIONS, {"strain": 0.6, "step": 0.1})
    plain = {"strain": 0.8, "step": STEP}
    dense = dict.fromkeys((REGULAR, AUXETIC), COMMON[-1:])
    return [
        *_cell(quick, STEADY, _of(REGULAR, AUXETIC), plain),
        *_cell(quick, STEADY, _of(NEUTRAL), plain, FEW),
        *_cell(quick, STEADY, _of(*EXTREMES), plain, FEWEST),
        *_cell(quick, STEADY, dense, {**plain, "step": FINE_STEP}, FEW),
    ]


def middle_cycles(quick: bool) -> list[Request]:
    """Appendix: cycles that are larger, and yet reversible."""
    lams = (REGULAR, AUXETIC) if quick else (REGULAR, NEUTRAL, AUXETIC)
    return [
        request
        for friction in (0.5, 0.0)
        for request in _cell(
            quick,
            MIDDLE,
            dict.fromkeys(lams, (MIDDLE_FRACTION,)),
            {"cycles": 1 if quick else 3, "friction": friction},
        )
    ]


def modulus(result: Result) -> float:
    """G [k] of the last cycle: in the first ones a packing that was never sheared still settles."""
    cycles = int(result.request.of("cycles"))
    strain, stress = result.column("stroke"), result.column("force")
    last = slice((len(strain) - 1) // cycles * (cycles - 1), None)
    return shear_modulus(strain[last], stress[last])


def yielding(result: Result) -> float:
    """Dynamic yield stress [k]."""
    return yield_stress(result.column("stroke"), result.column("force"), FLOWS)


def _flowing(result: Result, column: str) -> Floats:
    """A column once the flow is steady."""
    values: Floats = result.column(column)[result.column("stroke") > FLOWS]
    return values


def pressure(result: Result) -> float:
    """Mean normal stress on the plate [k]: of the steady flow, or of all cycles."""
    steady = int(result.request.of("protocol")) == STEADY
    return float(np.mean(_flowing(result, "normal") if steady else result.column("normal")))


def friction(result: Result) -> float:
    """τ/P of the steady flow."""
    return yielding(result) / pressure(result)


def fluctuation(result: Result) -> float:
    """Standard deviation of the normal stress of the steady flow [k]."""
    return float(np.std(_flowing(result, "normal")))


def unsteadiness(result: Result) -> float:
    """Standard deviation of the shear stress of the steady flow [k]."""
    return float(np.std(_flowing(result, "force")))


def rise(result: Result) -> float:
    """Normal stress far from the middle of a cycle, less that in the middle [k]."""
    return dilatancy(result.column("stroke"), result.column("normal"), FAR)


Value = Callable[[Result], float]
Chosen = Callable[[Sequence[Result]], list[Result]]


def judged(results: Sequence[Result]) -> list[Result]:
    """The runs that judge: the largest cell, and of those the steps that most runs have."""
    largest = max(int(r.request.of("grains")) for r in results)
    rows = where(results, grains=largest)
    steps = [r.request.of("step") for r in rows if "step" in dict(r.request.settings)]
    return where(rows, step=max(set(steps), key=steps.count)) if steps else rows


def smaller_cell(results: Sequence[Result]) -> list[Result]:
    """Those in a cell of half the width. Raises Unmeasurable if there are none."""
    return _some(where(results, grains=GRAINS // 2))


def finer_steps(results: Sequence[Result]) -> list[Result]:
    """Those in the finest steps. Raises Unmeasurable if there are none but the usual."""
    finest = min(float(r.request.of("step")) for r in results)
    usual = float(judged(results)[0].request.of("step"))
    return _some(where(results, step=finest) if finest < usual else [])


def _some(results: list[Result]) -> list[Result]:
    if not results:
        raise Unmeasurable("not run")
    return results


def _fractions(results: Sequence[Result]) -> list[float]:
    """Packing fractions that regular and auxetic grains have."""
    each = [
        {float(r.request.of("packing_fraction")) for r in of_lam(results, lam)}
        for lam in (REGULAR, AUXETIC)
    ]
    return sorted(set.intersection(*each))


def _two(
    results: Sequence[Result],
    rows: Callable[[list[Result]], list[tuple[int, float]]],
    unit: str = "k",
) -> Reading:
    """Regular over auxetic, seed by seed."""
    both = [rows(of_lam(results, lam)) for lam in (REGULAR, AUXETIC)]
    above, below = (
        Measured.of(label(lam), unit, [v for _, v in row] or [np.nan])
        for lam, row in zip((REGULAR, AUXETIC), both, strict=True)
    )
    return ratio(above, below, tuple(both))


def at_equal_volume(value: Value, chosen: Chosen = judged) -> Callable[[Sequence[Result]], Reading]:
    """Regular over auxetic at the highest packing fraction that both have."""

    def measure(results: Sequence[Result]) -> Reading:
        rows = chosen(results)
        fractions = _fractions(rows)
        dense = where(rows, packing_fraction=fractions[-1])
        reading = _two(dense, lambda some: by_seed(some, value))
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


def growth(value: Value) -> Callable[[Sequence[Result]], Reading]:
    """Regular over auxetic of what the quantity grows by from the lowest to the highest packing fraction that both have."""

    def measure(results: Sequence[Result]) -> Reading:
        rows = judged(results)
        fractions = _fractions(rows)
        if len(fractions) < 2:
            raise Unmeasurable("one packing fraction only")

        def grown(some: list[Result]) -> list[tuple[int, float]]:
            low, high = (
                dict(by_seed(where(some, packing_fraction=f), value))
                for f in (fractions[0], fractions[-1])
            )
            return [(seed, high[seed] - low[seed]) for seed in sorted(low.keys() & high.keys())]

        return _two(rows, grown)

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
) -> Callable[[Sequence[Result]], Reading]:
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


def exponent(value: Value, lam: float) -> Callable[[Sequence[Result]], Reading]:
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


def over_lambdas(value: Value, place: float) -> Callable[[Sequence[Result]], Reading]:
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


def dilates(lam: float, coefficient: float = 0.5) -> Callable[[Sequence[Result]], Reading]:
    """Rise of the pressure from the middle of a cycle to its ends [k]."""

    def measure(results: Sequence[Result]) -> Reading:
        rows = of_lam(where(results, friction=coefficient), lam)
        smooth = over_seeds(of_lam(where(results, friction=0.0), lam), rise)
        relative = over_seeds(rows, lambda r: rise(r) / pressure(r))
        return mean_of(
            Measured.of(label(lam), "k", over_seeds(rows, rise)),
            f"{number(float(np.mean(relative)), 2)} of the pressure; without friction "
            f"{number(float(np.mean(smooth)), 2)} k",
        )

    return measure


def dilates_alike(results: Sequence[Result]) -> Reading:
    """Regular over auxetic, with friction."""
    return _two(where(results, friction=0.5), lambda rows: by_seed(rows, rise))


# Figures.


def _means(results: Sequence[Result], lam: float, value: Value) -> tuple[Floats, Floats, Floats]:
    """Pressure, value, and spread of the value over seeds, one a packing fraction, in the order of pressure."""
    mine = [r for r in of_lam(results, lam) if pressure(r) > POSITIVE]
    rows = []
    for fraction in sorted({r.request.of("packing_fraction") for r in mine}):
        here = where(mine, packing_fraction=fraction)
        values = [value(result) for result in here]
        rows.append((np.mean([pressure(r) for r in here]), np.mean(values), np.std(values)))
    table = np.array(sorted(rows), dtype=np.float64).reshape(-1, 3)
    return table[:, 0], table[:, 1], table[:, 2]


def _against(results: Sequence[Result], value: Value, name: str) -> list[Panel]:
    """Against the packing fraction and against the pressure."""
    results = judged(results)
    volume, force = [], []
    for lam in lambdas(results):
        mine = of_lam(results, lam)
        fractions = sorted({float(r.request.of("packing_fraction")) for r in mine})
        values = [over_seeds(where(mine, packing_fraction=f), value) for f in fractions]
        means = np.array([np.mean(v) for v in values])
        spreads = np.array([np.std(v) for v in values])
        volume.append(
            Line(label(lam), colour(lam), np.array(fractions), means, spreads, points=True)
        )
        place, mean, spread = _means(results, lam, value)
        force.append(Line(label(lam), colour(lam), place, mean, spread, points=True))
    return [
        Panel("At equal volume", "packing fraction", name, tuple(volume)),
        Panel("At equal pressure", "normal stress P [k]", name, tuple(force), log_x=True),
    ]


def modulus_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 3g and i."""
    return _against(results, modulus, "shear modulus G [k]")


def yield_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 4d and f, and τ/P."""
    rows = judged(results)
    curves, ratios = [], []
    densest = _fractions(rows)[-1]
    for lam in lambdas(rows):
        mine = where(of_lam(rows, lam), packing_fraction=densest)
        if mine:
            first = min(mine, key=lambda result: result.request.seed)
            line = Line(label(lam), colour(lam), first.column("stroke"), first.column("force"))
            curves.append(line)
        ratios.append(Line(label(lam), colour(lam), *_means(rows, lam, friction), points=True))
    return [
        *_against(results, yielding, "yield stress [k]"),
        Panel("Friction", "normal stress P [k]", "τ/P", tuple(ratios), log_x=True),
        Panel(
            f"Shear, packing fraction {densest:g}, one seed",
            "shear strain",
            "shear stress τ [k]",
            tuple(curves),
        ),
    ]


def _collapse(name: str, value: Value, place: float, *variations: tuple[str, Chosen]) -> Part:
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


def _sublinear(name: str, value: Value) -> tuple[Part, ...]:
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


def _all_lambdas(name: str, value: Value) -> Part:
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


NARROW = f"a cell of half the width ({GRAINS // 2} grains)"
FINER = "strain steps of 1e-4, the paper's"
FINER_FLOW = "strain steps of 5e-4 instead of 2.5e-3"
DENSE = f"packing fraction {COMMON[-1]:g}"
G_DENSE = f"G at {DENSE}, regular / auxetic"
YIELD_DENSE = f"yield stress at {DENSE}, regular / auxetic"
WAVES_DENSE = f"standard deviation of the pressure at {DENSE}, regular / auxetic"
WAVES = f"standard deviation of the pressure at P = {MIDDLE_OF:g} k, regular / auxetic"

CLAIMS = (
    Claim(
        "shear_modulus",
        "Fig. 3g",
        "the shear modulus increases with confinement faster for the rings than for the metagrains; at large confinements "
        "the shear torque of the metagrains is twice as low",
        small_cycles,
        (
            Part("direction", "lower for auxetic grains", G_DENSE, MORE, at_equal_volume(modulus)),
            Part(
                "factor",
                "twice as low at large confinement",
                G_DENSE,
                TWICE,
                at_equal_volume(modulus),
                (
                    Variation(NARROW, at_equal_volume(modulus, smaller_cell)),
                    Variation(FINER, at_equal_volume(modulus, finer_steps)),
                ),
            ),
            Part(
                "trend",
                "increases faster with confinement for regular grains",
                f"rise of G from packing fraction {COMMON[0]:g} to {COMMON[-1]:g}, regular / auxetic",
                MORE,
                growth(modulus),
            ),
        ),
        (Figure("fig-3-shear-modulus", "Shear modulus (Fig. 3g, i)", modulus_panels),),
    ),
    Claim(
        "modulus_collapse",
        "Fig. 3i",
        "[against the confining pressure] the data points collapse onto a master curve that grows sublinearly",
        small_cycles,
        (
            _collapse("G", modulus, LOW),
            _collapse("G", modulus, HIGH, (NARROW, smaller_cell), (FINER, finer_steps)),
            _all_lambdas("G", modulus),
            *_sublinear("G", modulus),
        ),
    ),
    Claim(
        "yield_stress",
        "Fig. 4d",
        "in collections of metagrains, the yield stress is twice as small, fluctuates less, and increases much less quickly with "
        "confinement",
        steady_shears,
        (
            Part(
                "direction",
                "smaller for auxetic grains",
                YIELD_DENSE,
                MORE,
                at_equal_volume(yielding),
            ),
            Part(
                "factor",
                "twice as small",
                YIELD_DENSE,
                TWICE,
                at_equal_volume(yielding),
                (Variation(FINER_FLOW, at_equal_volume(yielding, finer_steps)),),
            ),
            Part(
                "direction",
                "fluctuates less",
                f"standard deviation of the shear stress at {DENSE}, regular / auxetic",
                MORE,
                at_equal_volume(unsteadiness),
                (Variation(FINER_FLOW, at_equal_volume(unsteadiness, finer_steps)),),
            ),
            Part(
                "factor",
                "increases much less quickly with confinement",
                f"rise of the yield stress from packing fraction {COMMON[0]:g} to {COMMON[-1]:g}, regular / auxetic",
                MUCH,
                growth(yielding),
            ),
        ),
        (Figure("fig-4-yield-stress", "Yield stress (Fig. 4d, f)", yield_panels),),
    ),
    Claim(
        "yield_collapse",
        "Fig. 4f",
        "we again plot the yield stress against pressure and find as above that the data points collapse onto a master curve "
        "[that grows sublinearly]",
        steady_shears,
        (
            _collapse("yield stress", yielding, LOW),
            _collapse("yield stress", yielding, HIGH),
            _all_lambdas("yield stress", yielding),
            *_sublinear("yield stress", yielding),
        ),
    ),
    Claim(
        "friction",
        "Fig. 4",
        "granular media have the same macroscopic friction coefficient τ/P, whether they are made of auxetic particles or not",
        steady_shears,
        tuple(
            Part(
                "value",
                f"the same coefficient, {words} and auxetic, at {place:g} k",
                f"τ/P at P = {place:g} k, {words} / auxetic",
                ALIKE,
                at_equal_pressure(friction, place, lams=(lam, AUXETIC), unit=""),
            )
            for words, lam in (("regular", REGULAR), ("λ = 1", NEUTRAL))
            for place in (LOW, HIGH)
        ),
    ),
    Claim(
        "pressure_fluctuations",
        "appendix “Numerical shearing setup”",
        "the pressure fluctuations are much smaller for auxetic systems than non-auxetic",
        steady_shears,
        (
            Part(
                "direction",
                "smaller, at equal volume",
                WAVES_DENSE,
                MORE,
                at_equal_volume(fluctuation),
            ),
            Part(
                "factor",
                "much smaller, at equal volume",
                WAVES_DENSE,
                MUCH,
                at_equal_volume(fluctuation),
                (Variation(FINER_FLOW, at_equal_volume(fluctuation, finer_steps)),),
            ),
            Part(
                "direction",
                "smaller, at equal pressure",
                WAVES,
                MORE,
                at_equal_pressure(fluctuation, MIDDLE_OF),
            ),
            Part(
                "factor",
                "much smaller, at equal pressure",
                WAVES,
                MUCH,
                at_equal_pressure(fluctuation, MIDDLE_OF),
            ),
        ),
    ),
    Claim(
        "dilatancy",
        "appendix “Experimental shearing setup”",
        "[Reynolds dilatancy is] observed as the increase of normal force when the packing is sheared out of its equilibrium; "
        "we could not distinguish a strong difference in this non-linear effect for the two different Poisson's ratio grains",
        middle_cycles,
        (
            *(
                Part(
                    "direction",
                    f"the normal force increases, {words}",
                    f"rise of the pressure from the middle of a cycle to its ends, friction 0.5, {words} [k]",
                    RISES,
                    dilates(lam),
                )
                for words, lam in (("regular", REGULAR), ("λ = 1", NEUTRAL), ("auxetic", AUXETIC))
            ),
            Part(
                "factor",
                "no strong difference between the two",
                "that rise, regular / auxetic",
                NO_STRONG,
                dilates_alike,
            ),
        ),
    ),
)

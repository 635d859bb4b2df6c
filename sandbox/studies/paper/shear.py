"""Claims about shear, Figs. 3, 4 and 5 of the paper: a cell between serrated plates, and avalanches in a periodic one."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.arrays import Floats
from core.shear import dilatancy, shear_modulus, yield_stress
from sandbox.studies.paper.bulk import colour, kinds, label, of_ratio, ratios
from sandbox.studies.paper.claims import (
    SURE,
    Claim,
    Figure,
    Finding,
    Line,
    Measured,
    Panel,
    Unmeasurable,
    number,
    over_seeds,
    ratio,
    surely_above,
    where,
)
from sandbox.studies.paper.probes import CHANGE_BINS
from sandbox.studies.paper.runs import Request, Result

FRACTIONS = (0.85, 0.87, 0.9, 0.94)  # packing fractions of all kinds
AUXETIC_FRACTIONS = (1.0, 1.08)  # more for auxetic grains, to reach the pressures of the others
STEADY, SMALL, MIDDLE = 0, 1, 2  # protocols of the scene
FLOWS = 0.3  # shear strain after which the flow counts as steady
COLLAPSE = 1.33  # factor within which values at equal pressure count as the same
SAME = 0.2  # relative difference of friction coefficients that counts as none
FAR = 0.03  # shear strain that is far from the middle of a cycle of 0.04
POSITIVE = 1e-4  # [k] a smaller pressure is none: the plates do not feel each other
MIDDLE_FRACTION = 0.92  # packing fraction of the middle cycles


def _cell(
    quick: bool, protocol: int, fractions: Sequence[float], **extra: float | int
) -> list[Request]:
    """Runs of the shear cell for all kinds and the given packing fractions; the auxetic one more."""
    requests = []
    for packing, setting in kinds((0.8, -0.8) if quick else (0.8, 0.0, -0.8)):
        last = AUXETIC_FRACTIONS if packing == "auxetic" and len(fractions) > 1 else ()
        requests += [
            Request(
                "couette",
                packing,
                seed,
                (
                    ("grains", 320 if quick else 800),
                    ("packing_fraction", fraction),
                    ("protocol", protocol),
                    setting,
                    *extra.items(),
                ),
                probe="plate",
            )
            for fraction in (*fractions, *last)
            for seed in range(1, 3 if quick else 4)
        ]
    return requests


def small_cycles(quick: bool) -> list[Request]:
    """Fig. 3: cycles of shear strain 0.002."""
    fractions = FRACTIONS[::2] if quick else FRACTIONS
    return _cell(
        quick, SMALL, fractions, cycles=2 if quick else 3, tolerance=1e-4, max_iterations=50_000
    )


def steady_shears(quick: bool) -> list[Request]:
    """Fig. 4: shear until the stress is steady."""
    fractions = FRACTIONS[::2] if quick else FRACTIONS
    strain, step = (0.6, 0.1) if quick else (0.8, 0.05)
    return _cell(quick, STEADY, fractions, strain=strain, step=step)


def middle_cycles(quick: bool) -> list[Request]:
    """Appendix: cycles that are larger, and yet reversible."""
    return [
        request
        for friction in (0.5, 0.0)
        for request in _cell(
            quick, MIDDLE, (MIDDLE_FRACTION,), cycles=1 if quick else 3, friction=friction
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


def _steady(result: Result) -> Floats:
    """Normal stress once the flow is steady [k]."""
    normal: Floats = result.column("normal")[result.column("stroke") > FLOWS]
    return normal


def pressure(result: Result) -> float:
    """Mean normal stress on the plate [k]: of the steady flow, or of all cycles."""
    steady = int(result.request.of("protocol")) == STEADY
    return float(np.mean(_steady(result) if steady else result.column("normal")))


def friction(result: Result) -> float:
    """τ/P of the steady flow."""
    return yielding(result) / pressure(result)


def fluctuation(result: Result) -> float:
    """Standard deviation of the normal stress of the steady flow [k]."""
    return float(np.std(_steady(result)))


def _fractions(results: Sequence[Result]) -> list[float]:
    """Packing fractions that all kinds have."""
    each = [
        {float(r.request.of("packing_fraction")) for r in of_ratio(results, nu)}
        for nu in ratios(results)
    ]
    return sorted(set.intersection(*each))


def _rigid(results: Sequence[Result]) -> list[Result]:
    return [result for result in results if pressure(result) > POSITIVE]


def _at_equal_volume(
    results: Sequence[Result], value: Callable[[Result], float], what: str
) -> Finding:
    """Auxetic below regular at the highest packing fraction that all have."""
    fractions = _fractions(results)
    dense = where(results, "packing_fraction", fractions[-1])
    measured = [
        Measured.of(label(nu), "k", over_seeds(of_ratio(dense, nu), value)) for nu in ratios(dense)
    ]
    over, error = ratio(measured[0], measured[-1])
    others = []
    for fraction in fractions[:-1]:
        loose = where(results, "packing_fraction", fraction)
        means = [float(np.mean(over_seeds(of_ratio(loose, nu), value))) for nu in (0.8, -0.8)]
        if means[1] > 0.0:
            others.append(f"{number(means[0] / means[1], 2)} at {fraction:g}")
    return Finding(
        surely_above(over, error, 1.0),
        f"{what} at packing fraction {fractions[-1]:g}, regular / auxetic {number(over)} ± {number(error, 2)}, "
        f"must exceed 1 by {SURE:g} standard errors",
        tuple(measured),
        f"regular / auxetic at lower packing fractions: {', '.join(others)}" if others else "",
    )


def _means(
    results: Sequence[Result], nu: float, value: Callable[[Result], float]
) -> tuple[Floats, Floats, Floats]:
    """Pressure, value, and spread of the value over seeds, one a packing fraction, in the order of pressure."""
    mine = _rigid(of_ratio(results, nu))
    rows = []
    for fraction in sorted({r.request.of("packing_fraction") for r in mine}):
        here = where(mine, "packing_fraction", fraction)
        values = [value(result) for result in here]
        rows.append((np.mean([pressure(r) for r in here]), np.mean(values), np.std(values)))
    table = np.array(sorted(rows), dtype=np.float64).reshape(-1, 3)
    return table[:, 0], table[:, 1], table[:, 2]


def _collapse(results: Sequence[Result], value: Callable[[Result], float], what: str) -> Finding:
    """Regular over auxetic at equal pressure, by interpolation of the logarithms, in the middle of the common range."""
    regular, auxetic = (_means(results, nu, value) for nu in (0.8, -0.8))
    if min(len(regular[0]), len(auxetic[0])) < 2:
        raise Unmeasurable("fewer than two packing fractions bear a pressure")
    low = max(regular[0][0], auxetic[0][0])
    high = min(regular[0][-1], auxetic[0][-1])
    if low >= high:
        raise Unmeasurable("regular and auxetic packings share no range of pressures")
    if min(regular[1].min(), auxetic[1].min()) <= 0.0:
        raise Unmeasurable(f"{what} is not positive everywhere")
    places = np.log(np.geomspace(low, high, 5))
    logs = [np.interp(places, np.log(p), np.log(v)) for p, v, _ in (regular, auxetic)]
    over = float(np.exp(np.mean(logs[0] - logs[1])))
    exponents = [float(np.polyfit(np.log(p), np.log(v), 1)[0]) for p, v, _ in (regular, auxetic)]
    return Finding(
        1.0 / COLLAPSE < over < COLLAPSE,
        f"{what} at equal pressure ({number(low, 2)} to {number(high, 2)} k), regular / auxetic {number(over)}, "
        f"must lie within a factor of {COLLAPSE:g} of 1",
        (Measured.of("regular / auxetic", "", over),),
        f"{what} grows as pressure to the power {number(exponents[0], 2)} (regular) and {number(exponents[1], 2)} (auxetic)",
    )


def judge_modulus(results: Sequence[Result]) -> Finding:
    """G at equal volume."""
    return _at_equal_volume(results, modulus, "G")


def judge_modulus_collapse(results: Sequence[Result]) -> Finding:
    """G at equal pressure."""
    return _collapse(results, modulus, "G")


def judge_yield(results: Sequence[Result]) -> Finding:
    """Yield stress at equal volume."""
    return _at_equal_volume(results, yielding, "yield stress")


def judge_yield_collapse(results: Sequence[Result]) -> Finding:
    """Yield stress at equal pressure."""
    return _collapse(results, yielding, "yield stress")


def judge_fluctuation(results: Sequence[Result]) -> Finding:
    """Fluctuations of the pressure at equal volume."""
    return _at_equal_volume(results, fluctuation, "standard deviation of the pressure")


def judge_friction(results: Sequence[Result]) -> Finding:
    """τ/P, mean over packing fractions, for each Poisson's ratio; one value a seed."""
    measured = []
    for nu in ratios(results):
        mine = _rigid(of_ratio(results, nu))
        seeds = sorted({result.request.seed for result in mine})
        if not seeds:
            raise Unmeasurable(f"no packing with {label(nu)} bears a pressure")
        values = [np.mean([friction(r) for r in mine if r.request.seed == s]) for s in seeds]
        measured.append(Measured.of(label(nu), "", values))
    means = [m.mean for m in measured]
    apart = (max(means) - min(means)) / float(np.mean(means))
    return Finding(
        apart < SAME,
        f"τ/P of all kinds differs by {number(100.0 * apart, 2)} %, must be < {100.0 * SAME:g} %",
        tuple(measured),
        "expected without friction: 0.06 to 0.12",
    )


def judge_dilatancy(results: Sequence[Result]) -> Finding:
    """Normal stress far from the middle of a cycle, less that in the middle; with friction, as in the experiment."""

    def rise(result: Result) -> float:
        return dilatancy(result.column("stroke"), result.column("normal"), FAR) / pressure(result)

    rough, smooth = (
        [
            Measured.of(label(nu), "of the pressure", over_seeds(of_ratio(runs, nu), rise))
            for nu in ratios(runs)
        ]
        for runs in (where(results, "friction", 0.5), where(results, "friction", 0.0))
    )
    least = min(rough, key=lambda m: m.mean - SURE * m.error)
    without = ", ".join(str(measured) for measured in smooth)
    return Finding(
        surely_above(least.mean, least.error, 0.0),
        "rise of the pressure from the middle of a cycle to its ends with friction 0.5, "
        f"{least.what}: {number(least.mean, 2)} ± {number(least.error, 2)} of the pressure, "
        f"must exceed 0 by {SURE:g} standard errors for all kinds",
        tuple(rough),
        f"without friction, where packings are known not to dilate (doi:10.1103/PhysRevE.78.011307): {without}",
    )


def _against(results: Sequence[Result], value: Callable[[Result], float], name: str) -> list[Panel]:
    """Against the packing fraction and against the pressure."""
    volume, force = [], []
    for nu in ratios(results):
        mine = of_ratio(results, nu)
        fractions = sorted({float(r.request.of("packing_fraction")) for r in mine})
        values = [over_seeds(where(mine, "packing_fraction", f), value) for f in fractions]
        means = np.array([np.mean(v) for v in values])
        spreads = np.array([np.std(v) for v in values])
        volume.append(Line(label(nu), colour(nu), np.array(fractions), means, spreads, points=True))
        place, mean, spread = _means(results, nu, value)
        force.append(Line(label(nu), colour(nu), place, mean, spread, points=True))
    return [
        Panel("At equal volume", "packing fraction", name, tuple(volume)),
        Panel("At equal pressure", "normal stress P [k]", name, tuple(force), log_x=True),
    ]


def modulus_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 3g and i."""
    return _against(results, modulus, "shear modulus G [k]")


def yield_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 4d and f, and τ/P."""
    curves = []
    for nu in ratios(results):
        mine = where(of_ratio(results, nu), "packing_fraction", _fractions(results)[-1])
        first = min(mine, key=lambda result: result.request.seed)
        curves.append(Line(label(nu), colour(nu), first.column("stroke"), first.column("force")))
    fraction = f"packing fraction {_fractions(results)[-1]:g}, one seed"
    return [
        *_against(results, yielding, "yield stress [k]"),
        Panel("Friction", "normal stress P [k]", "τ/P", _friction_lines(results), log_x=True),
        Panel(f"Shear, {fraction}", "shear strain", "shear stress τ [k]", tuple(curves)),
    ]


def _friction_lines(results: Sequence[Result]) -> tuple[Line, ...]:
    return tuple(
        Line(label(nu), colour(nu), *_means(results, nu, friction), points=True)
        for nu in ratios(results)
    )


# Avalanches.


def avalanches(quick: bool) -> list[Request]:
    """Fig. 5: simple shear of packings that were compressed to the same pressure."""
    return [
        Request(
            "avalanches",
            packing,
            seed,
            (
                ("grains", 200 if quick else 400),
                ("pressure", 0.02),
                ("strain", 0.3 if quick else 0.5),
                ("step", 0.05 if quick else 0.02),
                ("tolerance", 1e-3),
                setting,
            ),
            probe="avalanches",
        )
        for packing, setting in kinds((0.8, -0.8))
        for seed in range(1, 3 if quick else 6)
    ]


def _smaller(results: Sequence[Result], name: str, what: str, unit: str) -> Finding:
    """Mean over a run's avalanches, smaller for auxetic grains."""

    def mean(result: Result) -> float:
        values = result.lists[name]
        if not values:
            raise Unmeasurable(
                f"no avalanche in a run ({result.request.packing}, seed {result.request.seed})"
            )
        return float(np.mean(values))

    regular, auxetic = (
        Measured.of(label(nu), unit, over_seeds(of_ratio(results, nu), mean)) for nu in (0.8, -0.8)
    )
    over, error = ratio(regular, auxetic)
    counts = [sum(len(r.lists[name]) for r in of_ratio(results, nu)) for nu in (0.8, -0.8)]
    stress = [
        float(np.mean([np.mean(r.column("pressure")) for r in of_ratio(results, nu)]))
        for nu in (0.8, -0.8)
    ]
    return Finding(
        surely_above(over, error, 1.0),
        f"{what}, regular / auxetic {number(over)} ± {number(error, 2)}, must exceed 1 by {SURE:g} standard errors",
        (regular, auxetic),
        f"{counts[0]} avalanches of regular, {counts[1]} of auxetic grains; mean pressure while sheared at fixed volume "
        f"{number(stress[0])} and {number(stress[1])} k",
    )


def judge_participation(results: Sequence[Result]) -> Finding:
    """Inverse participation ratio of the grains."""
    return _smaller(results, "participation", "mean inverse participation ratio", "")


def judge_changes(results: Sequence[Result]) -> Finding:
    """Mean |Δf_c| over all contacts."""
    return _smaller(results, "mean_change", "mean |Δf_c| in an avalanche", "k R")


def avalanche_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 5c and d."""
    shares, changes = [], []
    for nu in ratios(results):
        mine = of_ratio(results, nu)
        values = np.concatenate([np.array(r.lists["participation"]) for r in mine])
        density, edges = np.histogram(values, bins=np.linspace(0.0, 1.0, 21), density=True)
        shares.append(Line(label(nu), colour(nu), 0.5 * (edges[1:] + edges[:-1]), density))
        counts = np.sum([r.lists["change_histogram"] for r in mine], axis=0)
        width = np.diff(CHANGE_BINS)
        there = counts > 0
        middle = np.sqrt(CHANGE_BINS[1:] * CHANGE_BINS[:-1])
        pdf = counts / (counts.sum() * width)
        changes.append(Line(label(nu), colour(nu), middle[there], pdf[there]))
    pdf_label = "probability density"
    return [
        Panel("Who takes part", "inverse participation ratio", pdf_label, tuple(shares)),
        Panel(
            "Changes of contact forces",
            "|Δf_c| [k R]",
            pdf_label + " [1/(k R)]",
            tuple(changes),
            log_x=True,
            log_y=True,
        ),
    ]


CLAIMS = (
    Claim(
        "shear_modulus",
        "Fig. 3g",
        "the shear modulus increases with confinement faster for the rings than for the metagrains; at large confinements "
        "the shear torque of the metagrains is twice as low",
        small_cycles,
        judge_modulus,
        (Figure("fig-3-shear-modulus", "Shear modulus (Fig. 3g, i)", modulus_panels),),
    ),
    Claim(
        "modulus_collapse",
        "Fig. 3i",
        "[against the confining pressure] the data points collapse onto a master curve that grows sublinearly",
        small_cycles,
        judge_modulus_collapse,
    ),
    Claim(
        "yield_stress",
        "Fig. 4d",
        "in collections of metagrains, the yield stress is twice as small […] and increases much less quickly with confinement",
        steady_shears,
        judge_yield,
        (Figure("fig-4-yield-stress", "Yield stress (Fig. 4d, f)", yield_panels),),
    ),
    Claim(
        "yield_collapse",
        "Fig. 4f",
        "we again plot the yield stress against pressure and find as above that the data points collapse onto a master curve",
        steady_shears,
        judge_yield_collapse,
    ),
    Claim(
        "friction",
        "Fig. 4",
        "granular media have the same macroscopic friction coefficient τ/P, whether they are made of auxetic particles or not",
        steady_shears,
        judge_friction,
    ),
    Claim(
        "pressure_fluctuations",
        "appendix “Numerical shearing setup”",
        "the pressure fluctuations are much smaller for auxetic systems than non-auxetic",
        steady_shears,
        judge_fluctuation,
    ),
    Claim(
        "dilatancy",
        "appendix “Experimental shearing setup”",
        "[Reynolds dilatancy is] observed as the increase of normal force when the packing is sheared out of its equilibrium",
        middle_cycles,
        judge_dilatancy,
    ),
    Claim(
        "participation",
        "Fig. 5c",
        "when an avalanche occurs, less particles are involved, as measured by the inversed partition ratio",
        avalanches,
        judge_participation,
        (Figure("fig-5-avalanches", "Avalanches (Fig. 5c, d)", avalanche_panels),),
    ),
    Claim(
        "force_changes",
        "Fig. 5d",
        "the inter-particle forces of the grains that are involved typically decreases less than in a regular packing",
        avalanches,
        judge_changes,
    ),
)

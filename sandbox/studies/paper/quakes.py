"""Claims about avalanches of a sheared packing, Fig. 5 of the paper."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from sandbox.studies.paper.claims import (
    MORE,
    Claim,
    Figure,
    Line,
    Measured,
    Panel,
    Part,
    Reading,
    Unmeasurable,
    Variation,
    by_seed,
    number,
    ratio,
    where,
)
from sandbox.studies.paper.conditions import (
    AUXETIC,
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
from sandbox.studies.paper.probes import CHANGE_BINS
from sandbox.studies.paper.runs import Request, Result

GRAINS, FEWER, MANY = 400, 200, 800
# [R] in a cell of some 33 R: shear strains of 1e-4, the paper's, and of 6e-4, the coarsest that a first study had.
FINE, COARSE = 0.0034, 0.02
PRESSURE = 0.02  # [k] at which packings are compared
HIGHER = 0.06
STRAIN = 0.3  # of the shear
HALF = SYSTEMS // 2  # seeds of the costlier variations


def _shears(quick: bool, count: int, **changed: float | int) -> list[Request]:
    settings = {
        "grains": FEWER if quick else GRAINS,
        "pressure": PRESSURE,
        "strain": STRAIN,
        "step": 0.05 if quick else FINE,
        "tolerance": 1e-3,
        **changed,
    }
    return [
        Request(
            "avalanches",
            packing(lam),
            seed,
            (*settings.items(), *material(lam)),
            probe="avalanches",
        )
        for lam in (REGULAR, AUXETIC)
        for seed in seeds(count, quick)
    ]


def avalanches(quick: bool) -> list[Request]:
    """Simple shear of packings that were compressed to the same pressure; other sizes, steps and pressures to compare."""
    if quick:
        return [*_shears(quick, SYSTEMS), *_shears(quick, SYSTEMS, grains=FEWER // 2)]
    return [
        *_shears(quick, SYSTEMS),
        *_shears(quick, SYSTEMS, grains=FEWER),
        *_shears(quick, HALF, grains=MANY),
        *_shears(quick, SYSTEMS, step=COARSE),
        *_shears(quick, HALF, pressure=HIGHER),
    ]


Chosen = Callable[[Sequence[Result]], list[Result]]


def judged(results: Sequence[Result]) -> list[Result]:
    """The runs that judge: those asked for first."""
    first = results[0].request
    return where(results, **{name: first.of(name) for name in ("grains", "step", "pressure")})


def _with(name: str, value: float) -> Chosen:
    """Runs that differ from those that judge in one setting. Raises Unmeasurable if there are none."""

    def chosen(results: Sequence[Result]) -> list[Result]:
        first = results[0].request
        if first.of(name) == value:
            raise Unmeasurable("that is what judges here")
        kept = {n: first.of(n) for n in ("grains", "step", "pressure") if n != name}
        found = where(results, **kept, **{name: value})
        if not found:
            raise Unmeasurable("not run")
        return found

    return chosen


def smaller(name: str, unit: str, chosen: Chosen = judged) -> Callable[[Sequence[Result]], Reading]:
    """Mean over a run's avalanches, regular over auxetic."""

    def mean(result: Result) -> float:
        values = result.lists[name]
        if not values:
            who = f"{result.request.packing}, seed {result.request.seed}"
            raise Unmeasurable(f"no avalanche in a run ({who})")
        return float(np.mean(values))

    def measure(results: Sequence[Result]) -> Reading:
        runs = chosen(results)
        both = [by_seed(of_lam(runs, lam), mean) for lam in (REGULAR, AUXETIC)]
        above, below = (
            Measured.of(label(lam), unit, [v for _, v in row])
            for lam, row in zip((REGULAR, AUXETIC), both, strict=True)
        )
        counts = [sum(len(r.lists[name]) for r in of_lam(runs, lam)) for lam in (REGULAR, AUXETIC)]
        stress = [
            float(np.mean([np.mean(r.column("pressure")) for r in of_lam(runs, lam)]))
            for lam in (REGULAR, AUXETIC)
        ]
        return ratio(
            above,
            below,
            tuple(both),
            f"{counts[0]} avalanches of regular, {counts[1]} of auxetic grains; mean pressure while sheared at fixed volume "
            f"{number(stress[0])} and {number(stress[1])} k",
        )

    return measure


def _variations(name: str, unit: str) -> tuple[Variation, ...]:
    return tuple(
        Variation(words, smaller(name, unit, _with(setting, value)))
        for words, setting, value in (
            (f"{FEWER} grains", "grains", FEWER),
            (f"{MANY} grains", "grains", MANY),
            ("steps six times as long", "step", COARSE),
            (f"a pressure of {HIGHER:g} k", "pressure", HIGHER),
        )
    )


def avalanche_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 5c and d."""
    shares, changes = [], []
    results = judged(results)
    for lam in lambdas(results):
        mine = of_lam(results, lam)
        values = np.concatenate([np.array(r.lists["participation"]) for r in mine])
        density, edges = np.histogram(values, bins=np.linspace(0.0, 1.0, 21), density=True)
        shares.append(Line(label(lam), colour(lam), 0.5 * (edges[1:] + edges[:-1]), density))
        counts = np.sum([r.lists["change_histogram"] for r in mine], axis=0)
        width = np.diff(CHANGE_BINS)
        there = counts > 0
        middle = np.sqrt(CHANGE_BINS[1:] * CHANGE_BINS[:-1])
        pdf = counts / (counts.sum() * width)
        changes.append(Line(label(lam), colour(lam), middle[there], pdf[there]))
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
        "participation",
        "Fig. 5c",
        "when an avalanche occurs, less particles are involved, as measured by the inversed partition ratio",
        avalanches,
        (
            Part(
                "direction",
                "fewer grains take part",
                f"mean inverse participation ratio at P = {PRESSURE:g} k, regular / auxetic",
                MORE,
                smaller("participation", ""),
                _variations("participation", ""),
            ),
        ),
        (Figure("fig-5-avalanches", "Avalanches (Fig. 5c, d)", avalanche_panels),),
    ),
    Claim(
        "force_changes",
        "Fig. 5d",
        "the inter-particle forces of the grains that are involved typically decreases less than in a regular packing",
        avalanches,
        (
            Part(
                "direction",
                "contact forces change less",
                f"mean |Δf_c| in an avalanche at P = {PRESSURE:g} k, regular / auxetic",
                MORE,
                smaller("mean_change", "k R"),
                _variations("mean_change", "k R"),
            ),
        ),
    ),
)

"""Claims about an intruder dragged through a closed box, Fig. 6a–c of the paper."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.arrays import Floats
from core.observables import force_drops
from sandbox.ensemble.estimates import Ratio
from sandbox.studies.common.verdicts import Demand
from sandbox.studies.paper.claims import (
    MORE,
    MUCH,
    SAME,
    Claim,
    Figure,
    Line,
    Measured,
    Panel,
    Part,
    Reading,
    Threshold,
    by_seed,
    of_kind,
    ratio,
)
from sandbox.studies.paper.conditions import SYSTEMS, seeds
from sandbox.studies.paper.runs import Request, Result
from scenes.scene import BY_MACHINE

KINDS = ("regular", "auxetic", "mixed")
STEADY = 0.25  # share of the drag that counts as its beginning
SMALL_DROP = 1e-3  # [k R] a fall of the force below that is the tolerance's
NEARER = Threshold(
    Demand(high=0.5), "nearer to the one than to the other: less than half of the way between them"
)


def drags(quick: bool) -> list[Request]:
    """Fig. 6a: a closed box, an intruder of 5.7 radii."""
    settings = (("grains", 400), ("stroke", 10.0), ("step", 0.1)) if quick else (("grains", 600),)
    return [
        Request("intruder", kind, seed, (*settings, BY_MACHINE))
        for kind in KINDS
        for seed in seeds(SYSTEMS, quick)
    ]


def _steady(result: Result) -> Floats:
    force = result.column("force")
    steady: Floats = force[int(STEADY * len(force)) :]
    return steady


def drag(result: Result) -> float:
    """Mean force on the intruder after the beginning [k R]."""
    return float(np.mean(_steady(result)))


def unsteadiness(result: Result) -> float:
    """Standard deviation of that force [k R]."""
    return float(np.std(_steady(result)))


def drops(result: Result) -> Floats:
    """Falls of the force on the intruder [k R], in the order of their coming."""
    sizes = force_drops(_steady(result))
    kept: Floats = sizes[sizes > SMALL_DROP]
    return kept


def mean_drop(result: Result) -> float:
    """Mean fall of the force on the intruder [k R]."""
    sizes = drops(result)
    return float(np.mean(sizes)) if len(sizes) else 0.0


def over(
    value: Callable[[Result], float], one: str, other: str
) -> Callable[[Sequence[Result]], Reading]:
    """One kind over the other, seed by seed."""

    def measure(results: Sequence[Result]) -> Reading:
        both = [by_seed(of_kind(results, kind), value) for kind in (one, other)]
        above, below = (
            Measured.of(kind, "k R", [v for _, v in row])
            for kind, row in zip((one, other), both, strict=True)
        )
        return ratio(above, below, tuple(both))

    return measure


def mixture_on_the_way(results: Sequence[Result]) -> Reading:
    """Where the mixture's drag lies on the way from auxetic (0) to regular (1): a ratio of two differences."""
    tables = {kind: dict(by_seed(of_kind(results, kind), drag)) for kind in KINDS}
    common = sorted(set.intersection(*(set(table) for table in tables.values())))
    regular, auxetic, mixed = (np.array([tables[kind][s] for s in common]) for kind in KINDS)
    measured = tuple(Measured.of(kind, "k R", list(tables[kind].values())) for kind in KINDS)
    return Reading(Ratio.of(mixed - auxetic, regular - auxetic), measured)


def drag_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 6b and c."""
    curves, distributions = [], []
    for kind in KINDS:
        runs = of_kind(results, kind)
        first = min(runs, key=lambda result: result.request.seed)
        curves.append(Line(kind, kind, first.column("stroke"), first.column("force")))
        sizes = np.sort(np.concatenate([drops(result) for result in runs]))
        share = np.arange(1, len(sizes) + 1) / max(len(sizes), 1)
        distributions.append(Line(kind, kind, sizes, share, dashed=kind == "mixed"))
    return [
        Panel("Drag, one seed", "way of the intruder [R]", "force [k R]", tuple(curves)),
        Panel(
            "Force drops, all seeds",
            "force drop [k R]",
            "cumulative distribution",
            tuple(distributions),
            log_x=True,
        ),
    ]


def _smaller(what: str, value: Callable[[Result], float], threshold: Threshold) -> tuple[Part, ...]:
    factor = threshold is MUCH
    return tuple(
        Part(
            "factor" if factor else "direction",
            f"{'much less' if factor else 'less'} than regular: {kind}",
            f"{what}, regular / {kind}",
            threshold,
            over(value, "regular", kind),
        )
        for kind in ("auxetic", "mixed")
    )


CLAIMS = (
    Claim(
        "intruder_drag",
        "Fig. 6b",
        "it is easier to traverse through a packing of metagrains or a mixture of metagrains and rings compared to a packing "
        "of rings only",
        drags,
        _smaller("mean drag", drag, MORE),
        (Figure("fig-6bc-intruder", "Intruder (Fig. 6b, c)", drag_panels),),
    ),
    Claim(
        "intruder_mixture",
        "Fig. 6b",
        "although it shows larger fluctuations, it is remarkable that the mixture shows almost the same drag force than the pure "
        "packing of metagrains",
        drags,
        (
            Part(
                "direction",
                "nearer to the metagrains than to the rings",
                "place of the mixture's mean drag between auxetic (0) and regular (1)",
                NEARER,
                mixture_on_the_way,
            ),
            Part(
                "factor",
                "almost the same drag",
                "mean drag, mixed / auxetic",
                SAME,
                over(drag, "mixed", "auxetic"),
            ),
            Part(
                "direction",
                "larger fluctuations than metagrains",
                "standard deviation of the drag, mixed / auxetic",
                MORE,
                over(unsteadiness, "mixed", "auxetic"),
            ),
        ),
    ),
    Claim(
        "intruder_drops",
        "Fig. 6c",
        "the size of the avalanches is also much reduced",
        drags,
        (
            *_smaller("mean force drop", mean_drop, MORE),
            *_smaller("mean force drop", mean_drop, MUCH),
        ),
    ),
)

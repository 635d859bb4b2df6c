"""The shear cell: which packings of it are run, what is read off its plate, and which of its runs judge."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from core.arrays import Floats
from sandbox.studies.paper.claims import Measured, Reading, Unmeasurable, ratio, where
from sandbox.studies.paper.conditions import (
    AUXETIC,
    REGULAR,
    SYSTEMS,
    label,
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
    0.01: (0.94, 1.0, 1.06),  # what ``confinement.MIDDLE_OF`` needs: they take four times as long
    0.1: (*COMMON, 1.0, 1.06, 1.12),
    1.0: (*COMMON, 0.98),
    10.0: (0.85, *COMMON),
    100.0: (0.845, 0.85, 0.855),
}
AROUND_HIGH = {0.1: (0.94, 1.06, 1.12), 10.0: (0.86, 0.88, 0.94)}  # what a variation needs
QUICK_FRACTIONS = {0.1: (0.86, 0.94, 1.06, 1.12), 10.0: (0.85, 0.86, 0.88, 0.94)}
STEADY, SMALL, MIDDLE = 0, 1, 2  # protocols of the scene
FEW = 8  # seeds of steady shear, of a variation, and of λ = 1
FEWEST = 6  # of the costliest kinds
FLOWS = 0.3  # shear strain after which the flow counts as steady
POSITIVE = 1e-4  # [k] a smaller pressure is none: the plates do not feel each other


def cell_runs(
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


def fractions_of(*lams: float) -> dict[float, tuple[float, ...]]:
    """All packing fractions of some λ."""
    return {lam: FRACTIONS[lam] for lam in lams}


def pressure(result: Result) -> float:
    """Mean normal stress on the plate [k]: of the steady flow, or of all cycles."""
    steady = int(result.request.of("protocol")) == STEADY
    return float(np.mean(flowing(result, "normal") if steady else result.column("normal")))


def flowing(result: Result, column: str) -> Floats:
    """A column once the flow is steady."""
    values: Floats = result.column(column)[result.column("stroke") > FLOWS]
    return values


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


def common_fractions(results: Sequence[Result]) -> list[float]:
    """Packing fractions that regular and auxetic grains have."""
    each = [
        {float(r.request.of("packing_fraction")) for r in of_lam(results, lam)}
        for lam in (REGULAR, AUXETIC)
    ]
    return sorted(set.intersection(*each))


def regular_over_auxetic(
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

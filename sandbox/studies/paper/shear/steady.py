"""Steady shear, Fig. 4: the yield stress, the friction of the packing, and how both fluctuate."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.shear import yield_stress
from sandbox.studies.common.verdicts import Demand
from sandbox.studies.paper.claims import (
    MORE,
    MUCH,
    TWICE,
    Claim,
    Figure,
    Line,
    Panel,
    Part,
    Threshold,
    Variation,
    where,
)
from sandbox.studies.paper.conditions import (
    AUXETIC,
    EXTREMES,
    NEUTRAL,
    REGULAR,
    colour,
    dashed,
    label,
    lambdas,
    of_lam,
)
from sandbox.studies.paper.runs import Request, Result
from sandbox.studies.paper.shear.cell import (
    COMMON,
    FEW,
    FEWEST,
    FLOWS,
    QUICK_FRACTIONS,
    STEADY,
    cell_runs,
    common_fractions,
    finer_steps,
    flowing,
    fractions_of,
    judged,
    pressure,
)
from sandbox.studies.paper.shear.confinement import (
    DENSE,
    HIGH,
    LOW,
    MIDDLE_OF,
    all_lambdas,
    at_equal_pressure,
    at_equal_volume,
    collapse,
    growth,
    sublinear,
)
from sandbox.studies.paper.shear.panels import against_confinement, against_pressure

STEP = 0.05  # [R] of the steady shear: a shear strain of 2.5e-3
FINE_STEP = 0.01
ALIKE = Threshold(
    Demand(1.0 / 1.2, 1.2),
    "“the same” coefficient is read as 1 within a fifth: the scatter of points in the paper's plot",
)
FINER_FLOW = "strain steps of 5e-4 instead of 2.5e-3"
YIELD_DENSE = f"yield stress at {DENSE}, regular / auxetic"
WAVES_DENSE = f"standard deviation of the pressure at {DENSE}, regular / auxetic"
WAVES = f"standard deviation of the pressure at P = {MIDDLE_OF:g} k, regular / auxetic"


def steady_shears(quick: bool) -> list[Request]:
    """Fig. 4: shear until the stress is steady; some in finer steps."""
    if quick:
        return cell_runs(quick, STEADY, QUICK_FRACTIONS, {"strain": 0.6, "step": 0.1})
    plain = {"strain": 0.8, "step": STEP}
    dense = dict.fromkeys((REGULAR, AUXETIC), COMMON[-1:])
    return [
        *cell_runs(quick, STEADY, fractions_of(REGULAR, NEUTRAL, AUXETIC), plain, FEW),
        *cell_runs(quick, STEADY, fractions_of(*EXTREMES), plain, FEWEST),
        *cell_runs(quick, STEADY, dense, {**plain, "step": FINE_STEP}, FEW),
    ]


def yielding(result: Result) -> float:
    """Dynamic yield stress [k]."""
    return yield_stress(result.column("stroke"), result.column("force"), FLOWS)


def friction(result: Result) -> float:
    """τ/P of the steady flow."""
    return yielding(result) / pressure(result)


def fluctuation(result: Result) -> float:
    """Standard deviation of the normal stress of the steady flow [k]."""
    return float(np.std(flowing(result, "normal")))


def unsteadiness(result: Result) -> float:
    """Standard deviation of the shear stress of the steady flow [k]."""
    return float(np.std(flowing(result, "force")))


def yield_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 4d and f, and τ/P."""
    rows = judged(results)
    curves, ratios = [], []
    densest = common_fractions(rows)[-1]
    for lam in lambdas(rows):
        mine = where(of_lam(rows, lam), packing_fraction=densest)
        if mine:
            first = min(mine, key=lambda result: result.request.seed)
            columns = first.column("stroke"), first.column("force")
            line = Line(label(lam), colour(lam), *columns, dashed=dashed(lam))
            curves.append(line)
        ratios.append(
            Line(
                label(lam),
                colour(lam),
                *against_pressure(rows, lam, friction),
                points=True,
                dashed=dashed(lam),
            )
        )
    return [
        *against_confinement(results, yielding, "yield stress [k]"),
        Panel("Friction", "normal stress P [k]", "τ/P", tuple(ratios), log_x=True),
        Panel(
            f"Shear, packing fraction {densest:g}, one seed",
            "shear strain",
            "shear stress τ [k]",
            tuple(curves),
        ),
    ]


CLAIMS = (
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
            collapse("yield stress", yielding, LOW),
            collapse("yield stress", yielding, HIGH),
            all_lambdas("yield stress", yielding),
            *sublinear("yield stress", yielding),
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
)

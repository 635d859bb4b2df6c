"""Reynolds dilatancy, an appendix: cycles that are larger than those of Fig. 3, and yet reversible."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.shear import dilatancy
from sandbox.studies.common.verdicts import Demand
from sandbox.studies.paper.claims import (
    RISES,
    Claim,
    Measure,
    Measured,
    Part,
    Reading,
    Threshold,
    by_seed,
    mean_of,
    number,
    over_seeds,
    where,
)
from sandbox.studies.paper.conditions import AUXETIC, NEUTRAL, REGULAR, label, of_lam
from sandbox.studies.paper.runs import Request, Result
from sandbox.studies.paper.shear.cell import FEW, MIDDLE, cell_runs, pressure, regular_over_auxetic

FAR = 0.03  # shear strain that is far from the middle of a cycle of 0.04
MIDDLE_FRACTION = 0.92  # packing fraction of the middle cycles
NO_STRONG = Threshold(
    Demand(0.5, 2.0), "“no strong difference” is read as less than a factor of two"
)


def middle_cycles(quick: bool) -> list[Request]:
    """Appendix: cycles that are larger, and yet reversible."""
    lams = (REGULAR, AUXETIC) if quick else (REGULAR, NEUTRAL, AUXETIC)
    return [
        request
        for friction in (0.5, 0.0)
        for request in cell_runs(
            quick,
            MIDDLE,
            dict.fromkeys(lams, (MIDDLE_FRACTION,)),
            {"cycles": 1 if quick else 3, "friction": friction},
            FEW,
        )
    ]


def rise(result: Result) -> float:
    """Normal stress far from the middle of a cycle, less that in the middle [k]."""
    return dilatancy(result.column("stroke"), result.column("normal"), FAR)


def dilates(lam: float, coefficient: float = 0.5) -> Measure:
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
    return regular_over_auxetic(where(results, friction=0.5), lambda rows: by_seed(rows, rise))


CLAIMS = (
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

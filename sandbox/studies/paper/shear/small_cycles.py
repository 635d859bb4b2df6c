"""The shear modulus, Fig. 3: cycles too small for the packing to yield."""

from __future__ import annotations

from collections.abc import Sequence

from core.shear import shear_modulus
from sandbox.studies.paper.claims import MORE, TWICE, Claim, Figure, Panel, Part, Variation
from sandbox.studies.paper.conditions import AUXETIC, EXTREMES, NEUTRAL, REGULAR
from sandbox.studies.paper.runs import Request, Result
from sandbox.studies.paper.shear.cell import (
    AROUND_HIGH,
    COMMON,
    FEW,
    FEWEST,
    GRAINS,
    QUICK_FRACTIONS,
    SMALL,
    cell_runs,
    finer_steps,
    fractions_of,
    smaller_cell,
)
from sandbox.studies.paper.shear.confinement import (
    DENSE,
    HIGH,
    LOW,
    all_lambdas,
    at_equal_volume,
    collapse,
    growth,
    sublinear,
)
from sandbox.studies.paper.shear.panels import against_confinement

CYCLE_STEP = 0.005  # [R] of the small cycles: a shear strain of 2e-4
PAPER_STEP = 0.002  # [R] in the small cycles: a shear strain of 1e-4, the paper's
NARROW = f"a cell of half the width ({GRAINS // 2} grains)"
FINER = "strain steps of 1e-4, the paper's"
G_DENSE = f"G at {DENSE}, regular / auxetic"


def small_cycles(quick: bool) -> list[Request]:
    """Fig. 3: cycles of shear strain 0.002; some in a cell of another size, some in the paper's strain steps."""
    careful = {"cycles": 2 if quick else 3, "tolerance": 1e-4, "max_iterations": 50_000}
    plain = {**careful, "step": CYCLE_STEP}
    if quick:
        return cell_runs(quick, SMALL, QUICK_FRACTIONS, plain)
    return [
        *cell_runs(quick, SMALL, fractions_of(REGULAR, AUXETIC), plain),
        *cell_runs(quick, SMALL, fractions_of(NEUTRAL), plain, FEW),
        *cell_runs(quick, SMALL, fractions_of(*EXTREMES), plain, FEWEST),
        *cell_runs(quick, SMALL, AROUND_HIGH, {**plain, "grains": GRAINS // 2}, FEW),
        *cell_runs(quick, SMALL, AROUND_HIGH, {**careful, "step": PAPER_STEP}, FEW),
    ]


def modulus(result: Result) -> float:
    """G [k] of the last cycle: in the first ones a packing that was never sheared still settles."""
    cycles = int(result.request.of("cycles"))
    strain, stress = result.column("stroke"), result.column("force")
    last = slice((len(strain) - 1) // cycles * (cycles - 1), None)
    return shear_modulus(strain[last], stress[last])


def modulus_panels(results: Sequence[Result]) -> list[Panel]:
    """Fig. 3g and i."""
    return against_confinement(results, modulus, "shear modulus G [k]")


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
            collapse("G", modulus, LOW),
            collapse("G", modulus, HIGH, (NARROW, smaller_cell), (FINER, finer_steps)),
            all_lambdas("G", modulus),
            *sublinear("G", modulus),
        ),
    ),
)

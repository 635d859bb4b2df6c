"""How far a body moves in an increment, and how carefully the grains are relaxed after it: parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from core.settings import LONGEST_STEP
from scenes.grains import recipe
from scenes.parameter import Parameter, Value

TOLERANCE = Parameter(
    "tolerance",
    1e-2,
    "",
    1e-8,
    0.3,
    "largest residual force over mean contact force at the end of an increment",
    live=True,
)
MAX_ITERATIONS = Parameter(
    "max_iterations",
    20_000,
    "",
    10,
    1_000_000,
    "force evaluations after which an increment ends unconverged, and says so",
    live=True,
)
# Increment and tolerance, for play and record alike, come from the work-precision plots of `study accuracy`, see
# assets/studies/accuracy. At 1e-2 the force that a hand feels is off by as much as the model is (2 % with C = 50 against hard
# contacts, up to 2.1 % by the contact law) in the press, the shear cell, the shrinking box and both hoppers; with friction the
# increment is to blame for that, and no tolerance helps. Ten times tighter costs 1.7 to 3.3 times the time. Where
# that is not enough, or more is cheap, the scene says so (intruder, avalanches). The intruder's path bifurcates within a few
# increments whatever the tolerance: beyond that single forces mean little, and means over seeds are what can be compared.
# Nothing relaxes to more than a few digits in a picture: --set tolerance=1e-6 for a
# measurement.
SOLVER = (
    Parameter(
        "step",
        0.05,
        "R",
        0.002,
        0.15,
        "longest move of a body in one increment; never more than a quarter of the smallest radius",
        live=True,
    ),
    TOLERANCE,
    MAX_ITERATIONS,
)


def solver_parameters(**defaults: float) -> tuple[Parameter, ...]:
    """``SOLVER``, some of it with defaults of a scene's own."""
    return tuple(replace(p, default=defaults.get(p.name, p.default)) for p in SOLVER)


def step(settings: Mapping[str, Value]) -> float:
    """How far a body moves in one increment at most [R]: as asked, but no further than the smallest grain allows."""
    asked = float(settings["step"])
    if "size_ratio" not in settings:
        return asked
    return min(asked, LONGEST_STEP * recipe(settings, "mixed").smallest)

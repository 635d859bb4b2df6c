"""The paper's conditions: its materials, how many systems, and which seeds set thresholds up and which judge."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.studies.paper.claims import Unmeasurable, number
from sandbox.studies.paper.runs import Request, Result
from scenes.parameter import Value

SETTING_UP = range(1, 11)  # seeds that thresholds, strains and pressures were chosen on
FIRST = 101  # seed that judges: from here on none was looked at before
SYSTEMS = 16  # the paper's number for each Poisson's ratio
QUICK = 3  # seeds of a quick study

# λ and μ of the paper. Auxetic and regular, where only two are compared, are those of ν = −0.82 and 0.82.
LAMBDAS = (0.01, 0.1, 1.0, 10.0, 100.0)
MU = 0.1
AUXETIC, NEUTRAL, REGULAR = 0.1, 1.0, 10.0
EXTREMES = (0.01, 100.0)


def seeds(count: int, quick: bool) -> range:
    """Those that judge."""
    return range(FIRST, FIRST + (min(count, QUICK) if quick else count))


def packing(lam: float) -> str:
    """Kind of packing for a λ."""
    return "auxetic" if lam < 1.0 else "regular"


def material(lam: float) -> tuple[tuple[str, Value], ...]:
    """Settings of a scene for the paper's λ at its μ."""
    return (("stiffness_ratio", lam), ("softness", MU))


def lam_of(request: Request) -> float:
    """The λ of a run's grains."""
    return float(request.of("stiffness_ratio"))


def of_lam(results: Sequence[Result], lam: float) -> list[Result]:
    """The runs with grains of that λ. Raises Unmeasurable if there are none."""
    found = [result for result in results if lam_of(result.request) == lam]
    if not found:
        raise Unmeasurable(f"no runs with {label(lam)}")
    return found


def lambdas(results: Sequence[Result]) -> list[float]:
    """Those that occur, from regular to auxetic."""
    return sorted({lam_of(result.request) for result in results}, reverse=True)


def label(lam: float) -> str:
    """For tables and figures."""
    return f"λ = {number(lam)}"


def colour(lam: float) -> str:
    """Kind of line in a figure."""
    return "other" if lam == NEUTRAL else "regular" if lam > NEUTRAL else "auxetic"


def dashed(lam: float) -> bool:
    """Whether its line is: the two that share a colour with another one."""
    return lam in EXTREMES

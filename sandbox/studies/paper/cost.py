"""What the paper's own conditions would cost, extrapolated from the seconds of the runs that were made."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import mean

from sandbox.studies.paper.claims import where
from sandbox.studies.paper.conditions import (
    LAMBDAS,
    SYSTEMS,
    lam_of,
)
from sandbox.studies.paper.runs import Result
from sandbox.studies.paper.shear.cell import GRAINS, SMALL, STEADY
from sandbox.studies.paper.shear.small_cycles import PAPER_STEP
from sandbox.studies.paper.shear.steady import FINE_STEP, STEP

SPEED = 3600.0  # seconds in an hour


@dataclass(frozen=True)
class Estimated:
    """A protocol in the paper's conditions."""

    protocol: str
    here: str  # what was done
    paper: str  # what the paper did
    runs: int
    hours: float  # of one core


@dataclass(frozen=True)
class _Protocol:
    name: str
    here: str
    paper: str
    mine: Callable[[Sequence[Result]], list[Result]]
    finer: float  # how many times as many steps the paper takes


def _steady(results: Sequence[Result]) -> list[Result]:
    return where(results, protocol=STEADY, grains=GRAINS, step=STEP)


def _small(results: Sequence[Result]) -> list[Result]:
    rows = where(results, protocol=SMALL, grains=GRAINS)
    return [r for r in rows if r.request.of("step") != PAPER_STEP]


def _bulk(results: Sequence[Result]) -> list[Result]:
    return [r for r in results if r.request.scene == "biaxial_periodic"]


PROTOCOLS = (
    _Protocol(
        "Fig. 2d, compression",
        "16 systems of 500 grains, five λ",
        "the same",
        _bulk,
        1.0,
    ),
    _Protocol(
        "Fig. 3, small cycles",
        "strain steps of 2.5e-4; 16 systems, at λ = 0.01 and 100 six and fewer points, at λ = 1 eight",
        "strain steps of 1e-4; 16 systems of each λ",
        _small,
        2.5,
    ),
    _Protocol(
        "Fig. 4, steady shear",
        "strain steps of 2.5e-3; 8 systems, at λ = 0.01 and 100 six and fewer points",
        "strain steps of 1e-4; 16 systems of each λ",
        _steady,
        25.0,
    ),
)


def growth(results: Sequence[Result]) -> float:
    """p in seconds ∝ (number of steps)^p, from the steady shears that were made in two steps; 1 where there are none."""
    fine = where(results, protocol=STEADY, grains=GRAINS, step=FINE_STEP)
    both = []
    for run in fine:
        asked = {**dict(run.request.settings), "step": STEP}
        same = [r for r in where(results, **asked) if r.request.seed == run.request.seed]
        both += [(run.seconds, twin.seconds) for twin in same if twin.seconds > 0.0]
    if not both:
        return 1.0
    slower = sum(a for a, _ in both) / sum(b for _, b in both)
    return math.log(slower) / math.log(STEP / FINE_STEP)


def estimate(results: Sequence[Result]) -> list[Estimated]:
    """What each protocol of the paper's simulations would cost; nothing for those that were not run with every λ."""
    power = growth(results)
    found = []
    for protocol in PROTOCOLS:
        rows = [r for r in protocol.mine(results) if r.failure is None]
        if {lam_of(r.request) for r in rows} != set(LAMBDAS):
            continue
        each = {lam: [r for r in rows if lam_of(r.request) == lam] for lam in LAMBDAS}
        points = max(
            len({dict(r.request.settings).get("packing_fraction") for r in some})
            for some in each.values()
        )
        runs = SYSTEMS * points * len(LAMBDAS)
        seconds = SYSTEMS * points * sum(mean(r.seconds for r in some) for some in each.values())
        hours = seconds * protocol.finer**power / SPEED
        found.append(Estimated(protocol.name, protocol.here, protocol.paper, runs, hours))
    return found

"""Grains under their own weight: the silo of Janssen, and the angle of repose."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from core import generate
from core.arrays import Floats
from core.packing import PeriodicBox
from core.quasistatic import Quasistatic
from core.rigid import Point, RigidBody, RigidWorld
from core.settings import Settings
from sandbox.ensemble.estimates import Ratio, Student
from sandbox.studies.classics.apparatus import engine, increment, plate
from sandbox.studies.classics.case import (
    Asking,
    Case,
    Check,
    Job,
    Numbers,
    Row,
    seeds,
    seeds_of,
    where,
)
from sandbox.studies.common.verdicts import Demand

GRAVITY = 0.002  # [k/R]: what lies below bears some hundredths of k
FINE = Settings(0.05, 1e-3, force_floor=1e-4, max_iterations=20_000)
AT_REST = 0.005  # of the fall of a free grain in an increment: less is none

# The silo.

SILO = 12.0  # [R] width
FRICTION = 0.5
COUNTS = (25, 50, 100, 200)  # grains, and so heights
SILO_SEEDS = 16
LOWERED = 0.6  # [R] that the floor sinks, so that the walls bear what they can
LOWERINGS = 60


def _filled(count: int, seed: int) -> Quasistatic:
    """A silo with so many grains, at rest."""
    half = 0.5 * SILO
    recipe = generate.Recipe(kind="regular", regular_poisson_ratio=0.0)
    top = count * recipe.mean_area() / (0.82 * SILO)
    tall = top + 4.0
    walls = [
        plate("floor", (0.0, 0.0), half),
        plate("left", (-half, 0.5 * tall), 0.5 * tall + 4.0, upright=True),
        plate("right", (half, 0.5 * tall), 0.5 * tall + 4.0, upright=True),
    ]
    outline: list[Point] = [(-half, 0.0), (half, 0.0), (half, top), (-half, top)]
    lid = plate("lid", (0.0, top), half)
    packing = generate.pack(
        recipe, seed=seed, outline=outline, world=RigidWorld([*walls, lid]), count=count
    )
    return engine(packing, walls, FRICTION, GRAVITY, FINE)


def _silo(job: Job, check: Asking) -> Numbers:
    """Force on the floor after it has sunk, mean over the second half of its way, and the weight of all grains [k R]."""
    silo = _filled(int(job.of("grains")), job.seed)
    for _ in range(20):
        increment(silo, check=check)
    floor, forces, unconverged = silo.world["floor"], [], 0
    index = silo.world.index("floor")
    for k in range(LOWERINGS):
        depth = LOWERED * (k + 1) / LOWERINGS
        done = increment(silo, {"floor": (0.0, floor.home[1] - depth)}, check)
        unconverged += done.report.reason.value != "converged"
        forces.append(-float(done.reactions[index, 1]))
    weight = GRAVITY * float(np.sum(silo.packing.rest_radius**2))
    return {
        "force": float(np.mean(forces[LOWERINGS // 2 :])),
        "weight": weight,
        "unconverged": float(unconverged),
    }


def janssen(weight: float, saturated: float) -> float:
    """Force on the floor under that weight of grains [k R]."""
    return saturated * (1.0 - math.exp(-weight / saturated))


def saturation(weights: Floats, forces: Floats) -> float:
    """W_s of Janssen's F = W_s (1 − exp(−W/W_s)) through forces (M,) under weights (M,), by least squares."""
    from scipy.optimize import minimize_scalar

    def misfit(log: float) -> float:
        saturated = math.exp(log)
        left = [f - janssen(w, saturated) for w, f in zip(weights, forces, strict=True)]
        return float(np.mean(np.square(left)))

    bounds = math.log(0.1 * weights.min()), math.log(100.0 * weights.max())
    return math.exp(float(minimize_scalar(misfit, bounds=bounds, method="bounded").x))


def _judge_silo(rows: Sequence[Row]) -> list[Check]:
    judging = seeds_of(rows)
    coefficients = []
    # The weight of a height H is W = w H, and W_s = w D/(2 K μ) with w the weight of a unit of height.
    density = GRAVITY * 0.82 * SILO / math.pi
    for seed in judging:
        mine = [row for row in rows if row.job.seed == seed]
        fitted = saturation(
            *(np.array([row[name] for row in mine]) for name in ("weight", "force"))
        )
        coefficients.append(density * SILO / (2.0 * FRICTION * fitted))
    saturated = saturation(*(np.array([row[name] for row in rows]) for name in ("weight", "force")))
    tall, half = (where(rows, grains=float(n)) for n in (COUNTS[-1], COUNTS[-2]))
    return [
        Check(
            "K, stress on the walls over the stress downwards, from the fitted saturation",
            Student.mean(coefficients),
            "between 1/3 and 3",
            Demand(1.0 / 3.0, 3.0),
            "Rankine's active and passive states at an internal friction of 30°, more than discs of μ = 0.5 have",
            judging,
        ),
        *(
            Check(
                f"force on the floor over W_s (1 − exp(−W/W_s)), {count} grains",
                Student.mean([row["force"] / janssen(row["weight"], saturated) for row in some]),
                f"1 (W/W_s = {some[0]['weight'] / saturated:.2f})",
                Demand(0.8, 1.25),
                "a fifth: a silo of six diameters is no continuum, and the floor of a low one is as near as its top",
                judging,
            )
            for count in COUNTS
            for some in (where(rows, grains=float(count)),)
        ),
        Check(
            "force on the floor, twice as high over as high",
            Ratio.of([r["force"] for r in tall], [r["force"] for r in half]),
            "2 in a liquid, near 1 where it saturates",
            Demand(high=1.5),
            "half way between the two",
            judging,
        ),
    ]


# The tilted bed.

FRICTIONS = (0.0, 0.2, 0.5)
BED_SEEDS = 8
BEDS = (
    (64.0, 40.0),
    (32.0, 20.0),
)  # [R] a period of the bed, and how deep it is; the first one is judged
QUICK_BED = (16.0, 8.0)
FALL = 0.25  # [R] of a free grain in an increment
TURN = 1.0  # [deg] from one tilt to the next
STEEPEST = 45.0  # [deg]
FURTHER = 4  # times ``FLOWS`` that it goes on, a degree steeper, before it is tilted back
BASE = 0.8  # [R] radius of the discs of the floor, and half of their spacing
FLOWS = 2.0  # [R] that the upper half has gone at one tilt, in the mean: it flows
# Increments at one tilt. In slow motion a bed that is too steep by δ goes FALL · δ in each, so that two R in 600 are δ = 0.8°.
PATIENCE = 600


def _bed(job: Job, check: Asking) -> Numbers:
    """Tilts [deg] at which a bed on a floor of discs, periodic along it, begins to flow, and stops again.

    Gravity turns, the bed stays. In between it flows on until it has forgotten how densely it was packed.
    """
    recipe = generate.Recipe(kind="regular", regular_poisson_ratio=0.0)
    width, deep = job.of("width"), job.of("depth")
    count = round(0.82 * width * deep / recipe.mean_area())
    across = np.arange(BASE, width, 2.0 * BASE)
    floor = RigidBody("floor", discs=[(float(x), -BASE, BASE) for x in across])
    lid = RigidBody("lid", segments=[(-3.0, deep, width + 3.0, deep, 0.0)])
    outline: list[Point] = [(0.0, -BASE), (width, -BASE), (width, deep), (0.0, deep)]
    packing = generate.pack(
        recipe,
        seed=job.seed,
        outline=outline,
        world=RigidWorld([floor, lid]),
        box=PeriodicBox(width),
        count=count,
    )
    settings = Settings(0.1, 1e-2, force_floor=1e-4, max_iterations=20_000)
    bed = engine(packing, [floor], job.of("friction"), GRAVITY, settings, GRAVITY / FALL)
    start = 0.0
    while start < STEEPEST and not _flows(bed, start, check):
        start += TURN
    stop = start
    for _ in range(FURTHER):
        _flows(bed, start + TURN, check)
    while stop > 0.0 and _flows(bed, stop, check):
        stop -= TURN
    return {"start": start, "stop": stop}


def _flows(bed: Quasistatic, tilt: float, check: Asking) -> bool:
    """Whether the upper half goes on and on at that tilt [deg]."""
    radians = math.radians(tilt)
    bed.system.gravity = (GRAVITY * math.sin(radians), -GRAVITY * math.cos(radians))
    start = bed.packing.x.copy()
    upper = bed.packing.y > np.median(bed.packing.y)
    for _ in range(PATIENCE):
        before = bed.packing.state[:2].copy()
        increment(bed, check=check)
        if float(np.mean((bed.packing.x - start)[upper])) > FLOWS:
            return True
        if float(np.max(np.hypot(*(bed.packing.state[:2] - before)))) < AT_REST * FALL:
            return False
    return False


def _judge_bed(rows: Sequence[Row]) -> list[Check]:
    widths = sorted({row.job.of("width") for row in rows}, reverse=True)
    rough, some, smooth = (where(rows, friction=mu, width=widths[0]) for mu in reversed(FRICTIONS))
    judging = seeds_of(rows)
    checks = [
        Check(
            "angle of repose, where a flowing bed of μ = 0.5 stops [deg]",
            Student.mean([row["stop"] for row in rough]),
            "15 to 21",
            Demand(12.0, 24.0),
            "beds of 4000 discs, 35 diameters deep, begin at 21° and stop at 15° (Deboeuf et al.); without inertia there is one "
            "angle in between; three degrees for the turning by whole ones and for a bed that is less than half as deep",
            judging,
        ),
        Check(
            "the same, μ = 0 [deg]",
            Student.mean([row["stop"] for row in smooth]),
            "6.3",
            Demand(high=10.0),
            "discs without friction flow at tan⁻¹ 0.11 = 6.3° (da Cruz et al.), and a bed of some hundred a little steeper",
            judging,
        ),
        Check(
            "μ = 0.5 less μ = 0.2 [deg]",
            Student.mean([a["stop"] - b["stop"] for a, b in zip(rough, some, strict=True)]),
            "above 0: the rougher, the steeper",
            Demand(0.0),
            "a direction",
            judging,
        ),
        Check(
            "where it begins to flow less where it stops, μ = 0.5 [deg]",
            Student.mean([row["start"] - row["stop"] for row in rough]),
            "above 0: a dense bed has to dilate first",
            Demand(0.0),
            "a direction",
            judging,
        ),
    ]
    for mu in FRICTIONS if len(widths) > 1 else ():
        large, small = (where(rows, friction=mu, width=width) for width in widths[:2])
        checks.append(
            Check(
                f"a bed of half the size less the whole one, μ = {mu:g} [deg]",
                Student.mean([b["stop"] - a["stop"] for a, b in zip(large, small, strict=True)]),
                "above 0: small beds find a hold more easily",
                Demand(0.0),
                "a direction: which way larger beds would go",
                judging,
            )
        )
    return checks


CASES = (
    Case(
        "silo",
        "The silo of Janssen",
        "Janssen 1895 (translated by Sperl, doi:10.1007/s10035-005-0224-z): the force on the floor is W_s (1 − exp(−W/W_s)), "
        "with W_s = w D/(2 K μ) in two dimensions",
        lambda quick: [
            Job("silo", (("grains", float(count)),), seed)
            for count in COUNTS
            for seed in seeds(SILO_SEEDS, quick)
        ],
        _silo,
        _judge_silo,
    ),
    Case(
        "repose",
        "Angle of repose",
        "beds of discs with μ = 0.5 that are tilted slowly: Staron, Vilotte and Radjai, doi:10.1103/PhysRevLett.89.204302; "
        "Deboeuf, Vilotte, Mangeney, Staron and Dauchot, doi:10.1201/NOE0415383486-27. Without friction: da Cruz, Emam, "
        "Prochnow, Roux and Chevoir, doi:10.1103/PhysRevE.72.021309",
        lambda quick: [
            Job("repose", (("friction", mu), ("width", width), ("depth", depth)), seed)
            for width, depth in ((QUICK_BED,) if quick else BEDS)
            for mu in FRICTIONS
            for seed in seeds(BED_SEEDS, quick)
        ],
        _bed,
        _judge_bed,
        "there is no inertia that carries a flow on below the angle at which it could begin",
    ),
)

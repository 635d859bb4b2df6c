"""A few discs that stand or fall by friction: a pile, an arch, a disc in a clamp; and one that rolls.

All forces of these follow from balance alone, as do the coefficients of friction at which they begin to slide. The discs are
light: the lighter, the less they deform, and the closer they come to the rigid ones of textbooks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from core.packing import Packing
from sandbox.ensemble.estimates import Exact
from sandbox.studies.classics.apparatus import engine, increment, least, plate, withdraw
from sandbox.studies.classics.case import Asking, Case, Check, Job, Numbers, Row, within

STIFFNESS = 50.0  # [k] of a contact
WEIGHT = 1e-4  # [k R] of a disc: it deforms by as much
WIDTH = 1e-4  # to which coefficients of friction are bisected
NOTHING = 1e-3  # of a weight: a support that bears less bears none
# What a deformation of some weights does to the angles, and the tangential springs to the slip, is below a thousandth.
CLOSE = 2e-3
LIGHT = (
    f"discs of weight {WEIGHT:g} k R deform by as much, which changes angles by less than {CLOSE:g}"
)


def _pile(friction: float, check: Asking) -> bool:
    """Whether two discs side by side bear a third one, once stops at both sides are gone."""
    packing = Packing([-1.0, 1.0, 0.0], [1.0, 1.0, 1.0 + math.sqrt(3.0)], 1.0, 0.0, STIFFNESS)
    bodies = [
        plate("floor", (0.0, 0.0), 20.0),
        plate("left", (-2.0, 1.0), 1.0, upright=True),
        plate("right", (2.0, 1.0), 1.0, upright=True),
    ]
    pile = engine(packing, bodies, friction, WEIGHT)
    for _ in range(5):
        increment(pile, check=check)
    ways = {"left": (-1.0, 0.0), "right": (1.0, 0.0)}
    return withdraw(pile, ways, 0.02 * WEIGHT, 0.01, check) < NOTHING * WEIGHT


def _measure_pile(job: Job, check: Asking) -> Numbers:
    del job
    return {"friction": least(lambda mu: _pile(mu, check), 0.1, 0.5, WIDTH)}


def _judge_pile(rows: Sequence[Row]) -> list[Check]:
    expected = math.tan(math.radians(15.0))
    found = Exact(rows[0]["friction"])
    return [
        Check(
            "least friction at which it stands",
            found,
            f"tan 15° = {expected:.5f}",
            within(expected, CLOSE),
            LIGHT,
        )
    ]


# An arch of three discs between walls.

SQUEEZES = 40  # increments in which the walls come closer
CLOSER = (
    20.0  # by so many weights over k, which is what the thrust squeezes the discs by, and some more
)
SLOPES = (20.0, 30.0)  # [deg] of the line from an outer disc to the one in the middle


def least_friction(slope: float) -> float:
    """Of three equal heavy discs that span from wall to wall, the middle one higher; ``slope`` [deg] of the lines of centres.

    With weights 1: the walls bear 3/2 each by friction; an outer disc does not turn, so the same force, 3/2, acts along its
    contact with the middle one, downwards on that. Balance of the middle disc, N sin β = 1/2 + 3/2 cos β, gives
    T/N = 3 sin β / (1 + 3 cos β); at the walls 3 sin β / (3 + cos β), which is less.
    """
    beta = math.radians(slope)
    return 3.0 * math.sin(beta) / (1.0 + 3.0 * math.cos(beta))


def _arch(slope: float, friction: float, check: Asking) -> bool:
    """Whether it stands once its springings are gone.

    Before that the walls come closer until the middle disc has risen: an arch needs a thrust, and without one all three fall
    together between the walls, whatever the friction.
    """
    beta, weight = math.radians(slope), 0.1 * WEIGHT
    dx, dy = 2.0 * math.cos(beta), 2.0 * math.sin(beta)
    packing = Packing([-dx, 0.0, dx], [1.0, 1.0 + dy, 1.0], 1.0, 0.0, STIFFNESS)
    bodies = [
        plate("left", (-dx - 1.0, 2.0), 4.0, upright=True),
        plate("right", (dx + 1.0, 2.0), 4.0, upright=True),
        plate("under the left", (-dx, 0.0), 0.3),
        plate("under the right", (dx, 0.0), 0.3),
    ]
    arch = engine(packing, bodies, friction, weight)
    increment(arch, check=check)
    for k in range(SQUEEZES):
        closer = CLOSER * weight * (k + 1) / SQUEEZES
        walls = {"left": (-dx - 1.0 + closer, 2.0), "right": (dx + 1.0 - closer, 2.0)}
        increment(arch, walls, check)
    down = dict.fromkeys(("under the left", "under the right"), (0.0, -1.0))
    return withdraw(arch, down, 0.05 * weight, 0.02, check) < NOTHING * weight


def _measure_arch(job: Job, check: Asking) -> Numbers:
    slope = job.of("slope")
    return {"friction": least(lambda mu: _arch(slope, mu, check), 0.1, 0.8, WIDTH)}


def _judge_arch(rows: Sequence[Row]) -> list[Check]:
    return [
        Check(
            f"least friction at which it stands, lines of centres at {slope:g}°",
            Exact(row["friction"]),
            f"3 sin β/(1 + 3 cos β) = {least_friction(slope):.5f}",
            within(least_friction(slope), CLOSE),
            f"{LIGHT}; here a tenth of that",
        )
        for row in rows
        for slope in (row.job.of("slope"),)
    ]


# A disc in a clamp, which cannot roll: Coulomb's block.

STEEPNESS = (0.1, 0.5, 1.2)  # tan α of the contact forces
GAP = 1.996  # [R] between the jaws


def _clamp(weight: float, friction: float, check: Asking) -> tuple[bool, float]:
    """Whether a disc hangs between two upright jaws once its support is gone, and the force of a jaw [k R]."""
    bodies = [
        plate("left", (-0.5 * GAP, 1.0), 4.0, upright=True),
        plate("right", (0.5 * GAP, 1.0), 4.0, upright=True),
        plate("under", (0.0, 0.0), 0.3),
    ]
    clamp = engine(Packing([0.0], [1.0], 1.0, 0.0, STIFFNESS), bodies, friction, weight)
    for _ in range(5):
        increment(clamp, check=check)
    left = withdraw(clamp, {"under": (0.0, -1.0)}, 0.01 * weight, 0.02, check)
    jaw = abs(float(clamp.reactions[clamp.world.index("left"), 0]))
    return left < NOTHING * weight, jaw


def _measure_clamp(job: Job, check: Asking) -> Numbers:
    steep = job.of("steepness")
    weight = 2.0 * steep * 0.5 * (2.0 - GAP)  # the jaws of a gap of 2 − 2δ press with 2 δ k
    weight *= 2.0
    found = least(lambda mu: _clamp(weight, mu, check)[0], 0.5 * steep, 1.6 * steep, WIDTH)
    jaw = _clamp(weight, 1.01 * found, check)[1]
    return {"friction": found, "steepness": 0.5 * weight / jaw}


def _judge_clamp(rows: Sequence[Row]) -> list[Check]:
    return [
        Check(
            f"least friction at which it holds over tan α = {row['steepness']:.3f}",
            Exact(row["friction"] / row["steepness"]),
            "1",
            within(1.0, 5e-3),
            "the steepness is measured where it just holds; the springs of the contacts give by a thousandth",
        )
        for row in rows
    ]


# Rolling between plates.

WAY = 1.5  # [R] of the upper plate
APART = 1.9998  # [R] of the plates: the grain is hardly squeezed


def _measure_rolling(job: Job, check: Asking) -> Numbers:
    """Between two plates of which one moves by s a round grain goes s/2 and turns by s/2R."""
    top = plate("top", (0.0, APART), 60.0)
    top.axis = (1.0, 0.0)
    packing = Packing([0.0], [0.5 * APART], 1.0, job.of("poisson_ratio"), STIFFNESS)
    rolling = engine(packing, [plate("floor", (0.0, 0.0), 60.0), top], 0.4)
    increment(rolling, check=check)
    steps = 30
    for k in range(steps):
        increment(rolling, {"top": (WAY * (k + 1) / steps, APART)}, check)
    assert rolling.friction is not None
    return {
        "way": float(packing.x[0]) / WAY,
        "turn": -float(rolling.friction.spin[0]) / WAY,
    }


def _judge_rolling(rows: Sequence[Row]) -> list[Check]:
    return [
        Check(
            f"{what} over the way of the plate, ν = {row.job.of('poisson_ratio'):g}",
            Exact(row[name]),
            "1/2",
            within(0.5, 3.0 * (2.0 - APART)),
            "the grain is squeezed by 1e-4 of its diameter, and its half-axes differ from R by as much",
        )
        for row in rows
        for name, what in (("way", "way of the centre"), ("turn", "turn times R"))
    ]


CASES = (
    Case(
        "pile",
        "A pile of three cylinders",
        "closed form: the angle of the contact force is half of that of the line of centres, which is 30° from the vertical",
        lambda _: [Job("pile")],
        _measure_pile,
        _judge_pile,
    ),
    Case(
        "block",
        "Coulomb's block: a disc between two jaws, which cannot roll",
        "closed form (Coulomb): it slides where the angle α of the contact force to the normal has tan α = μ, as a block on an "
        "incline of that angle does",
        lambda _: [Job("block", (("steepness", s),)) for s in STEEPNESS],
        _measure_clamp,
        _judge_clamp,
    ),
    Case(
        "rolling",
        "Rolling between plates",
        "closed form: without slip the centre goes half of the plate's way s, and the grain turns by s/2R",
        lambda _: [Job("rolling", (("poisson_ratio", nu),)) for nu in (-0.8, 0.0, 0.8)],
        _measure_rolling,
        _judge_rolling,
    ),
    Case(
        "arch",
        "An arch of three discs between walls",
        "closed form: balance of forces and torques",
        lambda quick: [Job("arch", (("slope", s),)) for s in (SLOPES[-1:] if quick else SLOPES)],
        _measure_arch,
        _judge_arch,
    ),
)

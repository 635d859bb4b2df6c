"""Results of the paper's runs made by hand, and what comes of them: for the tests of its claims."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from sandbox.studies.paper import hopper
from sandbox.studies.paper.claims import (
    MORE,
    Claim,
    Finding,
    Part,
    Reading,
    Threshold,
    Unmeasurable,
    Variation,
    settle,
)
from sandbox.studies.paper.conditions import LAMBDAS, material, packing
from sandbox.studies.paper.runs import HAND, Request, Result
from sandbox.studies.paper.shear import cell, steady
from sandbox.studies.paper.study import CLAIMS
from scenes.scene import HAND_STRENGTH

SEEDS = range(101, 107)
STIFFNESS = dict(zip(LAMBDAS, (0.3, 0.3, 0.7, 2.5, 8.0), strict=True))


def noise(seed: int) -> float:
    """A few per cent up or down, the same for both kinds of a seed, and a little more for itself."""
    return 1.0 + 0.02 * math.sin(7.0 * seed)


def result(request: Request, **columns: object) -> Result:
    """A run that came to these columns."""
    return Result(request, {name: np.asarray(c).tolist() for name, c in columns.items()})


def verdicts(name: str, results: Sequence[Result]) -> dict[str, str]:
    """Verdict on each part of a claim, by what it says, judged as if the claim were the whole study."""
    claim = next(claim for claim in CLAIMS if claim.name == name)
    return {f.part.says: f.verdict for f in settle(claim.find(results))}


def value(measure: Callable[[Sequence[Result]], Reading], results: Sequence[Result]) -> float:
    return measure(results).estimate.value


def made_up(
    estimate: object,
    threshold: Threshold = MORE,
    varied: Sequence[object] = (),
) -> Finding:
    """A finding of a claim whose part has measured just that."""

    def measuring(what: object) -> Callable[[Sequence[Result]], Reading]:
        def measure(_: Sequence[Result]) -> Reading:
            if isinstance(what, str):
                raise Unmeasurable(what)
            return Reading(what)  # type: ignore[arg-type]

        return measure

    variations = tuple(Variation(f"condition {k}", measuring(v)) for k, v in enumerate(varied))
    part = Part("direction", "says", "quantity", threshold, measuring(estimate), variations)
    (finding,) = Claim("c", "", "", lambda quick: (), (part,)).find([])
    return finding


def pushes(forces: dict[str, float], locked: dict[str, float]) -> list[Result]:
    """Piston forces that rise from half to all of a mean with a sawtooth on it; hands that lock that share of packings."""
    stroke = np.linspace(0.0, 20.0, 101)
    made = []
    for kind in hopper.KINDS:
        for seed in range(101, 141):
            rising = forces[kind] * noise(seed) * (0.5 + stroke / 40.0)
            saw = 0.2 * forces[kind] * (np.arange(101) % 5)
            machine = Request("hopper", kind, seed, (("friction", 0.5),))
            made.append(
                result(machine, stroke=stroke, force=rising + saw, grains_out=10.0 * stroke)
            )
            for strength in hopper.STRENGTHS:
                stuck = (seed - 101) < 40 * locked[kind]
                hand = Request("hopper", kind, seed, ((HAND_STRENGTH, strength),), probe=HAND)
                lists = {"locked": [float(stuck)], "out": [10.0 if stuck else 180.0]}
                made.append(Result(hand, lists=lists))
    return made


def shears(friction: dict[float, float], stiffness: dict[float, float]) -> list[Result]:
    """Steady flow at τ = friction × P, with P = stiffness × (φ − 0.84), in waves of a tenth."""
    strain = np.linspace(0.0, 1.0, 101)
    made = []
    for lam, fractions in cell.FRACTIONS.items():
        for fraction in fractions:
            for seed in SEEDS:
                pressure = noise(seed) * stiffness[lam] * (fraction - 0.84)
                settings = (
                    ("grains", cell.GRAINS),
                    ("step", steady.STEP),
                    ("packing_fraction", fraction),
                    ("protocol", cell.STEADY),
                    *material(lam),
                )
                wave = 1.0 + 0.1 * noise(seed + 1) * np.sin(40.0 * strain)
                made.append(
                    result(
                        Request("couette", packing(lam), seed, settings),
                        stroke=strain,
                        force=friction[lam] * pressure * wave * np.minimum(strain / 0.1, 1.0),
                        normal=pressure * wave,
                    )
                )
    return made

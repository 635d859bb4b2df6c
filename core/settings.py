"""How far and how hard a hand moves a body in one increment, and how carefully the grains are relaxed after it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from core.errors import InputError
from core.relaxation import DEFAULT_SKIN, DEFAULT_TOLERANCE

DEFAULT_STEP = 0.05  # [R]
FORCE_FLOOR = 1e-2  # [k] least mean contact force that a residual is relative to
MACHINE = math.inf  # [k R] the strength of a testing machine, which goes wherever it is driven
LONGEST_STEP = 0.25  # [R] of the smallest grain; a longer one could carry a body past a grain


@dataclass(frozen=True)
class Settings:
    """How far a hand moves a body in one increment, ``step`` [R], how hard, ``hand_strength`` [k R], and how carefully to relax.

    ``force_floor`` [k] and ``skin`` are multiplied by the largest rest radius (the skin by four smallest ones at most): what is
    done is the same in all units of length.
    """

    step: float = DEFAULT_STEP
    tolerance: float = DEFAULT_TOLERANCE
    force_floor: float = FORCE_FLOOR
    skin: float = DEFAULT_SKIN
    max_iterations: int = 8_000
    threads: int = 1
    hand_strength: float = MACHINE

    def __post_init__(self) -> None:
        if not 0.0 < self.step <= LONGEST_STEP:
            raise InputError(f"the increment must be greater than 0 and at most {LONGEST_STEP} R")
        if self.max_iterations < 1:
            raise InputError("an increment needs at least one iteration")
        if not (self.tolerance > 0.0 and self.force_floor > 0.0 and 0.0 < self.skin < math.inf):
            raise InputError("the tolerance, the force floor and the skin must be greater than 0")
        if not self.hand_strength > 0.0:
            raise InputError("the hand's strength must be greater than 0 k R")

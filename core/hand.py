"""A hand of limited strength: how hard it pushes what it moves, and how far it comes in one increment.

A hand that goes wherever it is driven, a testing machine, has a strength without bound. Any other one is as strong as it is:
where a whole increment would take more than that, the increment is done again with a shorter way, until the force is right or
there is no way left. So a hand never brings the force above its strength by more than ``SLACK``, however stiff the packing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from core.observables import GrainContacts, stress
from core.packing import PeriodicBox
from core.rigid import Point

SLACK = 0.02  # of the strength: by so much a force may exceed it
SHORTEST = 0.01  # of an increment: a shorter way is none
CELL = "box"  # the name of the handle that is no body but the periodic cell
MOST_TRIES = 10  # of one increment, before the hand is told that there is no way


def force_on_body(reaction: Point, pull: Point) -> float:
    """The hand's force on a body [k R] along the unit vector ``pull`` of its pull; ``reaction`` is the push of the grains.

    It is negative where the grains push the body on. What goes across is borne by the guide, or by holding straight.
    """
    return -(reaction[0] * pull[0] + reaction[1] * pull[1]) + 0.0


def force_on_box(
    contacts: GrainContacts, box: PeriodicBox, way: tuple[float, float, float]
) -> float:
    """The hand's force on a periodic cell [k R] whose width, height and shift it drives along ``way``, of any length.

    It is the work over the way: −area Σ σ_ij ε_ij with the strain of the cell (Haver et al., doi:10.1073/pnas.2317915121,
    appendix "Numerical biaxial setup").
    """
    length = math.hypot(*way)
    if length == 0.0:
        return 0.0
    over_area = stress(contacts, 1.0)
    work = 0.5 * (over_area[0, 1] + over_area[1, 0]) * way[2] / box.height
    if np.isfinite(box.width):
        work += over_area[0, 0] * way[0] / box.width
    if np.isfinite(box.height):
        work += over_area[1, 1] * way[1] / box.height
    return -float(work) / length + 0.0


@dataclass
class Push:
    """One increment of a hand: which share of its way is tried now. ``before`` is its force before anything moved [k R]."""

    strength: float
    before: float
    share: float = 1.0
    tries: int = 1

    def too_much(self, force: float) -> bool:
        """True if that is more force [k R] than the hand has."""
        return force > self.strength * (1.0 + SLACK)

    def overpowered(self, force: float) -> bool:
        """True if the way that was tried takes more force [k R] than the hand has, and a shorter one is to be tried."""
        return self.share > 0.0 and self.too_much(force)

    def shorten(self, force: float) -> None:
        """A way on which the force should just be what the hand has, by what it was before and after the one that was too long.

        ``force`` [k R] is not finite where that one led to nothing.
        """
        if math.isfinite(force) and force > self.before:
            aim = self.strength * (1.0 + 0.5 * SLACK)
            part = min(max((aim - self.before) / (force - self.before), 0.0), 0.7)
        else:
            part = 0.25
        self.share *= part
        self.tries += 1
        if self.share < SHORTEST or self.tries > MOST_TRIES:
            self.share = 0.0

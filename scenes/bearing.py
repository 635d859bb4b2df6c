"""Which grains bear what a body presses on: the strong contacts that lead away from it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.packing import Packing
from core.quasistatic import Increment
from core.rigid import RigidWorld

SHARE = (
    0.5  # of the greatest contact force on the body: weaker contacts only prop up the strong ones
)


def bearing(
    packing: Packing, increment: Increment, world: RigidWorld, body: str
) -> NDArray[np.bool_] | None:
    """The grains (N,) that are reached from ``body`` through contacts of at least ``SHARE`` of the strongest one on it.

    None if nothing touches the body, or it is none (the handle of a periodic cell).
    """
    if all(each.name != body for each in world.bodies):
        return None
    bodies, pairs = increment.body_contacts, increment.grain_contacts
    touching = world.primitives()[1][bodies.primitive] == world.index(body)
    if not touching.any():
        return None
    least = SHARE * float(bodies.normal_force[touching].max())
    reached = np.zeros(len(packing), dtype=bool)
    reached[bodies.grain[touching & (bodies.normal_force >= least)]] = True
    strong = pairs.normal_force >= least
    i, j = pairs.i[strong], pairs.j[strong]
    while True:
        one = reached[i] != reached[j]
        if not one.any():
            return reached
        reached[i[one]] = reached[j[one]] = True

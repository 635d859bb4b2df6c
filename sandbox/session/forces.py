"""The forces of all contacts after an increment, friction included: what a table adds up on bodies, contact by contact."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats, Indices
from core.frictional_contacts import FrictionForces
from core.quasistatic import Increment
from core.rigid import RigidWorld


@dataclass(frozen=True)
class ContactForces:
    """Contacts in the order of ``Frame.contacts``, first those of two grains, (C,) each."""

    fx: Floats  # on grain i [k R]; on the other grain, or the body, the opposite
    fy: Floats
    normal: Floats  # size of the normal force [k R]
    tangential: Floats  # size of friction [k R]; 0 without
    body: Indices  # which of the frame's bodies is touched; -1 between grains


def contact_forces(increment: Increment, world: RigidWorld) -> ContactForces:
    """Those at the end of an increment. What was gone back to, or read from a file, has no friction before the next one."""
    pairs, bodies, held = increment.grain_contacts, increment.body_contacts, increment.friction
    i, no_body = np.concatenate([pairs.i, bodies.grain]), np.full(len(pairs.i), -1)
    j = np.concatenate([pairs.j, np.full(len(bodies.grain), -1)])
    primitive = np.concatenate([no_body, bodies.primitive])
    fx, fy = np.concatenate([pairs.fx, bodies.fx]), np.concatenate([pairs.fy, bodies.fy])
    tangential = np.zeros(len(i))
    if held is not None and len(i):
        wanted, there = _keys(held.i, held.j, held.primitive), _keys(i, j, primitive)
        order = np.argsort(there)
        at = order[np.minimum(np.searchsorted(there, wanted, sorter=order), len(i) - 1)]
        known = there[at] == wanted  # any other has a cap of 0, and no force
        at = at[known]
        sign = np.where(i[at] == held.i[known], 1.0, -1.0)
        fx[at] += sign * held.fx[known]
        fy[at] += sign * held.fy[known]
        tangential[at] = np.hypot(held.fx, held.fy)[known]
    _, owner = world.primitives()
    return ContactForces(
        fx=fx,
        fy=fy,
        normal=np.concatenate([pairs.normal_force, bodies.normal_force]),
        tangential=tangential,
        body=np.concatenate([no_body, owner[bodies.primitive]]),
    )


def without(held: FrictionForces | None, gone: NDArray[np.bool_]) -> FrictionForces | None:
    """The friction that is left when the grains marked in ``gone`` (N,) are taken away, as those that stay are numbered then."""
    if held is None:
        return None
    place = np.where(gone, -1, np.cumsum(~gone) - 1)
    stays = ~gone[held.i] & ((held.j < 0) | ~gone[held.j])
    parts = {field.name: getattr(held, field.name)[stays] for field in fields(held)}
    parts["i"], parts["j"] = place[parts["i"]], np.where(parts["j"] < 0, -1, place[parts["j"]])
    return FrictionForces(**parts)


def _keys(i: Indices, j: Indices, primitive: Indices) -> Indices:
    """Different for different contacts: of two grains 0 and more, with a body below 0."""
    low, high = np.minimum(i, j), np.maximum(i, j)
    return np.where(j >= 0, (low << 31) + high, -1 - (i << 31) - primitive)

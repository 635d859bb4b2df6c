"""Contacts as they stand, and what they do to bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from core.arrays import Floats, Indices
from core.jit import kernel
from core.observables import push_bodies, touching_bodies, touching_grains

# Rows of ``Touching.pair`` and of ``Touching.body``.
FX, FY, FORCE, OVERLAP, DX, DY = range(6)
AT_X, AT_Y, IMAGE_X, IMAGE_Y = range(4, 8)


class Touching(NamedTuple):
    """All contacts that carry force, K between grains and L with bodies, as ``core.observables`` names them."""

    i: Indices
    j: Indices
    pair: Floats  # (6, K)
    grain: Indices
    primitive: Indices
    body: Floats  # (8, L)


@kernel(allocates=True, forceinline=False)
def touching(grains, primitives, box):
    """All contacts of the grains, with each other and with bodies."""
    state, stiffness = grains.state, grains.contact_stiffness
    i, j, pair = touching_grains(state, stiffness, box)
    grain, primitive, body = touching_bodies(state, stiffness, primitives, box)
    return Touching(i, j, pair, grain, primitive, body)


@kernel(allocates=True, forceinline=False)
def reactions(bodies, contacts, pulls):
    """Force and torque of the grains on each body (B, 3) [k R, k R²], friction included."""
    placement, owner = bodies.places[:, :3], bodies.owner
    total, rubbed = np.zeros((placement.shape[0], 3)), np.zeros((placement.shape[0], 3))
    v = contacts.body
    x, y = v[AT_X] + v[IMAGE_X], v[AT_Y] + v[IMAGE_Y]
    push_bodies(owner[contacts.primitive], v[FX], v[FY], x, y, placement, total)
    on_body = np.flatnonzero(pulls.who[1] < 0)
    if on_body.shape[0]:
        body, v = owner[pulls.who[2][on_body]], pulls.values[:, on_body]
        push_bodies(body, v[0], v[1], v[2], v[3], placement, rubbed)
        total += rubbed
    return total

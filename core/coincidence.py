"""Grains whose centres coincide: the line of centres has no direction, so that no force parts them, however deep the overlap."""

from __future__ import annotations

import math

import numpy as np

from core.observables import GrainContacts
from core.packing import Packing

NEAREST = 1e-12  # [R] centres nearer than this count as one place
NUDGE = 1e-6  # of a rest radius
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


def part_coincident(packing: Packing, contacts: GrainContacts) -> bool:
    """Nudge grains that stand at one place, each its own way, the same ways every time; True if there were any."""
    same = np.flatnonzero(np.hypot(contacts.dx, contacts.dy) < NEAREST)
    if not len(same):
        return False
    grains = np.unique(np.concatenate([contacts.i[same], contacts.j[same]]))
    angle = GOLDEN_ANGLE * np.arange(len(grains))
    packing.state[0, grains] += NUDGE * packing.rest_radius[grains] * np.cos(angle)
    packing.state[1, grains] += NUDGE * packing.rest_radius[grains] * np.sin(angle)
    return True

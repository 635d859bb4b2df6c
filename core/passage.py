"""Whether an increment has taken a grain into a body or through one of its faces: what such an increment leads to is no answer.

A contact is a spring, and springs can be overpowered: by a hand stronger than they are, by friction coefficients of 10. A grain
whose centre has come past a face is pushed on to the other side.
"""

from __future__ import annotations

import numpy as np

from core.arrays import Floats
from core.observables import RigidContacts
from core.packing import Packing
from core.rigid_contacts import EDGE


def deep_grains(packing: Packing, contacts: RigidContacts, step: float) -> set[int]:
    """The grains so deep in a body that one more step [R] could take its face past their centre."""
    deep = contacts.overlap + step >= packing.semi_axes[1][contacts.grain]
    return set(contacts.grain[deep].tolist())


def passed_faces(
    contacts: RigidContacts, start: Floats, state: Floats, rows_then: Floats, rows_now: Floats
) -> set[tuple[int, int]]:
    """Grain and primitive, for the grains of ``contacts`` that have crossed a face that they touched, on a straight way.

    ``start`` and ``state`` (5, N) are the grains before and after, ``rows_then`` and ``rows_now`` (M, 8) the primitives. For
    small moves only: after a long one nobody can tell a way through from one around.
    """
    face = rows_now[contacts.primitive, 0] == EDGE
    grain, primitive = contacts.grain[face], contacts.primitive[face]
    image = np.array([contacts.image_x[face], contacts.image_y[face]])
    along, beyond = [], []
    for places, rows in ((start, rows_then[primitive]), (state, rows_now[primitive])):
        dx, dy = places[:2, grain] + image - rows[:, 1:3].T
        ux, uy = rows[:, 3], rows[:, 4]
        along.append(dx * ux + dy * uy)
        beyond.append(ux * dy - uy * dx)
    length = (rows[:, 5] - rows[:, 1]) * ux + (rows[:, 6] - rows[:, 2]) * uy
    changed = (beyond[0] >= 0.0) != (beyond[1] >= 0.0)
    way = np.where(changed, beyond[0] - beyond[1], 1.0)
    crossing = along[0] + (along[1] - along[0]) * beyond[0] / way
    passed = changed & (crossing >= 0.0) & (crossing <= length)
    return set(zip(grain[passed].tolist(), primitive[passed].tolist(), strict=True))

"""What FIRE works on: arrays for the grains with their inertias, its limits, and new lists when the old ones are stale."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.arrays import Box, Floats
from core.fire import CONTROL, DT_FACTOR, SHAPE_MASS, Grains, Limits, Minimizer, reorder
from core.friction import SPIN_MASS
from core.frictional_contacts import FrictionalContacts, Origin, committed, relisted
from core.jit import shared
from core.material import area_modulus, deformation_stiffness, shape_modulus
from core.neighbors import FIT, PAIRS_FULL, RIGID_FULL, Lists, allocate, rebuild
from core.rigid_contacts import RigidTerms, changed_sides, doubled, find_rigid_pairs
from core.slip import TANGENTIAL_STIFFNESS
from core.steering import ALPHA_START, DT_START

SKIN_SPAN = 4.0  # of the smallest radius, where that is less than the largest: else small grains list far too many neighbours


@shared
def limits_for(
    rest_radius: Floats,
    contact_stiffness: Floats,
    spins: bool,
    tolerance: float,
    force_floor: float,
    skin: float,
) -> Limits:
    """Limits for grains of these radii [R] and stiffnesses [k], (N,), which spin with friction; ``skin`` is in largest radii."""
    stiffest, smallest, largest = 1.0, 1.0, 1.0
    if rest_radius.shape[0]:
        stiffest, smallest, largest = contact_stiffness.max(), rest_radius.min(), rest_radius.max()
    if spins:
        stiffest *= 1.0 + TANGENTIAL_STIFFNESS
    return Limits(
        tolerance,
        force_floor,
        DT_FACTOR / np.sqrt(stiffest),
        0.1 * smallest,
        skin * min(largest, SKIN_SPAN * smallest),
    )


@shared
def minimizer_for(
    state: Floats,
    rest_radius: Floats,
    poisson_ratio: Floats,
    contact_stiffness: Floats,
    spins: bool,
    dt_max: float,
) -> Minimizer:
    """Arrays for grains in ``state`` (5, N) before the first evaluation, their materials (N,) as a packing has them."""
    count = rest_radius.shape[0]
    nu, stiffness = poisson_ratio, contact_stiffness
    rest_area = rest_radius * rest_radius
    # A grain that resists area or shape far more than a contact does is made heavier, so that dt need not shrink for it.
    own = 2.0 * deformation_stiffness(nu, stiffness) * (1.0 + np.abs(nu))
    lightness = 1.0 / (SHAPE_MASS * np.maximum(1.0, own / (SHAPE_MASS * stiffness)))
    rows = 6 if spins else 5
    inverse_mass, whole = np.ones((rows, count)), np.zeros((rows, count))
    for row in range(5):
        whole[row] = state[row]
        if row > 1:
            inverse_mass[row] = lightness
    if spins:
        inverse_mass[5] = 1.0 / (SPIN_MASS * rest_area)
    return Minimizer(
        whole,
        np.zeros((rows, count)),
        np.zeros((rows, count)),
        inverse_mass,
        np.zeros((rows, count)),
        np.zeros((3, count)),
        Grains(
            stiffness.copy(),
            rest_area,
            area_modulus(nu, stiffness) / rest_area,
            2.0 * shape_modulus(nu, stiffness),
        ),
        allocate(count, 4 * count, 24, spins),
        np.arange(count),
        np.zeros(count),
        np.zeros(count, np.int64),
        fresh_control(dt_max),
    )


@shared
def fresh_control(dt_max: float) -> np.ndarray:
    """``Minimizer.control`` before the first evaluation; ``dt_max`` as in ``Limits``."""
    control = np.zeros(1, CONTROL)
    control[0]["dt"] = DT_START * dt_max
    control[0]["alpha"] = ALPHA_START
    control[0]["pending"] = True
    control[0]["start_energy"] = np.nan
    return control


@shared
def new_lists(
    m: Minimizer,
    rigid: Any,
    origin: Origin | None,
    contacts: FrictionalContacts | None,
    box: Box | None,
    skin: float,
) -> tuple[Minimizer, Any, Any]:
    """The same with new lists, in more room where they need it; what frictional contacts hold is remembered before.

    ``rigid`` and ``contacts`` are RigidTerms and FrictionalContacts, or None where the scene has no such term.
    """
    contacts = committed(m, contacts, box)
    while True:
        answer = relist(m, box, rigid, skin)
        if answer == FIT:
            break
        if answer == RIGID_FULL:
            rigid = doubled(rigid)
        else:
            m = with_lists(m, longer(m.lists, answer))
    return m, rigid, relisted(m, origin, contacts, rigid, box)


@shared
def relist(m: Minimizer, box: Box | None, rigid: RigidTerms | None, skin: float) -> int:
    """Rebuild all lists and put every per-grain array in their order. Returns FIT, or which arrays are too short.

    Called between slices of ``fire.run``: lists are rebuilt hundreds of times less often than forces. In pieces, each of which is
    compiled once for scenes with these terms and without.
    """
    trouble = rebuild(m.state, m.grains.contact_stiffness, skin, m.lists, box)
    if trouble != FIT:
        return trouble
    reorder(
        m.state,
        m.velocity,
        m.inverse_mass,
        m.grains,
        m.identity,
        m.lists.order,
        m.scratch,
        m.scratch_identity,
    )
    if rigid is not None and not find_rigid_pairs(m.state, rigid, 0.5 * skin, box):
        return RIGID_FULL
    m.reference[:] = m.state
    m.control[0]["moved"] = 0.0
    m.control[0]["listed"] = True
    return FIT


@shared
def longer(lists: Lists, trouble: int) -> Lists:
    """Lists with twice the room where ``relist`` says that it was too little."""
    pairs, slots = lists.first.shape[0], lists.width.shape[0]
    if trouble == PAIRS_FULL:
        pairs *= 2
    else:
        slots *= 2
    return allocate(lists.degree.shape[0], pairs, slots, lists.half)


@shared
def with_lists(m: Minimizer, lists: Lists) -> Minimizer:
    """The same with other lists."""
    return Minimizer(
        m.state,
        m.velocity,
        m.force,
        m.inverse_mass,
        m.reference,
        m.support,
        m.grains,
        lists,
        m.identity,
        m.scratch,
        m.scratch_identity,
        m.control,
    )


@shared
def cross(m: Minimizer, rigid: RigidTerms, box: Box | None, crossed: np.ndarray) -> None:
    """Turn ``crossed`` (N, M) over for the grains that have gone through an edge since the lists were made."""
    changed = np.flatnonzero(changed_sides(m.reference, m.state, rigid, box))
    for k in changed:
        i, row = m.identity[rigid.grain[k]], rigid.primitive[k]
        crossed[i, row] = not crossed[i, row]

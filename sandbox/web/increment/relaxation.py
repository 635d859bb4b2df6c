"""From grains to a relaxation and back: ``core.relaxation.Relaxation`` in one call, from its first evaluation to its last."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core import fire, neighbors, rigid_contacts
from core.arrays import Floats
from core.friction import SPIN_MASS
from core.jit import kernel
from core.relaxation import SKIN_SPAN
from core.slip import TANGENTIAL_STIFFNESS
from core.steering import ALPHA_START, DT_START
from core.sweeps import collapsed
from sandbox.web.increment.frictional import Pulls, candidates, commit, ended, first_contacts
from sandbox.web.increment.material import area_modulus, deformation_stiffness, shape_modulus

CONTROL = fire.CONTROL
# Why a relaxation ended: as in ``fire``, and what only core.relaxation and core.quasistatic know.
CONVERGED, BUDGET, NOT_FINITE, COLLAPSED = (
    fire.CONVERGED,
    fire.BUDGET,
    fire.NOT_FINITE,
    fire.COLLAPSED,
)
ITERATION_LIMIT, SUNK = 5, 6


class Relaxed(NamedTuple):
    """How a relaxation ended. All in the packing's order."""

    reason: int
    iterations: int
    energy: float  # [k R²]
    residual: float
    scale: float  # mean contact force [k R]
    state: Floats  # (5, N) [R]
    turned: Floats  # (N,) [rad]; 0 without friction
    unbalanced: Floats  # (2, N) what is left of the force on each grain [k R]
    known: NDArray[np.int64]  # keys of contacts that remember a slip
    slips: Floats  # and those [R]
    pulls: Pulls


@kernel(allocates=True)
def lists_for(grains, pairs, slots, half):
    """``core.neighbors.allocate``."""
    pairs = max(8, pairs)
    laid_out = grains if slots else 0
    entries = (1 if half else 2) * pairs + neighbors.SLOT_PADDING * slots if slots else 0
    return neighbors.Lists(
        half,
        np.zeros(slots, np.int64),
        np.zeros(slots, np.int64),
        np.zeros(entries, np.uint32),
        np.zeros(entries),
        np.zeros(laid_out, np.int64),
        np.zeros(grains, np.int64),
        np.zeros(4 * grains + 32, np.int64),
        np.zeros(grains, np.int64),
        np.zeros((3, grains)),
        np.zeros(laid_out, np.int64),
        np.zeros(laid_out, np.int64),
        np.zeros(pairs, np.int64),
        np.zeros(pairs, np.int64),
        np.zeros(laid_out, np.int64),
        np.zeros(slots + 2, np.int64),
    )


@kernel(allocates=True)
def room_for(primitives, capacity):
    """Terms of ``core.rigid_contacts`` with room for so many pairs."""
    return rigid_contacts.RigidTerms(
        primitives,
        np.zeros(capacity, np.int64),
        np.zeros(capacity, np.int64),
        np.zeros(1, np.int64),
    )


@kernel(allocates=True)
def minimizer(grains, spins, dt_max):
    """``core.relaxation`` before the first evaluation."""
    count = grains.label.shape[0]
    rows = 6 if spins else 5
    inverse_mass = np.ones((rows, count))
    state = np.zeros((rows, count))
    state[:5] = grains.state
    rest_area, area_stiffness, shape_stiffness = np.empty(count), np.empty(count), np.empty(count)
    for i in range(count):
        nu, stiffness = grains.poisson_ratio[i], grains.contact_stiffness[i]
        rest_area[i] = grains.rest_radius[i] * grains.rest_radius[i]
        area_stiffness[i] = area_modulus(nu, stiffness) / rest_area[i]
        shape_stiffness[i] = 2.0 * shape_modulus(nu, stiffness)
        own = 2.0 * deformation_stiffness(nu, stiffness) * (1.0 + abs(nu))
        mass = fire.SHAPE_MASS * max(1.0, own / (fire.SHAPE_MASS * stiffness))
        for row in range(2, 5):
            inverse_mass[row, i] = 1.0 / mass
        if spins:
            inverse_mass[5, i] = 1.0 / (SPIN_MASS * rest_area[i])
    control = np.zeros(1, CONTROL)
    control[0].dt = DT_START * dt_max
    control[0].alpha = ALPHA_START
    control[0].pending = True
    control[0].start_energy = np.nan
    return fire.Minimizer(
        state,
        np.zeros((rows, count)),
        np.zeros((rows, count)),
        inverse_mass,
        np.zeros((rows, count)),
        np.zeros((3, count)),
        fire.Grains(grains.contact_stiffness.copy(), rest_area, area_stiffness, shape_stiffness),
        lists_for(count, 4 * count, 24, spins),
        np.arange(count),
        np.zeros(count),
        np.zeros(count, np.int64),
        control,
    )


@kernel(allocates=True)
def with_lists(m, lists):
    """The same with other lists."""
    return fire.Minimizer(
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


@kernel(allocates=True, forceinline=False)
def relist(m, box, rigid, skin):
    """``core.fire.relist``."""
    pairs = neighbors.find_pairs(m.state, skin, m.lists, box)
    if pairs < 0:
        return neighbors.PAIRS_FULL
    trouble = neighbors.lay_out(pairs, m.grains.contact_stiffness, m.lists)
    if trouble != neighbors.FIT:
        return trouble
    fire.reorder(
        m.state,
        m.velocity,
        m.inverse_mass,
        m.grains,
        m.identity,
        m.lists.order,
        m.scratch,
        m.scratch_identity,
    )
    if not rigid_contacts.find_rigid_pairs(m.state, rigid, 0.5 * skin, box):
        return neighbors.RIGID_FULL
    m.reference[:] = m.state
    m.control[0].moved = 0.0
    m.control[0].listed = True
    return neighbors.FIT


@kernel(forceinline=False)
def go_on(m, box, rigid, contacts, weight, limits, most):
    """``core.fire.run`` with or without friction."""
    if contacts is None:
        return fire.run(m, box, rigid, None, weight, limits, most, None)
    return fire.run(m, box, rigid, contacts.terms, weight, limits, most, None)


@kernel(allocates=True)
def cross(m, rigid, box, crossed):
    """Turn ``crossed`` (N, M) over for the grains that have gone through an edge since the lists were made."""
    changed = rigid_contacts.changed_sides(m.reference, m.state, rigid, box)
    for k in range(changed.shape[0]):
        if changed[k]:
            i, row = m.identity[rigid.grain[k]], rigid.primitive[k]
            crossed[i, row] = not crossed[i, row]


@kernel
def limits_of(grains, settings, rubs):
    """``core.fire.Limits`` for these grains."""
    stiffest, smallest, largest = 1.0, 1.0, 1.0
    for i in range(grains.label.shape[0]):
        stiffness, radius = grains.contact_stiffness[i], grains.rest_radius[i]
        stiffest = stiffness if i == 0 else max(stiffest, stiffness)
        smallest = radius if i == 0 else min(smallest, radius)
        largest = radius if i == 0 else max(largest, radius)
    if rubs:
        stiffest *= 1.0 + TANGENTIAL_STIFFNESS
    return fire.Limits(
        settings.tolerance,
        settings.force_floor * largest,
        fire.DT_FACTOR / np.sqrt(stiffest),
        0.1 * smallest,
        settings.skin * min(largest, SKIN_SPAN * smallest),
    )


@kernel(allocates=True, forceinline=False)
def relax(grains, primitives, origin, weight, settings, max_iterations, crossed):
    """Relax grains among bodies at rest, in an open box; ``origin`` is None where there is no friction.

    ``grains`` stay as they are. ``crossed`` (N, M): which grains have gone through which edges, turned over for each time.
    """
    box = None
    count = grains.label.shape[0]
    limits = limits_of(grains, settings, origin is not None)
    m = minimizer(grains, origin is not None, limits.dt_max)
    rigid = room_for(primitives, 64 + 2 * max(count, 1))
    contacts = first_contacts(origin, primitives)
    reason, iterations = BUDGET if count else CONVERGED, 0
    if not np.all(np.isfinite(grains.state)):
        reason = NOT_FINITE
    listed = False
    while reason == BUDGET and iterations < max_iterations:
        code, used = go_on(m, box, rigid, contacts, weight, limits, max_iterations - iterations)
        iterations += used
        if code != fire.LISTS_STALE:
            reason = code
            continue
        if listed:
            cross(m, rigid, box, crossed)
        listed = True
        contacts = commit(m, contacts, primitives, box)
        while True:
            answer = relist(m, box, rigid, limits.skin)
            if answer == neighbors.FIT:
                break
            pairs, slots = m.lists.first.shape[0], m.lists.width.shape[0]
            if answer == neighbors.RIGID_FULL:
                rigid = room_for(primitives, 2 * rigid.grain.shape[0])
                continue
            if answer == neighbors.PAIRS_FULL:
                pairs *= 2
            else:
                slots *= 2
            m = with_lists(m, lists_for(count, pairs, slots, m.lists.half))
        contacts = candidates(m, origin, contacts, rigid, box)
    if reason == BUDGET:
        reason = COLLAPSED if collapsed(m.state) else ITERATION_LIMIT
    if listed:
        cross(m, rigid, box, crossed)
    state, unbalanced, turned = np.empty((5, count)), np.empty((2, count)), np.zeros(count)
    for i in range(count):
        at = m.identity[i]
        for row in range(5):
            state[row, at] = m.state[row, i]
        unbalanced[0, at] = m.force[0, i]
        unbalanced[1, at] = m.force[1, i]
        if m.state.shape[0] > 5:
            turned[at] = m.state[5, i]
    known, kept, pulls = ended(m, contacts, primitives, box)
    control = m.control[0]
    return Relaxed(
        reason,
        iterations,
        control.energy,
        control.residual,
        control.scale,
        state,
        turned,
        unbalanced,
        known,
        kept,
        pulls,
    )

"""From grains to a relaxation and back: ``core.relaxation.Relaxation`` in one call, from its first evaluation to its last."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from core import fire, rigid_contacts
from core.arrays import Floats, aligned_zeros
from core.frictional_contacts import Pulls, ended
from core.jit import kernel
from core.minimizer import cross, limits_for, minimizer_for, new_lists
from core.sweeps import collapsed

# Why a relaxation ended: as in ``fire``, and what only core.relaxation and core.quasistatic know.
CONVERGED, BUDGET, NOT_FINITE, COLLAPSED = (
    fire.CONVERGED,
    fire.BUDGET,
    fire.NOT_FINITE,
    fire.COLLAPSED,
)
ITERATION_LIMIT, SUNK = 5, 6


def _plain_zeros(rows, columns):
    return np.zeros((rows, columns))


@overload(aligned_zeros, strict=False)
def _choose(rows, columns):
    """Where memory begins is for the page's allocator to say."""
    del rows, columns
    return _plain_zeros


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


def terms_of(contacts):
    """What FIRE wants to know of frictional contacts; None without friction."""
    return None if contacts is None else contacts.terms


@overload(terms_of)
def _by_kind(contacts):
    if isinstance(contacts, types.NoneType):
        return lambda contacts: contacts
    return lambda contacts: contacts.terms


@kernel(allocates=True)
def no_pulls():
    """None at all."""
    return Pulls(np.empty((3, 0), np.int64), np.empty((6, 0)), np.empty(0, np.bool_))


@kernel(allocates=True, forceinline=False)
def held_at_the_end(m, contacts, box):
    """What contacts remember, and the forces that they stand for; nothing without friction."""
    if contacts is None:
        return np.zeros(0, np.int64), np.zeros(0), no_pulls()
    return ended(m, contacts, box)


@kernel(allocates=True, forceinline=False)
def relax(grains, box, primitives, origin, contacts, weight, settings, max_iterations, crossed):
    """Relax grains among bodies at rest. ``box`` is None where the cell is open, ``origin`` and ``contacts`` where nothing rubs.

    ``grains`` stay as they are. ``crossed`` (N, M): which grains have gone through which edges, turned over for each time.
    """
    count, spins = grains.label.shape[0], origin is not None
    radius, ratio, stiffness = grains.rest_radius, grains.poisson_ratio, grains.contact_stiffness
    floor = settings.force_floor * (radius.max() if count else 1.0)
    limits = limits_for(radius, stiffness, spins, settings.tolerance, floor, settings.skin)
    m = minimizer_for(grains.state, radius, ratio, stiffness, spins, limits.dt_max)
    rigid = rigid_contacts.allocate(primitives, max(count, 1))
    reason, iterations = BUDGET if count else CONVERGED, 0
    if not np.all(np.isfinite(grains.state)):
        reason = NOT_FINITE
    listed = False
    while reason == BUDGET and iterations < max_iterations:
        terms, left = terms_of(contacts), max_iterations - iterations
        code, used = fire.run(m, box, rigid, terms, weight, limits, left, None)
        iterations += used
        if code != fire.LISTS_STALE:
            reason = code
            continue
        if listed:
            cross(m, rigid, box, crossed)
        listed = True
        m, rigid, contacts = new_lists(m, rigid, origin, contacts, box, limits.skin)
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
    known, kept, pulls = held_at_the_end(m, contacts, box)
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

"""What is to be seen and said after an increment, where a page reads it: ``sandbox.session.take_frame`` as kernels.

It changes nothing that an increment goes on from.
"""

from __future__ import annotations

import math

import numpy as np

from core import rigid_contacts
from core.jit import kernel
from core.observables import support_coefficients
from core.squeezed import AUXETIC_AREA, RING_AREA, RING_WALL
from sandbox.web.increment.bodies import rows_of
from sandbox.web.increment.contacts import (
    AT_X,
    AT_Y,
    DX,
    DY,
    FORCE,
    FX,
    FY,
    touching,
)
from sandbox.web.increment.falls import drive_of, remember
from sandbox.web.increment.increment import failed
from sandbox.web.increment.memory import (
    COUNTS,
    DRIVE,
    PART,
    ROW,
    SIZES,
    clear,
    counts_of,
    floats_at,
    ints_at,
    row_of,
    system_in,
)
from sandbox.web.increment.powers import power
from sandbox.web.increment.remarks import remark


@kernel(allocates=True)
def observe(kept):
    """All of it."""
    system = system_in(kept)
    rows = rows_of(system.bodies)
    contacts = touching(system.grains, rows, system.box)
    show(kept, system.grains.state, contacts, rows)
    measure_stress(kept, system.grains.state, contacts, rows)
    measure_grains(kept, system)
    remark(kept, system, contacts)
    remember(kept, system, contacts)
    trust(kept, system)


@kernel(allocates=True)
def show(kept, state, contacts, rows):
    """Contacts, those with bodies last; at a disc the line ends where they touch, though the force acts at its centre."""
    counts, room = counts_of(kept), kept.ints[SIZES.contacts]
    first, second = ints_at(kept, PART.first, room), ints_at(kept, PART.second, room)
    force, ends = floats_at(kept, PART.force, room), floats_at(kept, PART.ends, 2 * room)
    pairs = min(contacts.i.shape[0], room)
    shown = min(pairs + contacts.grain.shape[0], room)
    for k in range(pairs):
        first[k] = contacts.i[k]
        second[k] = contacts.j[k]
        force[k] = contacts.pair[FORCE, k]
    for k in range(shown - pairs):
        i, m = contacts.grain[k], contacts.primitive[k]
        x, y = contacts.body[AT_X, k], contacts.body[AT_Y, k]
        if rows[m, 0] == rigid_contacts.DISC:
            dx, dy = state[0, i] - x, state[1, i] - y
            share = rows[m, 7] / max(math.sqrt(dx * dx + dy * dy), 1e-12)
            x += share * dx
            y += share * dy
        first[pairs + k] = i
        second[pairs + k] = -1
        force[pairs + k] = contacts.body[FORCE, k]
        ends[pairs + k] = x
        ends[room + pairs + k] = y
    counts[COUNTS.pairs] = pairs
    counts[COUNTS.shown] = shown


@kernel
def press(stress, support, i, force, nx, ny):
    """Add what a contact of grain ``i`` with that normal does to Σ f h and to Σ f h n⊗n, (3, N) [k R²]."""
    square = max(nx * nx + ny * ny, 1e-290)
    c2, s2 = (nx * nx - ny * ny) / square, 2.0 * nx * ny / square
    work = force * math.sqrt(max(support[0, i] + support[1, i] * c2 + support[2, i] * s2, 0.0))
    stress[0, i] += work
    stress[1, i] += work * c2
    stress[2, i] += work * s2


@kernel(allocates=True)
def measure_stress(kept, state, contacts, rows):
    """``core.observables.grain_stress``: pressure, and the difference of the principal stresses [k]."""
    n = state.shape[1]
    support, stress = support_coefficients(state), np.zeros((3, n))
    for k in range(contacts.i.shape[0]):
        dx, dy, force = contacts.pair[DX, k], contacts.pair[DY, k], contacts.pair[FORCE, k]
        press(stress, support, contacts.i[k], force, dx, dy)
        press(stress, support, contacts.j[k], force, dx, dy)
    for k in range(contacts.grain.shape[0]):
        i, nx, ny = contacts.grain[k], contacts.body[FX, k], contacts.body[FY, k]
        if rows[contacts.primitive[k], 0] == rigid_contacts.DISC:
            # A disc's force has a tangential part; its normal runs through both centres.
            nx, ny = state[0, i] - contacts.body[AT_X, k], state[1, i] - contacts.body[AT_Y, k]
        press(stress, support, i, contacts.body[FORCE, k], nx, ny)
    pressure = floats_at(kept, PART.pressure, n)
    difference = floats_at(kept, PART.difference, n)
    for i in range(n):
        p, q1, q2 = state[2, i], state[3, i], state[4, i]
        twice = max(2.0 * math.pi * (p * p - q1 * q1 - q2 * q2), 1e-290)
        pressure[i] = stress[0, i] / twice
        deviator = math.sqrt(stress[1, i] * stress[1, i] + stress[2, i] * stress[2, i])
        difference[i] = 2.0 * deviator / twice


@kernel
def error(bound, contact_force, left, moved):
    """``scenes.accuracy.Bound.error`` [k R]."""
    if contact_force <= 0.0:
        return 0.0
    return bound[0] * contact_force * power(left / contact_force, bound[1]) * power(moved, bound[2])


@kernel(allocates=True)
def trust(kept, system):
    """How far off the force on the handle may be, over its mean magnitude so far (``scenes.accuracy.Estimate.errors``)."""
    counts, row, last = counts_of(kept), row_of(kept), system.past.last
    bounds = floats_at(kept, PART.accuracy, 6).reshape(2, 3)
    farthest = 0.0
    for i in range(last.shape[1]):
        farthest = max(farthest, last[0, i] * last[0, i] + last[1, i] * last[1, i])
    moved = max(math.sqrt(farthest) / system.settings.step, 1.0)
    left = max(row[ROW.unbalanced], row[ROW.residual] * row[ROW.scale])
    mean = drive_of(kept)[DRIVE.felt] / counts[COUNTS.rows]
    usual = error(bounds[0], row[ROW.scale], left, moved)
    most = max(usual, error(bounds[1], row[ROW.scale], left, moved))
    known = mean > 0.0 and not failed(counts[COUNTS.reason])
    row[ROW.usual_error] = usual / mean if known else np.nan
    row[ROW.force_error] = most / mean if known else np.nan


@kernel(allocates=True)
def measure_grains(kept, system):
    """How far each has moved against the mean of all [R], and whether one is squeezed too far (``core.squeezed``)."""
    grains, last = system.grains, system.past.last
    n = grains.label.shape[0]
    motion, squeezed = floats_at(kept, PART.motion, n), ints_at(kept, PART.squeezed, n)
    clear(squeezed)
    mean_x, mean_y = 0.0, 0.0
    for i in range(n):
        mean_x += last[0, i] / n
        mean_y += last[1, i] / n
    for i in range(n):
        dx, dy = last[0, i] - mean_x, last[1, i] - mean_y
        motion[i] = math.sqrt(dx * dx + dy * dy)
        rest, q1, q2 = grains.rest_radius[i], grains.state[3, i], grains.state[4, i]
        mean, stretch = grains.state[2, i] / rest, math.sqrt(q1 * q1 + q2 * q2) / rest
        area = mean * mean - stretch * stretch
        if grains.poisson_ratio[i] < 0.0:
            squeezed[i] = 1 if area <= AUXETIC_AREA else 0
        elif mean - stretch <= RING_WALL or area <= RING_AREA:
            squeezed[i] = 1

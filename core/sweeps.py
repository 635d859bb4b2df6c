"""One pass over all grains: forces, and what FIRE does with velocities and coordinates between two evaluations.

Element-wise passes and largest values come out the same however the arrays are cut. Sums do not: they are taken chunk by chunk,
and the chunks added in their order, so that a relaxation has the same bits on one thread and on several (``core.threads``).
"""

from __future__ import annotations

import math

import numpy as np

from core.contacts import add_contact_forces
from core.elasticity import add_guard, finish
from core.frictional_pairs import add_pairs, react, receive
from core.jit import kernel
from core.slip import finish_friction

CHUNK = 1024  # grains


@kernel(fastmath=False)
def add(total, part):
    """total + part. Without fast math, so that no compiler may regroup a row of these."""
    return total + part


@kernel(noalias=True)
def kick(velocity, force, inverse_mass, keep, push):
    """v ← keep v + push F/m."""
    for i in range(velocity.shape[0]):
        velocity[i] = keep * velocity[i] + push * force[i] * inverse_mass[i]


@kernel(noalias=True)
def drift(state, velocity, dt):
    """x ← x + dt v."""
    for i in range(state.shape[0]):
        state[i] += dt * velocity[i]


@kernel
def largest(bits):
    """max |value| from the bits (n,) int64 of float64: integers order as the numbers do, nan above all, and vectorise."""
    most = np.int64(0)
    for i in range(bits.shape[0]):
        magnitude = bits[i] & np.int64(0x7FFFFFFFFFFFFFFF)
        most = max(most, magnitude)
    return most


@kernel(noalias=True)
def second_kick(velocity, force, inverse_mass, half_dt):
    """v ← v + dt/2 F/m. Returns (F·v, Σ F²/m, Σ m v²)."""
    power = 0.0
    force_square = 0.0
    speed_square = 0.0
    for i in range(velocity.shape[0]):
        f = force[i]
        weighted = f * inverse_mass[i]
        v = velocity[i] + half_dt * weighted
        velocity[i] = v
        power += f * v
        force_square += f * weighted
        speed_square += v * v / inverse_mass[i]
    return power, force_square, speed_square


@kernel
def first_kick(velocity, force, inverse_mass, keep, push, chunk):
    """``kick`` of all; returns the bits of the largest velocity."""
    most = np.int64(0)
    for begin in range(0, velocity.shape[0], chunk):
        end = min(begin + chunk, velocity.shape[0])
        kick(velocity[begin:end], force[begin:end], inverse_mass[begin:end], keep, push)
        most = max(most, largest(velocity[begin:end].view(np.int64)))
    return most


@kernel
def last_kick(velocity, force, inverse_mass, half_dt, chunk):
    """``second_kick`` of all. Returns (F·v, Σ F²/m, Σ m v², bits of the largest force)."""
    power = 0.0
    force_square = 0.0
    speed_square = 0.0
    most = np.int64(0)
    for begin in range(0, velocity.shape[0], chunk):
        end = min(begin + chunk, velocity.shape[0])
        p, f, v = second_kick(
            velocity[begin:end], force[begin:end], inverse_mass[begin:end], half_dt
        )
        power = add(power, p)
        force_square = add(force_square, f)
        speed_square = add(speed_square, v)
        most = max(most, largest(force[begin:end].view(np.int64)))
    return power, force_square, speed_square, most


@kernel
def chunk_forces(
    begin,
    end,
    state,
    support,
    force,
    width,
    offset,
    neighbor,
    stiffness,
    rest_area,
    area_stiffness,
    shape_stiffness,
    box,
    friction,
):
    """Contacts and elasticity of the grains from ``begin`` to ``end`` into ``force``; returns their energy [k R²].

    With friction the pairs have been gone through before, and their energy counted.
    """
    energy = 0.0
    p, q1, q2 = state[2, begin:end], state[3, begin:end], state[4, begin:end]
    fp, fq1, fq2 = force[2, begin:end], force[3, begin:end], force[4, begin:end]
    if friction is None:
        energy = add_contact_forces(
            begin, end, state, support, force, width, offset, neighbor, stiffness, box
        )
    else:
        sums = friction.sums
        pulls, deep = sums[0, begin:end], sums[1, begin:end]
        fx, fy = force[0, begin:end], force[1, begin:end]
        receive(friction.received[begin:end], fx, fy, fp, fq1, fq2, pulls, deep)
    area = rest_area[begin:end]
    own, small = finish(
        p, q1, q2, area, area_stiffness[begin:end], shape_stiffness[begin:end], fp, fq1, fq2
    )
    if small > 0.0:
        own += add_guard(p, q1, q2, area, fp, fq1, fq2)
    if friction is not None:
        finish_friction(p, q1, q2, pulls, deep, fq1, fq2, force[5, begin:end])
    return energy + own


@kernel
def all_forces(
    state,
    support,
    force,
    width,
    offset,
    neighbor,
    stiffness,
    rest_area,
    area_stiffness,
    shape_stiffness,
    box,
    friction,
):
    """``chunk_forces`` of all grains, with friction after their pairs."""
    energy = 0.0
    if friction is not None:
        for begin in range(0, state.shape[1], CHUNK):
            end = min(begin + CHUNK, state.shape[1])
            pairs = add_pairs(
                begin, end, state, support, force, width, offset, neighbor, stiffness, box, friction
            )
            energy = add(energy, pairs)
        react(neighbor, friction)
    for begin in range(0, state.shape[1], CHUNK):
        energy = add(
            energy,
            chunk_forces(
                begin,
                min(begin + CHUNK, state.shape[1]),
                state,
                support,
                force,
                width,
                offset,
                neighbor,
                stiffness,
                rest_area,
                area_stiffness,
                shape_stiffness,
                box,
                friction,
            ),
        )
    return energy


@kernel
def farthest(state, reference):
    """Upper bound of what any grain has moved plus grown since the lists were built [R]."""
    most = 0.0
    for i in range(state.shape[1]):
        dx = state[0, i] - reference[0, i]
        dy = state[1, i] - reference[1, i]
        dp = state[2, i] - reference[2, i]
        d1 = state[3, i] - reference[3, i]
        d2 = state[4, i] - reference[4, i]
        moved = math.sqrt(dx * dx + dy * dy) + abs(dp) + math.sqrt(d1 * d1 + d2 * d2)
        if not moved <= most:
            most = moved
    return most


@kernel
def collapsed(state):
    """True if some grain's shorter semi-axis is not greater than 0 (also when it is nan)."""
    flat = False
    for i in range(state.shape[1]):
        flat |= not state[2, i] > math.sqrt(state[3, i] ** 2 + state[4, i] ** 2)
    return flat


@kernel
def permute(values, order, scratch):
    """values ← values[order], in place."""
    for i in range(order.shape[0]):
        scratch[i] = values[order[i]]
    for i in range(order.shape[0]):
        values[i] = scratch[i]

"""The passes of a relaxation shared out to several threads: for some thousand grains and more, where one is asked for.

Every chunk writes its sums to a place of its own, and one thread adds them up in order: not a bit depends on how many threads
there are. A relaxation on one thread uses none of this, and nothing here is compiled for it.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numba
import numpy as np
from numba import prange
from numpy.typing import NDArray

from core.contacts import prepare
from core.errors import InputError
from core.frictional_pairs import add_pairs, react
from core.jit import kernel
from core.slip import prepare_friction
from core.sweeps import CHUNK, add, chunk_forces, drift, kick, largest, second_kick

# A thread of OpenMP's pool that has nothing to do shall sleep: by default it spins, and where other programs want the core too
# every pass then waits for its turn. Read when the pool is made.
_IDLE = ("OMP_WAIT_POLICY", "PASSIVE")
# Some of Numba's thread pools serve one caller at a time, and end the process when a second one comes.
_ONE_AT_A_TIME = threading.Lock()


class Shared(NamedTuple):
    """Where threads leave what they have summed up, one row a chunk."""

    sums: NDArray[np.float64]  # (chunks, 3)
    most: NDArray[np.int64]  # (chunks,) bits of largest values


def most_threads() -> int:
    """How many threads Numba can use on this machine."""
    config: Any = numba.config
    return int(config.NUMBA_NUM_THREADS)


def share(threads: int, grains: int) -> Shared | None:
    """Room for that many threads; None for one. Raises InputError if the machine has not so many."""
    most = most_threads()
    if not 1 <= threads <= most:
        raise InputError(f"the number of threads must lie between 1 and {most} on this machine")
    chunks = max(1, -(-grains // CHUNK))
    return None if threads == 1 else Shared(np.zeros((chunks, 3)), np.zeros(chunks, dtype=np.int64))


@contextmanager
def running(threads: int) -> Iterator[None]:
    """Kernels called inside run on so many threads."""
    if threads == 1:
        yield
        return
    os.environ.setdefault(*_IDLE)
    with _ONE_AT_A_TIME:
        numba.set_num_threads(threads)
        yield


@kernel(parallel=True, forceinline=False, allocates=True)
def first_kick(velocity, force, inverse_mass, keep, push, chunk, most):
    """As ``sweeps.first_kick``."""
    count = velocity.shape[0]
    for c in prange((count + chunk - 1) // chunk):
        begin = c * chunk
        end = min(begin + chunk, count)
        kick(velocity[begin:end], force[begin:end], inverse_mass[begin:end], keep, push)
        most[c] = largest(velocity[begin:end].view(np.int64))
    return largest(most)


@kernel(parallel=True, forceinline=False, allocates=True)
def move(state, velocity, dt, support, force, friction):
    """As ``sweeps.drift``, then as ``contacts.prepare``."""
    count = state.shape[1]
    for c in prange((count + CHUNK - 1) // CHUNK):
        begin = c * CHUNK
        end = min(begin + CHUNK, count)
        for row in range(state.shape[0]):
            drift(state[row, begin:end], velocity[row, begin:end], dt)
        prepare(
            state[2, begin:end],
            state[3, begin:end],
            state[4, begin:end],
            support[0, begin:end],
            support[1, begin:end],
            support[2, begin:end],
            force[0, begin:end],
            force[1, begin:end],
            force[2, begin:end],
            force[3, begin:end],
            force[4, begin:end],
        )
        if friction is not None:
            prepare_friction(begin, end, state, friction)


@kernel(parallel=True, forceinline=False, allocates=True)
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
    sums,
):
    """As ``sweeps.all_forces``."""
    count = state.shape[1]
    chunks = (count + CHUNK - 1) // CHUNK
    energy = 0.0
    if friction is not None:
        for c in prange(chunks):
            begin = c * CHUNK
            end = min(begin + CHUNK, count)
            sums[c, 0] = add_pairs(
                begin, end, state, support, force, width, offset, neighbor, stiffness, box, friction
            )
        for c in range(chunks):
            energy = add(energy, sums[c, 0])
        react(neighbor, friction)
    for c in prange(chunks):
        sums[c, 0] = chunk_forces(
            c * CHUNK,
            min((c + 1) * CHUNK, count),
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
        )
    for c in range(chunks):
        energy = add(energy, sums[c, 0])
    return energy


@kernel(parallel=True, forceinline=False, allocates=True)
def last_kick(velocity, force, inverse_mass, half_dt, chunk, sums, most):
    """As ``sweeps.last_kick``."""
    count = velocity.shape[0]
    chunks = (count + chunk - 1) // chunk
    for c in prange(chunks):
        begin = c * chunk
        end = min(begin + chunk, count)
        sums[c, 0], sums[c, 1], sums[c, 2] = second_kick(
            velocity[begin:end], force[begin:end], inverse_mass[begin:end], half_dt
        )
        most[c] = largest(force[begin:end].view(np.int64))
    power = 0.0
    force_square = 0.0
    speed_square = 0.0
    for c in range(chunks):
        power = add(power, sums[c, 0])
        force_square = add(force_square, sums[c, 1])
        speed_square = add(speed_square, sums[c, 2])
    return power, force_square, speed_square, largest(most)

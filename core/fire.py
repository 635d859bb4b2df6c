"""FIRE: the inertial minimiser that relaxes a packing to mechanical equilibrium.

Bitzek et al., doi:10.1103/PhysRevLett.97.170201, in velocity-Verlet order. The grains are given inertia and pushed downhill;
velocity is turned towards the force, and thrown away where it no longer goes downhill (``core.steering``).

Inertia is a preconditioner here, not physics: dt is fixed by the contact stiffness, dt_max = DT_FACTOR √(1/C), and a degree of
freedom that is stiffer than a contact is made heavier in proportion (``inverse_mass``). So nothing is tuned by hand per scene.

Everything that a relaxation needs from one call to the next stands in ``Minimizer``: cut into any number of calls, it takes the
same steps to the last bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core import sweeps, threads
from core.contacts import prepare, slot_force_sum
from core.jit import kernel
from core.neighbors import Lists
from core.rigid_contacts import add_rigid_forces, image, touch
from core.slip import prepare_friction
from core.steering import steer
from core.sweeps import CHUNK, add, collapsed, drift, farthest, permute

CONVERGED, BUDGET, NOT_FINITE, COLLAPSED, LISTS_STALE = 0, 1, 2, 3, 4

DT_FACTOR = 0.6  # of √(m / C k); velocity Verlet is stable to about 0.7
SHAPE_MASS = 4.0  # inertia of p, q1, q2 relative to x, y
SCALE_EVERY = 50  # iterations between looks at the mean contact force

# What a relaxation needs to know from one call to the next, ``Minimizer.control[0]``: a record, as kernels can write into it.
_CONTROL = {
    "dt": "f8",
    "alpha": "f8",
    "keep": "f8",  # of the velocity at the next kick
    "push": "f8",  # of the force over the inertia
    "moved": "f8",  # a bound on how far any grain has come since the lists were made [R]
    "scale": "f8",  # mean contact force [k R]
    "countdown": "i8",  # iterations until that is looked at again
    "energy": "f8",  # [k R²]
    "start_energy": "f8",  # nan before the first evaluation
    "residual": "f8",
    "fastest": "f8",  # largest velocity, later largest force, of any degree of freedom
    "fastest_bits": "i8",  # the same place: sweeps find the largest by its bits
    "listed": "?",  # are the lists good?
    "pending": "?",  # a step is made whose forces are not computed yet
}
CONTROL = np.dtype(
    {
        "names": list(_CONTROL),
        "formats": list(_CONTROL.values()),
        "offsets": [*range(0, 88, 8), 80, 88, 89],
        "itemsize": 96,
    }
)


class Grains(NamedTuple):
    """Material of each grain as the kernels want it, (N,)."""

    contact_stiffness: NDArray[np.float64]  # C [k]
    rest_area: NDArray[np.float64]  # A0 = R0² [R²]
    area_stiffness: NDArray[np.float64]  # κ(1+ν)/A0 [k/R²]
    shape_stiffness: NDArray[np.float64]  # 2κ(1−ν) [k]


class Minimizer(NamedTuple):
    """Arrays of one relaxation. All per-grain arrays stand in the order that the neighbour lists want.

    D is 5, or 6 with friction: row 5 is then how far each grain has turned since the start of the increment [rad].
    """

    state: NDArray[np.float64]  # (D, N) x, y, p, q1, q2 [R]
    velocity: NDArray[np.float64]  # (D, N)
    force: NDArray[np.float64]  # (D, N) [k R]
    inverse_mass: NDArray[np.float64]  # (D, N)
    reference: NDArray[np.float64]  # (D, N) state when the lists were built
    support: NDArray[np.float64]  # (3, N)
    grains: Grains
    lists: Lists
    identity: NDArray[np.int64]  # (N,) place of each grain in the packing
    scratch: NDArray[np.float64]  # (N,)
    scratch_identity: NDArray[np.int64]  # (N,)
    control: NDArray[np.void]  # (1,) of CONTROL


class Weight(NamedTuple):
    """Body forces on the grains, in proportion to their rest areas R0²."""

    x: float  # gravity [k/R]
    y: float
    drag: float  # [k/R²] against the way from ``start``: how fast grains fall that nothing holds
    start: NDArray[
        np.float64
    ]  # (2, N) centres when the relaxation began, in the packing's order [R]


class Limits(NamedTuple):
    """Numbers that bound a relaxation."""

    tolerance: float  # on max |generalised force| over the mean contact force
    force_floor: float  # least mean contact force that counts [k R]
    dt_max: float
    clamp: float  # largest displacement of any degree of freedom in one iteration [R]
    skin: float  # [R]


@kernel
def reorder(state, velocity, inverse_mass, grains, identity, order, scratch, scratch_identity):
    """Put every per-grain array into the order of new lists."""
    for row in range(state.shape[0]):
        permute(state[row], order, scratch)
        permute(velocity[row], order, scratch)
        permute(inverse_mass[row], order, scratch)
    permute(grains.contact_stiffness, order, scratch)
    permute(grains.rest_area, order, scratch)
    permute(grains.area_stiffness, order, scratch)
    permute(grains.shape_stiffness, order, scratch)
    permute(identity, order, scratch_identity)


@kernel
def add_weight(x, y, rest_area, identity, fx, fy, weight):
    """Weights and drags [k R] into fx, fy; returns their potential energy [k R²]."""
    energy = 0.0
    gx, gy, drag = weight.x, weight.y, weight.drag
    start_x, start_y = weight.start[0], weight.start[1]
    for i in range(x.shape[0]):
        dx = x[i] - start_x[identity[i]]
        dy = y[i] - start_y[identity[i]]
        fx[i] += rest_area[i] * (gx - drag * dx)
        fy[i] += rest_area[i] * (gy - drag * dy)
        energy += rest_area[i] * (0.5 * drag * (dx * dx + dy * dy) - gx * x[i] - gy * y[i])
    return energy


@kernel
def evaluate(m, box, rigid, friction, gravity, shared):
    """Forces of every term that the scene has, into ``force``; returns the energy [k R²].

    Several threads have prepared for it when they moved the grains.
    """
    state, support, force = m.state, m.support, m.force
    lists, grains = m.lists, m.grains
    if shared is None:
        prepare(
            state[2],
            state[3],
            state[4],
            support[0],
            support[1],
            support[2],
            force[0],
            force[1],
            force[2],
            force[3],
            force[4],
        )
        if friction is not None:
            prepare_friction(0, state.shape[1], state, friction)
    energy = 0.0
    if rigid is not None:
        energy += add_rigid_forces(
            state, support, grains.contact_stiffness, force, rigid, box, friction
        )
    if gravity is not None:
        energy += add_weight(
            state[0], state[1], grains.rest_area, m.identity, force[0], force[1], gravity
        )
    # It turns the contact sums into forces.
    if shared is None:
        own = sweeps.all_forces(
            state,
            support,
            force,
            lists.width,
            lists.offset,
            lists.neighbor,
            lists.stiffness,
            grains.rest_area,
            grains.area_stiffness,
            grains.shape_stiffness,
            box,
            friction,
        )
    else:
        own = threads.all_forces(
            state,
            support,
            force,
            lists.width,
            lists.offset,
            lists.neighbor,
            lists.stiffness,
            grains.rest_area,
            grains.area_stiffness,
            grains.shape_stiffness,
            box,
            friction,
            shared.sums,
        )
    return add(energy, own)


@kernel
def mean_contact_force(m, box, rigid):
    """Mean normal force of all contacts that carry one [k R]; 0 where there is none."""
    state, support = m.state, m.support
    width, offset = m.lists.width, m.lists.offset
    neighbor, stiffness = m.lists.neighbor, m.lists.stiffness
    total = 0.0
    contacts = 0.0
    share = 1.0 if m.lists.half else 0.5  # of an entry in a pair
    for t in range(width.shape[0]):
        n = width[t]
        if n == 0:
            break
        first = offset[t]
        force, number = slot_force_sum(
            neighbor[first : first + n],
            stiffness[first : first + n],
            state[0],
            state[1],
            support[0],
            support[1],
            support[2],
            box,
        )
        total += share * force
        contacts += share * number
    if rigid is not None:
        primitives, grain, primitive = rigid.primitives, rigid.grain, rigid.primitive
        contact_stiffness = m.grains.contact_stiffness
        for k in range(rigid.used[0]):
            i = grain[k]
            x, y = image(primitives, primitive[k], state[0, i], state[1, i], box)
            s, u, v = support[0, i], support[1, i], support[2, i]
            overlap = touch(primitives, primitive[k], x, y, s, u, v)[0]
            if overlap > 0.0:
                total += contact_stiffness[i] * overlap
                contacts += 1.0
    return total / contacts if contacts > 0.0 else 0.0


@kernel
def run(m, box, rigid, friction, gravity, limits, max_iterations, shared):
    """Relax for at most ``max_iterations`` force evaluations. Returns (reason, evaluations); after LISTS_STALE make new lists.

    ``box``, ``rigid``, ``friction`` and ``gravity`` are None where the scene has no such term, ``shared`` where one thread does
    it all; then no code for it exists.
    """
    control = m.control[0]
    state = m.state.reshape(-1)
    velocity = m.velocity.reshape(-1)
    force = m.force.reshape(-1)
    inverse_mass = m.inverse_mass.reshape(-1)
    chunk = CHUNK * m.state.shape[0]
    for iteration in range(max_iterations):
        dt = control.dt
        if not control.pending:
            keep, push = control.keep, control.push
            if shared is None:
                control.fastest_bits = sweeps.first_kick(
                    velocity, force, inverse_mass, keep, push, chunk
                )
            else:
                control.fastest_bits = threads.first_kick(
                    velocity, force, inverse_mass, keep, push, chunk, shared.most
                )
            fastest = control.fastest
            step = dt if fastest * dt <= limits.clamp else limits.clamp / fastest
            if shared is None:
                drift(state, velocity, step)
            else:
                threads.move(m.state, m.velocity, step, m.support, m.force, friction)
            # 4 × the largest change of any degree of freedom bounds displacement plus growth of one grain.
            control.moved += 4.0 * step * fastest
            if not control.moved <= 0.5 * limits.skin:
                control.moved = farthest(m.state, m.reference)
                if not control.moved <= 0.5 * limits.skin:
                    control.listed = False
        if not control.listed:
            control.pending = True  # the step is made; its forces wait for the new lists
            return LISTS_STALE, iteration
        if shared is not None and control.pending:
            threads.move(m.state, m.velocity, 0.0, m.support, m.force, friction)
        control.pending = False
        control.energy = evaluate(m, box, rigid, friction, gravity, shared)
        if np.isnan(control.start_energy):
            control.start_energy = control.energy
        if shared is None:
            power, force_square, speed_square, most = sweeps.last_kick(
                velocity, force, inverse_mass, 0.5 * dt, chunk
            )
        else:
            power, force_square, speed_square, most = threads.last_kick(
                velocity, force, inverse_mass, 0.5 * dt, chunk, shared.sums, shared.most
            )
        control.fastest_bits = most
        largest_force = control.fastest
        # Not isfinite: it is compiled to v - v == 0, which the licence to reorder sums turns into "true" for a sum.
        if not abs(power + force_square + speed_square + control.energy) < np.inf:
            control.residual = np.nan
            return NOT_FINITE, iteration + 1
        control.countdown -= 1
        if control.countdown <= 0 or largest_force <= limits.tolerance * control.scale:
            control.countdown = SCALE_EVERY
            control.scale = max(mean_contact_force(m, box, rigid), limits.force_floor)
        control.residual = largest_force / control.scale
        if control.residual <= limits.tolerance:
            # Asked here only: a grain that is flat on the way is pushed back by the guard of its area.
            return COLLAPSED if collapsed(m.state) else CONVERGED, iteration + 1
        control.dt, control.alpha, control.keep, control.push = steer(
            power, force_square, speed_square, dt, control.alpha, limits.dt_max
        )
    return BUDGET, max_iterations

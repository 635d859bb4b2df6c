"""Forces between grains that rub: every pair once, and what it does to either of its grains. Equations: ``contacts``, ``slip``.

Slots as in ``contacts``, but of HALF a neighbour list: with friction a pair costs so much more that it pays to put the reaction
on the other grain where that stands. The entries of a slot are gone through twice, since one loop would be too long a chain of
operations for a processor to have several grains under way: ``meet`` finds out how two grains touch and leaves that in the
entry's column of ``FrictionTerms.reactions``; ``rub`` makes forces of it, adds them to the first grain, and leaves there what
the second one gets. When all pairs are done, ``react`` adds that up. It goes through the entries in their order, whoever
computed them, so not a bit depends on the number of threads.
"""

from __future__ import annotations

import math

import numpy as np

from core.jit import kernel
from core.periodic import COINCIDENT, nearest
from core.scatter import WIDTH, add_columns
from core.slip import TANGENTIAL_STIFFNESS, TOUCHED, cut, own_way, pair_slip


@kernel(noalias=True)
def meet(neighbor, state, support, change, marks, box, begin, first, found):
    """How n grains, the first of which stands at ``begin``, touch their neighbours in one slot.

    Of the slot's entries the first is entry ``first`` of ``marks``. Into the seven arrays (n,) of ``found``: the unit vector to
    the neighbour, the overlap [R], 1/h of both [1/R], (h_i′ + h_j′)/r, and the slip u [R], not yet cut.
    Where two centres coincide n is 0: the pair then has an energy but no force on its centres, and nothing becomes nan.
    """
    nx, ny, overlap, inverse_hi, inverse_hj, slope, slip = found
    for t in range(neighbor.shape[0]):
        # Unsigned, as an index that might be negative would have to be asked each time.
        i = np.uint64(begin + t)
        j = neighbor[t]
        e = np.uint64(first + t)
        dx, dy = nearest(state[0, j] - state[0, i], state[1, j] - state[1, i], box)
        ui = support[1, i]
        vi = support[2, i]
        uj = support[1, j]
        vj = support[2, j]
        # Roots and divisions set the pace. With r h for h roots need not wait for a division, and one is enough for all.
        r2 = dx * dx + dy * dy + COINCIDENT
        c2 = dx * dx - dy * dy
        s2 = 2.0 * dx * dy
        r = math.sqrt(r2)
        hi = math.sqrt(support[0, i] * r2 + ui * c2 + vi * s2)
        hj = math.sqrt(support[0, j] * r2 + uj * c2 + vj * s2)
        depth = hi + hj - r2
        # Not max(0, depth): that is 0 for nan, and nan must go on meaning nan.
        depth = 0.0 if depth <= 0.0 else depth  # noqa: FURB136
        reached = depth + (marks[1, e] + TOUCHED) * r
        both = hi * hj
        share = 1.0 / (both * r2 * reached)
        touched = depth * both * r2 * share
        inverse2 = both * reached * share
        inverse = r * inverse2
        share *= r2 * reached * r
        by_i = hj * share
        by_j = hi * share
        c2 *= inverse2
        s2 *= inverse2
        depth *= inverse
        nx[t] = dx * inverse
        ny[t] = dy * inverse
        overlap[t] = depth
        inverse_hi[t] = by_i
        inverse_hj[t] = by_j
        slope[t] = (by_i * (vi * c2 - ui * s2) + by_j * (vj * c2 - uj * s2)) * inverse
        slip[t] = pair_slip(
            (dx * (dy - marks[3, e]) - dy * (dx - marks[2, e])) * inverse,
            depth,
            touched,
            marks[0, e],
            own_way(change[0, i], change[1, i], change[2, i], c2, s2) * by_i,
            own_way(change[0, j], change[1, j], change[2, j], c2, s2) * by_j,
            change[3, i],
            change[3, j],
        )


@kernel(noalias=True)
def rub(stiffness, coefficient, found, sums):
    """Add to the ``sums`` fx, fy, A, B, D, P, Q of n grains what their neighbours in one slot do to them; the energy [k R²].

    ``found`` (n,) each is what ``meet`` has left there, and then what is to be added to the sums of the neighbours.
    """
    to_x, to_y, to_a, to_b, to_d, to_pulls, to_deep = found
    fx, fy, a, b, d, pulls, deep = sums
    energy = 0.0
    for t in range(stiffness.shape[0]):
        nx = to_x[t]
        ny = to_y[t]
        overlap = to_a[t]
        inverse_hi = to_b[t]
        inverse_hj = to_d[t]
        c2 = nx * nx - ny * ny
        s2 = 2.0 * nx * ny
        f = stiffness[t] * overlap
        slip, _ = cut(to_deep[t], overlap, coefficient)
        pull = TANGENTIAL_STIFFNESS * stiffness[t] * slip
        energy += 0.5 * (f * overlap + pull * slip)
        across = f * to_pulls[t] - pull
        px = f * nx + across * ny
        py = f * ny - across * nx
        fi = f * inverse_hi
        fj = f * inverse_hj
        gi = pull * inverse_hi
        gj = pull * inverse_hj
        lever = 0.5 * pull * overlap
        fx[t] -= px
        fy[t] -= py
        a[t] += fi
        b[t] += fi * c2 - gi * s2
        d[t] += fi * s2 + gi * c2
        pulls[t] += gi
        deep[t] += lever
        to_x[t] = px
        to_y[t] = py
        to_a[t] = fj
        to_b[t] = fj * c2 - gj * s2
        to_d[t] = fj * s2 + gj * c2
        to_pulls[t] = gj
        to_deep[t] = lever
    return energy


@kernel
def add_pairs(begin, end, state, support, force, width, offset, neighbor, stiffness, box, friction):
    """Add to ``force`` and ``friction.sums`` what the pairs listed with the grains from ``begin`` to ``end`` do to these.

    Returns the energy of the pairs [k R²], and leaves for ``react`` what they do to their other grains.
    """
    energy = 0.0
    change, marks, own, r = friction.change, friction.marks, friction.sums, friction.reactions
    for t in range(width.shape[0]):
        i, j = begin, min(width[t], end)
        if j <= i:
            break
        e, g = offset[t] + i, offset[t] + j
        found = (r[0, e:g], r[1, e:g], r[2, e:g], r[3, e:g], r[4, e:g], r[5, e:g], r[6, e:g])
        meet(neighbor[e:g], state, support, change, marks, box, i, e, found)
        fx, fy, a, b, d = force[0, i:j], force[1, i:j], force[2, i:j], force[3, i:j], force[4, i:j]
        sums = fx, fy, a, b, d, own[0, i:j], own[1, i:j]
        energy += rub(stiffness[e:g], friction.coefficient, found, sums)
    return energy


@kernel
def react(neighbor, friction):
    """Add up, for each grain, what the pairs do to it that are listed with others."""
    reactions, received = friction.reactions, friction.received
    for first in range(0, reactions.shape[1], WIDTH):
        add_columns(reactions, np.uint64(first), neighbor, received)


@kernel(noalias=True)
def receive(received, fx, fy, a, b, d, pulls, deep):
    """Add to the sums of n grains what they have ``received`` (n, 8)."""
    for i in range(received.shape[0]):
        fx[i] += received[i, 0]
        fy[i] += received[i, 1]
        a[i] += received[i, 2]
        b[i] += received[i, 3]
        d[i] += received[i, 4]
        pulls[i] += received[i, 5]
        deep[i] += received[i, 6]

"""Forces between grains the plain way: one pair after another, each once, with Numba's default flags.

The yardstick of ``bench``: what somebody gets who writes the equations of core/MODEL.md, "Contacts", into a double loop
over a half list and puts ``@njit`` on top. Written for this purpose from those equations; it shares no code with
``core.contacts`` and none of its tricks (no reassociation, no noalias, no precomputed s, u, v, no slots), but it is not
made slow on purpose either: no trigonometry, a square root only where one is needed, nothing for pairs that do not touch.
"""

from __future__ import annotations

import math

import numba
import numpy as np


@numba.njit(cache=True, nogil=True)
def contact_forces(state, start, neighbor, stiffness, box, force):
    """Contact forces (5, N) [k R] into ``force``; returns the energy [k R²].

    ``state`` (5, N); the partners j of grain i, each pair listed once, are neighbor[start[i]:start[i + 1]], with
    ``stiffness`` C_ij [k] beside them; ``box`` as ``PeriodicBox.kernel_form`` gives it, or None.
    """
    x, y, p, q1, q2 = state[0], state[1], state[2], state[3], state[4]
    fx, fy, fp, f1, f2 = force[0], force[1], force[2], force[3], force[4]
    force[:] = 0.0
    energy = 0.0
    for i in range(x.shape[0]):
        for k in range(start[i], start[i + 1]):
            j = neighbor[k]
            dx = x[j] - x[i]
            dy = y[j] - y[i]
            if box is not None:
                rows = np.rint(dy * box[3])
                dx -= rows * box[4]
                dy -= rows * box[2]
                dx -= box[0] * np.rint(dx * box[1])
            r2 = dx * dx + dy * dy
            r = math.sqrt(r2)
            c2 = (dx * dx - dy * dy) / r2
            s2 = 2.0 * dx * dy / r2
            # h² = (p + q1 c2 + q2 s2)² + (q2 c2 − q1 s2)²
            along_i = p[i] + q1[i] * c2 + q2[i] * s2
            across_i = q2[i] * c2 - q1[i] * s2
            along_j = p[j] + q1[j] * c2 + q2[j] * s2
            across_j = q2[j] * c2 - q1[j] * s2
            hi = math.sqrt(along_i * along_i + across_i * across_i)
            hj = math.sqrt(along_j * along_j + across_j * across_j)
            overlap = hi + hj - r
            if overlap > 0.0:
                f = stiffness[k] * overlap
                energy += 0.5 * f * overlap
                # dh/dφ = 2 p (q2 c2 − q1 s2) / h, and turning n by dφ moves the centres by r dφ.
                turn = 2.0 * f * (p[i] * across_i / hi + p[j] * across_j / hj) / r2
                push = f / r
                gx = push * dx + turn * dy
                gy = push * dy - turn * dx
                fx[i] -= gx
                fy[i] -= gy
                fx[j] += gx
                fy[j] += gy
                gi = f / hi
                gj = f / hj
                fp[i] -= gi * along_i
                f1[i] -= gi * (q1[i] + p[i] * c2)
                f2[i] -= gi * (q2[i] + p[i] * s2)
                fp[j] -= gj * along_j
                f1[j] -= gj * (q1[j] + p[j] * c2)
                f2[j] -= gj * (q2[j] + p[j] * s2)
    return energy


@numba.njit(cache=True, nogil=True)
def repeat(times, state, start, neighbor, stiffness, box, force):
    """``contact_forces`` several times, for the clock."""
    energy = 0.0
    for _ in range(times):
        energy = contact_forces(state, start, neighbor, stiffness, box, force)
    return energy

"""A grain's own energy: what it costs to change its area and its shape. Equations: MODEL.md, "One grain".

The paper's energy does not forbid a grain to vanish: squeezed from all sides by more than the largest force that its area
can bear, it gives way altogether. A guard stops that at GUARD_AREA of the rest area, where a grain that stayed round has a
fifth of its radius: below it the energy GUARD_STIFFNESS A0 ½ ln²(ab / (GUARD_AREA A0)) is added, which is C¹ there, and below
LEAST_AREA goes on along its tangent. Everything above is as in the paper to the last bit.
"""

from __future__ import annotations

import math

from core.jit import kernel

GUARD_AREA = 0.04  # of the rest area
GUARD_STIFFNESS = 1.0  # [k]
LEAST_AREA = 1e-3  # of the rest area: below it the guard goes on along its tangent, so that ab ≤ 0 is pushed back too


@kernel(noalias=True)
def finish(p, q1, q2, rest_area, area_stiffness, shape_stiffness, fp, fq1, fq2):
    """Turn the contact sums in fp, fq1, fq2 into forces, add those of the grains' own elasticity.

    rest_area A0 = R0² [R²], area_stiffness κ(1+ν)/A0 [k/R²], shape_stiffness 2κ(1−ν) [k], all (N,). Returns the energy
    [k R²], and how many grains are so small that ``add_guard`` has to see to them.
    """
    energy = 0.0
    small = 0.0
    for i in range(p.shape[0]):
        pi = p[i]
        q1i = q1[i]
        q2i = q2[i]
        a = fp[i]
        b = fq1[i]
        d = fq2[i]
        q = q1i * q1i + q2i * q2i
        excess = pi * pi - q - rest_area[i]
        small += 1.0 if excess < (GUARD_AREA - 1.0) * rest_area[i] else 0.0
        pressure = area_stiffness[i] * excess
        shape = shape_stiffness[i]
        energy += 0.25 * pressure * excess + 0.5 * shape * q
        restore = shape - pressure
        fp[i] = -(pi * a + q1i * b + q2i * d) - pressure * pi
        fq1[i] = -(q1i * a + pi * b) - restore * q1i
        fq2[i] = -(q2i * a + pi * d) - restore * q2i
    return energy, small


@kernel
def add_guard(p, q1, q2, rest_area, fp, fq1, fq2):
    """Add the guard's forces to the grains below GUARD_AREA; returns its energy [k R²]."""
    energy = 0.0
    for i in range(p.shape[0]):
        share = (p[i] * p[i] - q1[i] * q1[i] - q2[i] * q2[i]) / rest_area[i]
        if share < GUARD_AREA:
            held = max(share, LEAST_AREA)
            depth = math.log(held / GUARD_AREA)
            slope = GUARD_STIFFNESS * depth / held  # dV/d(ab), negative
            energy += rest_area[i] * (
                0.5 * GUARD_STIFFNESS * depth * depth + slope * (share - held)
            )
            fp[i] -= 2.0 * slope * p[i]
            fq1[i] += 2.0 * slope * q1[i]
            fq2[i] += 2.0 * slope * q2[i]
    return energy

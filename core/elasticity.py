"""A grain's own energy: what it costs to change its area and its shape. Equations: MODEL.md, "One grain"."""

from __future__ import annotations

from core.jit import kernel


@kernel(noalias=True)
def finish(p, q1, q2, rest_area, area_stiffness, shape_stiffness, fp, fq1, fq2):
    """Turn the contact sums in fp, fq1, fq2 into forces, add those of the grains' own elasticity; return its energy [k R²].

    rest_area A0 = R0² [R²], area_stiffness κ(1+ν)/A0 [k/R²], shape_stiffness 2κ(1−ν) [k], all (N,).
    """
    energy = 0.0
    for i in range(p.shape[0]):
        pi = p[i]
        q1i = q1[i]
        q2i = q2[i]
        a = fp[i]
        b = fq1[i]
        d = fq2[i]
        q = q1i * q1i + q2i * q2i
        excess = pi * pi - q - rest_area[i]
        pressure = area_stiffness[i] * excess
        shape = shape_stiffness[i]
        energy += 0.25 * pressure * excess + 0.5 * shape * q
        restore = shape - pressure
        fp[i] = -(pi * a + q1i * b + q2i * d) - pressure * pi
        fq1[i] = -(q1i * a + pi * b) - restore * q1i
        fq2[i] = -(q2i * a + pi * d) - restore * q2i
    return energy

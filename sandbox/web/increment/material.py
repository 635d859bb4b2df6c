"""``core.material`` for one grain at a time."""

from __future__ import annotations

from core.jit import kernel


@kernel
def deformation_stiffness(nu, stiffness):
    """κ [k]."""
    return 4.0 * stiffness / ((stiffness - 2.0) * (1.0 - nu) * (1.0 + nu))


@kernel
def area_modulus(nu, stiffness):
    """κ(1+ν) [k]."""
    return deformation_stiffness(nu, stiffness) * (1.0 + nu)


@kernel
def shape_modulus(nu, stiffness):
    """κ(1−ν) [k]."""
    return deformation_stiffness(nu, stiffness) * (1.0 - nu)

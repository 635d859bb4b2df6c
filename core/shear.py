"""What is measured on a packing that is sheared between two plates: stresses, shear modulus, yield stress.

Haver et al., doi:10.1073/pnas.2317915121, appendices "Numerical shearing setup" and "Normalized experimental quantities".
"""

from __future__ import annotations

import numpy as np

from core.arrays import Floats
from core.errors import InputError


def plate_stress(reaction: Floats, width: float) -> tuple[float, float]:
    """(shear stress τ, normal stress P) [k] on the upper plate, from the force of the grains on it, (fx, fy, …) [k R].

    Force over the width of the plate [R]. τ > 0 where the grains hold back a plate that is moved towards +x, P > 0 where they
    push it up.
    """
    return -float(reaction[0]) / width + 0.0, float(reaction[1]) / width + 0.0


def shear_modulus(strain: Floats, stress: Floats) -> float:
    """G [k], from small cycles: slope of the stress (M,) [k] against the strain (M,), averaged over both directions of motion.

    A straight line is fitted through the points of each direction by itself, so that a hysteresis does not tilt it. Raises
    InputError unless there are two strains in each direction.
    """
    strain, stress = np.asarray(strain, dtype=np.float64), np.asarray(stress, dtype=np.float64)
    step = np.diff(strain)
    slopes = []
    for direction in (1.0, -1.0):
        at = np.flatnonzero(step * direction > 0.0) + 1
        if not len(at) or not np.ptp(strain[at]) > 0.0:
            raise InputError("a shear modulus needs two strains in each direction")
        x = strain[at] - strain[at].mean()
        slopes.append(float(np.sum(x * stress[at]) / np.sum(x * x)))
    return 0.5 * sum(slopes)


def yield_stress(strain: Floats, stress: Floats, start: float) -> float:
    """Dynamic yield stress [k]: mean shear stress over the strains beyond ``start``, where the flow is steady.

    For cycles: over all points whose strain, counted from the last turning point, is beyond ``start``; stress is counted along
    the motion. Raises InputError if there are none.
    """
    strain, stress = np.asarray(strain, dtype=np.float64), np.asarray(stress, dtype=np.float64)
    direction = np.sign(np.diff(strain))
    since, counted, before = 0.0, [], 0.0
    for k in range(1, len(strain)):
        way = direction[k - 1]
        if way == 0.0:
            continue
        if way == -before:
            since = 0.0
        before = way
        since += abs(strain[k] - strain[k - 1])
        if since > start:
            counted.append(way * stress[k])
    if not counted:
        raise InputError(f"nothing has been sheared by more than {start:g}")
    return float(np.mean(counted))


def dilatancy(strain: Floats, normal: Floats, far: float) -> float:
    """How much the normal stress (M,) [k] rises when grains are sheared out of the middle: Reynolds' dilatancy at fixed volume.

    Its mean at |strain| ≥ ``far`` less that at |strain| ≤ far/4; see the appendix "Experimental shearing setup". Raises
    InputError if either is missing.
    """
    strain, normal = np.abs(np.asarray(strain, dtype=np.float64)), np.asarray(normal)
    out, middle = strain >= far, strain <= 0.25 * far
    if not out.any() or not middle.any():
        raise InputError("dilatancy needs strains in the middle and far from it")
    return float(normal[out].mean() - normal[middle].mean())

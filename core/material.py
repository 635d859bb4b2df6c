"""What a grain is made of: Poisson's ratio and contact stiffness, and the paper's pair of ratios for the same thing.

The potential of one grain, with A0 = R0² and κ = 4C / ((C − 2)(1 − ν²)) [k]:

    V = κ(1+ν)/(4 A0) (ab − A0)²  +  κ(1−ν)/4 (a − b)²

is the one of Haver et al., doi:10.1073/pnas.2317915121, appendix "Numerical model", with λ = (1+ν)/(1−ν),
C = 2 + (λ+1)²/(λμ) and κ = Cμ. Every function takes floats or arrays of any shape and returns the like.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Floats
from core.errors import InputError
from core.jit import shared

DEFAULT_CONTACT_STIFFNESS = 50.0
DEFAULT_POISSON_RATIO = 0.8


def check_material(poisson_ratio: ArrayLike, contact_stiffness: ArrayLike) -> None:
    """Raise InputError unless -1 < poisson_ratio < 1 and contact_stiffness > 2 everywhere."""
    nu = np.asarray(poisson_ratio, dtype=np.float64)
    stiffness = np.asarray(contact_stiffness, dtype=np.float64)
    if not np.all((nu > -1.0) & (nu < 1.0)):
        raise InputError(
            "Poisson's ratio must lie between -1 and 1, both excluded: give a value such as -0.8 or 0.8"
        )
    if not np.all((stiffness > 2.0) & np.isfinite(stiffness)):
        raise InputError(
            "contact stiffness C must be greater than 2 and finite: at C = 2 the grain itself would be rigid"
        )


@shared
def deformation_stiffness(poisson_ratio: Any, contact_stiffness: Any) -> Any:
    """κ = 4C / ((C − 2)(1 − ν²)) [k], the stiffness that makes every grain equally stiff between two plates."""
    nu, stiffness = poisson_ratio, contact_stiffness
    return 4.0 * stiffness / ((stiffness - 2.0) * (1.0 - nu) * (1.0 + nu))


@shared
def area_modulus(poisson_ratio: Any, contact_stiffness: Any) -> Any:
    """κ(1+ν) [k]: resistance to a change of area."""
    return deformation_stiffness(poisson_ratio, contact_stiffness) * (1.0 + poisson_ratio)


@shared
def shape_modulus(poisson_ratio: Any, contact_stiffness: Any) -> Any:
    """κ(1−ν) [k]: resistance to a change of shape."""
    return deformation_stiffness(poisson_ratio, contact_stiffness) * (1.0 - poisson_ratio)


def from_paper(stiffness_ratio: ArrayLike, softness: ArrayLike) -> tuple[Floats, Floats]:
    """(λ, μ) of the paper → (Poisson's ratio, contact stiffness C).

    λ = k_A/k_s (area over shape), μ = (k_A + k_s)/k (grain over contact).
    C is infinite where λ μ is too small for float64. Raises InputError unless both are positive.
    """
    lam = np.asarray(stiffness_ratio, dtype=np.float64)
    mu = np.asarray(softness, dtype=np.float64)
    if not (np.all(lam > 0.0) and np.all(mu > 0.0)):
        raise InputError("the paper's λ and μ must both be greater than 0")
    with np.errstate(over="ignore", divide="ignore"):
        stiffness = 2.0 + (lam + 1.0) ** 2 / (lam * mu)
    return (lam - 1.0) / (lam + 1.0), stiffness


def contact_stiffness_of(poisson_ratio: ArrayLike, softness: ArrayLike) -> Floats:
    """C [k] that gives grains of that Poisson's ratio the paper's μ: κ = C μ. Raises InputError unless μ is positive."""
    nu = np.asarray(poisson_ratio, dtype=np.float64)
    return from_paper((1.0 + nu) / (1.0 - nu), softness)[1]


def to_paper(poisson_ratio: ArrayLike, contact_stiffness: ArrayLike) -> tuple[Floats, Floats]:
    """(Poisson's ratio, contact stiffness C) → (λ, μ) of the paper. Raises InputError when out of range."""
    check_material(poisson_ratio, contact_stiffness)
    nu = np.asarray(poisson_ratio, dtype=np.float64)
    stiffness = np.asarray(contact_stiffness, dtype=np.float64)
    return (1.0 + nu) / (1.0 - nu), deformation_stiffness(nu, stiffness) / stiffness

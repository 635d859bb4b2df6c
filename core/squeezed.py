"""Which grains are squeezed further than what they are made of could be.

The model is a spring without an end. A real grain is rubber with a hole in it, and rubber keeps its volume: once the hole has
closed there is nothing left to give way, and the grain is far stiffer than the model says. Where that is follows from the
measures of Haver et al., doi:10.1073/pnas.2317915121, appendix "Designing auxetic and regular grains", in radii at rest:

- The ring's wall is 1.5 mm thick on a small grain. 8 cm of intruder are 5.7 diameters of a large grain, 1.4 times a small one:
  5.0 mm of radius, so t = 0.30. Large grains are the same design magnified 1.4 times in the plane: 0.30 for both sizes. The
  walls meet where the shorter semi-axis has come down to b = t; and squeezed from all sides, the hole has gone where only the
  wall's own area is left, A/A0 = 1 − (1 − t)² = 0.51.
- The auxetic grain gives way by its re-entrant hole and by the wedge cut from the rim. Of these the paper has a drawing and no
  numbers; here they are as they are drawn in the window. The hole is an arrowhead, half the product of its diagonals,
  w (tip − notch); the wedge is a triangle that the rim cuts off. Together they are 27 % of the grain: both have closed at
  A/A0 = 0.726. (The tooth fills what its pocket leaves free.)

Walls touch earlier somewhere: what is marked is too far for the grain as it is drawn, what is not may be in doubt already.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats

# Measures in radii of the grain at rest.
RING_WALL = 0.30
TIP = 0.84  # of the hole, from the centre to the side opposite the wedge
WING = 0.70  # half the width of the hole
NOTCH = -0.06  # where the hole turns inwards
APEX = -0.20  # of the wedge; between it and the notch lies a hinge
MOUTH = 0.30  # half the width of the wedge at v = −1


def _wedge() -> float:
    """Area of the wedge inside the unit circle [R0²]: a triangle to where its sides meet the rim, and the segment beyond."""
    slope = MOUTH / (APEX + 1.0)  # |u| = slope (APEX − v)
    a, half_b = 1.0 + slope**2, -APEX * slope**2
    v = (-half_b - math.sqrt(half_b**2 - a * ((slope * APEX) ** 2 - 1.0))) / a
    u = slope * (APEX - v)
    return u * (APEX - v) + math.asin(u) + u * v


# Areas over those at rest.
RING_AREA = 1.0 - (1.0 - RING_WALL) ** 2
AUXETIC_AREA = 1.0 - (WING * (TIP - NOTCH) + _wedge()) / math.pi


def squeezed_beyond(
    p: Floats, q1: Floats, q2: Floats, rest_radius: Floats, poisson_ratio: Floats
) -> NDArray[np.bool_]:
    """True for the grains that no real grain could follow, (N,). Shapes and rest radii [R], each (N,); auxetic is ν < 0."""
    with np.errstate(all="ignore"):
        stretch = np.hypot(q1, q2) / rest_radius
        mean = p / rest_radius
        area = mean * mean - stretch * stretch
        ring = (mean - stretch <= RING_WALL) | (area <= RING_AREA)
        beyond: NDArray[np.bool_] = np.where(poisson_ratio < 0.0, area <= AUXETIC_AREA, ring)
    return beyond

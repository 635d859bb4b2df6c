"""The exact contact of two ellipses, which the contact law approximates, and how far that is off.

Two ellipses whose centres lie along the unit vector e touch at the distance at which e first leaves the sum of their shapes:
the least of (h1(n) + h2(n)) / (n·e) over all n, where h are the support functions. The contact law takes n = e instead, so it
never gives less: contact starts a little early, never late. It is exact for circles, along common axes, and for two ellipses that
are mirror images of one another in the line between them. Haver et al., doi:10.1073/pnas.2317915121, appendix "Ellipse
Overlap Approximation", with its expansions put right; see MODEL.md.
"""

from __future__ import annotations

import math

from core.packing import Packing

BISECTIONS = 60


def contact_distance(packing: Packing, i: int, j: int, angle: float) -> float:
    """Distance of the centres of grains i and j at which their outlines touch, with j in direction ``angle`` [rad] from i. [R]

    Along n = e + t e⊥ the sum of the support functions is convex in t, and its least value lies between those of both grains.
    """
    quadratics = [_support_squared(packing, k, angle) for k in (i, j)]
    low, high = sorted(-b / c for _, b, c in quadratics)
    for _ in range(BISECTIONS):
        t = 0.5 * (low + high)
        slope = sum((b + c * t) / math.sqrt(a + 2.0 * b * t + c * t * t) for a, b, c in quadratics)
        if slope < 0.0:
            low = t
        else:
            high = t
    t = 0.5 * (low + high)
    return sum(math.sqrt(a + 2.0 * b * t + c * t * t) for a, b, c in quadratics)


def approximate_distance(packing: Packing, i: int, j: int, angle: float) -> float:
    """The same as the contact law has it: h_i + h_j along the line of centres [R]."""
    return sum(math.sqrt(_support_squared(packing, k, angle)[0]) for k in (i, j))


def parallel_expansion(b: float, stretch: float, tilt: float) -> tuple[float, float]:
    """(exact, approximate) contact distance of two equal, equally tilted ellipses to the square of the stretch [R].

    a = b (1 + ``stretch``); ``tilt`` [rad] is that of the longer axes to the line of centres.
    """
    common = 2.0 + 2.0 * stretch * math.cos(tilt) ** 2
    bend = stretch**2 * (1.0 - math.cos(4.0 * tilt)) / 8.0
    return b * (common - 3.0 * bend), b * (common + bend)


def _support_squared(packing: Packing, k: int, angle: float) -> tuple[float, float, float]:
    """A, B, C with h(e + t e⊥)² = A + 2 B t + C t² of grain k [R²]: the square of its stretch tensor in the frame of e."""
    p, q1, q2 = (float(v) for v in packing.state[2:, k])
    cosine, sine = math.cos(2.0 * angle), math.sin(2.0 * angle)
    along, across = q1 * cosine + q2 * sine, q2 * cosine - q1 * sine
    s = p * p + q1 * q1 + q2 * q2
    return s + 2.0 * p * along, 2.0 * p * across, s - 2.0 * p * along

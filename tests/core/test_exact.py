"""The exact contact of ellipses: against a search over all directions, closed forms, and the size of the contact law's error."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core.exact import approximate_distance, contact_distance, parallel_expansion
from core.packing import Packing


def pair(
    axes: tuple[float, float], tilts: tuple[float, float], other: tuple[float, float] | None = None
) -> Packing:
    """Two ellipses with semi-axes ``axes`` (the second: ``other``) and tilts [rad]."""
    packing = Packing([0.0, 3.0], [0.0, 0.0])
    second = other or axes
    packing.set_axes([axes[0], second[0]], [axes[1], second[1]], tilts)
    return packing


def searched(packing: Packing, angle: float) -> float:
    """The least of (h1 + h2)/(n·e) over 200,000 directions."""
    phi = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 200_001)[1:-1]
    total = np.zeros_like(phi)
    a, b = packing.semi_axes
    for k in (0, 1):
        turned = phi + angle - packing.angle[k]
        total += np.sqrt((a[k] * np.cos(turned)) ** 2 + (b[k] * np.sin(turned)) ** 2)
    return float(np.min(total / np.cos(phi)))


def polar_radius(a: float, b: float, tilt: float) -> float:
    """From the centre to the outline [R]."""
    return a * b / math.hypot(b * math.cos(tilt), a * math.sin(tilt))


def test_against_a_search() -> None:
    """The grid is fine to 1.6e-5 rad, and the minimum flat: 1e-9."""
    random = np.random.default_rng(5)
    for _ in range(20):
        a, b, c, d = random.uniform(0.5, 1.5, 4)
        packing = pair((a, b), tuple(random.uniform(-2.0, 2.0, 2)), (c, d))
        angle = float(random.uniform(-4.0, 4.0))
        exact = contact_distance(packing, 0, 1, angle)
        assert exact == pytest.approx(searched(packing, angle), abs=1e-8)
        assert contact_distance(packing, 1, 0, angle) == pytest.approx(exact, abs=1e-13)
        assert exact <= approximate_distance(packing, 0, 1, angle) + 1e-14


def test_outlines_touch_there_and_not_before() -> None:
    """By points on both outlines: at the contact distance none lies inside the other ellipse, a little nearer some do."""
    packing = pair((1.3, 0.8), (0.4, 1.1), (1.1, 0.6))
    exact = contact_distance(packing, 0, 1, 0.3)
    around = np.linspace(0.0, 2.0 * np.pi, 100_001)
    c, s = math.cos(0.4), math.sin(0.4)
    outline = np.array([1.3 * np.cos(around), 0.8 * np.sin(around)])
    outline = np.array([c * outline[0] - s * outline[1], s * outline[0] + c * outline[1]])

    def deepest(distance: float) -> float:
        x, y = outline[0] - distance * math.cos(0.3), outline[1] - distance * math.sin(0.3)
        u, v = x * math.cos(1.1) + y * math.sin(1.1), y * math.cos(1.1) - x * math.sin(1.1)
        return float(np.min((u / 1.1) ** 2 + (v / 0.6) ** 2))

    assert deepest(exact) == pytest.approx(1.0, abs=1e-7)
    assert deepest(exact - 1e-3) < 1.0 - 1e-4


@pytest.mark.parametrize("tilt", np.linspace(0.0, np.pi, 13))
def test_parallel_ellipses_touch_at_their_polar_radii(tilt: float) -> None:
    packing = pair((1.2, 0.9), (tilt, tilt))
    assert contact_distance(packing, 0, 1, 0.0) == pytest.approx(
        2.0 * polar_radius(1.2, 0.9, tilt), abs=1e-13
    )


@pytest.mark.parametrize("tilt", np.linspace(0.0, np.pi, 13))
def test_mirror_images_are_exact(tilt: float) -> None:
    packing = pair((1.4, 0.8), (0.7 + tilt, 0.7 - tilt))
    assert contact_distance(packing, 0, 1, 0.7) == pytest.approx(
        approximate_distance(packing, 0, 1, 0.7), abs=1e-13
    )


@pytest.mark.parametrize("tilt", [0.2, 0.6, 0.8, 1.2])
def test_expansion_for_parallel_ellipses(tilt: float) -> None:
    """Right to the square of the stretch: the error falls by 8 where the stretch is halved."""
    b = 0.9

    def errors(stretch: float) -> np.ndarray:
        packing = pair((b * (1.0 + stretch), b), (tilt, tilt))
        measured = [f(packing, 0, 1, 0.0) for f in (contact_distance, approximate_distance)]
        return np.array(measured) - parallel_expansion(b, stretch, tilt)

    ratio = errors(0.01) / errors(0.005)
    assert ratio == pytest.approx([8.0, 8.0], rel=0.06)
    exact, approximate = parallel_expansion(b, 0.1, tilt)
    assert approximate - exact == pytest.approx(b * 0.1**2 * math.sin(2.0 * tilt) ** 2, abs=1e-15)


@pytest.mark.parametrize(("aspect", "percent"), [(1.1, 0.113), (1.2, 0.413), (1.4, 1.40)])
def test_how_early_contact_starts(aspect: float, percent: float) -> None:
    """Mean over random tilts, in percent of a diameter, from 20,000 pairs; here the spread of 1,000 is allowed.

    For small stretch it tends to (a/b − 1)²/8.
    """
    random = np.random.default_rng(1)
    early = []
    for tilts in random.uniform(0.0, np.pi, (1000, 2)):
        packing = pair((math.sqrt(aspect), 1.0 / math.sqrt(aspect)), tuple(tilts))
        early.append(
            approximate_distance(packing, 0, 1, 0.0) - contact_distance(packing, 0, 1, 0.0)
        )
    assert min(early) > -1e-14
    mean, error = 50.0 * np.mean(early), 50.0 * np.std(early) / math.sqrt(len(early))
    assert mean == pytest.approx(percent, abs=float(3.0 * error))

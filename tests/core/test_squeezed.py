"""Where a grain's hole has closed: closed forms, both criteria, both kinds, and what is drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from core import squeezed
from core.squeezed import AUXETIC_AREA, RING_AREA, RING_WALL, squeezed_beyond

REGULAR, AUXETIC = 0.8, -0.8


def beyond(a: float, b: float, nu: float, radius: float = 1.0, angle: float = 0.7) -> bool:
    half = 0.5 * (a - b) * radius
    arrays = (0.5 * (a + b) * radius, half * math.cos(angle), half * math.sin(angle), radius, nu)
    return bool(squeezed_beyond(*(np.array([value]) for value in arrays))[0])


@pytest.mark.parametrize("radius", [1.0, 1.0 / 1.4, 0.2])
@pytest.mark.parametrize("nu", [REGULAR, 0.0])
def test_a_ring_is_flat_where_its_walls_meet(nu: float, radius: float) -> None:
    assert not beyond(2.0, RING_WALL + 1e-6, nu, radius)
    assert beyond(2.0, RING_WALL - 1e-6, nu, radius)


def test_a_ring_from_all_sides_has_no_hole_where_only_its_wall_is_left() -> None:
    assert pytest.approx(0.51) == RING_AREA
    assert not beyond(math.sqrt(0.5101), math.sqrt(0.5101), REGULAR)
    assert beyond(math.sqrt(0.5099), math.sqrt(0.5099), REGULAR)


@pytest.mark.parametrize("aspect", [1.0, 1.3, 2.0])
def test_an_auxetic_grain_has_lost_its_hole_and_its_wedge(aspect: float) -> None:
    for area, expected in ((AUXETIC_AREA + 1e-6, False), (AUXETIC_AREA - 1e-6, True)):
        b = math.sqrt(area / aspect)
        assert beyond(aspect * b, b, AUXETIC, 1.0 / 1.4) is expected


def test_the_area_of_the_holes() -> None:
    """By counting points of a fine lattice in the unit disc."""
    u, v = np.meshgrid(*[(np.arange(2000) + 0.5) / 1000.0 - 1.0] * 2)
    disc = u**2 + v**2 < 1.0
    u = np.abs(u)

    def below(v0: float, u1: float, v1: float) -> NDArray[np.bool_]:
        under: NDArray[np.bool_] = v < v0 + (v1 - v0) * u / u1
        return under

    hole = below(squeezed.TIP, squeezed.WING, -0.44) & ~below(squeezed.NOTCH, squeezed.WING, -0.44)
    wedge = below(squeezed.APEX, squeezed.MOUTH, -1.0)
    matter = np.count_nonzero(disc & ~hole & ~wedge) / np.count_nonzero(disc)
    assert pytest.approx(matter, abs=2e-4) == AUXETIC_AREA
    assert pytest.approx(0.7257, abs=5e-5) == AUXETIC_AREA


def test_at_rest_nothing_is_squeezed_and_bad_numbers_are_not_either() -> None:
    assert not beyond(1.0, 1.0, REGULAR)
    assert not beyond(1.0, 1.0, AUXETIC)
    assert not beyond(math.nan, 1.0, REGULAR)
    none = np.empty(0)
    assert len(squeezed_beyond(none, none, none, none, none)) == 0

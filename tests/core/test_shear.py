"""Stresses on a plate, shear modulus, yield stress and dilatancy, on curves whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from core.errors import InputError
from core.shear import dilatancy, plate_stress, shear_modulus, yield_stress

Floats = NDArray[np.float64]


def triangle(amplitude: float, quarter: int, cycles: int) -> Floats:
    """Strains of a few cycles that begin at 0 and first rise."""
    phase = np.arange(4 * quarter * cycles + 1) / quarter % 4.0
    wave = np.where(phase <= 1.0, phase, np.where(phase <= 3.0, 2.0 - phase, phase - 4.0))
    return amplitude * wave


def test_stress_is_force_over_width_against_the_motion() -> None:
    assert plate_stress(np.array([-3.0, 6.0, 0.5]), 12.0) == (0.25, 0.5)
    shear, normal = plate_stress(np.zeros(3), 5.0)
    assert str(shear) == str(normal) == "0.0"  # no minus


def test_modulus_of_a_line_and_of_a_loop() -> None:
    strain = triangle(0.002, 10, 2)
    assert shear_modulus(strain, 0.3 * strain + 0.01) == pytest.approx(0.3)
    going_up = np.concatenate([[True], np.diff(strain) > 0.0])
    loop = 0.3 * strain + np.where(going_up, 1e-4, -1e-4)
    assert shear_modulus(strain, loop) == pytest.approx(0.3)
    # Slopes that differ by direction count alike.
    bent = np.where(going_up, 0.2, 0.4) * strain
    assert shear_modulus(strain, bent) == pytest.approx(0.3)


def test_modulus_needs_both_directions() -> None:
    with pytest.raises(InputError, match="each direction"):
        shear_modulus(np.linspace(0.0, 1.0, 20), np.linspace(0.0, 1.0, 20))


def test_yield_stress_of_steady_flow_and_of_cycles() -> None:
    strain = np.linspace(0.0, 2.0, 201)
    stress = np.minimum(strain, 0.5)
    assert yield_stress(strain, stress, 0.6) == pytest.approx(0.5)
    strain = triangle(2.0, 100, 2)
    way = np.concatenate([[1.0], np.sign(np.diff(strain))])
    assert yield_stress(strain, 0.25 * way, 0.5) == pytest.approx(0.25)
    with pytest.raises(InputError, match="sheared"):
        yield_stress(strain, stress=strain, start=10.0)


def test_a_pause_at_a_turning_point_changes_nothing() -> None:
    strain, stress = np.array([0.0, 1.0, 0.5, 0.0]), np.array([0.0, 0.3, -1.0, -0.2])
    paused, longer = np.insert(strain, 2, [1.0, 1.0]), np.insert(stress, 2, [0.3, 0.3])
    assert yield_stress(strain, stress, 0.6) == pytest.approx((0.3 + 0.2) / 2)
    assert yield_stress(paused, longer, 0.6) == yield_stress(strain, stress, 0.6)


def test_a_modulus_needs_two_strains_in_each_direction() -> None:
    strain = np.array([0.0, 1.0, 0.0, 1.0, 0.0])
    with pytest.raises(InputError, match="two strains"):
        shear_modulus(strain, 0.3 * strain)


def test_dilatancy_is_the_rise_away_from_the_middle() -> None:
    strain = triangle(0.04, 20, 1)
    assert dilatancy(strain, 0.1 + 5.0 * strain**2, 0.04) == pytest.approx(0.008, rel=0.1)
    assert dilatancy(strain, np.full(len(strain), 0.1), 0.03) == pytest.approx(0.0, abs=1e-15)
    with pytest.raises(InputError, match="far"):
        dilatancy(strain, strain, 1.0)

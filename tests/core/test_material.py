"""Material: two numbers, two ways to write them, and what they mean for a single grain."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core import material
from core.errors import InputError

RATIOS = st.floats(-0.999, 0.999)
STIFFNESSES = st.floats(2.001, 1e6)


@given(RATIOS, STIFFNESSES)
def test_round_trip(nu: float, stiffness: float) -> None:
    """(ν, C) → (λ, μ) → (ν, C). 1 − |ν| ≥ 1e-3 and C − 2 ≥ 1e-3 cost three digits each, of the sixteen."""
    back = material.from_paper(*material.to_paper(nu, stiffness))
    assert back[0] == pytest.approx(nu, abs=1e-12)
    assert back[1] - 2.0 == pytest.approx(stiffness - 2.0, rel=1e-9)


@given(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_round_trip_from_paper(ratio: float, softness: float) -> None:
    nu, stiffness = map(float, material.from_paper(ratio, softness))
    # For extreme pairs C − 2 drowns in the 2, or 1 − |ν| in the 1: what is left of their digits is what comes back.
    lost = 2.0 / (stiffness - 2.0) + (1.0 + ratio) / min(1.0, ratio)
    back = material.to_paper(nu, stiffness)
    assert back[0] == pytest.approx(ratio, rel=1e-15 * (4.0 + lost))
    assert back[1] == pytest.approx(softness, rel=1e-15 * (8.0 + 2.0 * lost))


@given(RATIOS, STIFFNESSES)
def test_moduli(nu: float, stiffness: float) -> None:
    """k_A = λμCk/(λ+1) and k_s = μCk/(λ+1) of the paper are half of ours, which stand before 1/4 instead of 1/2."""
    ratio, softness = material.to_paper(nu, stiffness)
    area = ratio * softness * stiffness / (ratio + 1.0)
    shape = softness * stiffness / (ratio + 1.0)
    assert 0.5 * material.area_modulus(nu, stiffness) == pytest.approx(area, rel=1e-12)
    assert 0.5 * material.shape_modulus(nu, stiffness) == pytest.approx(shape, rel=1e-12)


@given(RATIOS, STIFFNESSES)
def test_every_grain_is_equally_stiff(nu: float, stiffness: float) -> None:
    """Between two plates, to first order: minimise 2·C/2 (δ − e)² + own energy over both semi-axes; force/approach is k.

    With e_a = δa/R0: own energy κ(1+ν)/4 (e_a + e_b)² + κ(1−ν)/4 (e_a − e_b)², a 2 × 2 system.
    """
    area, shape = material.area_modulus(nu, stiffness), material.shape_modulus(nu, stiffness)
    own = 0.5 * np.array([[area + shape, area - shape], [area - shape, area + shape]])
    strain = 0.01  # by which each plate comes closer
    e = np.linalg.solve(own + np.diag([2.0 * stiffness, 0.0]), [-2.0 * stiffness * strain, 0.0])
    force = stiffness * (strain + e[0])
    assert force / (2.0 * strain) == pytest.approx(1.0, rel=1e-9)
    assert -e[1] / e[0] == pytest.approx(nu, abs=1e-9)


@pytest.mark.parametrize(
    ("ratio", "stiffness", "nu"),
    [
        (0.01, 1022.1, -0.98020),
        (0.1, 123.0, -0.81818),
        (1.0, 42.0, 0.0),
        (10.0, 123.0, 0.81818),
        (100.0, 1022.1, 0.98020),
    ],
)
def test_grains_of_the_paper(ratio: float, stiffness: float, nu: float) -> None:
    """C = 2 + (λ+1)²/(λμ) at μ = 0.1, to the digits printed here."""
    assert material.from_paper(ratio, 0.1) == pytest.approx((nu, stiffness), abs=1e-2, rel=1e-5)
    assert material.from_paper(ratio, 0.1)[0] == pytest.approx(nu, abs=5e-6)


def test_arrays() -> None:
    nu, stiffness = material.from_paper(np.array([0.1, 10.0]), 0.1)
    assert nu == pytest.approx([-9.0 / 11.0, 9.0 / 11.0])
    assert stiffness == pytest.approx([123.0, 123.0])


@pytest.mark.parametrize("nu", [-1.0, 1.0, 1.5, math.nan, math.inf])
def test_impossible_ratio(nu: float) -> None:
    with pytest.raises(InputError, match="Poisson's ratio"):
        material.check_material(nu, 50.0)


@pytest.mark.parametrize("stiffness", [2.0, 0.0, -1.0, math.nan, math.inf])
def test_impossible_stiffness(stiffness: float) -> None:
    with pytest.raises(InputError, match="contact stiffness"):
        material.to_paper(0.0, stiffness)


@pytest.mark.parametrize("pair", [(0.0, 0.1), (1.0, 0.0), (-1.0, 0.1), (math.nan, 0.1)])
def test_impossible_paper_ratios(pair: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="λ and μ"):
        material.from_paper(*pair)

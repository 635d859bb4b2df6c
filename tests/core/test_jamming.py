"""Onset of rigidity: at vanishing pressure every grain is a circle, so all packings jam as discs do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from core import generate, observables

COUNT = 150
SEEDS = range(4)


@dataclass(frozen=True)
class Onset:
    packing_fraction: float  # extrapolated to zero pressure
    above: float  # excess packing fraction at the lower pressure
    coordination: float  # without rattlers, at the lower pressure


def onset(nu: float, seed: int) -> Onset:
    """Bidisperse 1.4 packing at P = 1e-3 and 2e-3 k, where P is proportional to φ − φ_J."""
    recipe = generate.Recipe(kind="regular", regular_poisson_ratio=nu)
    phi, z = [], []
    for pressure in (1e-3, 2e-3):
        packing = generate.pack(
            recipe, seed=seed, count=COUNT, target_pressure=pressure, tolerance=1e-4
        )
        assert packing.box is not None
        contacts = observables.grain_contacts(packing)
        measured = observables.pressure(observables.stress(contacts, packing.box.area))
        assert measured == pytest.approx(pressure, rel=0.01)
        phi.append(observables.packing_fraction(packing, packing.box.area))
        z.append(observables.coordination(packing, contacts)[1])
    return Onset(2.0 * phi[0] - phi[1], phi[1] - phi[0], z[0])


@pytest.mark.parametrize("nu", [-0.8, 0.0, 0.8])
def test_onset(nu: float) -> None:
    """Packing fraction 0.84, coordination 4, for every Poisson's ratio.

    O'Hern et al., doi:10.1103/PhysRevE.68.011306: φ_J = 0.842 for large packings, lower and scattered by
    0.16 N^(−0.55) = 0.010 for one packing of 150, so by 0.005 in the mean of four; Z − 4 ≈ 3.6 (φ − φ_J)^(1/2).
    A frictionless packing of N discs in a periodic box needs 2N − 1 contacts, Z = 4 − 2/N.
    """
    onsets = [onset(nu, seed) for seed in SEEDS]
    assert np.mean([o.packing_fraction for o in onsets]) == pytest.approx(0.84, abs=0.01)
    for o in onsets:
        assert o.packing_fraction == pytest.approx(0.84, abs=3.0 * 0.010)
        assert o.above > 0.0
    excess = np.mean([o.coordination for o in onsets]) - 4.0
    predicted = 3.6 * np.sqrt(np.mean([o.above for o in onsets]))
    assert -2.0 / (0.9 * COUNT) <= excess <= 1.5 * predicted

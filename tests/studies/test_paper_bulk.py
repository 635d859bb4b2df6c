"""Compression, shear and avalanches of the paper, judged on runs made by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("scipy")

from sandbox.studies.common.verdicts import FAILS, HOLDS, OPEN
from sandbox.studies.paper import bulk, quakes
from sandbox.studies.paper.claims import Unmeasurable
from sandbox.studies.paper.conditions import AUXETIC, LAMBDAS, REGULAR, material, packing
from sandbox.studies.paper.runs import Request, Result
from sandbox.studies.paper.shear import cell, confinement, small_cycles, steady
from tests.studies.paper_results import SEEDS, STIFFNESS, noise, result, shears, value, verdicts


def squeezes(stiffness: dict[float, float], contacts: dict[float, float]) -> list[Result]:
    """Pressure proportional to strain, from a small one on; Z = 4 + contacts × strain."""
    strain = np.linspace(0.0, 0.1, 21)
    made = []
    for lam in LAMBDAS:
        for seed in SEEDS:
            request = Request("biaxial_periodic", packing(lam), seed, material(lam))
            slope = noise(seed) * stiffness[lam]
            made.append(
                result(
                    request,
                    stroke=strain,
                    force=slope * (strain + 0.001),
                    z=4.0 + noise(seed + 1) * contacts[lam] * strain,
                )
            )
    return made


def test_compression_and_contacts() -> None:
    stiffness = dict(zip(LAMBDAS, (0.25, 0.3, 0.6, 2.0, 5.0), strict=True))
    contacts = dict(zip(LAMBDAS, (9.0, 10.0, 15.0, 30.0, 60.0), strict=True))
    runs = squeezes(stiffness, contacts)
    assert bulk.strain(runs[0])[0] == pytest.approx(0.001)  # the pressure vanishes there
    for name in ("compression", "contacts_strain", "contacts_pressure"):
        assert set(verdicts(name, runs).values()) == {HOLDS}
    # Grains rearrange in the first increment, and the pressure falls: it begins to rise in the next.
    stroke, force = runs[0].column("stroke"), runs[0].column("force")
    force[1] = 0.9 * force[0]
    late = replace(runs[0], columns={**runs[0].columns, "force": force.tolist()})
    assert bulk.strain(late) - stroke == pytest.approx(0.001)
    with pytest.raises(Unmeasurable, match="does not rise"):
        bulk.strain(replace(late, columns={**late.columns, "force": [1.0] * len(stroke)}))
    alike = squeezes(dict.fromkeys(LAMBDAS, 2.0), dict.fromkeys(LAMBDAS, 30.0))
    assert verdicts("compression", alike)["a much slower one"] == FAILS
    assert HOLDS not in verdicts("contacts_strain", alike).values()
    assert HOLDS not in verdicts("contacts_pressure", alike).values()
    assert len(bulk.squeeze_panels(runs)) == 3


def test_yield_stress_collapses_if_friction_is_the_same() -> None:
    same = shears(dict.fromkeys(LAMBDAS, 0.1), STIFFNESS)
    assert value(confinement.at_equal_volume(steady.yielding), same) == pytest.approx(2.5 / 0.3)
    found = verdicts("yield_stress", same)
    assert found["smaller for auxetic grains"] == HOLDS
    assert found["twice as small"] == FAILS  # it is eight times
    assert found["increases much less quickly with confinement"] == HOLDS
    assert set(verdicts("friction", same).values()) == {HOLDS}
    collapse = verdicts("yield_collapse", same)
    assert collapse["one curve for λ from 0.01 to 100"] == HOLDS
    assert collapse[f"one curve for all at equal pressure, at {confinement.HIGH:g} k"] == HOLDS
    assert collapse["grows sublinearly with the pressure, regular"] != HOLDS  # τ ∝ P
    fluctuations = verdicts("pressure_fluctuations", same)
    assert fluctuations["much smaller, at equal volume"] == HOLDS
    assert fluctuations["much smaller, at equal pressure"] == FAILS
    assert fluctuations["smaller, at equal pressure"] != HOLDS
    different = shears({**dict.fromkeys(LAMBDAS, 0.1), REGULAR: 0.2}, STIFFNESS)
    assert set(verdicts("friction", different).values()) == {FAILS, HOLDS}
    assert HOLDS not in [
        v for says, v in verdicts("yield_collapse", different).items() if "equal pressure" in says
    ]
    assert len(steady.yield_panels(same)) == 4


def test_no_common_pressure_is_no_collapse() -> None:
    apart = shears(dict.fromkeys(LAMBDAS, 0.1), {**STIFFNESS, AUXETIC: 0.01})
    with pytest.raises(Unmeasurable, match="reach"):
        confinement.at_equal_pressure(steady.yielding, confinement.HIGH)(apart)


def cycles(
    modulus: dict[float, float],
    rise: float = 0.0,
    friction: float = 0.5,
    grains: int = cell.GRAINS,
    step: float = small_cycles.CYCLE_STEP,
) -> list[Result]:
    """One cycle of strain. The pressure rises by the share ``rise`` × strain."""
    strain = 0.04 * np.concatenate(
        [np.linspace(0, 1, 21), np.linspace(0.95, -1, 40), np.linspace(-0.95, 0, 20)]
    )
    made = []
    for lam in modulus:
        for fraction in cell.FRACTIONS[lam]:
            for seed in SEEDS:
                pressure = STIFFNESS[lam] * (fraction - 0.84)
                settings = (
                    ("grains", grains),
                    ("step", step),
                    ("packing_fraction", fraction),
                    ("protocol", 1),
                    ("cycles", 1),
                    ("friction", friction),
                    *material(lam),
                )
                made.append(
                    result(
                        Request("couette", packing(lam), seed, settings),
                        stroke=strain,
                        force=noise(seed) * modulus[lam] * math.sqrt(pressure) * strain,
                        normal=pressure * (1.0 + noise(seed) * rise * np.abs(strain)),
                    )
                )
    return made


def test_modulus_and_its_variations() -> None:
    """G ∝ √P, the same for all: a factor of √(2.5/0.3) = 2.9 at equal volume, which is more than twice; and a collapse."""
    all_alike = dict.fromkeys(LAMBDAS, 1.0)
    runs = cycles(all_alike)
    found = verdicts("shear_modulus", runs)
    assert found["lower for auxetic grains"] == HOLDS
    assert found["twice as low at large confinement"] == FAILS
    assert found["increases faster with confinement for regular grains"] == HOLDS
    assert set(verdicts("modulus_collapse", runs).values()) == {HOLDS}
    high = f"one curve for all at equal pressure, at {confinement.HIGH:g} k"
    odd = cycles({REGULAR: 1.0, AUXETIC: 1.7}, grains=cell.GRAINS // 2)
    assert verdicts("modulus_collapse", runs + odd)[high] == OPEN
    fine = cycles({REGULAR: 1.0, AUXETIC: 1.0}, step=small_cycles.PAPER_STEP)
    assert verdicts("modulus_collapse", runs + fine)[high] == HOLDS
    assert value(
        confinement.at_equal_pressure(small_cycles.modulus, confinement.HIGH, cell.finer_steps),
        runs + fine,
    ) == pytest.approx(1.0, abs=0.02)


def test_dilatancy_of_each_kind_and_between_them() -> None:
    lams = dict.fromkeys((REGULAR, 1.0, AUXETIC), 1.0)
    smooth = cycles(lams, friction=0.0)
    found = verdicts("dilatancy", cycles(lams, rise=5.0) + smooth)
    assert [found[f"the normal force increases, {k}"] for k in ("regular", "λ = 1", "auxetic")] == [
        HOLDS
    ] * 3
    assert found["no strong difference between the two"] == FAILS  # pressures differ by six here
    sinking = verdicts("dilatancy", cycles(lams, rise=-5.0) + smooth)
    assert HOLDS not in sinking.values()


def quakes_of(regular: float, auxetic: float, **changed: float) -> list[Result]:
    made = []
    for lam, size in ((REGULAR, regular), (AUXETIC, auxetic)):
        for seed in SEEDS:
            settings = {"grains": 400, "pressure": 0.02, "step": quakes.FINE, **changed}
            request = Request("avalanches", packing(lam), seed, (*settings.items(), *material(lam)))
            run = result(request, pressure=[0.02, 0.02])
            each = noise(seed) * size
            lists = {"participation": [each] * 3, "mean_change": [0.1 * each]}
            made.append(replace(run, lists=lists))
    return made


def test_avalanches_and_what_they_hang_on() -> None:
    says = "fewer grains take part"
    assert verdicts("participation", quakes_of(0.2, 0.1))[says] == HOLDS
    assert verdicts("force_changes", quakes_of(0.2, 0.1))["contact forces change less"] == HOLDS
    assert verdicts("participation", quakes_of(0.1, 0.2))[says] == FAILS
    small = quakes_of(0.1, 0.2, grains=200)
    assert verdicts("participation", quakes_of(0.2, 0.1) + small)[says] == OPEN
    silent = [replace(run, lists={"participation": []}) for run in quakes_of(0.2, 0.1)]
    with pytest.raises(Unmeasurable, match="no avalanche"):
        quakes.smaller("participation", "")(silent)

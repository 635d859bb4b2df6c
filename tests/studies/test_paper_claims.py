"""Sentences taken apart: every part of a claim has an aspect, a threshold, and runs that can be asked for."""

from __future__ import annotations

import math

import pytest

pytest.importorskip("scipy")

from sandbox.studies.paper import claims as parts_of
from sandbox.studies.paper.claims import ASPECTS, MUCH, Part
from sandbox.studies.paper.conditions import (
    FIRST,
    LAMBDAS,
    SETTING_UP,
    SYSTEMS,
    lam_of,
    material,
    packing,
)
from sandbox.studies.paper.probes import PROBES
from sandbox.studies.paper.runs import HAND, Request
from sandbox.studies.paper.shear import cell, confinement, dilatancy, steady
from sandbox.studies.paper.study import CLAIMS
from scenes import registry
from scenes.grains import material as grains_of


def all_parts() -> list[tuple[str, Part]]:
    return [(claim.name, part) for claim in CLAIMS for part in claim.parts]


def test_names_are_unique_and_every_run_can_be_asked_for() -> None:
    names = [claim.name for claim in CLAIMS]
    assert len(set(names)) == len(names)
    files = [figure.file for claim in CLAIMS for figure in claim.figures]
    assert len(set(files)) == len(files)
    for claim in CLAIMS:
        for quick in (True, False):
            requests = claim.runs(quick)
            assert len(set(requests)) == len(requests) > 0
            for request in requests:
                scene = registry.get(request.scene)
                scene.check_packing(request.packing)
                scene.settings(dict(request.settings))
                assert request.probe in PROBES or request.probe == HAND


@pytest.mark.parametrize(("name", "part"), all_parts())
def test_every_part_has_an_aspect_a_threshold_and_a_reason(name: str, part: Part) -> None:
    assert part.aspect in ASPECTS
    demand = part.threshold.demand
    assert math.isfinite(demand.low) or math.isfinite(demand.high)
    assert demand.low < demand.high
    assert len(part.threshold.reason) > 5
    assert part.says
    assert part.quantity
    assert not str(part.threshold).startswith("no number")


def test_direction_and_factor_are_judged_apart() -> None:
    """Where the words give a size, the part that asks for it asks for more than the part that asks for a direction."""
    for name in ("press", "compression", "shear_modulus", "yield_stress", "pressure_fluctuations"):
        claim = next(claim for claim in CLAIMS if claim.name == name)
        by_aspect = {part.aspect: part.threshold.demand for part in claim.parts}
        assert by_aspect["factor"].low > by_aspect["direction"].low
    assert not MUCH.demand.holds(1.9)
    assert parts_of.TWICE.demand.holds(2.0)
    assert not parts_of.TWICE.demand.holds(7.8)  # which is more than twice


def test_what_could_hang_on_size_or_step_is_varied() -> None:
    at_high = [
        p for n, p in all_parts() if n == "modulus_collapse" and f"{confinement.HIGH:g} k" in p.says
    ]
    (participation,) = [p for n, p in all_parts() if n == "participation"]
    for part in (*at_high, participation):
        words = " ".join(variation.condition for variation in part.variations)
        assert "grains" in words
        assert "step" in words


def test_the_seeds_that_judge_were_not_used_to_set_up() -> None:
    assert max(SETTING_UP) < FIRST
    for claim in CLAIMS:
        chance = {r.seed for r in claim.runs(False)} - {1}
        assert all(seed >= FIRST for seed in chance)
        dear = {claim.name for claim in (*steady.CLAIMS, *dilatancy.CLAIMS)} | {
            "hopper_no_friction"
        }
        if chance:
            assert len(chance) >= (cell.FEW if claim.name in dear else SYSTEMS)


@pytest.mark.parametrize("lam", LAMBDAS)
def test_materials_are_the_papers(lam: float) -> None:
    """ν = (λ − 1)/(λ + 1) and C = 2 + (λ + 1)²/(λμ) at μ = 0.1, in every scene whose grains have a λ here."""
    request = Request("biaxial_periodic", packing(lam), FIRST, material(lam))
    assert lam_of(request) == lam
    for scene in ("biaxial_periodic", "biaxial_press", "couette", "avalanches"):
        settings = registry.get(scene).settings(dict(material(lam)))
        nu, stiffness = grains_of(settings, packing(lam))
        assert nu == pytest.approx((lam - 1.0) / (lam + 1.0))
        assert stiffness == pytest.approx(2.0 + (lam + 1.0) ** 2 / (0.1 * lam))

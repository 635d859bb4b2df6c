"""The arithmetic of claims, on results made by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sandbox.studies.paper import bulk as paper_bulk
from sandbox.studies.paper import flow as paper_flow
from sandbox.studies.paper import grains as paper_grains
from sandbox.studies.paper import shear as paper_shear
from sandbox.studies.paper.claims import (
    Claim,
    Finding,
    Measured,
    Unmeasurable,
    cross,
    number,
    ratio,
)
from sandbox.studies.paper.probes import PROBES
from sandbox.studies.paper.runs import Request, Result
from sandbox.studies.paper.study import CLAIMS
from scenes import registry


def result(request: Request, **columns: object) -> Result:
    """A run that came to these columns."""
    return Result(request, {name: np.asarray(c).tolist() for name, c in columns.items()})


def test_means_and_spreads() -> None:
    measured = Measured.of("force", "k R", [1.0, 2.0, 3.0, 4.0])
    assert measured.mean == 2.5
    assert measured.spread == pytest.approx(math.sqrt(5.0 / 3.0))
    assert measured.error == pytest.approx(math.sqrt(5.0 / 12.0))
    assert str(measured) == "force 2.5 ± 1.3 k R"
    alone = Measured.of("share", "", 0.25)
    assert (alone.spread, alone.error, str(alone)) == (None, 0.0, "share 0.25")


def test_error_of_a_ratio_is_propagated() -> None:
    above, below = Measured.of("a", "", [3.0, 5.0]), Measured.of("b", "", [1.0, 3.0])
    value, error = ratio(above, below)
    assert value == 2.0
    assert error == pytest.approx(2.0 * math.hypot(1.0 / 4.0, 1.0 / 2.0))
    with pytest.raises(Unmeasurable):
        ratio(above, Measured.of("none", "", [0.0, 0.0]))


def test_a_curve_is_read_between_its_points() -> None:
    x, y = np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 10.0])
    assert cross(x, y, 2.0) == 6.0
    assert cross(x, y, 0.0) == 0.0
    with pytest.raises(Unmeasurable, match="before 4"):
        cross(x, y, 4.0)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1234.0, "1234"),
        (-0.5, "−0.5"),
        (2e-7, "2e−7"),
        (math.inf, "no number"),
        (math.nan, "no number"),
    ],
)
def test_numbers_for_people(value: float, text: str) -> None:
    assert number(value).replace("e-", "e−") == text


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
                assert request.probe in PROBES


def test_a_failed_run_leaves_its_claim_unmeasured() -> None:
    claim = Claim("c", "", "", lambda quick: (), lambda results: Finding(True, "never asked"))
    good = result(Request("hopper", "regular", 1))
    bad = Result(Request("hopper", "mixed", 5), failure="collapsed at increment 7 of 9")
    assert claim.find([good]).holds is True
    finding = claim.find([good, bad])
    assert finding.holds is None
    assert finding.verdict == "not measured"
    for word in ("1 of 2", "hopper, mixed, seed 5", "collapsed at increment 7 of 9"):
        assert word in finding.decided_by
    short = replace(good, ended="squeezed flat")
    assert claim.find([short]).holds is None
    assert replace(claim, bears_short_runs=True).find([short]).holds is True
    assert replace(claim, bears_short_runs=True).find([bad]).holds is None


def test_a_claim_that_cannot_be_judged_says_why() -> None:
    def judge(results: object) -> Finding:
        raise Unmeasurable("no avalanche")

    finding = Claim("c", "", "", lambda quick: (), judge).find([])
    assert (finding.holds, finding.decided_by) == (None, "no avalanche")


# Flow.


def pushes(regular: float, auxetic: float, mixed: float) -> list[Result]:
    """Hopper runs whose force is 100 before the last quarter of the stroke, and then as given, 10 % up or down by seed."""
    stroke = np.linspace(0.0, 20.0, 101)
    made = []
    for kind, force in (("regular", regular), ("auxetic", auxetic), ("mixed", mixed)):
        for seed, factor in ((1, 0.9), (2, 1.1)):
            late = np.where(stroke > 15.0, factor * force, 100.0)
            made.append(result(Request("hopper", kind, seed), stroke=stroke, force=late))
    return made


def test_hopper_compares_the_last_quarter() -> None:
    finding = paper_flow.judge_hopper(pushes(8.0, 2.0, 3.0))
    assert finding.holds is True
    assert finding.measured[0].mean == pytest.approx(8.0)
    assert "4 ±" in finding.decided_by
    assert "4 over the first 5 seeds" in finding.remark
    assert paper_flow.judge_hopper(pushes(3.5, 2.0, 3.0)).holds is False


def test_hopper_leaves_out_runs_that_ended_early_unless_they_are_many() -> None:
    runs = pushes(8.0, 2.0, 3.0)
    assert runs[4].request.packing == "mixed"
    runs[4] = replace(runs[4], ended="a grain was squeezed flat at increment 3 of 9")
    finding = paper_flow.judge_hopper_mixture(runs)
    assert finding.holds is True
    assert finding.measured[2].values == pytest.approx((3.3,))
    assert "1 mixed of 6 runs" in finding.remark
    assert "left out" not in paper_flow.judge_hopper(runs).remark
    runs[5] = replace(runs[5], ended="the same")
    with pytest.raises(Unmeasurable, match="only 0 of 2 mixed runs"):
        paper_flow.judge_hopper_mixture(runs)
    assert paper_flow.judge_hopper(runs).holds is True


def test_hopper_mixture_and_no_friction() -> None:
    assert paper_flow.judge_hopper_mixture(pushes(8.0, 2.0, 3.0)).holds is True
    assert paper_flow.judge_hopper_mixture(pushes(8.0, 2.0, 7.0)).holds is False
    assert paper_flow.judge_no_friction(pushes(0.004, 0.003, 1.0)).holds is True
    assert paper_flow.judge_no_friction(pushes(4.0, 0.003, 1.0)).holds is False


def drags(regular: float, auxetic: float, mixed: float) -> list[Result]:
    """Intruder runs with a sawtooth between 0.5 and 1.5 of a mean force."""
    made = []
    for kind, force in (("regular", regular), ("auxetic", auxetic), ("mixed", mixed)):
        for seed, factor in ((1, 0.98), (2, 1.02)):
            saw = 0.5 + (np.arange(400) % 5) / 4.0
            made.append(
                result(
                    Request("intruder", kind, seed),
                    stroke=np.arange(400) * 0.05,
                    force=factor * force * saw,
                )
            )
    return made


def test_drag_and_drops_of_the_intruder() -> None:
    runs = drags(0.8, 0.2, 0.3)
    finding = paper_flow.judge_drag(runs)
    assert finding.holds is True
    assert finding.measured[0].mean == pytest.approx(0.8)
    drops = paper_flow.judge_drops(runs)
    assert drops.holds is True
    assert drops.measured[0].mean == pytest.approx(0.8)  # from 1.5 to 0.5 of it
    assert paper_flow.judge_mixture_drag(runs).holds is True
    assert paper_flow.judge_mixture_drag(drags(0.8, 0.2, 0.7)).holds is False
    assert paper_flow.judge_drag(drags(0.2, 0.2, 0.2)).holds is False


# Compression.


def squeezes(stiffness: dict[float, float], contacts: dict[float, float]) -> list[Result]:
    """Pressure proportional to strain; Z = 4 + contacts × strain."""
    strain = np.linspace(0.0, 0.1, 21)
    made = []
    for packing, setting in paper_bulk.kinds():
        for seed, noise in ((1, 0.99), (2, 1.01)):
            nu = setting[1]
            made.append(
                result(
                    Request("biaxial_periodic", packing, seed, (setting,)),
                    stroke=strain,
                    force=5e-4 + noise * stiffness[nu] * strain,
                    z=4.0 + noise * contacts[nu] * strain,
                )
            )
    return made


def test_compression_and_contacts() -> None:
    runs = squeezes({0.8: 2.0, 0.0: 0.6, -0.8: 0.3}, {0.8: 30.0, 0.0: 15.0, -0.8: 10.0})
    finding = paper_bulk.judge_squeeze(runs)
    assert finding.holds is True
    assert finding.measured[0].mean == pytest.approx(0.1605)
    assert paper_bulk.judge_contacts_strain(runs).holds is True
    assert paper_bulk.judge_contacts_pressure(runs).holds is True
    assert paper_bulk.judge_onset(runs).holds is True
    alike = squeezes({0.8: 2.0, 0.0: 2.0, -0.8: 2.0}, {0.8: 30.0, 0.0: 30.0, -0.8: 30.0})
    assert paper_bulk.judge_squeeze(alike).holds is False
    assert paper_bulk.judge_contacts_strain(alike).holds is False
    assert paper_bulk.judge_contacts_pressure(alike).holds is False
    assert len(paper_bulk.squeeze_panels(runs)) == 3


# Shear.


def shears(friction: dict[float, float], stiffness: dict[float, float]) -> list[Result]:
    """Steady flow at τ = friction × P, with P = stiffness × (φ − 0.84)."""
    strain = np.linspace(0.0, 1.0, 101)
    made = []
    for packing, setting in paper_bulk.kinds():
        nu = setting[1]
        fractions = (*paper_shear.FRACTIONS, *(paper_shear.AUXETIC_FRACTIONS if nu < 0.0 else ()))
        for fraction in fractions:
            for seed, noise in ((1, 0.99), (2, 1.01)):
                pressure = noise * stiffness[nu] * (fraction - 0.84)
                request = Request(
                    "couette",
                    packing,
                    seed,
                    (("packing_fraction", fraction), ("protocol", 0), setting),
                )
                wave = 1.0 + 0.1 * np.sin(40.0 * strain)
                made.append(
                    result(
                        request,
                        stroke=strain,
                        force=friction[nu] * pressure * np.minimum(strain / 0.1, 1.0),
                        normal=pressure * wave,
                    )
                )
    return made


def test_yield_stress_collapses_if_friction_is_the_same() -> None:
    same = shears({0.8: 0.1, 0.0: 0.1, -0.8: 0.1}, {0.8: 1.0, 0.0: 0.7, -0.8: 0.5})
    finding = paper_shear.judge_yield(same)
    assert finding.holds is True
    assert "0.94, regular / auxetic 2 ±" in finding.decided_by
    assert paper_shear.judge_friction(same).holds is True
    assert paper_shear.judge_fluctuation(same).holds is True
    collapse = paper_shear.judge_yield_collapse(same)
    assert collapse.holds is True
    assert collapse.measured[0].mean == pytest.approx(1.0, abs=0.02)
    different = shears({0.8: 0.2, 0.0: 0.1, -0.8: 0.1}, {0.8: 1.0, 0.0: 0.7, -0.8: 0.5})
    assert paper_shear.judge_friction(different).holds is False
    assert paper_shear.judge_yield_collapse(different).holds is False
    assert len(paper_shear.yield_panels(same)) == 4


def test_no_common_pressure_is_no_collapse() -> None:
    apart = shears({0.8: 0.1, 0.0: 0.1, -0.8: 0.1}, {0.8: 10.0, 0.0: 1.0, -0.8: 0.1})
    with pytest.raises(Unmeasurable, match="share no range"):
        paper_shear.judge_yield_collapse(apart)


def cycles(modulus: dict[float, float], rise: float = 0.0, friction: float = 0.5) -> list[Result]:
    """One cycle of strain; the stress of seed 2 is twice as high. The pressure rises by the share ``rise`` × strain."""
    strain = 0.04 * np.concatenate(
        [np.linspace(0, 1, 21), np.linspace(0.95, -1, 40), np.linspace(-0.95, 0, 20)]
    )
    made = []
    for packing, setting in paper_bulk.kinds():
        for fraction in paper_shear.FRACTIONS:
            for seed in (1, 2):
                nu = setting[1]
                pressure = modulus[nu] * (fraction - 0.84)
                request = Request(
                    "couette",
                    packing,
                    seed,
                    (
                        ("packing_fraction", fraction),
                        ("protocol", 1),
                        ("cycles", 1),
                        ("friction", friction),
                        setting,
                    ),
                )
                made.append(
                    result(
                        request,
                        stroke=strain,
                        force=seed * modulus[nu] * strain,
                        normal=pressure * (1.0 + rise * np.abs(strain)),
                    )
                )
    return made


def test_modulus_and_dilatancy() -> None:
    runs = cycles({0.8: 0.4, 0.0: 0.3, -0.8: 0.2}, rise=5.0)
    assert paper_shear.modulus(runs[0]) == pytest.approx(0.4)
    finding = paper_shear.judge_modulus(runs)
    assert finding.measured[0].values == pytest.approx((0.4, 0.8))
    assert finding.holds is False  # two seeds that differ by a factor of two prove nothing
    smooth = cycles({0.8: 0.4, 0.0: 0.3, -0.8: 0.2}, friction=0.0)
    assert paper_shear.judge_dilatancy(runs + smooth).holds is True
    flat = cycles({0.8: 0.4, 0.0: 0.3, -0.8: 0.2}) + smooth
    assert paper_shear.judge_dilatancy(flat).holds is False


def quakes(regular: float, auxetic: float) -> list[Result]:
    made = []
    for packing, setting in paper_bulk.kinds((0.8, -0.8)):
        size = auxetic if packing == "auxetic" else regular
        for seed, noise in ((1, 0.95), (2, 1.05)):
            request = Request("avalanches", packing, seed, (setting,))
            run = result(request, pressure=[0.02, 0.02])
            lists = {"participation": [noise * size] * 3, "mean_change": [0.1 * noise * size]}
            made.append(replace(run, lists=lists))
    return made


def test_avalanches() -> None:
    assert paper_shear.judge_participation(quakes(0.2, 0.1)).holds is True
    assert paper_shear.judge_changes(quakes(0.2, 0.1)).holds is True
    assert paper_shear.judge_participation(quakes(0.1, 0.2)).holds is False
    silent = [replace(run, lists={"participation": []}) for run in quakes(0.2, 0.1)]
    with pytest.raises(Unmeasurable, match="no avalanche"):
        paper_shear.judge_participation(silent)


# Single grains.


def test_row_of_grains() -> None:
    def row(kind: str, sideways: float) -> Result:
        down = np.array([0.0, 1.0, 2.0])
        return result(Request("grain_row", kind), force=sideways * down, down=down)

    finding = paper_grains.judge_row([row("regular", 0.7), row("auxetic", 0.0)])
    assert finding.holds is True
    assert paper_grains.judge_row([row("regular", 0.7), row("auxetic", 0.1)]).holds is False


def test_overlap_factor_knows_the_true_expansion() -> None:
    """Fed with the paper's own factor of 5 the claim holds; with the true −3 it does not."""

    def ellipses(exact: float) -> list[Result]:
        made = []
        for aspect in paper_grains.ASPECTS:
            stretch, tilt = aspect - 1.0, np.array([0.0, 45.0])
            bend = stretch**2 * (1.0 - np.cos(np.deg2rad(4.0 * tilt))) / 16.0
            first = 2.0 + 2.0 * stretch * np.cos(np.deg2rad(tilt)) ** 2
            made.append(
                result(
                    Request("two_ellipses", "regular", settings=(("aspect", aspect),)),
                    stroke=tilt,
                    a=[aspect, aspect],
                    b=[1.0, 1.0],
                    exact_distance=first + exact * bend,
                    model_distance=first + 2.0 * bend,
                )
            )
        return made

    assert paper_grains.judge_overlap_factor(ellipses(10.0)).holds is True
    finding = paper_grains.judge_overlap_factor(ellipses(-6.0))
    assert finding.holds is False
    assert "−3," in finding.decided_by

"""Sentences taken apart, and the arithmetic of their parts, on results made by hand."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("scipy")

from sandbox.ensemble.estimates import Exact, Student
from sandbox.studies.common.verdicts import FAILS, HOLDS, OPEN, Demand
from sandbox.studies.paper import bulk, cost, grains, hopper, intruder, quakes, report
from sandbox.studies.paper import claims as parts_of
from sandbox.studies.paper.claims import (
    ASPECTS,
    MORE,
    MUCH,
    NOT_MEASURED,
    Claim,
    Finding,
    Measured,
    Part,
    Reading,
    Threshold,
    Unmeasurable,
    Variation,
    cross,
    number,
    settle,
)
from sandbox.studies.paper.conditions import (
    AUXETIC,
    FIRST,
    LAMBDAS,
    REGULAR,
    SETTING_UP,
    SYSTEMS,
    lam_of,
    material,
    packing,
)
from sandbox.studies.paper.probes import PROBES
from sandbox.studies.paper.runs import HAND, Request, Result
from sandbox.studies.paper.shear import cell, confinement, dilatancy, small_cycles, steady
from sandbox.studies.paper.study import CLAIMS
from scenes import registry
from scenes.grains import material as grains_of
from scenes.scene import HAND_STRENGTH

SEEDS = range(101, 107)


def noise(seed: int) -> float:
    """A few per cent up or down, the same for both kinds of a seed, and a little more for itself."""
    return 1.0 + 0.02 * math.sin(7.0 * seed)


def result(request: Request, **columns: object) -> Result:
    """A run that came to these columns."""
    return Result(request, {name: np.asarray(c).tolist() for name, c in columns.items()})


def verdicts(name: str, results: Sequence[Result]) -> dict[str, str]:
    """Verdict on each part of a claim, by what it says, judged as if the claim were the whole study."""
    claim = next(claim for claim in CLAIMS if claim.name == name)
    return {f.part.says: f.verdict for f in settle(claim.find(results))}


def value(measure: Callable[[Sequence[Result]], Reading], results: Sequence[Result]) -> float:
    return measure(results).estimate.value


# How sentences are taken apart.


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


# Verdicts.


def made_up(
    estimate: object,
    threshold: Threshold = MORE,
    varied: Sequence[object] = (),
) -> Finding:
    """A finding of a claim whose part has measured just that."""

    def measuring(what: object) -> Callable[[Sequence[Result]], Reading]:
        def measure(_: Sequence[Result]) -> Reading:
            if isinstance(what, str):
                raise Unmeasurable(what)
            return Reading(what)  # type: ignore[arg-type]

        return measure

    variations = tuple(Variation(f"condition {k}", measuring(v)) for k, v in enumerate(varied))
    part = Part("direction", "says", "quantity", threshold, measuring(estimate), variations)
    (finding,) = Claim("c", "", "", lambda quick: (), (part,)).find([])
    return finding


def test_a_failed_run_leaves_its_claim_unmeasured() -> None:
    part = Part("value", "says", "quantity", MORE, lambda _: Reading(Exact(2.0)))
    claim = Claim("c", "", "", lambda quick: (), (part, part))
    good = result(Request("hopper", "regular", 1))
    bad = Result(Request("hopper", "mixed", 5), failure="collapsed at increment 7 of 9")
    assert [f.verdict for f in settle(claim.find([good]))] == [HOLDS, HOLDS]
    for finding in settle(claim.find([good, bad])):
        assert finding.verdict == NOT_MEASURED
        for word in ("1 of 2", "hopper, mixed, seed 5", "collapsed at increment 7 of 9"):
            assert word in finding.decided_by
    short = replace(good, ended="squeezed flat")
    patient = replace(claim, bears_short_runs=True)
    assert settle(claim.find([short]))[0].verdict == NOT_MEASURED
    assert settle(patient.find([short]))[0].verdict == HOLDS
    assert settle(patient.find([bad]))[0].verdict == NOT_MEASURED


def test_a_part_that_cannot_be_measured_says_why() -> None:
    (finding,) = settle([made_up("no avalanche")])
    assert (finding.verdict, finding.decided_by) == (NOT_MEASURED, "no avalanche")


def test_what_a_variation_contradicts_is_not_established() -> None:
    sure, other = Student(2.0, 0.01, 15.0), Student(0.8, 0.05, 7.0)
    unsure = Student(0.8, 0.5, 7.0)
    assert settle([made_up(sure)])[0].verdict == HOLDS
    assert settle([made_up(sure, varied=[unsure, "not run"])])[0].verdict == HOLDS
    (contradicted,) = settle([made_up(sure, varied=[sure, other])])
    assert contradicted.verdict == OPEN
    assert "condition 1" in contradicted.decided_by
    (refuted,) = settle([made_up(other, Threshold(Demand(1.0), "reason"), [sure])])
    assert refuted.verdict == FAILS


def test_three_verdicts_in_words() -> None:
    findings = settle(
        [made_up(Student(v, e, 15.0)) for v, e in ((2.0, 0.01), (0.5, 0.01), (1.1, 0.2))]
    )
    assert [f.verdict for f in findings] == [HOLDS, FAILS, OPEN]
    assert all(f.p is not None for f in findings)
    assert "2 (1.98 to 2.02), must be above 1" in findings[0].decided_by


def test_means_and_spreads() -> None:
    measured = Measured.of("force", "k R", [1.0, 2.0, 3.0, 4.0])
    assert measured.mean == 2.5
    assert measured.spread == pytest.approx(math.sqrt(5.0 / 3.0))
    assert str(measured) == "force 2.5 ± 1.3 k R"
    alone = Measured.of("share", "", 0.25)
    assert (alone.spread, str(alone)) == (None, "share 0.25")


def test_a_ratio_of_nothing_is_told() -> None:
    some, none = Measured.of("a", "", [1.0, 1.0]), Measured.of("none", "", [0.0, 0.0])
    rows = ([(1, 1.0), (2, 1.0)], [(1, 0.0), (2, 0.0)])
    with pytest.raises(Unmeasurable, match="none is not above 0"):
        parts_of.ratio(some, none, rows)
    with pytest.raises(Unmeasurable, match="no seed"):
        parts_of.ratio(some, none, ([(1, 1.0)], [(2, 1.0)]))


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


# Hopper.


def pushes(forces: dict[str, float], locked: dict[str, float]) -> list[Result]:
    """Piston forces that rise from half to all of a mean with a sawtooth on it; hands that lock that share of packings."""
    stroke = np.linspace(0.0, 20.0, 101)
    made = []
    for kind in hopper.KINDS:
        for seed in range(101, 141):
            rising = forces[kind] * noise(seed) * (0.5 + stroke / 40.0)
            saw = 0.2 * forces[kind] * (np.arange(101) % 5)
            machine = Request("hopper", kind, seed, (("friction", 0.5),))
            made.append(
                result(machine, stroke=stroke, force=rising + saw, grains_out=10.0 * stroke)
            )
            for strength in hopper.STRENGTHS:
                stuck = (seed - 101) < 40 * locked[kind]
                hand = Request("hopper", kind, seed, ((HAND_STRENGTH, strength),), probe=HAND)
                lists = {"locked": [float(stuck)], "out": [10.0 if stuck else 180.0]}
                made.append(Result(hand, lists=lists))
    return made


def test_hopper_counts_what_locks() -> None:
    runs = pushes(
        {"regular": 5.0, "auxetic": 0.8, "mixed": 1.2},
        {"regular": 1.0, "auxetic": 0.0, "mixed": 0.1},
    )
    assert set(verdicts("hopper", runs).values()) == {HOLDS}
    reading = hopper.locks("regular", hopper.DEFAULT)(runs)
    assert reading.remark == "40 of 40 locked"
    assert reading.estimate.interval()[0] == pytest.approx(0.912, abs=1e-3)


def test_hopper_does_not_say_more_than_it_shows() -> None:
    """All alike: nothing locks more often than anything, and half of all is no verdict on most of them."""
    same = dict.fromkeys(hopper.KINDS, 0.5)
    found = verdicts("hopper", pushes(dict.fromkeys(hopper.KINDS, 2.0), same))
    assert found["the rings clog"] == OPEN
    assert found["metagrains flow"] == OPEN
    assert found["rings clog more often than auxetic, hand of 8 k R"] == OPEN
    assert found["more force for rings than for auxetic"] == OPEN
    assert found["a large build up of force: much more than for mixed"] == FAILS


def test_hopper_leaves_out_runs_that_ended_early_unless_they_are_many() -> None:
    forces = {"regular": 5.0, "auxetic": 0.8, "mixed": 1.2}
    runs = pushes(forces, dict.fromkeys(hopper.KINDS, 0.0))
    mixed = [k for k, r in enumerate(runs) if r.request.packing == "mixed" and not r.lists]
    runs[mixed[0]] = replace(runs[mixed[0]], ended="a grain was squeezed flat")
    reading = hopper.force_over(hopper.peak, "regular", "mixed")(runs)
    assert "1 mixed of 120 runs" in reading.remark
    for k in mixed[:30]:
        runs[k] = replace(runs[k], ended="the same")
    with pytest.raises(Unmeasurable, match="only 10 of 40 mixed runs"):
        hopper.force_over(hopper.peak, "regular", "auxetic")(runs)


def test_a_run_that_ended_early_leaves_the_figure_whole() -> None:
    runs = pushes({"regular": 5.0, "auxetic": 0.8, "mixed": 1.2}, dict.fromkeys(hopper.KINDS, 0.0))
    k = next(k for k, r in enumerate(runs) if r.request.packing == "mixed")
    short = {name: values[:40] for name, values in runs[k].columns.items()}
    runs[k] = replace(runs[k], columns=short, ended="a grain was squeezed flat")
    one, mean, locked = hopper.hopper_panels(runs)
    assert [len(line.x) for line in one.lines] == [101, 101, 40]
    assert [len(line.x) for line in mean.lines] == [101, 101, 101]
    assert all(len(line.x) == len(line.y) for p in (one, mean, locked) for line in p.lines)


def test_hopper_avalanches_and_no_friction() -> None:
    runs = pushes({"regular": 5.0, "auxetic": 0.8, "mixed": 1.2}, dict.fromkeys(hopper.KINDS, 0.0))
    machine = [r for r in runs if not r.lists]
    assert set(verdicts("hopper_mixture", machine).values()) == {HOLDS}
    weak = pushes(dict.fromkeys(hopper.KINDS, 0.004), dict.fromkeys(hopper.KINDS, 0.0))
    assert set(verdicts("hopper_no_friction", [r for r in weak if not r.lists]).values()) == {HOLDS}
    assert set(verdicts("hopper_no_friction", machine).values()) == {FAILS}


# Intruder.


def drags(regular: float, auxetic: float, mixed: float) -> list[Result]:
    """Intruder runs with a sawtooth between 0.5 and 1.5 of a mean force."""
    made = []
    for kind, force in (("regular", regular), ("auxetic", auxetic), ("mixed", mixed)):
        for seed in SEEDS:
            saw = 0.5 + (np.arange(400) % 5) / 4.0
            forces = noise(seed) * force * saw
            made.append(
                result(Request("intruder", kind, seed), stroke=np.arange(400) * 0.05, force=forces)
            )
    return made


def test_drag_and_drops_of_the_intruder() -> None:
    runs = drags(0.8, 0.2, 0.3)
    assert value(intruder.over(intruder.drag, "regular", "auxetic"), runs) == pytest.approx(4.0)
    assert value(intruder.over(intruder.mean_drop, "regular", "mixed"), runs) == pytest.approx(
        0.8 / 0.3
    )
    assert value(intruder.mixture_on_the_way, runs) == pytest.approx(1.0 / 6.0)
    assert set(verdicts("intruder_drag", runs).values()) == {HOLDS}
    assert set(verdicts("intruder_drops", runs).values()) == {HOLDS}
    assert verdicts("intruder_mixture", runs) == {
        "nearer to the metagrains than to the rings": HOLDS,
        "almost the same drag": FAILS,  # half as much again
        "larger fluctuations than metagrains": HOLDS,
    }
    assert set(verdicts("intruder_drag", drags(0.2, 0.3, 0.3)).values()) == {FAILS}
    far = verdicts("intruder_mixture", drags(0.8, 0.2, 0.7))
    assert far["nearer to the metagrains than to the rings"] == FAILS


# Compression.


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
    alike = squeezes(dict.fromkeys(LAMBDAS, 2.0), dict.fromkeys(LAMBDAS, 30.0))
    assert verdicts("compression", alike)["a much slower one"] == FAILS
    assert HOLDS not in verdicts("contacts_strain", alike).values()
    assert HOLDS not in verdicts("contacts_pressure", alike).values()
    assert len(bulk.squeeze_panels(runs)) == 3


# Shear.


def shears(friction: dict[float, float], stiffness: dict[float, float]) -> list[Result]:
    """Steady flow at τ = friction × P, with P = stiffness × (φ − 0.84), in waves of a tenth."""
    strain = np.linspace(0.0, 1.0, 101)
    made = []
    for lam, fractions in cell.FRACTIONS.items():
        for fraction in fractions:
            for seed in SEEDS:
                pressure = noise(seed) * stiffness[lam] * (fraction - 0.84)
                settings = (
                    ("grains", cell.GRAINS),
                    ("step", steady.STEP),
                    ("packing_fraction", fraction),
                    ("protocol", cell.STEADY),
                    *material(lam),
                )
                wave = 1.0 + 0.1 * noise(seed + 1) * np.sin(40.0 * strain)
                made.append(
                    result(
                        Request("couette", packing(lam), seed, settings),
                        stroke=strain,
                        force=friction[lam] * pressure * wave * np.minimum(strain / 0.1, 1.0),
                        normal=pressure * wave,
                    )
                )
    return made


STIFFNESS = dict(zip(LAMBDAS, (0.3, 0.3, 0.7, 2.5, 8.0), strict=True))


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


# Single grains.


def test_row_of_grains() -> None:
    def row(kind: str, sideways: float) -> Result:
        down = np.array([0.0, 1.0, 2.0])
        return result(Request("grain_row", kind), force=sideways * down, down=down)

    assert set(verdicts("grain_row", [row("regular", 0.7), row("auxetic", 0.0)]).values()) == {
        HOLDS
    }
    pushed = verdicts("grain_row", [row("regular", 0.7), row("auxetic", 0.1)])
    assert pushed["auxetic grains never do"] == FAILS


def test_overlap_factor_knows_the_true_expansion() -> None:
    """Fed with the paper's own factor of 5 the claim holds; with the true −3 it does not."""

    def ellipses(exact: float) -> list[Result]:
        made = []
        for aspect in grains.ASPECTS:
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

    says = "a difference by a factor of 5"
    assert verdicts("overlap_factor", ellipses(10.0))[says] == HOLDS
    assert verdicts("overlap_factor", ellipses(-6.0))[says] == FAILS
    assert value(grains.overlap_factor, ellipses(-6.0)) == pytest.approx(-3.0)


# What is told.


def test_a_table_has_one_row_a_run_and_nothing_breaks_out_of_its_cells() -> None:
    runs = pushes(dict.fromkeys(hopper.KINDS, 1.0), dict.fromkeys(hopper.KINDS, 0.5))[:12]
    used = {run.request: ["hopper"] for run in runs}
    lines = report.as_table(runs, used).splitlines()
    assert len(lines) == 13
    header = lines[0].split(",")
    assert {
        "claims",
        "scene",
        "packing",
        "seed",
        HAND_STRENGTH,
        "force_mean",
        "locked_mean",
    } <= set(header)
    assert all(len(line.split(",")) == len(header) for line in lines)
    claim = Claim("c", "Fig. | 1", "a | b", lambda quick: (), (made_up(Exact(2.0)).part,))
    judged = [report.Judged(claim, tuple(settle(claim.find([]))))]
    text = report.as_markdown(judged, [], {})
    assert "“a \\| b”" in text
    assert "| direction: says | quantity: 2 | above 1 | no chance | **holds** |" in text
    assert "Must be above 1: a direction" in text


def test_the_cost_of_the_papers_conditions_is_extrapolated() -> None:
    """Steps five times as many that take twice as long: 25 times as many take four times as long."""
    plain = [replace(run, seconds=10.0) for run in shears(dict.fromkeys(LAMBDAS, 0.1), STIFFNESS)]
    fine = []
    for run in plain:
        settings = dict(run.request.settings)
        if settings["packing_fraction"] == cell.COMMON[-1] and settings["grains"] == cell.GRAINS:
            asked = replace(run.request, settings=tuple({**settings, "step": 0.01}.items()))
            fine.append(replace(run, request=asked, seconds=20.0))
    assert cost.growth(plain) == 1.0
    assert cost.growth(plain + fine) == pytest.approx(math.log(2.0) / math.log(5.0))
    (steady,) = cost.estimate(plain + fine)
    assert steady.protocol.startswith("Fig. 4")
    points = max(len(fractions) for fractions in cell.FRACTIONS.values())
    assert steady.runs == SYSTEMS * points * len(LAMBDAS)
    assert steady.hours == pytest.approx(steady.runs * 10.0 * 4.0 / 3600.0)
    assert cost.estimate([run for run in plain if lam_of(run.request) != AUXETIC]) == []

"""Whatever a built-in lesson says about physics is a closed form, or held here on several seeds; a tendency by most of them.

``HELD`` names, for every step that says something about an outcome, the test that holds it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest

from core import observables
from sandbox.lessons import classroom
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from sandbox.studies.hand.tour_claims import play_lesson
from sandbox.window.measure.gauges import force_through
from scenes.couette import plate_stresses
from scenes.grain_row import free_room

SEEDS = (1, 2, 3)  # that of the lessons among them
KINDS = ("regular", "mixed", "auxetic")

HELD = {
    ("poisson", "guess"): "test_widths_follow_poissons_ratio",
    ("poisson", "number"): "test_widths_follow_poissons_ratio",
    ("poisson", "zero"): "test_widths_follow_poissons_ratio",
    ("poisson", "stiff"): "test_between_two_plates_both_are_equally_stiff_at_first",
    ("poisson", "four"): "test_from_all_sides_the_regular_grain_is_stiffer",
    ("poisson", "row"): "test_who_pushes_sideways",
    ("poisson", "reckon"): "test_what_is_reckoned",
    ("mixture", "row"): "test_who_pushes_sideways",
    ("mixture", "box"): "test_pressure_rises_fastest_where_nothing_gives_way",
    ("mixture", "push"): "test_the_regular_hopper_locks_alone",
    ("mixture", "flow"): "test_the_regular_hopper_locks_alone",
    ("mixture", "chains"): "test_the_regular_hopper_locks_alone",
    ("mixture", "explain"): "test_packings_differ_in_poissons_ratio_alone",
    ("arches", "narrow"): "test_arches_over_a_narrow_orifice",
    ("arches", "count"): "test_arches_over_a_narrow_orifice",
    ("arches", "shake"): "test_every_step_can_be_done",
    ("arches", "wide"): "test_more_grains_leave_a_wide_orifice_or_without_friction",
    ("arches", "smooth"): "test_more_grains_leave_a_wide_orifice_or_without_friction",
    ("arches", "explain"): "test_more_grains_leave_a_wide_orifice_or_without_friction",
    ("yield", "rise"): "test_stress_rises_then_goes_up_and_down",
    ("yield", "mean"): "test_stress_rises_then_goes_up_and_down",
    ("yield", "compare"): "test_pressure_decides_about_the_yield_stress",
    ("yield", "ratio"): "test_pressure_decides_about_the_yield_stress",
    ("yield", "loose"): "test_loose_grains_bear_nothing",
    ("yield", "reckon"): "test_what_is_reckoned",
    ("friction", "law"): "test_what_is_reckoned",
    ("friction", "smooth"): "test_pressure_decides_about_the_yield_stress",
    ("friction", "rough"): "test_friction_raises_the_ratio_more_than_threefold",
    ("friction", "walls"): "test_rough_walls_carry_a_part_of_the_load",
    ("friction", "without"): "test_without_friction_the_hopper_flows_under_hardly_any_force",
    ("friction", "pile"): "test_what_is_reckoned",  # and `study classics` piles them
    ("residual", "balance"): "test_cuts_agree_as_far_as_the_residual_says",
    ("residual", "loose"): "test_cuts_agree_as_far_as_the_residual_says",
    ("residual", "price"): "test_many_digits_cost_a_few_times_the_work",
    ("residual", "model"): "test_the_model_sees_contact_early_however_fine_the_tolerance",
    ("residual", "hard"): "test_overlaps_take_two_over_c_of_an_approach",
    ("residual", "chance"): "test_what_is_reckoned",
}  # fmt: skip


def test_every_step_is_held() -> None:
    steps = {
        (name, step.key) for name in classroom.names() for step in classroom.lesson(name).steps
    }
    assert steps == set(HELD)
    assert set(HELD.values()) <= set(globals())


def settings(lesson: str, key: str) -> dict[str, object]:
    """What a step sets."""
    step = next(step for step in classroom.lesson(lesson).steps if step.key == key)
    return dict(step.settings)


def right(lesson: str, key: str) -> float:
    """The right option, from 1, or the right number."""
    predict = next(s.predict for s in classroom.lesson(lesson).steps if s.key == key)
    assert predict is not None
    assert predict.right is not None
    return predict.right + (predict.kind == "choice")


def begun(scene: str, kind: str, seed: int, given: dict[str, object]) -> Session:
    session = Session(scene, kind, seed, given)
    session.build()
    session.submit(Protocol(True))
    return session


def run(scene: str, kind: str, seed: int, increments: int, **given: object) -> Session:
    """After so many increments of the scene's own drive, or when it is at its end or locked."""
    session = begun(scene, kind, seed, given)
    done = 0
    while done < increments and not (done and (session.idle or session.run.locked)):
        done += session.advance(4000)
    return session


def strains(session: Session) -> tuple[float, float]:
    """Of height and width of a single grain."""
    packing = session.run.setup.packing
    tall, wide = (
        np.array([packing.p - packing.q1, packing.p + packing.q1]) / packing.rest_radius - 1
    )
    return float(tall[0]), float(wide[0])


# -- poisson --


def test_widths_follow_poissons_ratio() -> None:
    regular = strains(
        run("single_grain", "regular", 1, 20)
    )  # plate by 0.1 R, a twentieth of a diameter
    auxetic = strains(run("single_grain", "auxetic", 1, 20))
    assert regular[0] == pytest.approx(-0.05, abs=0.003)
    assert regular[1] > 0.0 > auxetic[1]
    assert (right("poisson", "guess"), right("poisson", "number")) == (3, 4.0)
    assert 100.0 * regular[1] * 0.05 / -regular[0] == pytest.approx(4.0, abs=0.3)
    for kind in ("regular", "auxetic"):
        tall, wide = strains(run("single_grain", kind, 1, 20, **settings("poisson", "zero")))
        assert abs(wide) < 0.1 * abs(tall)


def test_between_two_plates_both_are_equally_stiff_at_first() -> None:
    ends = []
    for kind in ("regular", "auxetic"):
        stroke, force = run("single_grain", kind, 1, 80).history.curve
        assert force[4] / stroke[4] == pytest.approx(1.0, abs=0.02)
        ends.append(force[-1])
    assert falling(ends), "further on they part"


def test_from_all_sides_the_regular_grain_is_stiffer() -> None:
    frame = run("single_grain", "mixed", 1, 10, four_plates=True).frame()
    force = np.bincount(frame.contacts.i, frame.contacts.force, frame.grains)
    assert force[~frame.auxetic].sum() > 7.0 * force[frame.auxetic].sum()
    assert pytest.approx([5.0, 0.56], abs=0.005) == [1.0 / (1.0 - 0.8), 1.0 / 1.8]
    assert right("poisson", "four") == 2


def test_who_pushes_sideways() -> None:
    sessions = {kind: run("grain_row", kind, 1, 40) for kind in KINDS}
    force = {kind: float(session.history.curve[1, -1]) for kind, session in sessions.items()}
    assert force["regular"] > 0.0
    assert 0.0 < force["mixed"] < 0.3 * force["regular"]
    assert force["auxetic"] == 0.0
    assert free_room(sessions["auxetic"].run.setup) > 0.0
    assert (right("poisson", "row"), right("mixture", "row")) == (2, 3)


def test_what_is_reckoned() -> None:
    assert right("poisson", "reckon") == pytest.approx(0.6 / 2.0)
    assert right("yield", "reckon") == pytest.approx(0.1 * 0.06)
    assert right("friction", "law") == pytest.approx(0.4 * 2.0)
    assert right("friction", "pile") == pytest.approx(math.tan(math.radians(15.0)), abs=1e-4)
    assert right("residual", "chance") == pytest.approx((0.2 / 0.05) ** 2)
    assert right("residual", "hard") == pytest.approx(100.0 * 2.0 / 50.0)


# -- mixture --


def falling(values: Sequence[float]) -> bool:
    return all(a > b for a, b in itertools.pairwise(values))


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_pressure_rises_fastest_where_nothing_gives_way(seed: int) -> None:
    given = settings("mixture", "box")
    ends = [run("biaxial_periodic", kind, seed, 14, **given).history.curve[1, -1] for kind in KINDS]
    assert falling(ends)
    assert ends[1] < 0.5 * (ends[0] + ends[2]), "half of them bring it down by more than half"


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_the_regular_hopper_locks_alone(seed: int) -> None:
    regular = run("hopper", "regular", seed, 400)
    assert regular.run.locked
    frame, strength = regular.frame(), regular.run.strength
    forces = frame.contacts.force[frame.contacts.force > 0.0]
    assert forces.max() > 2.0 * forces.mean()
    for kind in ("mixed", "auxetic"):
        other = run("hopper", kind, seed, len(regular.history) - 1)
        assert not other.run.locked
        assert other.history.curve[1].max() < strength
        loaded = other.frame().contacts.force
        assert loaded[loaded > 0.0].mean() < forces.mean()
    assert right("mixture", "push") == 1


def test_packings_differ_in_poissons_ratio_alone() -> None:
    sessions = [run("hopper", kind, 1, 0) for kind in ("regular", "auxetic")]
    first, second = (session.run.setup.packing for session in sessions)
    assert np.array_equal(np.sort(first.rest_radius), np.sort(second.rest_radius))
    assert sessions[0].settings == sessions[1].settings
    assert not np.any(np.sign(first.poisson_ratio) == np.sign(second.poisson_ratio))


# -- arches --


@pytest.mark.slow
def test_arches_over_a_narrow_orifice() -> None:
    sizes = []
    for seed in SEEDS:
        session = begun("gravity_hopper", "mixed", seed, settings("arches", "narrow"))
        while not {e.kind for e in session.history.events} & {"clog", "arch"}:
            session.advance(4000)
        frame = session.frame()
        assert frame.grains_out <= 10
        assert frame.highlight is not None
        sizes.append(int(frame.highlight.sum()))
    assert sum(3 <= size <= 7 for size in sizes) >= 2
    assert right("arches", "count") == 5.0
    assert right("arches", "narrow") == 3


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_more_grains_leave_a_wide_orifice_or_without_friction(seed: int) -> None:
    out = {
        key: run("gravity_hopper", "mixed", seed, 250, **settings("arches", key), shake=0.0)
        .frame()
        .grains_out
        for key in ("narrow", "wide", "smooth")
    }
    assert out["narrow"] <= 10
    assert out["wide"] > 20 + 2 * out["narrow"]
    assert out["smooth"] > 15
    assert (right("arches", "wide"), right("arches", "smooth"), right("arches", "explain")) == (
        1,
        2,
        2,
    )


# -- yield, friction --


@cache
def sheared(
    kind: str, seed: int, increments: int, *given: tuple[str, object]
) -> tuple[np.ndarray, np.ndarray, float]:
    """Shear stress and pressure after each increment, and how far the grains have turned [rad]."""
    session = begun("couette", kind, seed, dict(given))
    box, stresses = session.run.setup.packing.box, []
    assert box is not None
    for _ in range(increments):
        while not session.advance(4000):
            pass
        latest = session.run.engine.latest
        assert latest is not None
        stresses.append(plate_stresses(session.run.setup.world, box.width, latest))
    shear, pressure = np.array(stresses).T
    friction = session.run.setup.friction
    turned = 0.0 if friction is None else float(np.abs(friction.spin).mean())
    return shear, pressure, turned


def of(lesson: str, key: str) -> list[tuple[str, object]]:
    return sorted(settings(lesson, key).items())


@pytest.mark.slow
def test_stress_rises_then_goes_up_and_down() -> None:
    rises = []
    for seed in SEEDS:
        shear, _, _ = sheared("mixed", seed, 120, *of("yield", "rise"))
        steady = shear[60:]
        rises.append(shear[0] < 0.5 * steady.mean())
        assert len(observables.force_drops(steady)) > 3
        assert steady.std() > 0.1 * steady.mean()
        assert abs(steady[:30].mean() - steady[30:].mean()) < 0.7 * steady.mean()
        assert shear.max() < 0.02  # the axis of the sketch has room for it
    assert sum(rises) >= 2


@pytest.mark.slow
def test_pressure_decides_about_the_yield_stress() -> None:
    ratios = []
    for seed in SEEDS:
        found = {
            kind: sheared(kind, seed, 120, *of("yield", "compare"))
            for kind in ("regular", "auxetic")
        }
        shear, pressure = (
            [float(part[40:].mean()) for part in parts[:2]] for parts in found.values()
        )
        regular, auxetic = found.values()
        assert regular[0][40:].mean() > 2.0 * auxetic[0][40:].mean()
        assert regular[1][40:].mean() > 2.0 * auxetic[1][40:].mean()
        ratios += [shear[0] / shear[1], pressure[0] / pressure[1]]
    assert sum(0.05 <= ratio <= 0.15 for ratio in ratios) > len(ratios) // 2, ratios
    assert (right("yield", "compare"), right("yield", "ratio")) == (1, 2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_loose_grains_bear_nothing(seed: int) -> None:
    loose = sheared("mixed", seed, 80, *of("yield", "loose"))[0][40:].mean()
    usual = sheared("mixed", seed, 80, ("grains", 160))[0][40:].mean()
    assert loose < 0.01 * usual
    below, above = (
        sheared("mixed", seed, 60, ("grains", 160), ("packing_fraction", phi))[1][30:].mean()
        for phi in (0.8, 0.85)
    )
    assert below < 0.1 * above
    assert right("yield", "loose") == 3


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_friction_raises_the_ratio_more_than_threefold(seed: int) -> None:
    smooth, pressed, _ = sheared("regular", seed, 120, *of("friction", "law"))
    rough, more, turned = sheared("regular", seed, 120, *of("friction", "rough"))
    ratio = smooth[40:].mean() / pressed[40:].mean()
    assert 0.03 < ratio < 0.15
    assert rough[40:].mean() / more[40:].mean() > 3.0 * ratio
    assert turned > 0.01
    assert right("friction", "rough") == 2


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_rough_walls_carry_a_part_of_the_load(seed: int) -> None:
    frame = run("hopper", "regular", seed, 14, **settings("friction", "walls")).frame()
    (piston,) = frame.handles
    shares = []
    for depth in (3.0, 6.0, 9.0):
        found = force_through(frame, (-50.0, piston.y - depth), (50.0, piston.y - depth))
        assert found is not None
        shares.append(found.pressing / -piston.fy)
    assert 0.75 < shares[0] < 0.97
    assert falling(shares)
    assert right("friction", "walls") == 2


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_without_friction_the_hopper_flows_under_hardly_any_force(seed: int) -> None:
    rough = run("hopper", "regular", seed, 14, **settings("friction", "walls"))
    smooth = run("hopper", "regular", seed, 14, **settings("friction", "without"))
    assert smooth.frame().grains_out > rough.frame().grains_out
    assert smooth.history.curve[1, -1] < 0.1 * rough.history.curve[1, -1]
    assert right("friction", "without") == 3


# -- residual --


@cache
def squeezed(seed: int, tolerance: float) -> tuple[float, int]:
    """Spread of the forces through nine cuts over their mean, and the work it took [force evaluations]."""
    session = run("biaxial_periodic", "mixed", seed, 10, grains=100, tolerance=tolerance)
    frame = session.frame()
    assert frame.box is not None
    width, height, _ = frame.box
    pressing = []
    for share in np.linspace(0.05, 0.95, 9):
        found = force_through(frame, (0.0, share * height), (width, share * height))
        assert found is not None
        pressing.append(found.pressing)
    return float(np.std(pressing) / np.mean(pressing)), int(
        session.history.column("iterations").sum()
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_cuts_agree_as_far_as_the_residual_says(seed: int) -> None:
    fine, coarse = squeezed(seed, 1e-4)[0], squeezed(seed, 0.3)[0]
    assert fine < 5e-4
    assert 0.003 < coarse < 0.2
    assert settings("residual", "balance")["tolerance"] == 1e-4
    assert settings("residual", "loose")["tolerance"] == 0.3
    assert (right("residual", "balance"), right("residual", "loose")) == (2, 2)


@pytest.mark.slow
def test_many_digits_cost_a_few_times_the_work() -> None:
    times = [squeezed(seed, 1e-6)[1] / squeezed(seed, 1e-2)[1] for seed in SEEDS]
    assert sum(3.0 <= more <= 5.0 for more in times) >= 2, times
    assert max(times) < 10.0
    assert right("residual", "price") == 2


def test_the_model_sees_contact_early_however_fine_the_tolerance() -> None:
    session = run("two_ellipses", "mixed", 1, 40, **settings("residual", "model"))
    early = session.history.curve[1]
    assert np.all(early >= -1e-9)
    assert early.max() > 0.1  # percent of a diameter
    assert right("residual", "model") == 2


def test_overlaps_take_two_over_c_of_an_approach() -> None:
    session = run("single_grain", "regular", 1, 8)
    approach = float(session.history.curve[0, -1])
    shrunk = -2.0 * strains(session)[0]  # of a diameter of 2 R
    assert (approach - shrunk) / approach == pytest.approx(0.04, abs=0.003)


# -- all of it by hand --


@pytest.mark.slow
@pytest.mark.parametrize("name", classroom.names())
def test_every_step_can_be_done(name: str) -> None:
    for step in play_lesson(classroom.lesson(name), 1, {}):
        assert step["done"], step
        assert not step["broken"], step

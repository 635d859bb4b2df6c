"""Live changes: the grains where they stand take on what is new, and nothing blows up."""

from __future__ import annotations

import numpy as np
import pytest

from core.friction import Friction
from core.quasistatic import Quasistatic
from core.relaxation import StopReason
from core.system import System
from sandbox.session.commands import Change, Protocol, Reset
from sandbox.session.session import Session
from scenes import registry
from tests.session.test_time import SCENES, built, do, go, rest

SAID_TWICE = {"regular_poisson_ratio", "auxetic_poisson_ratio", "contact_stiffness"}


def pressed(scene: str, packing: str, increments: int, **settings: float) -> Session:
    """A scene after so many increments of its script."""
    session = Session(scene, packing, 1, settings)
    session.build()
    do(session, Protocol(True))
    go(session, increments)
    do(session, Protocol(False))
    return session


def test_a_live_change_is_one_relaxation_of_the_grains_where_they_stand() -> None:
    session = pressed("intruder", "mixed", 15, grains=100, intruder_radius=3.0)
    run = session.run
    twin = run.engine.packing.copy()
    twin.poisson_ratio = np.where(twin.poisson_ratio < 0.0, twin.poisson_ratio, 0.1)
    placement, rows = run.setup.world.placement(), len(session.history)
    built_before = run
    do(session, Change("regular_poisson_ratio", 0.1))
    go(session, 1)
    assert session.run is built_before
    assert session.idle
    assert len(session.history) == rows + 1
    assert np.array_equal(run.setup.world.placement(), placement)
    by_hand = Quasistatic(System(twin, run.setup.world, run.setup.solver))
    by_hand.begin({})
    assert by_hand.relax(1_000_000) is not None
    assert by_hand.packing.hash() == run.engine.packing.hash()
    assert session.frame().settings["regular_poisson_ratio"] == 0.1


@pytest.mark.parametrize(
    ("scene", "increments", "settings"),
    [
        ("intruder", 40, {"grains": 100, "intruder_radius": 3.0}),
        ("biaxial_press", 110, {"grains": 50, "compression": 0.4}),
        ("biaxial_periodic", 50, {"grains": 80, "strain": 0.3}),
        ("grain_row", 130, {"compression": 0.34}),
    ],
)
def test_poisson_ratios_and_stiffness_may_jump_from_end_to_end_under_load(
    scene: str, increments: int, settings: dict[str, float]
) -> None:
    session = pressed(scene, "mixed", increments, **settings)
    size = session.run.setup.packing.rest_radius
    for name, value in [
        ("regular_poisson_ratio", 0.0),
        ("regular_poisson_ratio", 0.99),
        ("auxetic_poisson_ratio", -0.01),
        ("auxetic_poisson_ratio", -0.99),
        ("contact_stiffness", 5.0),
        ("contact_stiffness", 1000.0),
    ]:
        do(session, Change("max_iterations", 100_000), Change(name, value))
        rest(session)
        assert session.frame().stop_reason == "converged", (name, value)
        assert np.all(session.run.setup.packing.semi_axes[1] > 0.1 * size)
    assert all(check.holds is not False for check in session.checks()[:2])


def test_the_kind_of_a_grain_outlives_a_ratio_of_zero() -> None:
    session = Session("single_grain", "mixed")
    session.build()
    for nu in (0.0, 0.4):
        do(session, Change("poisson_ratio", nu))
    assert session.run.setup.packing.poisson_ratio.tolist() == [0.4, -0.4]


def test_friction_comes_and_goes() -> None:
    said: list[str] = []
    session = Session("hopper", "mixed", 1, {"grains": 60, "width": 12.0, "friction": 0.0})
    session.build(lambda text, share: said.append(text))
    assert session.frame().spin is None
    said.clear()
    do(session, Change("friction", 0.6), Protocol(True))
    assert any("compiling" in text for text in said)
    go(session, 6)
    friction = session.run.engine.friction
    assert isinstance(friction, Friction)
    assert friction.coefficient == 0.6
    assert friction.remembered()
    spin = session.frame().spin
    assert spin is not None
    assert np.any(spin != 0.0)
    do(session, Change("friction", 0.2))
    assert session.run.engine.friction is friction
    assert friction.coefficient == 0.2
    go(session, 2)
    assert session.frame().stop_reason == "converged"
    do(session, Change("friction", 0.0))
    go(session, 3)
    assert session.frame().spin is None
    assert session.run.setup.friction is None


def test_reset_goes_to_the_start_with_the_present_settings() -> None:
    changed = {"regular_poisson_ratio": 0.3, "contact_stiffness": 70.0, "friction": 0.0}
    session = built("hopper")
    do(session, Protocol(True))
    go(session, 4)
    for name, value in changed.items():
        do(session, Change(name, value))
    do(session, Reset())
    start = session.state_hash()
    packing = session.run.setup.packing
    assert set(packing.poisson_ratio) == {0.3, -0.8}
    assert set(packing.contact_stiffness) == {70.0}
    assert session.run.engine.friction is None
    assert len(session.history) == 1
    do(session, Protocol(True))
    go(session, 3)
    do(session, Reset())
    assert session.state_hash() == start
    for name in changed:
        do(session, Change(name, built("hopper").settings[name]))
    do(session, Reset())
    assert session.state_hash() == built("hopper").state_hash()


def test_how_carefully_to_relax_is_live() -> None:
    session = built("intruder")
    do(session, Protocol(True))
    go(session, 5)
    do(session, Change("step", 0.1), Change("tolerance", 1e-5), Change("max_iterations", 50_000))
    before = session.run.setup.world["intruder"].position[0]
    go(session, 1)
    assert session.run.setup.world["intruder"].position[0] == before
    go(session, 4)
    assert session.run.setup.world["intruder"].position[0] - before > 0.3
    frame = session.frame()
    assert frame.tolerance == 1e-5
    assert frame.residual <= 1e-5


def test_the_script_goes_on_where_it_was_when_the_step_changes() -> None:
    session = built("hopper")
    do(session, Protocol(True))
    go(session, 10)
    piston = session.run.setup.world["piston"]
    for step in (0.01, 0.1, 0.03):
        do(session, Change("step", step))
        go(session, 1)
        before = piston.position[1]
        go(session, 2)
        # Not back, not further than two steps on, and no more than one behind.
        assert step <= before - piston.position[1] <= 2.0 * step + 1e-12


def test_a_step_that_is_too_long_changes_nothing() -> None:
    session = Session("single_grain", "mixed", 1, {"radius": 0.3})
    session.build()
    start = session.state_hash()
    do(session, Change("step", 0.14))
    assert "step must be at most" in session.frame().notices[0]
    assert session.settings["step"] == 0.005
    assert session.state_hash() == start
    assert session.idle
    assert session.log().commands == ()


def test_every_scene_has_live_parameters_and_applies_them() -> None:
    for name in registry.names():
        scene = registry.get(name)
        live = [p for p in scene.parameters if p.live]
        assert {p.name for p in live} >= {"contact_stiffness"}
        session = Session(name, scene.packings[0], 1, SCENES.get(name))
        session.build()
        run = session.run
        for p in live:
            before = session.settings[p.name]
            new = p.low if before != p.low else p.high
            if p.name == "step":
                new = before / 2
            do(session, Change(p.name, new))
            assert session.settings[p.name] == new, (name, p.name)
            if p.name in SAID_TWICE:  # set back, or λ and μ in their place would be refused
                do(session, Change(p.name, before))
        assert session.run is run
        assert session.run.setup is session.run.engine.system
        go(session, 2)
        reason = session.history[-1].stop_reason
        assert reason not in (StopReason.NOT_FINITE, StopReason.COLLAPSED), name


def test_what_a_change_leaves_unrelaxed_is_relaxed_in_further_increments() -> None:
    session = pressed("intruder", "mixed", 30, grains=100, intruder_radius=3.0)
    rows = len(session.history)
    do(session, Change("max_iterations", 900), Change("regular_poisson_ratio", 0.0))
    rest(session)
    reasons = session.history.column("stop_reason")[rows:]
    assert 1 < len(reasons) <= 5
    assert set(reasons[:-1]) == {"iteration limit"}
    assert reasons[-1] == "converged"

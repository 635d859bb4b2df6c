"""What is too much ends with a named reason, and leaves the last good state; what makes no sense is refused."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from core.packing import Packing, PeriodicBox
from core.passage import deep_grains
from core.quasistatic import Increment, Quasistatic
from core.relaxation import FAILED, Relaxation, StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.system import System

PLATE = ((-3.0, 0.0), (3.0, 0.0), (3.0, 1.0), (-3.0, 1.0))


def press(stiffness: float, step: float = 0.05) -> Quasistatic:
    """A grain of radius 1 on a floor at y = 0, a lid over it that nothing stops."""
    lid = RigidBody(
        "lid",
        "piston",
        (0.0, 2.0),
        polygons=[(PLATE, 0.0)],
        axis=(0.0, -1.0),
    )
    floor = RigidBody("floor", segments=[(-4.0, -0.5, 4.0, -0.5, 0.5)])
    packing = Packing([0.0], [1.0], 1.0, 0.8, stiffness)
    return Quasistatic(System(packing, RigidWorld([lid, floor]), Settings(step=step)))


def increment(engine: Quasistatic, y: float) -> Increment:
    engine.begin({"lid": (0.0, y)})
    done = engine.relax(100_000)
    assert done is not None
    return done


@pytest.mark.parametrize("stiffness", [2.1, 3.0, 50.0])
def test_a_lid_never_presses_a_grain_through_the_floor(stiffness: float) -> None:
    engine = press(stiffness)
    while engine.world["lid"].position[1] > 0.0:
        before, place = engine.packing.state.copy(), engine.world.placement()
        done = increment(engine, -1.0)
        if done.report.reason in FAILED:
            break
        assert 0.0 < engine.packing.y[0] < engine.world["lid"].position[1]
    assert done.report.reason is StopReason.SUNK
    assert np.array_equal(engine.packing.state, before)
    assert np.array_equal(engine.world.placement(), place)
    assert done.moved["lid"] != (0.0, 0.0)
    for _ in range(3):
        assert increment(engine, 3.0).report.reason is StopReason.CONVERGED


@pytest.mark.parametrize("step", [0.02, 0.05, 0.15, 0.25])
def test_no_increment_that_is_kept_has_pressed_a_grain_as_deep_as_one_step_from_through(
    step: float,
) -> None:
    """Not only the last of them: what is deep when the next one begins would pass for having been so before."""
    engine = press(50.0, step)
    while (done := increment(engine, -1.0)).report.reason not in FAILED:
        bodies = done.body_contacts
        assert not deep_grains(engine.packing.state, bodies.grain, bodies.overlap, step).any()
    assert done.report.reason is StopReason.SUNK


def test_a_grain_that_is_in_a_wall_already_is_let_out() -> None:
    engine = press(50.0)
    engine.packing.state[1] = -0.1
    engine.begin({})
    done = engine.relax(100_000)
    assert done is not None
    assert done.report.reason not in FAILED


def test_an_increment_that_cannot_be_begun_moves_nothing() -> None:
    packing = Packing([1.0, 3.0], [1.0, 3.0], box=PeriodicBox(4.7, 4.7))
    engine = Quasistatic(System(packing, RigidWorld(), Settings(skin=0.1)))
    with pytest.raises(InputError, match="box is too small"):
        for _ in range(20):
            state, box = packing.state.copy(), packing.box
            engine.begin({}, PeriodicBox(4.0, 4.0))
            assert engine.relax(100_000) is not None
    assert np.array_equal(packing.state, state)
    assert packing.box == box
    engine.begin({}, PeriodicBox(5.0, 5.0))
    assert engine.relax(100_000) is not None


@pytest.mark.parametrize("unit", [1e-4, 1.0, 1e4])
def test_units_of_length_make_no_difference(unit: float) -> None:
    """Energy goes with the square of length, and the residual is relative."""
    random = np.random.default_rng(1)
    x, y = random.uniform(0.0, 9.0, (2, 30))
    packing = Packing(x * unit, y * unit, unit, 0.5, box=PeriodicBox(9.0 * unit, 9.0 * unit))
    engine = Quasistatic(System(packing, RigidWorld(), Settings(min(0.05, 0.1 * unit), 1e-9)))
    engine.begin({})
    done = engine.relax(100_000)
    assert done is not None
    assert done.report.reason is StopReason.CONVERGED
    energy = done.report.energy / unit**2
    reference = Packing(x, y, 1.0, 0.5, box=PeriodicBox(9.0, 9.0))
    relaxation = Relaxation(reference, tolerance=1e-9, force_floor=1e-2, max_iterations=100_000)
    assert energy == pytest.approx(relaxation.run(100_000).energy, rel=1e-6)


@pytest.mark.parametrize("gravity", [(0.0, -50.0), (1e300, 0.0), (float("nan"), 0.0)])
def test_weights_that_no_contact_can_bear_are_refused(gravity: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="gravity must be less than 50 k/R"):
        Quasistatic(System(Packing([0.0], [1.0]), RigidWorld(), gravity=gravity))


@pytest.mark.parametrize(
    "wrong",
    [
        {"tolerance": 0.0},
        {"tolerance": float("nan")},
        {"force_floor": 0.0},
        {"skin": 0.0},
        {"skin": float("inf")},
        {"step": float("nan")},
        {"max_iterations": 0},
    ],
)
def test_settings_that_make_no_sense_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError):
        Settings(**wrong)  # type: ignore[arg-type]

"""Hard cases of long ways: sheared by strain 10, back and forth a great many times; and of solvers that are given too little."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from sandbox.studies.stability import rigs
from sandbox.studies.stability.case import REFUSED, Act, Case
from sandbox.studies.stability.rigs import KINDS
from sandbox.studies.stability.watch import Watch

STRAIN = 10.0
CYCLE = 10  # increments there and back
DRIFT = 1e-6  # [R] after all of them


def cases() -> Iterator[Case]:
    """All of this module."""
    yield from _long_ways()
    yield from _too_little()


def _long_ways() -> Iterator[Case]:
    for kind, friction in itertools.product(KINDS, (0.0, 0.5, 10.0)):
        yield Case(
            "sheared by strain 10",
            f"{kind}, friction {friction:g}",
            "converges at every step; the cell is as whole as at first",
            _sheared(kind, friction),
            seconds=90.0,
            quick=friction != 0.5,
        )
    for friction, increments in ((0.0, 1_000_000), (0.5, 100_000)):
        yield Case(
            "back and forth without end",
            f"two grains, friction {friction:g}, {increments:,} increments (quick: a hundredth)",
            "no drift",
            _back_and_forth(friction, increments),
            seconds=900.0,
        )
    for kind in KINDS:
        yield Case(
            "back and forth without end",
            f"40 grains, {kind}, 1,000 increments",
            "the energy at the same place settles, and no longer rises",
            _cycled(kind),
            seconds=90.0,
        )


def _too_little() -> Iterator[Case]:
    for most, kind in itertools.product((1, 10, 100), KINDS):
        yield Case(
            "too few iterations",
            f"{most} an increment, {kind}",
            "says that it has not converged, and gains no energy",
            _starved(kind, most),
            allowed=(StopReason.ITERATION_LIMIT,),
            named=(),
        )
    for tolerance in (0.3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-300):
        yield Case(
            "tolerance",
            f"{tolerance:g}",
            "converges, or says within the bound that it has not",
            _tolerance(tolerance),
        )
    for name, value in (
        ("step", 0.0),
        ("step", float("nan")),
        ("step", 1.0),
        ("max_iterations", 0),
        ("tolerance", 0.0),
        ("tolerance", float("nan")),
        ("force_floor", 0.0),
        ("force_floor", float("nan")),
        ("skin", -1.0),
        ("skin", float("nan")),
        ("skin", 0.0),
    ):
        yield Case(
            "settings that make no sense",
            f"{name} = {value:g}",
            "refused with one line",
            _senseless(name, value),
            allowed=(REFUSED,),
            named=(),
        )


def _sheared(kind: str, friction: float) -> Act:
    def act(watch: Watch) -> None:
        solver = rigs.settings(tolerance=1e-2, step=0.1)
        rig = rigs.cell(rigs.materials(kind, 0.8, 50.0), count=30, friction=friction, solver=solver)
        rig.rest(watch)
        rig.shear(watch, STRAIN)
        watch.expect_true("the strain reached", rig.packing.box is not None)
        pairs = rig.engine.contacts()[0]
        watch.expect("overlap over a radius", np.max(pairs.overlap, initial=0.0), 0.5)

    return act


def _back_and_forth(friction: float, increments: int) -> Act:
    def act(watch: Watch) -> None:
        count = increments // 100 if watch.quick else increments
        strip = ((-5.0, 0.0), (5.0, 0.0), (5.0, 1.0), (-5.0, 1.0))
        lid = RigidBody("lid", "piston", (0.0, 2.0), polygons=[(strip, 0.0)], axis=(0.0, -1.0))
        floor = RigidBody("floor", segments=[(-6.0, -0.5, 6.0, -0.5, 0.5)])
        packing = Packing([-0.98, 0.98], [1.0, 1.0], 1.0, [0.8, -0.8])
        solver = rigs.settings(tolerance=1e-9, step=0.02)
        engine = rigs.engine(packing, RigidWorld([lid, floor]), solver=solver, friction=friction)
        # The first cycles part the grains as far as they ever will be.
        for _ in range(5):
            _cycle(watch, engine)
        start, away = packing.state.copy(), 0.0
        for number in range(count // CYCLE - 5):
            _cycle(watch, engine, look=number % 100 == 0)
            away = max(away, float(np.max(np.abs(engine.packing.state - start))))
        watch.expect("farthest from the first cycle at the same place [R]", away, DRIFT)

    return act


def _cycle(watch: Watch, engine: Quasistatic, look: bool = True) -> None:
    """The lid five steps down and up again."""
    for depth in (0.02, 0.04, 0.06, 0.08, 0.1, 0.08, 0.06, 0.04, 0.02, 0.0):
        watch.step(engine, {"lid": (0.0, 2.0 - depth)}, look=look)


def _cycled(kind: str) -> Act:
    def act(watch: Watch) -> None:
        rig = rigs.cell(rigs.materials(kind, 0.8, 50.0), fraction=0.9)
        rig.engine.system.solver = rigs.settings(step=0.01, tolerance=1e-6)
        rig.rest(watch)
        box = rig.packing.box
        assert box is not None
        energies = []
        for _ in range(100):
            for k in (1, 2, 3, 4, 5, 4, 3, 2, 1, 0):
                share = 1.0 - 0.001 * k
                target = PeriodicBox(box.width * share, box.height * share)
                done = watch.step(rig.engine, box=target)
            energies.append(done.report.energy)
        late = np.array(energies[-20:])
        watch.expect("spread of the energy, relative", np.ptp(late) / late.mean(), 1e-3)
        rise = (late.mean() - energies[0]) / energies[0]
        watch.expect("rise of the energy, relative", rise, 1e-3)

    return act


def _starved(kind: str, most: int) -> Act:
    def act(watch: Watch) -> None:
        rig = rigs.cell(rigs.materials(kind, 0.8, 50.0), fraction=0.9)
        rig.engine.system.solver = rigs.settings(tolerance=1e-9, max_iterations=most)
        rig.rest(watch)
        rig.squeeze(watch, 0.9)
        watch.expect(
            "evaluations beyond the bound", watch.iterations - most * watch.increments, 0.0
        )

    return act


def _tolerance(tolerance: float) -> Act:
    def act(watch: Watch) -> None:
        rig = rigs.cell(rigs.materials("mixed", 0.8, 50.0))
        rig.engine.system.solver = rigs.settings(tolerance=tolerance, max_iterations=20_000)
        rig.rest(watch)
        rig.squeeze(watch, 0.99)

    return act


def _senseless(name: str, value: float) -> Act:
    def act(watch: Watch) -> None:
        solver = Settings(**{name: value})  # type: ignore[arg-type]
        rig = rigs.cell(rigs.materials("mixed", 0.8, 50.0), count=40, solver=solver)
        rig.rest(watch)
        raise AssertionError(f"{name} = {value} was taken")

    return act

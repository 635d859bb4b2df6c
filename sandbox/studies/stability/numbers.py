"""Hard cases of numbers: denormal, tiny, huge, not finite; of units, places, materials, forces and wishes of a hand."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping

import numpy as np

from core.generate import Recipe, pack
from core.packing import MAX_LENGTH, Packing, PeriodicBox
from core.relaxation import StopReason
from sandbox.session.commands import Grab, Move
from sandbox.studies.stability import rigs
from sandbox.studies.stability.case import REFUSED, SOLVED, Act, Case
from sandbox.studies.stability.scenes import finish, small
from sandbox.studies.stability.watch import Watch
from scenes import registry

DENORMAL = 5e-324
UNITS = (1e-5, 1e-3, 1e3, 1e6)
NONSENSE = (math.nan, math.inf, -math.inf)


def cases() -> Iterator[Case]:
    """All of this module."""
    yield from _of_lengths()
    yield from _of_material()
    yield from _of_requests()


def _of_lengths() -> Iterator[Case]:
    for unit, kind in itertools.product(UNITS, rigs.KINDS):
        yield Case(
            "units",
            f"all lengths times {unit:g}, {kind}",
            "the same physics as at 1: energies in the ratio of the squares",
            _in_units(unit, kind),
        )
    for far in (0.0, DENORMAL, 1e-300, 1e4, 1e6):
        yield Case(
            "far from the origin",
            f"two grains and a lid at {far:g} R",
            "converges to what rounding leaves of it",
            _far_away(far),
        )
    for what, arguments in _bad_packings().items():
        yield Case(
            "packings that make no sense",
            what,
            "refused with one line",
            _packing(arguments),
            (REFUSED,),
            (),
        )


def _of_material() -> Iterator[Case]:
    for nu, stiffness in itertools.product(
        (0.8, -0.8, 1.0 - 1e-12, -1.0 + 1e-12), (2.0 + 1e-9, 2.001, 1e8, 1e12)
    ):
        yield Case(
            "materials beyond reason",
            f"ν = {nu:.12g}, C = {stiffness:.10g}",
            "converges, or ends with its reason within the bound",
            _material(nu, stiffness),
        )
    for name, value in itertools.product(
        ("friction", "gravity"), (DENORMAL, 1e-300, 1e-6, 1e6, 1e300)
    ):
        yield Case(
            "terms beyond reason",
            f"{name} {value:g}",
            "converges, is refused, or ends with its reason within the bound",
            _term(name, value),
            allowed=(SOLVED, REFUSED),
            named=(StopReason.ITERATION_LIMIT, StopReason.NOT_FINITE, StopReason.COLLAPSED),
        )


def _of_requests() -> Iterator[Case]:
    for value in (*NONSENSE, 1e300, -1e300, DENORMAL):
        yield Case(
            "a hand that asks for nonsense",
            f"{value:g}",
            "passed over if it is not finite, else approached step by step; Reset",
            _asked(value),
        )
    for what, request in _bad_requests().items():
        yield Case(
            "requests for packings",
            what,
            "refused with one line",
            _request(request),
            (REFUSED,),
            (),
        )


def _in_units(unit: float, kind: str) -> Act:
    def act(watch: Watch) -> None:
        packing = pack(Recipe(kind=kind), seed=1, count=40, packing_fraction=0.9)
        solver = rigs.settings(tolerance=1e-8, step=min(0.05, 0.1 * unit))
        energies = []
        for scale in (1.0, unit):
            twin = packing.copy()
            twin.rest_radius = packing.rest_radius * scale
            twin.state = packing.state * scale
            assert packing.box is not None
            twin.box = PeriodicBox(packing.box.width * scale, packing.box.height * scale)
            small = rigs.engine(
                twin, solver=solver if scale == unit else rigs.settings(tolerance=1e-8)
            )
            energies.append(watch.step(small).report.energy)
        ratio = energies[1] / energies[0] / unit**2
        watch.expect("ratio of the energies off by", abs(ratio - 1.0), 1e-6)

    return act


def _far_away(far: float) -> Act:
    def act(watch: Watch) -> None:
        world, outline = rigs.walls(6.0, 3.9)
        for body in world.bodies:
            body.position = (body.position[0] + far, body.position[1])
            body.home = body.position
        outline = [(x + far, y) for x, y in outline]
        packing = Packing(np.array([2.9, 3.1]) + far, [1.0, 2.9], 1.0, [0.8, -0.8])
        rig = rigs.boxed(packing, world, outline, solver=rigs.settings(tolerance=1e-4))
        rig.rest(watch)
        rig.lid_to(watch, 0.5)
        rig.lid_to(watch, -0.5)

    return act


def _bad_packings() -> dict[str, Mapping[str, object]]:
    bad: dict[str, Mapping[str, object]] = {}
    for value in NONSENSE:
        bad[f"a place {value:g}"] = {"x": [value, 0.0]}
        bad[f"a radius {value:g}"] = {"rest_radius": value}
        bad[f"a Poisson's ratio {value:g}"] = {"poisson_ratio": value}
        bad[f"a stiffness {value:g}"] = {"contact_stiffness": value}
    for radius in (0.0, -1.0, DENORMAL, 1e300):
        bad[f"a radius {radius:g}"] = {"rest_radius": radius}
    for nu in (-1.0, 1.0, 2.0):
        bad[f"a Poisson's ratio {nu:g}"] = {"poisson_ratio": nu}
    for stiffness in (2.0, 0.0, -50.0):
        bad[f"a stiffness {stiffness:g}"] = {"contact_stiffness": stiffness}
    bad["a place beyond the largest"] = {"x": [0.0, 10.0 * MAX_LENGTH]}
    bad["labels that are alike"] = {"label": [1, 1]}
    bad["a label below 0"] = {"label": [-1, 1]}
    bad["a label of 62 bits"] = {"label": [2**61, 1]}
    bad["three places along, two up"] = {"x": [0.0, 1.0, 2.0]}
    return bad


def _packing(arguments: Mapping[str, object]) -> Act:
    def act(watch: Watch) -> None:
        del watch
        Packing(**{"x": [0.0, 3.0], "y": [0.0, 3.0], **arguments})  # type: ignore[arg-type]

    return act


def _material(nu: float, stiffness: float) -> Act:
    def act(watch: Watch) -> None:
        packing = Packing([2.9, 3.1], [1.0, 2.9], 1.0, nu, stiffness)
        world, outline = rigs.walls(6.0, 3.9)
        solver = rigs.settings(tolerance=1e-3, max_iterations=50_000)
        rig = rigs.boxed(packing, world, outline, solver=solver)
        rig.rest(watch)
        rig.lid_to(watch, 0.2)
        rig.lid_to(watch, -0.5)

    return act


def _term(name: str, value: float) -> Act:
    def act(watch: Watch) -> None:
        packing = Packing([1.2, 3.1, 4.6], [1.0, 1.0, 1.0], 1.0, [0.8, -0.8, 0.8])
        world, outline = rigs.walls(6.0, 3.9)
        friction, gravity = (value, None) if name == "friction" else (0.0, (0.0, -value))
        solver = rigs.settings(max_iterations=20_000)
        rig = rigs.boxed(packing, world, outline, solver=solver, friction=friction, gravity=gravity)
        rig.rest(watch)
        rig.lid_to(watch, 2.2)
        rig.lid_to(watch, -0.5)

    return act


def _asked(value: float) -> Act:
    def act(watch: Watch) -> None:
        session = small(registry.get("intruder"), "mixed")
        for x, y in ((value, 1.0), (1.0, value), (value, value)):
            session.submit(Grab("intruder"))
            session.submit(Move("intruder", x, y))
            watch.run(session, 5)
        finish(watch, session)

    return act


def _bad_requests() -> dict[str, dict[str, object]]:
    return {
        "packing fraction 2": {"count": 10, "packing_fraction": 2.0},
        "packing fraction 0": {"count": 10, "packing_fraction": 0.0},
        "packing fraction nan": {"count": 10, "packing_fraction": math.nan},
        "minus ten grains": {"count": -10},
        "seed −1": {"count": 10, "seed": -1},
        "a cell smaller than its grains": {"count": 2, "packing_fraction": 0.84},
        "neither number nor place": {},
        "a negative pressure": {"count": 40, "target_pressure": -1.0},
        "a pressure beyond reach": {"count": 40, "target_pressure": 1e6},
        "a pressure nan": {"count": 40, "target_pressure": math.nan},
        "an outline without room": {"outline": [(0.0, 0.0), (1.0, 0.0), (0.0, 0.0)]},
        "an outline thinner than a grain": {
            "outline": [(0.0, 0.0), (100.0, 0.0), (100.0, 0.5), (0.0, 0.5)],
            "world": rigs.walls(100.0, 0.5)[0],
        },
    }


def _request(request: dict[str, object]) -> Act:
    def act(watch: Watch) -> None:
        del watch
        pack(Recipe(), **{"seed": 1, **request})  # type: ignore[arg-type]

    return act

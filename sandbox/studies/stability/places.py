"""Hard cases of where grains are: in one another, in a body, on a line, alone, none at all, far too many."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from core.generate import Recipe
from core.packing import Packing, PeriodicBox
from core.relaxation import StopReason
from core.rigid import Point, RigidBody, RigidWorld
from sandbox.studies.stability import rigs
from sandbox.studies.stability.case import TIME_LIMIT, Act, Case
from sandbox.studies.stability.rigs import KINDS
from sandbox.studies.stability.watch import Watch

MANY = 100_000
OVERLAPPING = 1.2  # packing fraction of a bad start
TOUCHING = 0.1  # [R] of overlap that two resting grains may keep


def cases() -> Iterator[Case]:
    """All of this module."""
    for kind, stiffness, seed in itertools.product(KINDS, (3.0, 50.0, 1e3, 1e5), (1, 2)):
        yield Case(
            "bad start: anywhere, at packing fraction 1.2",
            f"{kind}, C = {stiffness:g}, seed {seed}, periodic",
            "converges, no grain vanishes",
            _scattered(kind, stiffness, seed),
        )
    for kind, friction in itertools.product(KINDS, (0.0, 0.5, 10.0)):
        yield Case(
            "bad start: anywhere, at packing fraction 1.2",
            f"{kind}, friction {friction:g}, walls",
            "converges, no grain vanishes or passes a wall",
            _scattered_in_walls(kind, friction),
        )
    yield from _coincident()
    for kind, way in itertools.product(KINDS, ("across", "up", "aslant")):
        yield Case(
            "all grains on a line",
            f"{kind}, {way}",
            "converges, though no force points off the line",
            _line(kind, way),
        )
    for grains, where in itertools.product((0, 1), ("open", "periodic", "walls")):
        for term in ("nothing more", "friction", "gravity", "drag"):
            if (where, term) == ("periodic", "gravity") or (where, term) == ("open", "gravity"):
                continue  # nothing holds the grain: it would fall for ever
            yield Case(
                "one grain or none",
                f"{grains or 'no'} grain{'s' * (not grains)}, {where}, {term}",
                "converges",
                _few(grains, where, term),
            )
    for kind in KINDS:
        yield Case(
            "1e5 grains",
            kind,
            "goes downhill within a bounded number of iterations, and says that it has not converged",
            _many(kind),
            allowed=(StopReason.ITERATION_LIMIT,),
            named=(TIME_LIMIT,),
            seconds=120.0,
            quick=kind == "mixed",
        )


def _coincident() -> Iterator[Case]:
    places: dict[str, Sequence[Point]] = {
        "two grains": [(3.0, 3.0)] * 2,
        "three grains": [(3.0, 3.0)] * 3,
        "ten grains": [(5.0, 5.0)] * 10,
        "two pairs": [(3.0, 3.0), (3.0, 3.0), (7.0, 3.0), (7.0, 3.0)],
        "apart by 5e-324 R": [(0.0, 3.0), (5e-324, 3.0)],
        "apart by 1e-160 R": [(0.0, 3.0), (1e-160, 3.0)],
        "apart by 1e-12 R": [(3.0, 3.0), (3.0 + 1e-12, 3.0)],
        "apart by the side of the cell": [(0.0, 3.0), (12.0, 3.0)],
    }
    for name, friction in itertools.product(places, (0.0, 0.5)):
        yield Case(
            "coincident centres",
            f"{name}{', friction' if friction else ''}",
            "they part",
            _apart(places[name], friction),
        )
    bodies: dict[str, Point] = {
        "of a disc": (4.0, 4.0),
        "of a disc, almost": (4.0, 4.0 + 1e-9),
        "of a wall's end": (6.0, 1.0),
        "of a wall": (5.0, 1.0),
    }
    for name, place in bodies.items():
        yield Case(
            "coincident centres",
            f"a grain in the middle {name}",
            "it is pushed out",
            _in_a_body(place),
        )


def _scattered(kind: str, stiffness: float, seed: int) -> Act:
    def act(watch: Watch) -> None:
        recipe = rigs.materials(kind, 0.8, stiffness)
        packing = rigs.scattered(recipe, 40, OVERLAPPING, seed, (0.0, 0.0), (10.0, 10.0))
        rig = rigs.Rig(rigs.engine(packing))
        rig.rest(watch)
        rig.squeeze(watch, 0.98)

    return act


def _scattered_in_walls(kind: str, friction: float) -> Act:
    def act(watch: Watch) -> None:
        recipe = Recipe(kind=kind)
        packing = rigs.scattered(recipe, 40, OVERLAPPING, 3, (0.0, 0.0), (10.0, 10.0))
        assert packing.box is not None
        world, outline = rigs.walls(packing.box.width, packing.box.height)
        packing.box = None
        rig = rigs.boxed(packing, world, outline, friction=friction)
        rig.rest(watch)
        rig.lid_to(watch, 0.2)
        rig.lid_to(watch, -2.0)

    return act


def _apart(places: Sequence[Point], friction: float) -> Act:
    def act(watch: Watch) -> None:
        packing = rigs.at(places)
        packing.box = PeriodicBox(12.0, 12.0)
        rig = rigs.Rig(rigs.engine(packing, friction=friction))
        for _ in range(3):
            rig.rest(watch)
        overlap = rig.engine.contacts()[0].overlap
        watch.expect("deepest overlap that is left [R]", np.max(overlap, initial=0.0), TOUCHING)

    return act


def _in_a_body(place: Point) -> Act:
    def act(watch: Watch) -> None:
        world = RigidWorld(
            [
                RigidBody("disc", "intruder", position=(4.0, 4.0), discs=[(0.0, 0.0, 1.0)]),
                RigidBody("stub", segments=[(3.0, 1.0, 6.0, 1.0, 0.2)]),
            ]
        )
        rig = rigs.Rig(rigs.engine(rigs.at([place]), world))
        for _ in range(3):
            watch.step(rig.engine)

    return act


def _line(kind: str, way: str) -> Act:
    def act(watch: Watch) -> None:
        random = np.random.default_rng(1)
        radius, nu = Recipe(kind=kind).grains(12, random)
        along = np.cumsum(radius) * 1.7
        x, y = {
            "across": (along + 1.0, np.full(12, 5.0)),
            "up": (np.full(12, 5.0), along + 1.0),
            "aslant": (0.7 * along + 1.0, 0.7 * along + 1.0),
        }[way]
        side = float(along[-1]) + 3.0
        world, outline = rigs.walls(side, side)
        rig = rigs.boxed(Packing(x, y, radius, nu), world, outline)
        rig.rest(watch)
        top = float(np.max(rig.packing.y)) + 1.0
        rig.lid_to(watch, side - top + 1.0)
        rig.lid_to(watch, -1.0)

    return act


def _few(grains: int, where: str, term: str) -> Act:
    def act(watch: Watch) -> None:
        packing = rigs.at([(3.0, 3.0)] * grains)
        friction = 0.5 if term == "friction" else 0.0
        gravity = (0.0, -0.05) if term in ("gravity", "drag") else None
        drag = 1.0 if term == "drag" else 0.0
        world, outline = None, None
        if where == "periodic":
            packing.box = PeriodicBox(8.0, 8.0)
        if where == "walls":
            world, outline = rigs.walls(6.0, 6.0)
        engine = rigs.engine(packing, world, friction=friction, gravity=gravity, drag=drag)
        rig = rigs.Rig(engine, outline)
        for _ in range(5):
            rig.rest(watch)
        if where == "walls":
            rig.home = engine.world["lid"].position
            rig.lid_to(watch, 4.5)
        if where == "periodic" and not drag:
            rig.squeeze(watch, 0.95)

    return act


def _many(kind: str) -> Act:
    def act(watch: Watch) -> None:
        most = 30 if watch.quick else 300
        random = np.random.default_rng(1)
        recipe = Recipe(kind=kind)
        radius, nu = recipe.grains(MANY, random)
        side = math.sqrt(MANY * recipe.mean_area() / 0.9)
        columns = math.ceil(math.sqrt(MANY))
        row, column = np.divmod(np.arange(MANY), columns)
        spacing = side / columns
        jitter = random.uniform(-0.3, 0.3, (2, MANY))
        x, y = (column + 0.5 + jitter[0]) * spacing, (row + 0.5 + jitter[1]) * spacing
        packing = Packing(x, y, radius, nu, box=PeriodicBox(side, side))
        rig = rigs.Rig(rigs.engine(packing, solver=rigs.settings(max_iterations=most)))
        rig.rest(watch)
        watch.expect("evaluations beyond the bound", watch.iterations - most, 0.0)

    return act

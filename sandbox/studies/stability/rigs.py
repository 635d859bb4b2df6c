"""Small packings and boxes for hard cases: a periodic cell, a box of walls with a lid, one grain between two plates."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.friction import Friction
from core.generate import Recipe, pack
from core.material import DEFAULT_POISSON_RATIO
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import FAILED
from core.rigid import Point, RigidBody, RigidWorld, wall
from core.settings import Settings
from core.system import System
from sandbox.studies.stability.watch import Watch

WALL = 1.6  # thickness of the walls [R]
MOST = 200_000  # force evaluations of one increment: a bound, far above what a case should need
KINDS = ("regular", "auxetic", "mixed")


@dataclass
class Rig:
    """A packing with its engine and the region that it must not leave."""

    engine: Quasistatic
    outline: list[Point] | None = None
    home: Point = (0.0, 0.0)  # of the lid

    @property
    def packing(self) -> Packing:
        """The grains."""
        return self.engine.packing

    def rest(self, watch: Watch) -> None:
        """Relax where things stand."""
        watch.step(self.engine, outline=self.outline)

    def squeeze(self, watch: Watch, share: float) -> None:
        """Scale the sides of the periodic cell by ``share``, step by step."""
        box = self.packing.box
        assert box is not None
        target = PeriodicBox(box.width * share, box.height * share, box.shift * share)
        while self.packing.box != target:
            watch.step(self.engine, box=target)

    def shear(self, watch: Watch, strain: float) -> None:
        """Shift the upper image of the periodic cell to that shear strain, step by step."""
        box = self.packing.box
        assert box is not None
        target = PeriodicBox(box.width, box.height, strain * box.height)
        while self.packing.box != target:
            watch.step(self.engine, box=target)

    def lid_to(self, watch: Watch, depth: float, most: int = 10_000) -> None:
        """Move the lid until it stands ``depth`` [R] below its home, or does not move any more."""
        target = (self.home[0], self.home[1] - depth)
        for _ in range(most):
            done = watch.step(self.engine, {"lid": target}, outline=self.outline)
            if math.hypot(*done.moved["lid"]) < 1e-12 or done.report.reason in FAILED:
                return


def settings(**changes: float | int) -> Settings:
    """How cases relax, unless they say otherwise."""
    return Settings(**{"tolerance": 1e-4, "max_iterations": MOST, **changes})  # type: ignore[arg-type]


def materials(kind: str, nu: float, stiffness: float) -> Recipe:
    """Grains with Poisson's ratio ±|nu|, as the kind of packing says."""
    return Recipe(
        kind=kind,
        regular_poisson_ratio=abs(nu),
        auxetic_poisson_ratio=-abs(nu),
        contact_stiffness=stiffness,
    )


def engine(
    packing: Packing,
    world: RigidWorld | None = None,
    *,
    solver: Settings | None = None,
    friction: float = 0.0,
    gravity: Point | None = None,
    drag: float = 0.0,
) -> Quasistatic:
    """An engine with the terms that are not 0."""
    rubbing = Friction.of(friction, len(packing))
    world = RigidWorld() if world is None else world
    return Quasistatic(System(packing, world, solver or settings(), rubbing, gravity, drag))


def cell(
    recipe: Recipe,
    *,
    count: int = 40,
    fraction: float = 0.86,
    seed: int = 1,
    solver: Settings | None = None,
    friction: float = 0.0,
) -> Rig:
    """A packing in a square periodic cell."""
    packing = pack(recipe, seed=seed, count=count, packing_fraction=fraction)
    return Rig(engine(packing, solver=solver, friction=friction))


def press(
    recipe: Recipe,
    *,
    count: int = 30,
    fraction: float = 0.8,
    seed: int = 1,
    solver: Settings | None = None,
    friction: float = 0.0,
) -> Rig:
    """A packing in a box of walls under a lid that comes down as far as it is told."""
    side = math.sqrt(count * recipe.mean_area() / fraction)
    world, outline = walls(side, side)
    below = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
    packing = pack(recipe, seed=seed, outline=below, world=world, packing_fraction=fraction)
    return boxed(packing, world, outline, solver=solver, friction=friction)


def boxed(
    packing: Packing,
    world: RigidWorld,
    outline: list[Point],
    *,
    solver: Settings | None = None,
    friction: float = 0.0,
    gravity: Point | None = None,
) -> Rig:
    """Grains already placed inside ``walls``."""
    built = engine(packing, world, solver=solver, friction=friction, gravity=gravity)
    return Rig(built, outline, world["lid"].position)


def walls(width: float, height: float) -> tuple[RigidWorld, list[Point]]:
    """A box with its lower left corner at 0, a lid that can come down to the floor, and the region inside."""
    high = 2.0 * height + 4.0
    box = wall("box", [(0.0, high), (0.0, 0.0), (width, 0.0), (width, high)], WALL)
    corners = ((0.0, 0.0), (width, 0.0), (width, WALL), (0.0, WALL))
    lid = RigidBody(
        "lid",
        "piston",
        position=(0.0, height),
        polygons=[(corners, 0.0)],
        axis=(0.0, -1.0),
        travel=(-4.0, height),
    )
    return RigidWorld([box, lid]), [(0.0, 0.0), (width, 0.0), (width, high), (0.0, high)]


def plates(nu: float, stiffness: float, solver: Settings) -> Rig:
    """One grain of radius 1 on a floor, the lid just above it."""
    packing = Packing([4.0], [1.0], 1.0, nu, stiffness)
    world, outline = walls(8.0, 2.0)
    return boxed(packing, world, outline, solver=solver)


def scattered(
    recipe: Recipe, count: int, fraction: float, seed: int, low: Point, high: Point
) -> Packing:
    """Grains anywhere in a rectangle, overlapping as chance has it; the rectangle is scaled to the packing fraction."""
    random = np.random.default_rng(seed)
    radius, nu = recipe.grains(count, random)
    width, height = high[0] - low[0], high[1] - low[1]
    scale = math.sqrt(float(np.pi * np.sum(radius**2)) / (fraction * width * height))
    x, y = random.random((2, count)) * np.array([[width], [height]]) * scale
    box = PeriodicBox(width * scale, height * scale)
    return Packing(x, y, radius, nu, recipe.contact_stiffness, box=box)


def at(places: Sequence[Point]) -> Packing:
    """Regular grains of radius 1 at these places."""
    x, y = zip(*places, strict=True) if places else ((), ())
    return Packing(x, y, 1.0, DEFAULT_POISSON_RATIO)

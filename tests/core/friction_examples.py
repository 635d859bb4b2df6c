"""Cases of friction that several tests share: grains and bodies that have gone a bit since slips were counted."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from hypothesis import settings

from core import observables
from core.candidates import BODY, GRAIN
from core.friction import Friction
from core.frictional_contacts import FrictionForces
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import Relaxation
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.slip import TANGENTIAL_STIFFNESS
from core.system import System
from tests.core import examples, reference_friction

Floats = examples.Floats
EPSILON = float(np.finfo(np.float64).eps)
RELATIVE = 1e-12  # where it comes from: see test_twins.py
MU = 0.4
FEW = settings(max_examples=15, deadline=None)


@dataclass
class Case:
    """Where slips are counted from, and where grains and bodies are now."""

    before: Packing
    world: RigidWorld
    placed: Floats  # of the bodies, before
    friction: Friction
    packing: Packing
    turned: Floats
    place: Floats

    def relaxation(self, *, friction: bool = True, skin: float = 0.3) -> Relaxation:
        """One that has looked at the forces once."""
        self.world.place(self.placed)
        rows, owner = self.world.primitives()
        origin = self.friction.begin(self.before, rows, owner, self.placed, self.place)
        self.world.place(self.place)
        rows = self.world.primitives()[0]
        relaxation = Relaxation(self.packing, rows, origin if friction else None, skin=skin)
        if friction:
            relaxation._minimizer.state[5] = self.turned
        relaxation.run(1)
        return relaxation

    def forces(self) -> tuple[float, Floats]:
        """Energy [k R²] and forces (6, N) of friction alone."""
        return rubbing(self.relaxation(), self.relaxation(friction=False))

    def twin(self) -> reference_friction.Before:
        self.world.place(self.placed)
        rows, owner = self.world.primitives()
        return reference_friction.Before(
            self.before,
            self.friction.remembered(),
            self.friction.coefficient,
            rows,
            (self.place - self.placed)[owner, 2],
        )

    def contacts(self) -> list[reference_friction.Tangential]:
        """As the twin has them."""
        before = self.twin()
        self.world.place(self.place)
        rows = self.world.primitives()[0]
        return reference_friction.frictional_contacts(self.packing, self.turned, rows, before)


def rubbing(with_friction: Relaxation, without: Relaxation) -> tuple[float, Floats]:
    """Energy and forces (6, N) by which two relaxations differ."""
    forces = with_friction.forces()
    forces[:5] -= without.forces()
    return with_friction.report().energy - without.report().energy, forces


def remember(friction: Friction, packing: Packing, world: RigidWorld, seed: int) -> None:
    """Give every contact a memory of up to 0.9 of what it can hold."""
    pairs = observables.grain_contacts(packing)
    bodies = observables.body_contacts(packing, world.primitives()[0])
    label = packing.label
    a, b = label[pairs.i], label[pairs.j]
    keys = np.concatenate(
        [
            np.minimum(a, b) * GRAIN + np.maximum(a, b),
            label[bodies.grain] * GRAIN + BODY + bodies.primitive,
        ]
    )
    overlap = np.concatenate([pairs.overlap, bodies.overlap])
    order = np.argsort(keys)
    share = np.random.default_rng(seed).uniform(-0.9, 0.9, len(keys))
    limit = friction.coefficient / TANGENTIAL_STIFFNESS * overlap[order]
    friction.remember(friction.spin, keys[order], share * limit)


def wander(packing: Packing, seed: int, size: float) -> tuple[Packing, Floats]:
    """The packing with every grain moved, deformed and turned a bit."""
    random = np.random.default_rng(seed + 100)
    moved = packing.copy()
    moved.state += random.uniform(-size, size, moved.state.shape)
    return moved, random.uniform(-size, size, len(packing))


def case(
    seed: int,
    size: float = 0.01,
    box: PeriodicBox | None = None,
    bodies: bool = True,
    move: float = 0.02,
    count: int = 20,
    side: float = 9.0,
) -> Case:
    """Grains and bodies anywhere that have gone up to ``size`` and ``move`` since every contact remembered something."""
    packing = examples.random_grains(count, side, seed, box)
    world = examples.bodies() if bodies else RigidWorld()
    if box is not None and bodies:
        world.remove("floor")  # it is too long for a cell
    placed = world.placement()
    friction = Friction(MU, len(packing))
    remember(friction, packing, world, seed)
    place = placed + np.random.default_rng(seed).uniform(-move, move, placed.shape)
    moved, turned = wander(packing, seed, size)
    return Case(packing, world, placed, friction, moved, turned, place)


def stretch(state: Floats) -> Floats:
    """U (2, 2) from p, q1, q2."""
    p, q1, q2 = state
    return np.array([[p + q1, q2], [q2, p - q1]])


def rotation(angle: float) -> Floats:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def turn_shapes(state: Floats, angle: float) -> None:
    """Turn the ellipses of (5, N) in place."""
    state[3:5] = rotation(2.0 * angle) @ state[3:5]


def stay(friction: Friction, packing: Packing, before: Packing | None = None) -> FrictionForces:
    """An increment in which grains go from ``before``, or nothing moves, and what is left is remembered."""
    none, still = np.zeros((0, 3)), np.zeros(len(packing))
    made = Case(before or packing, RigidWorld(), none, friction, packing, still, none)
    keys, slips, forces = made.relaxation().slips()
    friction.end(keys, slips, still)
    return forces


def box_of_grains(count: int = 25) -> tuple[Packing, RigidWorld]:
    """A random packing between two plates and two walls; the upper plate is a piston in both senses."""
    random = np.random.default_rng(count)
    side = math.sqrt(count)
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    packing = Packing(
        1.8 * x.ravel() + random.uniform(-0.05, 0.05, count),
        1.8 * y.ravel() + random.uniform(-0.05, 0.05, count),
        random.uniform(0.9, 1.0, count),
        random.choice([-0.8, 0.8], count),
    )
    low, high = -0.9, 1.8 * side - 0.9
    floor = RigidBody("floor", segments=[(low - 5.0, low, high + 5.0, low, 0.0)])
    left = RigidBody("left", segments=[(low, low - 5.0, low, high + 5.0, 0.0)])
    right = RigidBody("right", segments=[(high, low - 5.0, high, high + 5.0, 0.0)])
    plate = RigidBody(
        "plate",
        position=(0.0, high),
        segments=[(-9.0, 0.0, 30.0, 0.0, 0.0)],
        axis=(1.0, 0.0),
    )
    return packing, RigidWorld([floor, left, right, plate])


CAREFUL = Settings(step=0.05, tolerance=1e-4, max_iterations=20_000)


def sheared(slices: list[int]) -> Quasistatic:
    """The plate goes forth by 0.25 R; every increment cut into slices of so many iterations."""
    packing, world = box_of_grains()
    engine = Quasistatic(System(packing, world, CAREFUL, Friction(MU, len(packing))))
    for _ in range(6):
        engine.begin({"plate": (0.25, world["plate"].position[1])})
        turn = 0
        while engine.relax(slices[turn % len(slices)]) is None:
            turn += 1
    return engine

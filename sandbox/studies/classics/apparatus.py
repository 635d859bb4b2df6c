"""What cases are built with: flat bodies, whole increments, supports that are withdrawn, and bisection."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.friction import Friction
from core.packing import Packing
from core.quasistatic import Increment, Quasistatic
from core.rigid import Point, RigidBody, RigidWorld
from core.settings import Settings
from core.system import System
from sandbox.studies.classics.case import Asking

CAREFUL = Settings(0.05, 1e-7, force_floor=1e-9, max_iterations=200_000)


def plate(name: str, at: Point, half: float, *, upright: bool = False) -> RigidBody:
    """A flat face of length 2 · ``half`` [R] about ``at``: level, sliding along y, or upright, sliding along x."""
    ends = (0.0, -half, 0.0, half, 0.0) if upright else (-half, 0.0, half, 0.0, 0.0)
    axis = (1.0, 0.0) if upright else (0.0, 1.0)
    return RigidBody(name, "body", position=at, segments=[ends], axis=axis)


def engine(
    packing: Packing,
    bodies: Sequence[RigidBody],
    friction: float,
    weight: float = 0.0,
    settings: Settings = CAREFUL,
    drag: float = 0.0,
) -> Quasistatic:
    """Grains among bodies, of which a large one weighs ``weight`` [k R]."""
    gravity = (0.0, -weight) if weight else None
    rub = Friction.of(friction, len(packing))
    return Quasistatic(System(packing, RigidWorld(list(bodies)), settings, rub, gravity, drag))


def increment(
    engine: Quasistatic, targets: dict[str, Point] | None = None, check: Asking = lambda: None
) -> Increment:
    """One whole increment."""
    check()
    engine.begin(targets or {})
    while True:
        done = engine.relax(20_000)
        if done is not None:
            return done
        check()


def withdraw(
    engine: Quasistatic,
    ways: dict[str, Point],
    first: float,
    total: float,
    check: Asking,
    growth: float = 1.15,
) -> float:
    """Take supports away along their ways, unit vectors, by steps that grow from ``first`` to a sum of ``total`` [R].

    Returns the force that they still bear then [k R]: none, if what they held stands by itself.
    """
    gone, step = 0.0, first
    done = None
    while gone < total:
        gone += step
        step = min(step * growth, 0.1 * total)
        targets = {}
        for name, (x, y) in ways.items():
            home = engine.world[name].home
            targets[name] = (home[0] + gone * x, home[1] + gone * y)
        done = increment(engine, targets, check)
    assert done is not None
    forces = [done.reactions[engine.world.index(name), :2] for name in ways]
    return float(np.max(np.hypot(*np.transpose(forces))))


def least(stands: Callable[[float], bool], low: float, high: float, width: float) -> float:
    """The least number at which something stands, in the middle of an interval of ``width``; it falls at ``low``.

    Raises ValueError if it does not fall at ``low``, or does not stand at ``high``.
    """
    if stands(low) or not stands(high):
        raise ValueError(f"it does not fall at {low:g} and stand at {high:g}")
    while high - low > width:
        middle = 0.5 * (low + high)
        if stands(middle):
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)

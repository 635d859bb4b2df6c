"""The state of an engine between two increments, to go back to: complete, so that what follows is the same to the last bit."""

from __future__ import annotations

from dataclasses import dataclass

from core.arrays import Floats
from core.friction import Friction
from core.packing import Packing
from core.rigid import Point, RigidBody, RigidWorld
from core.settings import Settings


@dataclass(frozen=True)
class BodyState:
    """A body, which stays as it was made, and where it was."""

    body: RigidBody
    position: Point  # [R]
    angle: float  # [rad]
    home: Point  # [R]
    axis: Point | None


@dataclass(frozen=True)
class EngineState:
    """All that the next increment depends on. It shares no array with the engine, and nothing in it is ever written to."""

    packing: Packing
    bodies: tuple[BodyState, ...]
    reactions: Floats  # (B, 3) [k R, k R²]
    last: Floats  # (5, N) displacement in the latest increment [R]
    own_motion: Floats  # (2, N) beyond that of the periodic cell [R]
    last_moved: dict[str, Point]
    friction: Friction | None
    solver: Settings
    gravity: Point | None
    drag: float

    @property
    def size(self) -> int:
        """Bytes, without material that may be shared with the state before."""
        arrays = self.packing.state.nbytes + self.last.nbytes + self.own_motion.nbytes
        return arrays + (0 if self.friction is None else self.friction.size)


def keep_packing(packing: Packing, before: Packing | None) -> Packing:
    """An independent copy; arrays of material that are the same to the last bit in ``before`` are shared with it."""
    twin = packing.copy()
    if before is not None:
        for name in ("rest_radius", "poisson_ratio", "contact_stiffness", "label"):
            own, other = getattr(twin, name), getattr(before, name)
            if own.tobytes() == other.tobytes():
                setattr(twin, name, other)
    return twin


def keep_bodies(world: RigidWorld) -> tuple[BodyState, ...]:
    """All bodies and where they are."""
    return tuple(BodyState(b, b.position, b.angle, b.home, b.axis) for b in world.bodies)


def place_bodies(world: RigidWorld, states: tuple[BodyState, ...]) -> None:
    """Let the world have these bodies and no others, where they were."""
    for kept in states:
        body = kept.body
        body.position, body.angle, body.home, body.axis = (
            kept.position,
            kept.angle,
            kept.home,
            kept.axis,
        )
    world.bodies = [kept.body for kept in states]

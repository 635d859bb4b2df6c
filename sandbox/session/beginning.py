"""What a session begins with and leaves behind, if not a scene as it is built: data, read and written elsewhere."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.engine_state import EngineState
from core.errors import InputError
from core.friction import Friction
from core.generate import inside
from core.packing import Packing
from core.rigid import Point, RigidBody
from sandbox.session.editing import drawn_wall
from scenes.grains import KINDS_OF_GRAINS, material
from scenes.parameter import Value
from scenes.scene import Scene, Setup, Values

Placement = tuple[float, float, float]

BEYOND = 6.0  # [R] how far outside the picture of its scene something may be
HAIR = 1e-6  # [R] a difference of places that is none


@dataclass(frozen=True)
class SceneFile:
    """A scene as it was left: what it was built from, and where its grains, bodies and drawn walls were."""

    name: str  # of the file, for messages
    scene: str
    packing: str
    seed: int
    settings: dict[str, Value]
    placements: dict[str, Placement]  # x, y [R] and angle [rad] of every body
    walls: tuple[tuple[Point, ...], ...]  # lines of the drawn walls [R]
    grains: Packing
    spin: Floats | None  # (N,) [rad]; None if there was no friction
    memory: tuple[NDArray[np.int64], Floats] | None  # of the frictional contacts
    text: bytes  # the two files themselves, to be put into a log
    data: bytes

    def of_kind(self, kind: str) -> SceneFile:
        """The same places with grains of another kind of packing, to be looked at side by side; nothing to be logged."""
        if kind == self.packing:
            return self
        made_of = np.array([material(self.settings, one) for one in KINDS_OF_GRAINS])
        share = {"regular": 0.0, "auxetic": 1.0}.get(
            kind, float(self.settings.get("auxetic_fraction", 0.5))
        )
        steps = np.floor(np.arange(len(self.grains) + 1) * share + 1e-9)
        grains = self.grains.copy()
        materials = made_of[np.diff(steps).astype(np.int64)]
        grains.poisson_ratio, grains.contact_stiffness = np.ascontiguousarray(materials.T)
        return replace(self, packing=kind, grains=grains, text=b"", data=b"")


@dataclass(frozen=True)
class Asked:
    """What is to be built: a scene with its settings, or what was made of one."""

    scene: Scene
    packing: str
    seed: int
    settings: Values
    file: SceneFile | None = None


@dataclass(frozen=True)
class Made:
    """What there is to be written: a state between two increments, to which nobody writes any more. Any thread may have it."""

    scene: str
    packing: str
    seed: int
    settings: Values
    state: EngineState
    file: SceneFile | None = None  # what it goes on from
    worth_keeping: bool = True  # has a person done anything?


def put_into(setup: Setup, file: SceneFile) -> None:
    """Make a scene that was just built the one of the file. Raises InputError if its parts do not go together."""
    walls = [drawn_wall(k, line) for k, line in enumerate(file.walls, 1)]
    try:
        check_fit(setup, file.grains, file.placements, walls)
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from None
    setup.packing = file.grains.copy()
    for body in setup.world.bodies:
        if body.name in file.placements:
            x, y, angle = file.placements[body.name]
            body.position, body.angle = (x, y), angle
    setup.world.redraw(walls)
    if setup.friction is not None:
        setup.friction = Friction(setup.friction.coefficient, len(file.grains))
        if file.spin is not None and file.memory is not None:
            setup.friction.remember(file.spin, *file.memory)


def check_fit(
    setup: Setup, grains: Packing, placements: Mapping[str, Placement], walls: list[RigidBody]
) -> None:
    """Raises InputError unless a built scene can have its grains, bodies and walls there."""
    _check_box(setup, grains)
    x0, y0, x1, y1 = setup.bounds
    low, high = np.array([x0, y0]) - BEYOND, np.array([x1, y1]) + BEYOND
    standing = np.array(grains.folded()).T
    if np.any((standing < low) | (standing > high)):
        raise InputError("a grain lies far outside the scene")
    if setup.outlet is None and setup.follow is None:
        near = standing[~inside(setup.outline, *standing.T)]
        corners = np.array(setup.outline)
        if np.any((near < corners.min(axis=0) - 1.0) | (near > corners.max(axis=0) + 1.0)):
            raise InputError("a grain lies outside the walls")
    names = {body.name for body in setup.world.bodies}
    for name in placements:
        if name not in names:
            raise InputError(f"this scene has no body {name!r}")
    for body in setup.world.bodies:
        if body.name in placements:
            _check_placement(body, placements[body.name], low, high, free=setup.follow is not None)
    if walls and grains.box is not None:
        raise InputError("there are no drawn walls in a cell that repeats itself")


def _check_box(setup: Setup, grains: Packing) -> None:
    own, other = setup.packing.box, grains.box
    if (own is None) != (other is None):
        raise InputError("the grains are not of this scene: only one of them has a periodic cell")
    if own is None or other is None:
        return
    for mine, theirs in ((own.width, other.width), (own.height, other.height)):
        if math.isinf(mine) != math.isinf(theirs):
            raise InputError("the periodic cell of the grains is not of this scene")
        if not math.isinf(mine) and not 0.3 <= theirs / mine <= 3.0:
            raise InputError("the periodic cell of the grains is not of this scene")


def _check_placement(
    body: RigidBody, placement: Placement, low: Floats, high: Floats, *, free: bool
) -> None:
    """Raises InputError unless a hand, or the scene with ``free``, could have brought the body there."""
    at = np.array(placement[:2])
    way = at - body.position
    if body.held or free:
        allowed = bool(np.all((at > low) & (at < high)))
    elif body.axis is not None:
        along = float(np.dot(at - body.home, body.axis))
        across = float(np.linalg.norm(at - body.home - along * np.array(body.axis)))
        allowed = body.travel[0] - HAIR <= along <= body.travel[1] + HAIR and across < HAIR
    else:
        allowed = bool(np.all(np.abs(way) < HAIR))
    if not allowed or abs(placement[2] - body.angle) > HAIR:
        raise InputError(f"body {body.name!r} cannot be where the file has it")

"""A scene that is built, written into the blocks of memory that kernels and a page share; and its state read from them."""

from __future__ import annotations

import hashlib
import math
from dataclasses import astuple
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats, Indices
from core.errors import InputError
from core.friction import Friction
from core.packing import Packing, PeriodicBox
from core.rigid import SAME_POINT, RigidBody
from core.rigid_contacts import EDGE, VERTEX
from sandbox.web.increment import curve, remarks
from sandbox.web.increment.memory import COUNTS, KINDS, PART, ROW, SIZES, Sizes, blank
from sandbox.web.increment.systems import PLACES, TURN
from scenes.gravity_hopper import REST, TREMBLE
from scenes.scene import Scene, Setup, Values

Blocks = tuple[Indices, Floats]
ROOM = 8  # contacts a grain, and a few more: far above what any packing has
CURVES = {
    "grain_row": curve.ROW_OF_GRAINS,
    "biaxial_press": curve.PRESS,
    "gravity_hopper": curve.GRAINS_OUT,
    "couette": curve.SHEAR,
}
REMARKS = {
    "hopper": remarks.HOPPER,
    "gravity_hopper": remarks.GRAVITY,
    "intruder": remarks.DISC,
    "grain_row": remarks.ROW_OF_GRAINS,
    "single_grain": remarks.SINGLE,
    "couette": remarks.SHEAR,
}
SIDES = {"left wall": -1, "right wall": 1}  # of an orifice
REPEATED = {"gravity_hopper": REST + TREMBLE}  # a script that begins again after so many increments
PART_NAMES = PART._asdict()


def part(blocks: Blocks, name: str, length: int) -> NDArray[Any]:
    """So many numbers of a part, to be read and written."""
    ints, floats = blocks
    at = int(ints[PART_NAMES[name]])
    block = floats if PART_NAMES[name] < PART.label else ints
    return block[at : at + length]


def laid_out(scene: Scene, setup: Setup, settings: Values, kind: str) -> Blocks:
    """A run of what was built from grains of that kind, before its first increment.

    Raises InputError for what a page cannot run: a cell that is periodic upwards or has walls, bodies that turn, and any but
    discs that are dragged anywhere.
    """
    _check(scene, setup)
    packing, world = setup.packing, setup.world
    script = _script(scene, setup, settings)
    rows, owner = world.primitives()
    corners = np.zeros((0, 2)) if setup.outlet is None else np.asarray(setup.outlet.below)
    room = ROOM * len(packing) + 64
    sizes = Sizes(
        grains=len(packing),
        bodies=len(world.bodies),
        primitives=len(rows),
        room=room,
        contacts=room,
        steps=len(script),
        corners=len(corners),
        capacity=len(packing),
    )
    blocks = blank(sizes)

    def put(name: str, values: object) -> None:
        flat = np.asarray(values).ravel()
        part(blocks, name, len(flat))[:] = flat

    put("state", packing.state)
    put("rest_radius", packing.rest_radius)
    put("poisson_ratio", packing.poisson_ratio)
    put("contact_stiffness", packing.contact_stiffness)
    put("label", packing.label)
    put("places", _places(setup))
    put("local", _local(rows, owner, world.placement()))
    put("owner", owner)
    if packing.box is not None:
        put("cell", packing.box.kernel_form())
    put("joints", _joints(rows))
    put("script", script)
    put("corners", corners)
    solver, friction = setup.solver, setup.friction
    put(
        "settings",
        [
            *(solver.step, solver.tolerance, solver.force_floor, solver.skin),
            *(float(solver.max_iterations), solver.hand_strength),
            0.0 if friction is None else friction.coefficient,
            *(setup.gravity or (0.0, 0.0)),
            setup.drag,
        ],
    )
    row, counts = part(blocks, "row", len(ROW)), part(blocks, "counts", len(COUNTS))
    handle = setup.handles[0]
    row[ROW.direction_x], row[ROW.direction_y] = handle.direction
    if setup.outlet is not None:
        row[ROW.outlet], row[ROW.beside] = setup.outlet.y, setup.outlet.beside
    counts[COUNTS.script], counts[COUNTS.driven] = -1, world.index(handle.body)
    counts[COUNTS.curve] = CURVES.get(scene.name, curve.FORCE)
    counts[COUNTS.repeats] = scene.name in REPEATED
    counts[COUNTS.scene] = REMARKS.get(scene.name, remarks.NOBODY)
    put("side", [SIDES.get(body.name, 0) for body in world.bodies])
    put("announced", [-1] * KINDS)
    known = scene.accuracy.estimate(kind)
    put("accuracy", [astuple(known.usual), astuple(known.nine_of_ten)])
    row[ROW.base] = min(y for _, y in setup.outline)
    row[ROW.rest] = setup.rest
    row[ROW.side] = math.hypot(*np.subtract(setup.outline[1], setup.outline[0]))
    return blocks


def _check(scene: Scene, setup: Setup) -> None:
    if setup.curve is not None and scene.name not in CURVES:
        raise InputError(f"a page cannot plot the curve of {scene.name}")
    other = [body for body in setup.world.bodies if body.held and not _radius(body)]
    turned = [body for body in setup.world.bodies if body.movable and body.angle != 0.0]
    box = setup.packing.box
    walls = any(body.segments or body.polygons for body in setup.world.bodies)
    if box is not None and (walls or math.isfinite(box.height)):
        raise InputError("a page runs scenes whose cell is open, or goes round from left to right")
    if other or (setup.drag > 0.0 and setup.gravity is None):
        raise InputError("a page runs scenes with bodies that slide, and discs")
    if turned or setup.follow is not None or not setup.relaxes or setup.box_target is not None:
        raise InputError(
            "a page runs scenes whose bodies move straight, and all of whose grains relax"
        )


def _places(setup: Setup) -> Floats:
    places = np.zeros((len(setup.world.bodies), PLACES))
    for row, body in zip(places, setup.world.bodies, strict=True):
        axis = body.axis or (0.0, 0.0)
        radius = _radius(body) if body.held else 0.0
        row[:] = [*body.position, body.angle, *body.home, *axis, *body.travel, radius]
    return places


def _radius(body: RigidBody) -> float:
    """That of a body which is a disc about its own place [R]; 0 of all others."""
    alone = len(body.discs) == 1 and not body.segments and not body.polygons
    return body.discs[0][2] if alone and body.discs[0][:2] == (0.0, 0.0) else 0.0


def _local(rows: Floats, owner: Indices, placement: Floats) -> Floats:
    """Primitives (M, 8) with points as seen from their bodies."""
    local = rows.copy()
    local[:, 1:3] -= placement[owner, :2]
    edges = rows[:, 0] == EDGE
    local[edges, 5:7] -= placement[owner[edges], :2]
    return local


def _joints(rows: Floats) -> Indices:
    """See ``systems.Bodies.joints``: the edges whose ends the vertices are."""
    joints = np.zeros((len(rows), 2), dtype=np.int64)
    edges = np.flatnonzero(rows[:, 0] == EDGE)
    for m in np.flatnonzero(rows[:, 0] == VERTEX):
        for side, way in enumerate((rows[m, 3:5], rows[m, 5:7])):
            for e in edges:
                ends = ((rows[e, 1:3], -rows[e, 3:5], -1), (rows[e, 5:7], rows[e, 3:5], 1))
                for place, along, sign in ends:
                    near = np.abs(place - rows[m, 1:3]).max() < SAME_POINT
                    if near and rows[e, 7] == rows[m, 7] and np.array_equal(along, way):
                        joints[m, side] = sign * (e + 1)
    return joints


def _script(scene: Scene, setup: Setup, settings: Values) -> Floats:
    """Where the driven body goes, increment by increment (S, 2) [R]."""
    body = setup.handles[0].body
    script: list[tuple[float, float]] = []
    most = REPEATED.get(scene.name, math.inf)
    while len(script) < most and (targets := scene.drive(setup, settings, len(script))) is not None:
        script.append(targets[body])
    return np.array(script).reshape(-1, 2)


def packing_in(blocks: Blocks) -> Packing:
    """The grains as they are now."""
    n = int(blocks[0][SIZES.grains])
    x, y, *_ = part(blocks, "state", 5 * n).reshape(5, n)
    width = float(part(blocks, "cell", 1)[0])
    packing = Packing(
        x,
        y,
        part(blocks, "rest_radius", n).copy(),
        part(blocks, "poisson_ratio", n).copy(),
        part(blocks, "contact_stiffness", n).copy(),
        box=PeriodicBox(width) if width > 0.0 else None,
    )
    packing.state[:] = part(blocks, "state", 5 * n).reshape(5, n)
    packing.label = part(blocks, "label", n).copy()
    return packing


def state_hash(blocks: Blocks) -> str:
    """As ``sandbox.session.run.Run.state_hash``."""
    ints, _ = blocks
    bodies, n = int(ints[SIZES.bodies]), int(ints[SIZES.grains])
    places = part(blocks, "places", PLACES * bodies).reshape(bodies, PLACES)
    placement = np.ascontiguousarray(places[:, : TURN + 1])
    digest = hashlib.sha256(packing_in(blocks).hash().encode() + placement.tobytes())
    coefficient = float(part(blocks, "settings", 7)[6])
    if coefficient > 0.0:
        friction = Friction(coefficient, n)
        count = int(part(blocks, "known", 1)[0])
        known = part(blocks, "keys", count), part(blocks, "slips", count)
        friction.remember(part(blocks, "spin", n), *known)
        digest.update(friction.hash().encode())
    return digest.hexdigest()

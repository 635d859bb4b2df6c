"""Is what a scene file says something that this program would have written? Nothing of it is believed before."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any, TypeGuard

import numpy as np

from core.errors import InputError
from core.friction import Friction
from core.hand import CELL
from core.material import DEFAULT_POISSON_RATIO
from core.packing import MAX_LABEL, Packing
from core.relaxation import StopReason
from core.rigid import Point
from sandbox.session.beginning import GoingOn, Place, State
from sandbox.session.course import Course
from sandbox.session.editing import FARTHEST, MOST_GRAINS, MOST_PIECES, MOST_WALLS
from sandbox.session.history import History
from sandbox.session.run import MOST_RELAXATIONS
from scenes.parameter import Value, check_seed
from scenes.scene import Scene

MOST_BODIES = 200
RADII = (0.05, 50.0)  # [R] of grains at rest
CROWD = 60  # grains whose centres lie in one square with sides of the smallest grain's radius
MOST_INCREMENTS = 10_000_000


def check_scene(
    scene: Scene, packing: object, seed: object, settings: Mapping[str, object]
) -> tuple[str, int, dict[str, Value]]:
    """Kind, seed and settings that the scene knows. Raises InputError."""
    if not isinstance(packing, str):
        raise InputError("packing is not what it should be")
    return scene.check_packing(packing), check_seed(seed), scene.settings(numbers(settings))


def check_state(scene: Scene, state: State) -> State:
    """The state with settings as the scene has them. Raises InputError for one that no command leads to."""
    _check_places(state.bodies)
    _check_walls(state.walls)
    check_grains(state.grains)
    _check_material(scene, state.grains)
    _check_friction(state)
    if state.going_on is not None:
        _check_going_on(state, state.going_on)
    return replace(state, settings=scene.settings(numbers(state.settings)))


def check_grains(grains: Packing) -> None:
    """Raises InputError for grains that this program would not have made: too many, of odd sizes, or in one heap."""
    if len(grains) > MOST_GRAINS:
        raise InputError(f"{len(grains)} grains are more than a scene holds ({MOST_GRAINS})")
    if not len(grains):
        return
    radius = grains.rest_radius
    if np.any((radius < RADII[0]) | (radius > RADII[1])):
        raise InputError(f"rest radii of grains must lie between {RADII[0]:g} and {RADII[1]:g} R")
    longer, shorter = grains.semi_axes
    if np.any(shorter <= 0.0) or np.any(longer > 100.0 * radius):
        raise InputError("a grain is flatter or longer than any grain of this program")
    if np.any(np.abs(grains.state[:2]) > FARTHEST):
        raise InputError("a grain lies far outside the scene")
    squares = np.floor(np.array(grains.folded()) / float(radius.min()))
    _, crowd = np.unique(squares, axis=1, return_counts=True)
    if crowd.max() > CROWD:
        raise InputError("the grains lie on top of one another")


def _check_material(scene: Scene, grains: Packing) -> None:
    """Raises InputError for what no parameter of the scene can be set to."""
    for parameter in scene.parameters:
        if parameter.name == "contact_stiffness":
            for stiffness in np.unique(grains.contact_stiffness):
                parameter.check(float(stiffness))
    offered = [p for p in scene.parameters if p.name.endswith("poisson_ratio")]
    most = max((abs(v) for p in offered for v in (p.low, p.high)), default=DEFAULT_POISSON_RATIO)
    if np.any(np.abs(grains.poisson_ratio) > most):
        raise InputError(f"Poisson's ratios of grains must lie between {-most:g} and {most:g}")


def check_history(history: History) -> None:
    """Raises InputError for rows and events that no run leaves."""
    if not 1 <= len(history) <= MOST_INCREMENTS:
        raise InputError("the history has no rows, or more than any run")
    if history.column("increment").tolist() != list(range(len(history))):
        raise InputError("the rows of the history are not numbered one after another")
    reasons = {str(reason) for reason in StopReason} - {str(StopReason.BUDGET)}
    if not set(history.column("stop_reason").tolist()) <= reasons:
        raise InputError("a row of the history ended for a reason that nobody knows")
    forces = [history.column(name) for name in ("fx", "fy", "on_drawn_x", "on_drawn_y")]
    if not np.all(np.isfinite(np.concatenate([history.curve.ravel(), *forces]))):
        raise InputError("the curve of the history must be finite, and so must its forces")
    if np.any(np.isinf(history.column("on_solids"))):  # not a number: an older program's rows
        raise InputError("forces of the history must not be infinite")


def _check_going_on(state: State, on: GoingOn) -> None:
    """What the next increment depends on must be of these grains and bodies, and must not keep it from ever coming."""
    grains, course = len(state.grains), on.course
    shapes = {
        "reactions": (on.reactions, (len(state.bodies) + len(state.walls), 3)),
        "displacement": (on.displacement, (5, grains)),
        "own_motion": (on.own_motion, (2, grains)),
        "unbalanced": (on.unbalanced, (grains,)),
    }
    for name, (array, shape) in shapes.items():
        if array.shape != shape or not np.all(np.isfinite(array)):
            raise InputError(f"array {name} is not of these grains and bodies, or not finite")
    marked = course.remarks.highlight
    if marked is not None and marked.shape != (grains,):
        raise InputError("the grains that are pointed at are not these")
    names = {*(place.name for place in state.bodies), CELL}
    for where in (on.moved, on.asked, on.pulled, on.stopped, course.targets):
        _check_names(where, names)
    for several in (course.held, course.blocked):
        _check_names(several, names)
    ways = [*on.moved.values(), *on.asked.values(), *on.pulled.values(), *course.targets.values()]
    if any(abs(v) > FARTHEST for way in ways for v in way):
        raise InputError("a hand is further away than any scene reaches")
    if on.report.reason is StopReason.BUDGET or on.report.iterations < 0:
        raise InputError("the latest increment has not ended")
    _check_counts(state, on, course)
    events = [event.increment for event in on.events]
    if events != sorted(events) or not all(0 <= e < len(on.history) for e in events):
        raise InputError("the events are not those of the rows")


def _check_counts(state: State, on: GoingOn, course: Course) -> None:
    first_free = int(state.grains.label.max(initial=-1)) + 1
    script = 0 if course.script is None else course.script
    whole = (
        0 <= script <= MOST_INCREMENTS
        and 0 <= course.touched <= MOST_RELAXATIONS
        and 0 <= course.stuck <= len(on.history)
        and 0 <= course.out <= course.initial <= MAX_LABEL
        and first_free <= course.next_label <= MAX_LABEL
    )
    if not whole:
        raise InputError("what has been counted is nothing that a run could have counted")


def _check_names(names: Iterable[str], known: set[str]) -> None:
    for name in names:
        if name not in known:
            raise InputError(f"nothing here is called {name[:80]!r}")


def _check_friction(state: State) -> None:
    memory = (state.spin, state.contact_keys, state.contact_slips)
    if all(part is None for part in memory):
        return
    spin, keys, slips = memory
    if spin is None or keys is None or slips is None:
        raise InputError("the frictional memory of the grains is not whole")
    if [spin.dtype, slips.dtype, keys.dtype] != [np.dtype(k) for k in (float, float, np.int64)]:
        raise InputError("the frictional memory of the grains has arrays of another kind")
    if spin.shape != (len(state.grains),) or keys.ndim != 1:
        raise InputError("the frictional memory is not that of these grains")
    Friction(1.0, len(state.grains)).remember(spin, keys, slips)


def numbers(settings: Mapping[str, object]) -> dict[str, object]:
    """Settings as a person cannot have typed them: no text, and nothing that a float does not hold."""
    for key, value in settings.items():
        if not isinstance(value, bool) and not _finite(value):
            raise InputError(f"setting {key!r} must be a finite number or a switch")
    return dict(settings)


def _finite(value: object) -> TypeGuard[float]:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return abs(value) <= 1e15


def places_of(rows: list[Any]) -> tuple[Place, ...]:
    """Where the bodies of an older file are."""
    places = []
    for row in rows:
        if not isinstance(row, dict) or set(row) != {"name", "x", "y", "angle"}:
            raise InputError("each of bodies must have name, x, y and angle, and nothing else")
        x, y, angle = (row[key] for key in ("x", "y", "angle"))
        if not isinstance(row["name"], str):
            raise InputError("each of bodies must have a name of its own")
        if not (_finite(x) and _finite(y) and _finite(angle)):
            raise InputError(f"body {row['name']!r}: x, y and angle must be finite numbers")
        places.append(Place(row["name"], (float(x), float(y)), float(angle)))
    return tuple(places)


def _check_places(places: tuple[Place, ...]) -> None:
    if len(places) > MOST_BODIES:
        raise InputError("more bodies than any scene has")
    if len({place.name for place in places}) < len(places):
        raise InputError("each of bodies must have a name of its own")
    for place in places:
        numbers = (*place.position, place.angle, *(place.home or ()), *(place.axis or ()))
        if any(abs(v) > FARTHEST for v in numbers):
            raise InputError(f"body {place.name!r} is further away than any scene reaches")


def walls_of(rows: list[Any]) -> tuple[tuple[Point, ...], ...]:
    """Lines of the drawn walls of an older file."""
    walls = []
    for row in rows:
        if not isinstance(row, dict) or set(row) != {"points"}:
            raise InputError("each of walls must have points, and nothing else")
        points = row["points"]
        if not isinstance(points, list):
            raise InputError("each of walls must have a list of points")
        for point in points:
            pair = isinstance(point, list) and len(point) == 2
            if not pair or not all(_finite(v) for v in point):
                raise InputError("each point of a drawn wall must be two finite numbers")
        walls.append(tuple((float(x), float(y)) for x, y in points))
    return tuple(walls)


def _check_walls(walls: tuple[tuple[Point, ...], ...]) -> None:
    if len(walls) > MOST_WALLS:
        raise InputError(f"more drawn walls than {MOST_WALLS}")
    for line in walls:
        if not 1 <= len(line) <= MOST_PIECES + 1:
            raise InputError(f"a drawn wall must have from 1 to {MOST_PIECES + 1} points")
        if any(abs(v) > FARTHEST for point in line for v in point):
            raise InputError("each point of a drawn wall must be two finite numbers, not far away")
        if any(math.dist(a, b) < 1e-6 for a, b in pairwise(line)):
            raise InputError("a drawn wall has the same point twice in a row")
    if sum(len(line) - 1 for line in walls) > MOST_PIECES:
        raise InputError(f"the drawn walls have more than {MOST_PIECES} straight pieces")

"""What a session begins with and leaves behind, if not a scene as it is built: data, read and written elsewhere."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.engine_state import BodyState, EngineState, keep_bodies
from core.errors import InputError
from core.friction import Friction
from core.generate import inside
from core.packing import Packing
from core.quasistatic import Increment
from core.relaxation import Report
from core.rigid import Point, RigidBody, depth
from sandbox.session.checkpoints import NO_BODIES, NO_PAIRS, Checkpoint
from sandbox.session.course import Course
from sandbox.session.editing import WALL, check_walls, drawn_wall, line_of
from sandbox.session.history import Event, History
from scenes.grains import KINDS_OF_GRAINS, material
from scenes.parameter import Value
from scenes.scene import Scene, Setup, Values

HAIR = 1e-6  # [R] a difference of places that is none
OUTSIDE = 1.0  # [R] so far a grain may be squeezed into a wall that nothing gets through
BEYOND = 6.0  # [R] how far outside the picture of its scene a body may be that a hand drags


@dataclass(frozen=True)
class Place:
    """Where a body of a scene is."""

    name: str
    position: Point  # [R]
    angle: float  # [rad]
    home: Point | None = None  # [R]; of this and the next older files know nothing
    axis: Point | None = None


@dataclass(frozen=True)
class GoingOn:
    """What the next increment depends on beside where everything stands, and what has been counted and said so far."""

    reactions: Floats  # (B, 3) [k R, k R²]
    displacement: Floats  # (5, N) in the latest increment [R]
    own_motion: Floats  # (2, N) [R]
    unbalanced: Floats  # (N,) [k R]
    moved: dict[str, Point]  # in the latest increment [R], as the engine has it
    # The latest increment: see ``Increment``.
    asked: dict[str, Point]
    pulled: dict[str, Point]
    stopped: dict[str, str]
    share: float
    hand_force: float
    report: Report
    course: Course
    history: History  # its rows
    events: tuple[Event, ...]


@dataclass(frozen=True)
class State:
    """A run between two increments, apart from the objects of the scene that it was built from."""

    settings: dict[str, Value]  # as they were then
    bodies: tuple[Place, ...]
    walls: tuple[tuple[Point, ...], ...]  # lines of the drawn walls [R]
    grains: Packing
    spin: Floats | None = None  # (N,) [rad]; None if there was no friction
    contact_keys: NDArray[np.int64] | None = None  # (K,) what its contacts remember
    contact_slips: Floats | None = None  # (K,) [R]
    going_on: GoingOn | None = (
        None  # None: it begins anew, with the grains relaxed where they stand
    )

    @classmethod
    def of(cls, kept: Checkpoint) -> State:
        """What a checkpoint is apart from those objects."""
        engine, last = kept.engine, kept.last
        friction = engine.friction
        keys, slips = (None, None) if friction is None else friction.memory()
        return cls(
            settings=dict(kept.settings),
            bodies=tuple(
                Place(b.body.name, b.position, b.angle, b.home, b.axis)
                for b in engine.bodies
                if not b.body.drawn
            ),
            walls=tuple(line_of(b.body) for b in engine.bodies if b.body.drawn),
            grains=engine.packing,
            spin=None if friction is None else friction.spin,
            contact_keys=keys,
            contact_slips=slips,
            going_on=GoingOn(
                reactions=engine.reactions,
                displacement=engine.last,
                own_motion=engine.own_motion,
                unbalanced=last.unbalanced,
                moved=engine.last_moved,
                asked=last.moved,
                pulled=last.pulled,
                stopped=last.stopped,
                share=last.share,
                hand_force=last.hand_force,
                report=last.report,
                course=kept.course,
                history=kept.history.first(kept.length),
                events=tuple(e for e in kept.history.events if e.increment < kept.length),
            ),
        )


@dataclass(frozen=True)
class SceneFile:
    """A scene as it was left: what it was built from, and how it stood."""

    name: str  # of the file, for messages
    scene: str
    packing: str
    seed: int
    built: dict[str, Value]  # the settings it was built from
    state: State
    before_edit: State | None = None  # see ``Checkpoint``

    @property
    def settings(self) -> dict[str, Value]:
        """As they are now."""
        return self.state.settings

    @property
    def grains(self) -> Packing:
        """Where they stand."""
        return self.state.grains

    def of_kind(self, kind: str) -> SceneFile:
        """The same places with grains of a kind of packing, to be looked at side by side: a new beginning for each kind."""
        state = replace(self.state, going_on=None)
        if kind != self.packing:
            made_of = np.array([material(self.settings, one) for one in KINDS_OF_GRAINS])
            share = {"regular": 0.0, "auxetic": 1.0}.get(
                kind, float(self.settings.get("auxetic_fraction", 0.5))
            )
            steps = np.floor(np.arange(len(self.grains) + 1) * share + 1e-9)
            grains = self.grains.copy()
            materials = made_of[np.diff(steps).astype(np.int64)]
            grains.poisson_ratio, grains.contact_stiffness = np.ascontiguousarray(materials.T)
            state = replace(state, grains=grains)
        return replace(self, packing=kind, state=state, before_edit=None)


@dataclass(frozen=True)
class Asked:
    """What is to be built: a scene with its settings, or what was made of one."""

    scene: Scene
    packing: str
    seed: int
    settings: Values
    file: SceneFile | None = None

    @property
    def settings_now(self) -> Values:
        """Those that it has when it is built."""
        return self.settings if self.file is None else self.file.settings


@dataclass(frozen=True)
class Made:
    """What there is to be written: a state between two increments, to which nobody writes any more. Any thread may have it."""

    scene: str
    packing: str
    seed: int
    built: Values
    kept: Checkpoint
    file: SceneFile | None = None  # what it goes on from
    worth_keeping: bool = True  # has a person done anything?

    def to_file(self, name: str) -> SceneFile:
        """The same apart from the objects of the scene, for a file of that name."""
        before = self.kept.before_edit
        return SceneFile(
            name,
            self.scene,
            self.packing,
            self.seed,
            dict(self.built),
            State.of(self.kept),
            None if before is None else State.of(before),
        )


def put_into(setup: Setup, asked: Asked) -> Checkpoint | None:
    """Make a scene that was just built the one of the file. The checkpoint to go on from; None: relax it where it stands.

    Raises InputError if its parts do not go together.
    """
    file = asked.file
    assert file is not None
    try:
        before = None
        if file.before_edit is not None:
            before = _put(setup, asked, asked.settings, file.before_edit)
        earlier = asked.settings if file.before_edit is None else file.before_edit.settings
        kept = _put(setup, asked, earlier, file.state)
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from None
    return kept if kept is None else replace(kept, before_edit=before)


def _put(setup: Setup, asked: Asked, earlier: Values, state: State) -> Checkpoint | None:
    """``state`` put into a setup with the settings ``earlier``."""
    changed = {name for name, value in state.settings.items() if value != earlier[name]}
    asked.scene.adjust(setup, state.settings, frozenset(changed))
    walls = [drawn_wall(k, line) for k, line in enumerate(state.walls, 1)]
    check_fit(setup, state, walls)
    setup.packing = state.grains.copy()
    if setup.friction is not None:
        setup.friction = Friction(setup.friction.coefficient, len(state.grains))
        if (
            state.spin is not None
            and state.contact_keys is not None
            and state.contact_slips is not None
        ):
            setup.friction.remember(state.spin, state.contact_keys, state.contact_slips)
    placed = _placed(setup, state)
    if state.going_on is None:
        for kept in placed:
            kept.body.position, kept.body.angle = kept.position, kept.angle
        setup.world.redraw(walls)
        return None
    return _checkpoint(setup, state, state.going_on, (*placed, *_standing(walls)))


def _placed(setup: Setup, state: State) -> tuple[BodyState, ...]:
    """The bodies of the scene where the state has them."""
    places = {place.name: place for place in state.bodies}
    found = []
    for own in keep_bodies(setup.world):
        place = places.get(own.body.name)
        if place is not None:
            home, axis = (own.home, own.axis) if place.home is None else (place.home, place.axis)
            own = BodyState(own.body, place.position, place.angle, home, axis)
        found.append(own)
    return tuple(found)


def _standing(walls: list[RigidBody]) -> tuple[BodyState, ...]:
    return tuple(BodyState(w, w.position, w.angle, w.home, w.axis) for w in walls)


def _checkpoint(
    setup: Setup, state: State, on: GoingOn, bodies: tuple[BodyState, ...]
) -> Checkpoint:
    engine = EngineState(
        packing=setup.packing.copy(),
        bodies=bodies,
        reactions=on.reactions,
        last=on.displacement,
        own_motion=on.own_motion,
        last_moved=on.moved,
        friction=None if setup.friction is None else setup.friction.copy(),
        solver=setup.solver,
        gravity=setup.gravity,
        drag=setup.drag,
    )
    last = Increment(
        moved=on.asked,
        pulled=on.pulled,
        stopped=on.stopped,
        share=on.share,
        hand_force=on.hand_force,
        report=on.report,
        reactions=on.reactions,
        grain_contacts=NO_PAIRS,
        body_contacts=NO_BODIES,
        unbalanced=on.unbalanced,
        beyond_cone=on.history[-1].beyond_cone if len(on.history) else 0.0,
    )
    history = History.of(on.history.rows(), on.events)  # the run's own, as it goes on
    return Checkpoint(engine, on.course, last, history, len(history), state.settings)


def check_fit(setup: Setup, state: State, walls: list[RigidBody]) -> None:
    """Raises InputError unless a built scene can have its grains, bodies and walls where ``state`` has them."""
    grains = state.grains
    _check_box(setup, grains)
    closed = setup.outlet is None and setup.follow is None
    # What slides pushes out of an open box the grains that were put behind it, and they go as far as they like.
    if closed and not any(body.axis is not None for body in setup.world.bodies):
        standing = np.array(grains.folded()).T
        near = standing[~inside(setup.outline, *standing.T)]
        corners = np.array(setup.outline)
        low, high = corners.min(axis=0) - OUTSIDE, corners.max(axis=0) + OUTSIDE
        if np.any((near < low) | (near > high)):
            raise InputError("a grain lies outside the walls")
    bodies = {body.name: body for body in setup.world.bodies}
    for place in state.bodies:
        if place.name not in bodies:
            raise InputError(f"this scene has no body {place.name!r}")
        _check_place(setup, bodies[place.name], place)
    if state.going_on is not None and [p.name for p in state.bodies] != list(bodies):
        raise InputError(f"this scene has the bodies {', '.join(bodies) or 'none'}, in this order")
    if state.going_on is not None:
        known = state.going_on.history.column("on_solids").shape[1]
        if known not in (0, 2 * len(setup.solids)):  # an older program does not know
            raise InputError("the rows of the history are not of the bodies of this scene")
    if walls:
        _check_walls(setup, state, walls)


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


def _check_place(setup: Setup, body: RigidBody, place: Place) -> None:
    """Raises InputError unless a hand, or the scene where things follow, could have brought the body there."""
    x0, y0, x1, y1 = setup.bounds
    low, high = np.array([x0, y0]) - BEYOND, np.array([x1, y1]) + BEYOND
    at = np.array(place.position)
    follows = setup.follow is not None
    if body.held or follows:
        allowed = bool(np.all((at > low) & (at < high)))
    elif body.axis is not None:
        along = float(np.dot(at - body.home, body.axis))
        across = float(np.linalg.norm(at - body.home - along * np.array(body.axis)))
        allowed = body.travel[0] - HAIR <= along <= body.travel[1] + HAIR and across < HAIR
    else:
        allowed = math.dist(at, body.position) < HAIR
    if place.home is not None:
        allowed &= (place.axis is None) == (body.axis is None)
        allowed &= place.axis is None or abs(math.hypot(*place.axis) - 1.0) < HAIR
        if not follows:
            allowed &= math.dist(place.home, body.home) < HAIR and (
                place.axis is None or body.axis is None or math.dist(place.axis, body.axis) < HAIR
            )
    if not allowed or abs(place.angle - body.angle) > HAIR:
        raise InputError(f"body {body.name!r} cannot be where the file has it")


def _check_walls(setup: Setup, state: State, walls: list[RigidBody]) -> None:
    """Raises InputError for walls that nobody could have drawn there."""
    if state.grains.box is not None:
        raise InputError("there are no drawn walls in a cell that repeats itself")
    if setup.follow is not None or not setup.relaxes:
        raise InputError("nothing can be made in this scene: its grains and plates move together")
    check_walls(tuple(walls))
    places = {place.name: place.position for place in state.bodies}
    for body in setup.world.bodies:
        # A hand presses a body into a wall a little; nothing gets as far as the wall's middle.
        if body.movable and depth(body, places.get(body.name, body.position), walls) > WALL:
            raise InputError(f"a drawn wall goes through body {body.name!r}")

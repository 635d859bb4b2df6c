"""Hard cases of the scenes: wild hands, friction 0 and 10, orifices smaller than a grain, pistons driven to the floor."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from core.relaxation import StopReason
from sandbox.session.commands import Change, Grab, Move, Protocol, Release, Reset
from sandbox.session.session import Session
from sandbox.studies.stability.case import TIME_LIMIT, Act, Case
from sandbox.studies.stability.rigs import KINDS
from sandbox.studies.stability.watch import Watch
from scenes import registry
from scenes.parameter import Value
from scenes.scene import HAND_STRENGTH, STRONGEST, Scene

# The smallest packings that a scene takes, or little more.
SMALL: Mapping[str, Value] = {
    "grains": 60,
    "width": 12.0,
    "intruder_radius": 2.0,
    "max_iterations": 100_000,
    HAND_STRENGTH: STRONGEST,
}
FAR = 1e6  # [R]
SCRIPTED = 12  # increments of the scripted drive
WILD = 6  # increments after each wish of a wild hand
TO_THE_END = 800
# A testing machine is stronger than any contact: what it crushes is told and taken back.
CRUSHED = (StopReason.COLLAPSED, StopReason.SUNK, StopReason.ITERATION_LIMIT, TIME_LIMIT)


def cases() -> Iterator[Case]:
    """All of this module."""
    for name in registry.names():
        scene = registry.get(name)
        for kind in KINDS:
            yield Case(
                "every scene",
                f"{name}, {kind}",
                "scripted drive, a hand that flings every handle far away, nonsense, Reset: the start to the last bit",
                _wild(scene, kind),
                named=CRUSHED,
                seconds=60.0,
            )
        if "friction" not in {p.name for p in scene.parameters}:
            continue
        for kind, friction in itertools.product(KINDS, (0.0, 10.0)):
            yield Case(
                "friction 0 and 10",
                f"{name}, {kind}, friction {friction:g}",
                "converges, bodies and grains stay apart; Reset",
                _rubbed(scene, kind, friction),
                named=CRUSHED,
                seconds=60.0,
            )
    for name, kind, friction in itertools.product(("hopper", "gravity_hopper"), KINDS, (0.0, 10.0)):
        yield Case(
            "orifice smaller than a grain",
            f"{name}, {kind}, friction {friction:g}",
            "no grain leaves, however hard it is pushed",
            _narrow(registry.get(name), kind, friction),
            named=CRUSHED,
            seconds=60.0,
        )
    for kind, orifice in itertools.product(KINDS, (0.3, 3.0)):
        yield Case(
            "piston driven to the floor",
            f"{kind}, orifice {orifice:g} diameters",
            "the hand gives way, or the piston arrives; no grain is lost or passes a wall",
            _to_the_floor(kind, orifice),
            named=CRUSHED,
            seconds=60.0,
        )
    for kind, friction in itertools.product(KINDS, (0.0, 10.0)):
        for where in ("flung across", "pressed into a corner", "parked on a grain"):
            yield Case(
                "intruder",
                f"{where}, {kind}, friction {friction:g}",
                "converges; intruder, grains and walls stay apart",
                _intruder(kind, friction, where),
                named=CRUSHED,
                seconds=60.0,
            )


def small(scene: Scene, kind: str, **settings: Value) -> Session:
    """A session of the scene with few grains, built."""
    known = {p.name: p for p in scene.parameters}
    asked = {name: value for name, value in {**SMALL, **settings}.items() if name in known}
    if "grains" in asked:
        grains = known["grains"]
        asked["grains"] = min(max(asked["grains"], grains.low), grains.high)
    session = Session(scene.name, kind, 1, asked)
    session.build()
    return session


def finish(watch: Watch, session: Session) -> None:
    """The program goes on, and Reset leads back to the start to the last bit, from where it goes on again."""
    start = small_start(session)
    session.submit(Reset())
    session.settle()
    watch.expect_true("after Reset not the state at the start", session.state_hash() == start)
    session.submit(Protocol(True))
    watch.run(session, 2)


def small_start(session: Session) -> str:
    """The hash of the state at the start of a session with these settings."""
    again = Session(session.scene.name, session.packing, session.seed, dict(session.settings))
    again.build()
    return again.state_hash()


def drag(
    watch: Watch, session: Session, handle: str, way: Sequence[tuple[float, float]], n: int
) -> None:
    """Take hold of a handle, and ask it to be at each place in turn, ``n`` increments each."""
    session.submit(Grab(handle))
    for x, y in way:
        session.submit(Move(handle, x, y))
        watch.run(session, n)
    session.submit(Release(handle))


def _wild(scene: Scene, kind: str) -> Act:
    def act(watch: Watch) -> None:
        session = small(scene, kind)
        session.submit(Protocol(True))
        watch.run(session, SCRIPTED)
        for handle in session.run.setup.handles:
            way = [(FAR, FAR), (-FAR, FAR), (0.0, -FAR), (0.0, 0.0)]
            drag(watch, session, handle.body, way, WILD)
        session.submit(Grab("nothing"))
        session.submit(Change("nothing", 1.0))
        session.submit(Change("grains", -1))
        watch.run(session, 1)
        frame = session.frame()
        watch.expect("drawn values that are not finite", np.sum(~np.isfinite(frame.x)), 0.0)
        _kept(watch, session)
        finish(watch, session)

    return act


def _rubbed(scene: Scene, kind: str, friction: float) -> Act:
    def act(watch: Watch) -> None:
        session = small(scene, kind, friction=friction)
        session.submit(Protocol(True))
        watch.run(session, 2 * SCRIPTED)
        handle = session.run.setup.handles[0].body
        drag(watch, session, handle, [(FAR, FAR), (-FAR, -FAR)], WILD)
        _kept(watch, session)
        finish(watch, session)

    return act


def _narrow(scene: Scene, kind: str, friction: float) -> Act:
    def act(watch: Watch) -> None:
        session = small(scene, kind, friction=friction, orifice=0.3, shake=0.0)
        session.submit(Protocol(True))
        watch.run(session, 60)
        watch.expect("grains that left", session.frame().grains_out, 0.0)
        _kept(watch, session)
        finish(watch, session)

    return act


def _to_the_floor(kind: str, orifice: float) -> Act:
    def act(watch: Watch) -> None:
        session = small(registry.get("hopper"), kind, orifice=orifice, grains=40, width=8.0)
        x, y = session.run.setup.world["piston"].position
        drag(watch, session, "piston", [(x, -FAR), (x, y), (x, -FAR)], TO_THE_END)
        _kept(watch, session)
        finish(watch, session)

    return act


def _intruder(kind: str, friction: float, where: str) -> Act:
    def act(watch: Watch) -> None:
        session = small(registry.get("intruder"), kind, friction=friction, step=0.15)
        setup = session.run.setup
        width, height = setup.outline[2]
        if where == "flung across":
            way, n = [(FAR, 0.5 * height), (-FAR, 0.5 * height), (0.5 * width, 0.5 * height)], 60
        elif where == "pressed into a corner":
            way, n = [(width + 20.0, height + 20.0), (width + 20.0, -20.0)], 150
        else:
            packing = setup.packing
            nearest = int(np.argmin(np.hypot(packing.x - 0.6 * width, packing.y - 0.5 * height)))
            way, n = [(float(packing.x[nearest]), float(packing.y[nearest]))], 150
        drag(watch, session, "intruder", way, n)
        x, y = setup.world["intruder"].position
        radius = setup.world["intruder"].discs[0][2]
        room = min(x, y, width - x, height - y)
        watch.expect("intruder sunk into a wall [R]", radius - room, 0.05)
        _kept(watch, session)
        finish(watch, session)

    return act


def _kept(watch: Watch, session: Session) -> None:
    """No grain is lost; the scene's own checks of that hold."""
    for check in session.checks()[:2]:
        watch.expect_true(f"{check.name}: {check.measured}", check.holds is not False)
    frame = session.frame()
    watch.expect_true("history and state disagree", math.isfinite(float(frame.curve_force[-1])))

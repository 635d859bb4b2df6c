"""A scene's short protocol, walked from one and the same start with any choice of numerical settings.

A walk is what a session does, without commands, history and frames: only the increments, each with its cost and its residual.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.arrays import Floats
from core.friction import Friction
from core.hand import CELL
from core.material import area_modulus, shape_modulus
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment, Quasistatic
from core.relaxation import Relaxation, StopReason
from core.rigid import Point
from core.warmup import compile_kernels
from sandbox.ensemble.clock import clock
from scenes import registry
from scenes.parameter import Value
from scenes.scene import Scene, Setup

Solve = Callable[[Relaxation, float], int]  # relaxes to a tolerance by other means; its evaluations

TIGHT = 1e-10  # relative residual of the start and of the reference
MOST_ITERATIONS = (
    60_000  # of one increment: where grains slide on one another there may be no end to it
)
LEAD_TOLERANCE = 1e-3  # on the way to the start
LEAD_ITERATIONS = 20_000
MOST_LEAD = 3  # times its length that a lead may take to feel a force
LEAST_CONTACTS = 2  # of a grain that bears force


@dataclass(frozen=True)
class Knobs:
    """The numerical settings of one walk. ``step`` is the increment as a share of the scene's own."""

    tolerance: float = TIGHT
    step: float = 1.0
    max_iterations: int = MOST_ITERATIONS
    contact_stiffness: float | None = None  # None: the scene's own
    solve: Solve | None = None  # None: FIRE
    slice: int = MOST_ITERATIONS  # force evaluations between two looks, as a window takes them


@dataclass
class Start:
    """A built scene, driven to where the protocol begins: what every walk sets out from."""

    scene: Scene
    settings: Mapping[str, Value]
    setup: Setup
    packing: Packing
    placement: Floats
    friction: Friction | None
    lead: int  # increments of the scripted drive before the start

    @property
    def area(self) -> float:
        """Area that a stress refers to [R²]."""
        box = self.packing.box
        if box is not None and np.isfinite(box.area):
            return box.area
        x, y = np.array(self.setup.outline).T
        return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))


@dataclass(frozen=True)
class Look:
    """What is read off after one increment."""

    force: Floats  # on the handle (2,) [k R]; where the handle is a periodic cell, what the scene plots, and 0
    stress: Floats  # (2, 2) [k]
    energy: float  # stored in grains and contacts [k R²]
    state: Floats  # (5, N) [R]
    label: NDArray[np.int64]  # (N,)
    bearing: NDArray[np.bool_]  # (N,) grains that bear force
    residual: float
    scale: float  # mean contact force [k R]
    converged: bool
    beyond_cone: float = 0.0  # share of contacts that pull harder than friction allows
    iterations: int = 0  # force evaluations
    seconds: float = 0.0  # processor time of the whole increment
    solving: float = 0.0  # and of the minimiser alone


@dataclass
class Walk:
    """All increments of one walk. Increment k ends at (k + 1) ``step`` of the scene's own increments."""

    step: float
    looks: list[Look] = field(default_factory=list)

    @property
    def seconds(self) -> float:
        """Processor time of all increments [s]."""
        return sum(look.seconds for look in self.looks)

    @property
    def solving(self) -> float:
        """Processor time of the minimiser alone [s]."""
        return sum(look.solving for look in self.looks)

    def at(self, place: float) -> Look | None:
        """What was seen after ``place`` of the scene's own increments; None if no increment ended there."""
        k = place / self.step
        if abs(k - round(k)) > 1e-9 or not 1 <= round(k) <= len(self.looks):
            return None
        return self.looks[round(k) - 1]


def begin(
    name: str,
    packing: str,
    seed: int,
    overrides: Mapping[str, object],
    lead: int,
    least_force: float = 0.0,
) -> Start:
    """Build a scene, drive it for ``lead`` of its increments, on until the handle feels ``least_force`` [k R], and relax it."""
    scene = registry.get(name)
    settings = scene.settings(overrides)
    terms = scene.ingredients(settings)
    compile_kernels(
        periodic=terms.periodic, rigid=terms.rigid, friction=terms.friction, gravity=terms.gravity
    )
    setup = scene.build(settings, packing, seed)
    placement = setup.world.placement()
    start = Start(scene, settings, setup, setup.packing, placement, setup.friction, 0)
    walker = Walker(start, Knobs(tolerance=LEAD_TOLERANCE, max_iterations=LEAD_ITERATIONS))
    done = 0
    while done < MOST_LEAD * lead:
        look = walker.increment()
        if look is None:
            break
        done += 1
        if done >= lead and np.hypot(*look.force) >= least_force:
            break
    if setup.drag == 0.0 and setup.relaxes:
        walker.rest(TIGHT)
    engine = walker.engine
    return Start(
        scene,
        settings,
        setup,
        engine.packing.copy(),
        setup.world.placement(),
        engine.friction,
        done,
    )


class Walker:
    """One walk under way."""

    def __init__(self, start: Start, knobs: Knobs) -> None:
        self.start, self.knobs = start, knobs
        self.settings = dict(start.settings)
        if "step" in self.settings:
            self.settings["step"] = float(self.settings["step"]) * knobs.step
        packing = start.packing.copy()
        if knobs.contact_stiffness is not None:
            packing.contact_stiffness[:] = knobs.contact_stiffness
        start.setup.world.place(start.placement)
        solver = start.setup.solver
        # Where there is drag, an increment is a step of time, and no body moves in this protocol.
        share = knobs.step if start.setup.drag == 0.0 else 1.0
        self.setup = replace(
            start.setup,
            packing=packing,
            friction=None if start.friction is None else start.friction.copy(),
            solver=replace(
                solver,
                step=solver.step * share,
                tolerance=knobs.tolerance,
                max_iterations=knobs.max_iterations,
            ),
            drag=start.setup.drag / knobs.step,
        )
        self.engine = Quasistatic(self.setup)
        self._next = round(start.lead / knobs.step)
        if knobs.contact_stiffness is not None:
            self.rest()

    def rest(self, tolerance: float | None = None) -> Look:
        """Relax where things stand, to ``tolerance``, or that of the knobs."""
        usual = self.setup.solver
        self.setup.solver = replace(
            usual,
            tolerance=self.knobs.tolerance if tolerance is None else tolerance,
            max_iterations=MOST_ITERATIONS,
        )
        done, iterations, solving = self._relaxed({}, None)
        self.setup.solver = usual
        return replace(self.look(done), iterations=iterations, solving=solving)

    def increment(self) -> Look | None:
        """The next increment of the protocol; None at its end."""
        targets: dict[str, Point] | None = {}
        if self.setup.drag == 0.0:  # else the grains go on by themselves
            targets = self.start.scene.drive(self.setup, self.settings, self._next)
        if targets is None:
            return None
        self._next += 1
        box = targets.pop(CELL, None)
        began = clock()
        done, iterations, solving = self._relaxed(targets, self._cell(box))
        seconds = clock() - began
        look = self.look(self._let_go(done))
        return replace(look, iterations=iterations, seconds=seconds, solving=solving)

    def _cell(self, target: Point | None) -> PeriodicBox | None:
        to_box = self.setup.box_target
        return None if target is None or to_box is None else to_box(target)

    def _relaxed(
        self, targets: dict[str, Point], box: PeriodicBox | None
    ) -> tuple[Increment, int, float]:
        """One increment, its force evaluations, and the time of the minimiser alone [s]."""
        engine, knobs = self.engine, self.knobs
        engine.begin(targets, box)
        relaxation = engine.relaxation
        assert relaxation is not None
        began = clock()
        if knobs.solve is None:
            while self.setup.relaxes and relaxation.run(knobs.slice).reason is StopReason.BUDGET:
                pass
            evaluations = relaxation.iterations
        else:
            evaluations = knobs.solve(relaxation, knobs.tolerance)
            relaxation.max_iterations = 1  # FIRE looks how good that is, and does nothing
        seconds = clock() - began
        done = engine.relax(1)
        assert done is not None
        return done, evaluations, seconds

    def _let_go(self, done: Increment) -> Increment:
        """Take out the grains that have left; the increment without them."""
        gone = None if self.setup.outlet is None else self.setup.outlet.gone(self.setup.packing)
        if gone is not None and gone.any():
            self.engine.remove(gone)
            pairs, bodies = self.engine.contacts()
            done = replace(done, grain_contacts=pairs, body_contacts=bodies)
        return done

    def look(self, done: Increment) -> Look:
        """What users read after that increment; its cost is left open."""
        packing, setup = self.setup.packing, self.setup
        pairs, bodies = done.grain_contacts, done.body_contacts
        report = done.report
        drive = setup.handles[0].body
        if drive == CELL or not setup.relaxes:
            measure = None if setup.curve is None else setup.curve.force
            assert measure is not None
            force = np.array([measure(packing, done), 0.0])
        else:
            force = done.reactions[setup.world.index(drive), :2].copy()
        stress = observables.stress(pairs, self.start.area, bodies, packing)
        if done.friction is not None:
            stress = stress + done.friction.stress(self.start.area, bodies=True)
        return Look(
            force=force,
            stress=stress,
            energy=elastic_energy(packing, pairs, bodies),
            state=packing.state.copy(),
            label=packing.label.copy(),
            bearing=bearing(packing, pairs, bodies) | (setup.drag > 0.0),
            residual=report.residual,
            scale=report.mean_contact_force,
            converged=report.reason is StopReason.CONVERGED,
            beyond_cone=done.beyond_cone,
        )


def walk(start: Start, knobs: Knobs, length: float) -> Walk:
    """Walk the protocol for ``length`` of the scene's own increments."""
    walker, path = Walker(start, knobs), Walk(knobs.step)
    while len(path.looks) < round(length / knobs.step):
        look = walker.increment()
        if look is None:
            break
        path.looks.append(look)
    return path


def bearing(
    packing: Packing, pairs: observables.GrainContacts, bodies: observables.RigidContacts
) -> NDArray[np.bool_]:
    """Grains with at least two contacts (N,): where a rattler is, nobody can say."""
    number = np.zeros(len(packing), dtype=np.int64)
    for grains in (pairs.i, pairs.j, bodies.grain):
        number += np.bincount(grains, minlength=len(packing))
    enough: NDArray[np.bool_] = number >= LEAST_CONTACTS
    return enough


def elastic_energy(
    packing: Packing, pairs: observables.GrainContacts, bodies: observables.RigidContacts
) -> float:
    """Energy in contacts and grains [k R²], without friction, weight and drag."""
    nu, stiffness = packing.poisson_ratio, packing.contact_stiffness
    rest = packing.rest_radius**2
    square = packing.q1**2 + packing.q2**2
    excess = packing.p**2 - square - rest
    own = 0.25 * area_modulus(nu, stiffness) / rest * excess**2
    own += shape_modulus(nu, stiffness) * square
    touching = np.sum(pairs.normal_force * pairs.overlap)
    touching += np.sum(bodies.normal_force * bodies.overlap)
    return float(np.sum(own) + 0.5 * touching)

"""Load increments: move the rigid bodies a bounded step, predict, relax, observe.

The hand waits for the physics. A body moves at most ``step`` [R]; the packing is relaxed to its tolerance, or ends with
a named reason; only then does the body move on. However far a hand has asked, it gets there in such increments, so a body
flung across the box passes through nothing. Wall time decides how often somebody looks, never how far a relaxation goes:
an increment may be cut into any number of calls and takes the same course to the last bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.arrays import Floats
from core.coincidence import part_coincident
from core.endless import endless
from core.engine_state import EngineState, keep_bodies, keep_packing, place_bodies
from core.errors import InputError
from core.friction import Friction
from core.frictional_contacts import FrictionForces
from core.packing import Packing, PeriodicBox
from core.passage import deep_grains, pass_faces
from core.prediction import carry_on
from core.relaxation import FAILED, Relaxation, Report, StopReason
from core.rigid import Point, RigidWorld
from core.settings import LONGEST_STEP
from core.system import System
from core.tries import Tries

Touching = tuple[observables.GrainContacts, observables.RigidContacts]  # who touches whom


@dataclass(frozen=True)
class Increment:
    """What one increment came to."""

    # Displacement of each body that was asked to move [R]; of an increment that FAILED, as it was tried.
    moved: dict[str, Point]
    pulled: dict[str, Point]  # and the way in which the hand pulls it, a unit vector, or 0
    stopped: dict[str, str]  # and why it stopped short: "force limit", "end of travel" or "wall"
    share: float  # of a step that the strength of the hand was enough for
    hand_force: float  # along its pull [k R]; nan where it pulled at nothing
    report: Report
    reactions: Floats  # force and torque of the grains on each body, (B, 3) [k R, k R²]
    grain_contacts: observables.GrainContacts
    body_contacts: observables.RigidContacts
    unbalanced: Floats  # (N,) size of the force that is left on each grain [k R]; 0 if it failed
    friction: FrictionForces | None = None
    beyond_cone: float = 0.0  # share of frictional contacts, see ``FrictionForces.beyond_cone``


class Quasistatic:
    """A packing among rigid bodies, driven increment by increment."""

    def __init__(self, system: System) -> None:
        """Works on ``system``, which whoever drives it may change between two increments. Raises InputError as ``look_again``."""
        self.system = system
        self._check()
        packing, world = system.packing, system.world
        self.reactions = np.zeros((len(world.bodies), 3))
        self.latest: Increment | None = None  # as it ended
        self._contacts: Touching | None = None  # between two increments, once somebody has asked
        self._relaxation: Relaxation | None = None
        self._start: Floats = packing.state.copy()
        self._start_box = packing.box
        self._placement: Floats = world.placement()
        # Grains that were moved through a face (N, M), see ``passage``.
        self._through = np.zeros((0, 0), dtype=np.bool_)
        self._last: Floats = np.zeros_like(packing.state)  # displacement in the increment before
        self._carried: Floats = packing.state[:2].copy()  # centres, moved with the periodic cell
        self._own_motion: Floats = np.zeros_like(self._carried)
        self._last_moved: dict[str, Point] = {}
        self._tries = Tries(system, {})

    @property
    def packing(self) -> Packing:
        """The grains."""
        return self.system.packing

    @property
    def world(self) -> RigidWorld:
        """The bodies."""
        return self.system.world

    @property
    def friction(self) -> Friction | None:
        """What contacts remember, if there is friction."""
        return self.system.friction

    @property
    def busy(self) -> bool:
        """True while an increment is begun and not finished."""
        return self._relaxation is not None

    def save(self, before: EngineState | None = None) -> EngineState:
        """The state between two increments; material that is the same as in ``before`` is shared with it."""
        if self._relaxation is not None:
            raise RuntimeError("the increment is not finished")
        return EngineState(
            packing=keep_packing(self.packing, None if before is None else before.packing),
            bodies=keep_bodies(self.world),
            reactions=self.reactions.copy(),
            last=self._last.copy(),
            own_motion=self._own_motion.copy(),
            last_moved=dict(self._last_moved),
            friction=None if self.friction is None else self.friction.copy(),
            solver=self.system.solver,
            gravity=self.system.gravity,
            drag=self.system.drag,
        )

    def restore(self, state: EngineState) -> None:
        """Be as when ``state`` was saved: what follows is the same to the last bit."""
        system = self.system
        system.packing = state.packing.copy()
        place_bodies(system.world, state.bodies)
        self.reactions = state.reactions.copy()
        self._last, self._own_motion = state.last.copy(), state.own_motion.copy()
        self._last_moved = dict(state.last_moved)
        system.friction = None if state.friction is None else state.friction.copy()
        system.solver, system.gravity, system.drag = state.solver, state.gravity, state.drag
        self._relaxation = self._contacts = None

    def look_again(self) -> None:
        """What the system has, or what its packing is made of, was changed. Raises InputError for what cannot go on so."""
        if self._relaxation is not None:
            raise RuntimeError("nothing can be changed in the middle of an increment")
        self._check()
        self._contacts = None

    def _check(self) -> None:
        _check_step(self.system.solver.step, self.packing)
        _check_gravity(self.system.gravity, self.packing)

    def begin(self, targets: dict[str, Point], box: PeriodicBox | None = None) -> None:
        """Move each named body one step towards its target and start to relax. With no targets: relax where things stand.

        ``box`` is a target too: the periodic box goes there by steps of its sides, and the grains with it, affinely.
        Raises InputError, and nothing has moved, for what cannot be: a box too small for its grains, a body that stands fast.
        """
        if self._relaxation is not None:
            raise RuntimeError("the increment before is not finished")
        self._tries = Tries(self.system, targets, box)
        self._placement = self.world.placement()
        state, cell = self.packing.state.copy(), self.packing.box
        try:
            self._begin()
        except InputError:
            self.packing.state[:], self.packing.box = state, cell
            self.world.place(self._placement)
            self._contacts = None
            raise

    def _begin(self) -> None:
        if self.system.relaxes and part_coincident(self.packing, self.contacts()[0]):
            self._contacts = None
        touched = self.contacts()[1]
        rows_then, owner = self.world.primitives()
        rows_then = endless(rows_then, self.packing.box)
        self._tries.move_bodies(self.reactions)
        origin = None
        if self.friction is not None:
            ways = self._placement, self.world.placement()
            origin = self.friction.begin(self.packing, rows_then, owner, *ways)
        # Neither writes into it.
        self._start = self.packing.state.copy() if origin is None else origin.state
        self._start_box = self.packing.box
        if self.system.follow is not None:
            self.system.follow(self.packing, self.world)
        self._squeeze(self._tries.cell(self._start_box))
        self._carried = self.packing.state[:2].copy()
        if self.system.relaxes and self.system.drag == 0.0:
            self._predict()
        primitives, _ = self.world.primitives()
        if self.system.relaxes:
            rows_now = endless(primitives, self.packing.box)
            places = self._start, self.packing.state, rows_then, rows_now
            self._through = np.zeros((len(self.packing), len(primitives)), dtype=np.bool_)
            which = touched.grain, touched.primitive, touched.image_x, touched.image_y
            if len(primitives):
                pass_faces(*which, *places, self._through)
        solver = self.system.solver
        largest = float(self.packing.rest_radius.max()) if len(self.packing) else 1.0
        self._relaxation = Relaxation(
            self.packing,
            primitives,
            origin,
            self.system.gravity,
            self.system.drag,
            tolerance=solver.tolerance,
            force_floor=solver.force_floor * largest,
            skin=solver.skin,
            max_iterations=solver.max_iterations,
            threads=solver.threads,
        )

    def relax(self, max_iterations: int) -> Increment | None:
        """Go on relaxing for at most ``max_iterations`` force evaluations. The finished increment, or None: call again."""
        relaxation = self._relaxation
        if relaxation is None:
            raise RuntimeError("no increment is begun")
        report = relaxation.run(max_iterations if self.system.relaxes else 1)
        if not self.system.relaxes and report.reason in (
            StopReason.BUDGET,
            StopReason.ITERATION_LIMIT,
        ):
            report = replace(report, reason=StopReason.CONVERGED, residual=0.0)
        if report.reason is StopReason.BUDGET:
            return None
        unbalanced = np.zeros(len(self.packing))
        held = None if self.friction is None else (*relaxation.slips(), relaxation.turned())
        good = report.reason not in FAILED
        relaxed = good and self.system.relaxes
        if relaxed:
            relaxation.write_back()
            unbalanced = np.hypot(*relaxation.forces()[:2])
            self._through ^= relaxation.gone_through()
        self._relaxation = relaxation = None  # its arrays make room for those of the contacts
        contacts = self._touching() if good else self.contacts()
        if relaxed and (self._through.any() or self._sunk(contacts[1])):
            report, good = replace(report, reason=StopReason.SUNK), False
        remembered = self._remembered()
        forces = None
        if good and self.friction is not None and held is not None:
            keys, slips, forces, turned = held
            self.friction.end(keys, slips, turned)
        reactions = self._measure(contacts[1], forces) if good else self.reactions
        spent = self._tries.spent + report.iterations
        if self._tries.limited:
            force = self._hand_force(contacts[0], reactions) if good else math.inf
            if self._tries_again(force):
                self._tries.spent = spent
                self._take_back()
                self.system.friction = remembered
                self._begin()
                return None
            if good and self._creeps(force):
                # At rest the force is right to the tolerance only, and friction creeps: what was within the strength stays.
                self._take_back()
                self.system.friction = remembered
                return self._stand_still(spent)
            report = replace(report, iterations=spent)
        if not good:
            # Back to the last good state, bodies too: what is shown and saved is always finite and whole. Energy and residual in
            # the report are those of what was tried.
            self._take_back()
            contacts = self.contacts()
            unbalanced[:] = 0.0
            if self.friction is None:  # else they are as they were, with what friction had in them
                reactions = self._measure(contacts[1], None)
        self._last = self.packing.state - self._start
        self._own_motion = self.packing.state[:2] - self._carried if good else 0.0 * self._carried
        self._last_moved = self._tries.moved
        self._contacts, self.reactions = contacts, reactions
        beyond = 0.0
        if forces is not None and self.friction is not None:
            beyond = forces.beyond_cone(self.friction.coefficient, len(self.packing), *contacts)
        return self._observe(report, unbalanced, forces, beyond)

    def _sunk(self, bodies: observables.RigidContacts) -> bool:
        """True if grains have come deep into a body that were not when the increment began."""
        step = self.system.solver.step
        deep = deep_grains(self.packing.state, bodies.grain, bodies.overlap, step)
        if not deep.any():
            return False
        # As they stood before anything moved: a prediction that flattens a grain would make it look deep already.
        before = self.contacts()[1]
        return bool(np.any(deep & ~deep_grains(self._start, before.grain, before.overlap, step)))

    def _remembered(self) -> Friction | None:
        """What frictional contacts remember, where the increment may have to be done again."""
        return None if self.friction is None or not self._tries.limited else self.friction.copy()

    def _tries_again(self, force: float) -> bool:
        """After a try that took that force [k R], inf if it led to nothing: has the hand overpowered itself? Then a shorter way
        is set.
        """
        before = self._hand_force(self.contacts()[0], self.reactions)
        return self._tries.again(force, before, squeezed=self.packing.box != self._start_box)

    def _creeps(self, force: float) -> bool:
        """True if nothing was moved, and the force [k R] has come above the strength of the hand all the same."""
        # With drag grains go on where no body moves.
        still = self._tries.share == 0.0 and self.system.drag == 0.0
        return still and self._tries.too_much(force)

    def _stand_still(self, spent: int) -> Increment:
        """An increment in which nothing has changed, after ``spent`` force evaluations: one more tells how well it is relaxed."""
        tries, self._tries = self._tries, Tries(self.system, {})
        self._begin()
        assert self._relaxation is not None
        report = self._relaxation.run(1)
        unbalanced = np.hypot(*self._relaxation.forces()[:2])
        self._relaxation = None
        self._take_back()  # a prediction, too
        self._tries = tries
        if report.reason is StopReason.BUDGET:
            report = replace(report, reason=StopReason.ITERATION_LIMIT)
        self._last = np.zeros_like(self.packing.state)
        self._own_motion = np.zeros_like(self.packing.state[:2])
        self._last_moved = tries.moved
        return self._observe(replace(report, iterations=spent + report.iterations), unbalanced)

    def _hand_force(self, pairs: observables.GrainContacts, reactions: Floats) -> float:
        return self._tries.hand_force(pairs, reactions, self._start_box)

    def _take_back(self) -> None:
        """Grains, cell and bodies as they were before the increment."""
        self.packing.state[:] = self._start
        self.packing.box = self._start_box
        self.world.place(self._placement)

    def contacts(self) -> Touching:
        """All contacts as things stand now."""
        if self._relaxation is not None:
            return self._touching()
        if self._contacts is None:
            self._contacts = self._touching()
        return self._contacts

    def _touching(self) -> Touching:
        return observables.grain_contacts(self.packing), observables.body_contacts(
            self.packing, self.world.primitives()[0]
        )

    def progress(self) -> Report | None:
        """How the increment under way stands, or None."""
        return None if self._relaxation is None else self._relaxation.report()

    @property
    def relaxation(self) -> Relaxation | None:
        """The relaxation under way, or None: for studies, that solve it by other means as well."""
        return self._relaxation

    def farthest_move(self) -> float:
        """How far any grain has moved in the latest increment [R]."""
        return float(np.hypot(*self._last[:2]).max(initial=0.0))

    def own_motion(self) -> Floats:
        """Displacements in the latest increment beyond those of the periodic cell (2, N) [R]: of x and y."""
        return self._own_motion.copy()

    def remove(self, gone: NDArray[np.bool_]) -> None:
        """Take the grains marked in ``gone`` (N,) out of the packing."""
        if self._relaxation is not None:
            raise RuntimeError("grains cannot leave in the middle of an increment")
        self.system.packing = self.packing.select(~gone)
        self._last = np.ascontiguousarray(self._last[:, ~gone])
        self._own_motion = np.ascontiguousarray(self._own_motion[:, ~gone])
        self._contacts = None
        if self.friction is not None:
            self.friction.select(~gone)

    def take_over(self, packing: Packing) -> None:
        """Go on with other grains, or after bodies have come or gone; ``friction`` knows of both already."""
        if self._relaxation is not None:
            raise RuntimeError("grains and bodies cannot change in the middle of an increment")
        self.system.packing = packing
        self._placement = self.world.placement()
        self._last = np.zeros_like(packing.state)
        self._own_motion = np.zeros_like(packing.state[:2])
        self._last_moved = {}
        self._contacts = None
        self.reactions = self._measure(self.contacts()[1], None)

    def _squeeze(self, new: PeriodicBox | None) -> None:
        """Change the periodic box to ``new``, and the grains' places with it: all images of a grain go to those of one place."""
        old = self.packing.box
        if new is None or old is None or new == old:
            return
        wider = new.width / old.width if np.isfinite(old.width) else 1.0
        share = self.packing.state[1] / old.height  # 0 if open in y
        self.packing.state[0] = (
            self.packing.state[0] - share * old.shift
        ) * wider + share * new.shift
        if np.isfinite(old.height):
            self.packing.state[1] = share * new.height
        self.packing.box = new

    def _predict(self) -> None:
        """Start from the displacement of the increment before, as far as the bodies go on as they went.

        Saves 4 to 10 % of the work.
        """
        before = sum(dx * dx + dy * dy for dx, dy in self._last_moved.values())
        now = sum(dx * dx + dy * dy for dx, dy in self._tries.moved.values())
        along = sum(
            dx * self._last_moved[name][0] + dy * self._last_moved[name][1]
            for name, (dx, dy) in self._tries.moved.items()
            if name in self._last_moved
        )
        if along <= 0.0:
            return
        pairs, bodies = self.contacts()
        held = np.zeros(len(self.packing))
        for grains in (pairs.i, pairs.j, bodies.grain):
            held[grains] = 1.0
        carry_on(self.packing.state, self._last, held, min(along / before, 1.0), math.sqrt(now))

    def _measure(
        self, bodies: observables.RigidContacts, friction: FrictionForces | None
    ) -> Floats:
        """Force and torque of the grains on each body, (B, 3) [k R, k R²]."""
        _, owner = self.world.primitives()
        placement = self.world.placement()
        reactions = observables.reactions(bodies, owner, placement)
        return reactions if friction is None else reactions + friction.reactions(owner, placement)

    def _observe(
        self,
        report: Report,
        unbalanced: Floats,
        friction: FrictionForces | None = None,
        beyond_cone: float = 0.0,
    ) -> Increment:
        """The increment that has ended so, with contacts and reactions as they are now."""
        pairs, bodies = self.contacts()
        self.latest = Increment(
            moved=self._tries.moved,
            pulled=self._tries.pulled,
            stopped=self._tries.stopped,
            share=self._tries.share,
            hand_force=self._hand_force(pairs, self.reactions),
            report=report,
            reactions=self.reactions,
            grain_contacts=pairs,
            body_contacts=bodies,
            unbalanced=unbalanced,
            friction=friction,
            beyond_cone=beyond_cone,
        )
        return self.latest


def _check_gravity(gravity: Point | None, packing: Packing) -> None:
    """Raises InputError if a grain's weight alone presses it into the floor by its radius; ``gravity`` in k/R."""
    if gravity is None or not len(packing):
        return
    most = float(np.min(packing.contact_stiffness / packing.rest_radius))
    if not math.hypot(*gravity) < most:
        raise InputError(f"gravity must be less than {most:.3g} k/R for these grains")


def _check_step(step: float, packing: Packing) -> None:
    """Raises InputError if a body could get past a grain in one increment [R]."""
    smallest = float(packing.rest_radius.min()) if len(packing) else 1.0
    if step > LONGEST_STEP * smallest * (1.0 + 1e-9):
        raise InputError(
            f"the increment must be at most {LONGEST_STEP} of the smallest radius, here {LONGEST_STEP * smallest:.3g} R"
        )

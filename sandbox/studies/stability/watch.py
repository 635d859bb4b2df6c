"""What must hold after every increment, whatever is asked of the program: watched while a hard case is driven.

Bounds come from the residual that the solver itself reports, not from what a case is hoped to reach: with largest generalised
force f on any grain, N grains cannot be out of balance by more than N f, nor the stress tensor out of symmetry by more than what
those forces can turn.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from core import observables
from core.elasticity import GUARD_AREA
from core.errors import InputError
from core.generate import inside
from core.packing import Packing, PeriodicBox
from core.quasistatic import Increment, Quasistatic
from core.relaxation import FAILED, StopReason
from core.rigid import Point, RigidBody, RigidWorld
from sandbox.ensemble.pool import Stopped
from sandbox.session.session import Session

SLICE = 400  # force evaluations between two looks at the clock
ROUNDING = 1e-9  # of the sum of the magnitudes of what is added up


class TimeLimit(Exception):
    """A case took more time of a core than it may."""


@dataclass(frozen=True)
class Look:
    """Something measured, and the most that it may be."""

    name: str
    value: float
    allowed: float

    @property
    def holds(self) -> bool:
        """False for nan, too."""
        return self.value <= self.allowed


class Watch:
    """Counts what a case costs, looks after every increment, and remembers the worst."""

    def __init__(
        self, seconds: float, quick: bool = False, stopping: Callable[[], bool] = lambda: False
    ) -> None:
        self.quick = quick
        self.increments = 0
        self.iterations = 0
        self.reasons: Counter[str] = Counter()
        self.worst: dict[str, Look] = {}
        self.broken: dict[str, str] = {}
        self.guarded = 0  # increments after which the guard of the area acted on some grain
        self.flattest = 1.0  # least b/a of any grain
        self._stopping = stopping
        self._began = time.process_time()
        self._limit = seconds

    @property
    def seconds(self) -> float:
        """Time of this core so far."""
        return time.process_time() - self._began

    def check_time(self) -> None:
        """Raises TimeLimit or Stopped."""
        if self._stopping():
            raise Stopped
        if self.seconds > self._limit:
            raise TimeLimit

    # What a case does.

    def step(
        self,
        engine: Quasistatic,
        targets: dict[str, Point] | None = None,
        box: PeriodicBox | None = None,
        outline: list[Point] | None = None,
        *,
        look: bool = True,
    ) -> Increment:
        """One increment to its end, looked at."""
        engine.begin(targets or {}, box)
        increment = None
        while increment is None:
            self.check_time()
            increment = engine.relax(SLICE)
        self._count(increment)
        if look:
            self._look(engine, increment, outline)
        return increment

    def run(self, session: Session, increments: int) -> int:
        """Advance a session until so many increments are finished or nothing is left to do; how many there were."""
        done, out = 0, session.history[-1].grains_out
        for row in islice(session.increments(SLICE, self.check_time), increments):
            done += 1
            engine, latest = session.run.engine, session.run.engine.latest
            assert latest is not None
            self._count(latest)
            setup = session.run.setup
            if setup.outlet is None:
                self._look(engine, latest, setup.outline)
            elif row.grains_out == out:
                self._look(engine, latest, None)
            out = row.grains_out
        return done

    def expect(self, name: str, value: float, allowed: float) -> None:
        """Something more that must hold in this case: a value at most ``allowed``."""
        look = Look(name, float(value), float(allowed))
        if not look.holds:
            self.broken.setdefault(name, f"{name}: {look.value:.3g}, allowed {look.allowed:.3g}")
        before = self.worst.get(name)
        if before is None or fraction_of_allowed(look) > fraction_of_allowed(before):
            self.worst[name] = look

    def expect_true(self, name: str, holds: bool) -> None:
        """Something more that must be so in this case."""
        self.expect(name, 0.0 if holds else 1.0, 0.0)

    @contextmanager
    def refuses(self, what: str) -> Iterator[None]:
        """The block must end in one clear line for the user."""
        name = f"refused with one line: {what}"
        try:
            yield
        except InputError as error:
            self.expect_true(name, bool(str(error)) and "\n" not in str(error))
        else:
            self.expect_true(name, False)

    # What is looked at.

    def _count(self, increment: Increment) -> None:
        self.increments += 1
        self.iterations += increment.report.iterations
        self.reasons[str(increment.report.reason)] += 1

    def _look(self, engine: Quasistatic, increment: Increment, outline: list[Point] | None) -> None:
        a, b = engine.packing.semi_axes
        self.guarded += bool(np.any(a * b < GUARD_AREA * engine.packing.rest_radius**2))
        self.flattest = min(self.flattest, float(np.min(b / a, initial=1.0)))
        for look in (
            *soundness(engine.packing, engine.world, outline),
            *reported(increment),
            *balance(engine, increment),
        ):
            self.expect(look.name, look.value, look.allowed)


def soundness(
    packing: Packing, world: RigidWorld, outline: list[Point] | None = None
) -> list[Look]:
    """What must hold of any state that is kept, however the increment ended."""
    a, b = packing.semi_axes
    numbers = np.concatenate([packing.state.ravel(), world.placement().ravel()])
    looks = [
        Look("numbers that are not finite", float(np.sum(~np.isfinite(numbers))), 0.0),
        Look("grains without width", float(np.sum(~((a > 0.0) & (b > 0.0)))), 0.0),
    ]
    sunk = sum(int(np.sum(_within(body, packing))) for body in world.bodies)
    looks.append(Look("grains with their centre in a body", float(sunk), 0.0))
    if outline is not None:
        outside = int(np.sum(~inside(outline, *packing.folded())))
        looks.append(Look("grains outside", float(outside), 0.0))
    return looks


def reported(increment: Increment) -> list[Look]:
    """What must hold of the report: finite, or a reason; and no energy gained at fixed bodies.

    Friction is no potential: as normal forces grow on the way, the springs at their caps may store more than they did.
    """
    report = increment.report
    if report.reason in FAILED:
        return []
    energies = abs(report.energy) + abs(report.start_energy)
    finite = np.all(np.isfinite([report.energy, report.residual, *increment.reactions.flat]))
    looks = [Look("reported as solved and not finite", float(not finite), 0.0)]
    if increment.friction is None:
        gained = report.energy - report.start_energy
        looks.append(Look("energy gained by relaxing [k R²]", gained, ROUNDING * energies))
    return looks


def balance(engine: Quasistatic, increment: Increment) -> list[Look]:
    """Newton's third law and the symmetry of the stress, to within what the reported residual leaves open."""
    report = increment.report
    if (
        report.reason is not StopReason.CONVERGED
        or engine.system.drag > 0.0
        or report.residual == 0.0
    ):
        return []
    packing, count = engine.packing, len(engine.packing)
    largest = report.residual * report.mean_contact_force
    pairs, bodies = increment.grain_contacts, increment.body_contacts
    areas = packing.rest_radius**2
    gravity = engine.system.gravity or (0.0, 0.0)
    magnitude = float(np.abs([*pairs.fx, *pairs.fy, *bodies.fx, *bodies.fy]).sum())
    magnitude += float(areas.sum()) * math.hypot(*gravity)
    allowed = count * largest * (1.0 + ROUNDING) + ROUNDING * magnitude
    # What the grains do to the bodies, they get from them; the rest of what pulls at them is their weight.
    pull = np.array(gravity) * areas.sum() - increment.reactions[:, :2].sum(axis=0)
    tensor = observables.stress(pairs, 1.0, bodies, packing)
    turn = 2.0 * math.sqrt(2.0) * float(np.hypot(packing.q1, packing.q2).sum())
    if increment.friction is not None:
        tensor = tensor + increment.friction.stress(1.0, bodies=True)
        turn += count  # the spins are only as well balanced as everything else
    lever = float(np.max(packing.semi_axes[0], initial=1.0))
    return [
        Look("forces out of balance [k R]", float(np.max(np.abs(pull))), allowed),
        Look(
            "asymmetry of the stress times area [k R²]",
            abs(float(tensor[0, 1] - tensor[1, 0])),
            turn * largest * (1.0 + ROUNDING) + ROUNDING * magnitude * lever,
        ),
    ]


def _within(body: RigidBody, packing: Packing) -> NDArray[np.bool_]:
    """True for grains (N,) whose centre lies in the body."""
    x, y = packing.state[:2]
    found = np.zeros(len(packing), dtype=bool)
    for cx, cy, radius in body.discs:
        px, py = body.to_world([(cx, cy)])[0]
        found |= np.hypot(x - px, y - py) < radius
    for x0, y0, x1, y1, radius in body.segments:
        (ax, ay), (bx, by) = body.to_world([(x0, y0), (x1, y1)])
        length = max(math.hypot(bx - ax, by - ay), 1e-300)
        ux, uy = (bx - ax) / length, (by - ay) / length
        along = np.clip((x - ax) * ux + (y - ay) * uy, 0.0, length)
        found |= np.hypot(x - ax - along * ux, y - ay - along * uy) < radius
    for corners, _ in body.polygons:
        found |= inside([(px, py) for px, py in body.to_world(corners)], x, y)
    return found


def fraction_of_allowed(look: Look) -> float:
    """How near a look is to not holding."""
    if math.isnan(look.value):
        return math.inf
    return look.value / look.allowed if look.allowed > 0.0 else look.value

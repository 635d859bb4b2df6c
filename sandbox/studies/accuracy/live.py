"""How far off the force on the handle is, increment by increment of a scripted drive: what the live estimate is fitted to.

All is at its defaults, but a testing machine drives. Some increments, spread over the whole drive, are solved a second time from
the same place, to a thousandth of the tolerance; on its way there such a solution is looked at where it passes other tolerances.
The drive then goes on from what the first one has left.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from core import observables
from core.arrays import Floats
from core.engine_state import EngineState
from core.hand import CELL
from core.quasistatic import Increment
from core.relaxation import FAILED, Relaxation, Report, StopReason
from core.rigid import Point
from core.warmup import compile_kernels
from sandbox import __version__
from sandbox.ensemble.pool import Stopped
from sandbox.studies.accuracy.walk import Knobs, Look, Start, Walker
from scenes import registry
from scenes.scene import BY_MACHINE, HAND_STRENGTH

Stopping = Callable[[], bool]

DATA_VERSION = 1  # raise it when something else is measured
FIT = (1, 2, 3, 4)  # seeds that the estimate is fitted to
JUDGE = (5, 6, 7, 8)  # and those that judge it
MEASURED = 30  # increments of a drive, about
QUICK = 6
LEVELS = (10.0, 0.1)  # times the tolerance: looked at on the way
TIGHT = 1e-3  # times the tolerance: held to be exact, and not below
TIGHTEST = 1e-10
TOLD = 0.1  # times the tolerance: what is left with more than that tells nothing
MOST_EVALUATIONS = 40_000
LOOKS = 8  # force evaluations from one look at the residual to the next


@dataclass(frozen=True)
class Drive:
    """The scripted drive of one packing of a scene, from one seed."""

    scene: str
    packing: str
    seed: int
    measured: int

    def key(self) -> str:
        """Name of its file: changes with all that it depends on, the defaults of its scene too."""
        settings = sorted(registry.get(self.scene).settings().items())
        words = [asdict(self), settings, LEVELS, TIGHT, MOST_EVALUATIONS, DATA_VERSION, __version__]
        digest = hashlib.sha256(json.dumps(words, sort_keys=True).encode()).hexdigest()[:12]
        return f"drive-{self.scene}-{self.packing}-{self.seed}-{digest}"


def drives(scene: str, quick: bool, measured: int = MEASURED) -> list[Drive]:
    """All drives of a scene; none where nothing relaxes. Quick: a few increments of two seeds."""
    seeds = (FIT[0], JUDGE[0]) if quick else (*FIT, *JUDGE)
    if scene == "two_ellipses":
        return []
    many = QUICK if quick else measured
    return [Drive(scene, kind, s, many) for kind in registry.get(scene).packings for s in seeds]


def measure(drive: Drive, stopping: Stopping = lambda: False) -> dict[str, Any]:
    """Carry a drive out. Raises Stopped."""
    return Driven(drive).report(stopping)


class Driven(Walker):
    """A drive under way."""

    def __init__(self, drive: Drive) -> None:
        scene = registry.get(drive.scene)
        known = {parameter.name for parameter in scene.parameters}
        settings = scene.settings(dict([BY_MACHINE]) if HAND_STRENGTH in known else {})
        terms = scene.ingredients(settings)
        compile_kernels(
            periodic=terms.periodic,
            rigid=terms.rigid,
            friction=terms.friction,
            gravity=terms.gravity,
        )
        setup = scene.build(settings, drive.packing, drive.seed)
        placement, solver = setup.world.placement(), setup.solver
        start = Start(scene, settings, setup, setup.packing, placement, setup.friction, 0)
        usual = Knobs(tolerance=solver.tolerance, max_iterations=solver.max_iterations)
        super().__init__(start, usual)
        self.steps = scene.steps(settings)
        self.every = max(1, self.steps // drive.measured)

    def report(self, stopping: Stopping) -> dict[str, Any]:
        """Drive to the end, or to the first increment that fails. Raises Stopped."""
        magnitudes = [_magnitude(self.rest(self.setup.solver.tolerance))]
        rows: list[dict[str, Any]] = []
        untold = unconverged = 0
        for number in range(1, self.steps + 1):
            if stopping():
                raise Stopped
            targets = self.start.scene.drive(self.setup, self.settings, number - 1)
            if targets is None:
                break
            before = self.engine.save() if number % self.every == 0 else None
            done, iterations, _ = self._relaxed(*self._asked(targets))
            if done.report.reason in FAILED:
                break
            look = self.look(done)
            magnitudes.append(_magnitude(look))
            unconverged += not look.converged
            readings: list[dict[str, float]] = []
            if before is not None:
                ended = Glance(1.0, done.report, _norm(done.unbalanced), look)
                after = self.engine.save()
                readings = self._again(before, targets, done, ended)
                self.engine.restore(after)
                untold += not readings
            self._let_go(done)
            if readings:
                row = {
                    "increment": number,
                    "force": magnitudes[-1],
                    "change": magnitudes[-1] - magnitudes[-2],
                    "mean": float(np.mean(magnitudes)),
                    "converged": look.converged,
                    "evaluations": iterations,
                    "moved": max(self.engine.farthest_move() / self.setup.solver.step, 1.0),
                    "readings": readings,
                }
                rows.append(row)
        return {
            "increments": len(magnitudes) - 1,
            "unconverged": unconverged,
            "untold": untold,
            "rows": rows,
        }

    def _asked(self, targets: Mapping[str, Point]) -> tuple[dict[str, Point], Any]:
        bodies = {name: target for name, target in targets.items() if name != CELL}
        return bodies, self._cell(targets.get(CELL))

    def _again(
        self, before: EngineState, targets: Mapping[str, Point], done: Increment, ended: Glance
    ) -> list[dict[str, float]]:
        """Solve the increment tightly that has come to ``done``; [] where that tells nothing. The engine is left there."""
        engine, setup = self.engine, self.setup
        engine.restore(before)
        usual = setup.solver
        tight = max(TIGHT * usual.tolerance, TIGHTEST)
        setup.solver = replace(usual, tolerance=tight, max_iterations=MOST_EVALUATIONS)
        engine.begin(*self._asked(targets))
        relaxation, levels, seen = engine.relaxation, list(LEVELS), [ended]
        assert relaxation is not None
        while relaxation.run(LOOKS).reason is StopReason.BUDGET:
            if levels and relaxation.report().residual <= levels[0] * usual.tolerance:
                seen.append(self._glance(levels.pop(0), relaxation, done))
        final = engine.relax(1)
        assert final is not None
        if final.report.reason in FAILED or final.report.residual > TOLD * usual.tolerance:
            return []
        exact = self.look(final)
        return [
            {
                "level": one.level,
                "residual": one.report.residual,
                "evaluations": one.report.iterations,
                "contact_force": one.report.mean_contact_force,
                "unbalanced": one.unbalanced,
                "error": float(np.hypot(*(one.look.force - exact.force))),
            }
            for one in seen
        ]

    def _glance(self, level: float, relaxation: Relaxation, done: Increment) -> Glance:
        """A look in the middle of a relaxation; ``done`` is any increment."""
        relaxation.write_back()
        pairs, bodies = self.engine.contacts()
        owner, placement = self.setup.world.primitives()[1], self.setup.world.placement()
        reactions = observables.reactions(bodies, owner, placement)
        friction = None if self.engine.friction is None else relaxation.slips()[2]
        if friction is not None:
            reactions = reactions + friction.reactions(owner, placement)
        report = relaxation.report()
        now = replace(
            done,
            report=report,
            reactions=reactions,
            grain_contacts=pairs,
            body_contacts=bodies,
            friction=friction,
        )
        unbalanced = _norm(np.hypot(*relaxation.forces()[:2]))
        return Glance(level, report, unbalanced, self.look(now))


@dataclass(frozen=True)
class Glance:
    """How things stand where a relaxation has come to a tolerance, ``level`` times the scene's own."""

    level: float
    report: Report
    unbalanced: float  # root of the sum of squares of the forces that are left on the grains [k R]
    look: Look


def _norm(unbalanced: Floats) -> float:
    return float(np.linalg.norm(unbalanced))


def _magnitude(look: Look) -> float:
    return float(np.hypot(*look.force))

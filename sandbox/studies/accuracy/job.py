"""Everything that is measured from one beginning of one scene, as plain numbers: one job of the study."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from statistics import median
from typing import Any

import numpy as np

from core import reference
from core.arrays import Floats
from core.observables import force_drops
from sandbox import __version__
from sandbox.ensemble.pool import Stopped
from sandbox.studies.accuracy.chart import paper_chart
from sandbox.studies.accuracy.contact import contact_job
from sandbox.studies.accuracy.exact import exact_increment
from sandbox.studies.accuracy.fronts import rms
from sandbox.studies.accuracy.peers import df_sane, l_bfgs_b, newton
from sandbox.studies.accuracy.protocols import FULL, QUICK, Protocol, Sweeps, protocol
from sandbox.studies.accuracy.walk import Knobs, Look, Solve, Start, Walk, Walker, begin, walk
from scenes import registry

Stopping = Callable[[], bool]

DATA_VERSION = 3  # raise it when a job measures something else
TIGHT = 1e-8  # relative residual of the walks that say where paths part
CHECKED = 1e-9  # relative residual asked of the Newton polish
COMPARED = 2  # starts from which peers, budgets and models are measured
LONG = 0.25  # [s] a walk that takes so long is not timed again: several starts do that
SLICE = 200  # force evaluations between two looks of a window
CHART: dict[str, Solve] = {"paper's chart": paper_chart}
PEERS: dict[str, Solve] = {"SciPy L-BFGS-B": l_bfgs_b, **CHART}
ROOT_FINDERS: dict[str, Solve] = {"SciPy DF-SANE": df_sane, **CHART}  # with friction
QUANTITIES = ("force", "stress", "position", "shape", "energy")
NO_TWIN = 1000  # grains beyond which the slow twin is not asked


@dataclass(frozen=True)
class Job:
    """One beginning of one scene."""

    scene: str
    seed: int
    quick: bool

    def key(self) -> str:
        """Name of its file: changes with all that it depends on, the defaults of its scene too."""
        plan, sweeps = protocol(self.scene, self.quick), QUICK if self.quick else FULL
        settings = sorted(registry.get(self.scene).settings(dict(plan.settings)).items())
        words = [asdict(self), asdict(plan), asdict(sweeps), settings, DATA_VERSION, __version__]
        digest = hashlib.sha256(json.dumps(words, sort_keys=True).encode()).hexdigest()[:12]
        return f"{self.scene}-{self.seed}-{digest}"


def measure(job: Job, stopping: Stopping = lambda: False) -> dict[str, Any]:
    """Carry a job out. Raises InputError for a scene that there is not, or Stopped."""
    plan, sweeps = protocol(job.scene, job.quick), QUICK if job.quick else FULL
    scene = registry.get(job.scene)
    if job.scene == "two_ellipses":
        return contact_job(scene, plan.length)
    packing = "mixed" if "mixed" in scene.packings else scene.packings[0]
    start = begin(job.scene, packing, job.seed, dict(plan.settings), plan.lead, plan.least_force)
    return Bench(start, plan, sweeps, stopping).report(job.seed)


class Bench:
    """A start, its reference, and the walks that are held against it."""

    def __init__(
        self, start: Start, plan: Protocol, sweeps: Sweeps, stopping: Stopping = lambda: False
    ) -> None:
        self.start, self.plan, self.sweeps, self.stopping = start, plan, sweeps, stopping
        self.reference = self.walk(
            Knobs(tolerance=sweeps.reference_tolerance, step=sweeps.reference_step)
        )
        looks = self.reference.looks
        self.scales = {
            "force": float(np.mean([np.hypot(*look.force) for look in looks])),
            "stress": float(np.mean([np.linalg.norm(look.stress) for look in looks])),
            "position": 1.0,
            "shape": 1.0,
            "energy": float(np.mean([look.energy for look in looks])),
        }
        self.tightest = {
            step: self.walk(Knobs(tolerance=TIGHT, step=step))
            for step in (1.0, *sweeps.steps, sweeps.reference_step, 2.0 * sweeps.reference_step)
        }

    def walk(self, knobs: Knobs, length: float | None = None) -> Walk:
        """A walk of the protocol. Raises Stopped."""
        if self.stopping():
            raise Stopped
        return walk(self.start, knobs, self.plan.length if length is None else length)

    def report(self, seed: int) -> dict[str, Any]:
        """All that this start has to say; checks of the reference from the first alone, peers and models from two."""
        plan, setup = self.plan, self.start.setup
        result: dict[str, Any] = {
            "grains": len(self.start.packing),
            "length": plan.length,
            "step": setup.solver.step,
            "tolerance": setup.solver.tolerance,
            "friction": self.start.friction is not None,
            "memory": self.start.friction is not None or setup.drag > 0.0,
            "scales": self.scales,
            "reference": self._described(),
            "tight": list(self._tight()),
            "walks": list(self._grid()),
            "beyond": [self._beyond(t) for t in self.sweeps.beyond_tolerances if plan.beyond],
            "sliced": self._sliced(),
        }
        if seed <= COMPARED:
            # Friction is a field of forces and no gradient: what goes by an energy does not apply.
            potential = self.start.friction is None
            peers = PEERS if potential else ROOT_FINDERS
            for solve in peers.values():
                self.walk(Knobs(tolerance=0.1, solve=solve), 1)  # compiles
            result["budgets"] = [self._timed(knobs) for knobs in self._budgets()]
            result["peers"] = {
                name: [
                    self._timed(Knobs(tolerance=tolerance, solve=solve), 1)
                    for tolerance in self.sweeps.peer_tolerances
                ]
                for name, solve in peers.items()
            }
            result["stiffness"] = [self._stiffness(c) for c in self.sweeps.stiffness]
            result["overlap"] = self._overlap() if potential else None
        if seed == 1:
            result["check"] = self._check() if self.start.friction is None else None
        return result

    def errors(self, look: Look, exact: Look) -> dict[str, float]:
        """How far one look is from another: what users read, relative; positions and shapes [R]."""
        force = float(np.hypot(*(look.force - exact.force)))
        stress = float(np.linalg.norm(look.stress - exact.stress))
        position, shape = distances(look, exact)
        raw = force, stress, position, shape, abs(look.energy - exact.energy)
        scales = self.scales.values()
        return {
            name: float(value / scale) if scale > 0.0 else (0.0 if value == 0.0 else np.nan)
            for name, value, scale in zip(QUANTITIES, raw, scales, strict=True)
        }

    def _places(self, step: float) -> Floats:
        """Where a walk with that increment can be held against the reference."""
        places: Floats = step * np.arange(1, round(self.plan.length / step) + 1, dtype=np.float64)
        return places

    def _compared(self, path: Walk, exact: Walk) -> list[dict[str, float]]:
        """Errors against another walk wherever both have ended an increment."""
        found = []
        for place in self._places(path.step):
            look, other = path.at(place), exact.at(place)
            if look is not None and other is not None:
                found.append({"place": float(place), **self.errors(look, other)})
        return found

    def _tight(self) -> Iterator[dict[str, Any]]:
        """How far tight walks are from the reference at each place [R]: of another tolerance, of other increments.

        Friction and drag give the path a memory, and errors in proportion to the increment: there the coarser ones do not count.
        """
        fine = 2.0 * self.sweeps.reference_step
        memory = self.start.friction is not None or self.start.setup.drag > 0.0
        for step, path in self.tightest.items():
            if step <= (fine if memory else 1.0):
                rows = self._compared(path, self.reference)
                yield {"step": step, "apart": [(row["place"], row["position"]) for row in rows]}

    def _timed(self, knobs: Knobs, timings: int | None = None) -> dict[str, Any]:
        """A walk several times over: its cost by the middle one; its errors.

        ``errors`` are those against the reference, ``own`` those against the tightest walk with the same increments: what the
        relaxation alone is to blame for.
        """
        path = self.walk(knobs)
        again = (timings or self.sweeps.timings) - 1 if path.seconds < LONG else 0
        paths = [path, *(self.walk(knobs) for _ in range(again))]
        looks = path.looks
        return {
            "tolerance": knobs.tolerance,
            "step": knobs.step,
            "budget": knobs.max_iterations,
            "increments": len(looks),
            "seconds": median(path.seconds for path in paths),
            "solving": median(path.solving for path in paths),
            "iterations": float(np.mean([look.iterations for look in looks])),
            "residual": float(np.median([look.residual for look in looks])),
            "converged": float(np.mean([look.converged for look in looks])),
            "beyond_cone": float(np.mean([look.beyond_cone for look in looks])),
            "errors": self._compared(path, self.reference),
            "own": self._compared(path, self.tightest[knobs.step]),
        }

    def _grid(self) -> Iterator[dict[str, Any]]:
        sweeps = self.sweeps
        plan = [(t, 1.0) for t in sweeps.tolerances]
        plan += [(t, step) for step in sweeps.steps for t in sweeps.step_tolerances]
        for tolerance, step in plan:
            yield self._timed(Knobs(tolerance=tolerance, step=step))

    def _budgets(self) -> Iterator[Knobs]:
        for budget in self.sweeps.budgets:
            yield Knobs(tolerance=1e-13, max_iterations=budget)

    def _stiffness(self, stiffness: float) -> dict[str, Any]:
        """Force at every place with contacts of that stiffness; and what a walk costs at the scene's own tolerance."""
        tight = self.walk(Knobs(tolerance=TIGHT, contact_stiffness=stiffness))
        usual = Knobs(tolerance=self.start.setup.solver.tolerance, contact_stiffness=stiffness)
        looks = tight.looks
        timed = self._timed(usual)
        return {
            "stiffness": stiffness,
            "force": [float(np.hypot(*look.force)) for look in looks],
            "pressure": [0.5 * float(np.trace(look.stress)) for look in looks],
            "solving": timed["solving"],
            "converged": float(np.mean([look.converged for look in tight.looks])),
        }

    def _overlap(self) -> dict[str, Any]:
        """Where things stand at the start, with the contact law and with exact contacts."""
        law = Walker(self.start, Knobs())
        usual = law.rest()
        exact = exact_increment(Walker(self.start, Knobs()))
        return {
            **self.errors(usual, exact),
            "residual": exact.residual,
            "aspect": float(np.mean(_aspects(usual.state))),
        }

    def _beyond(self, tolerance: float) -> dict[str, float]:
        """A long walk as one draw of a distribution."""
        path = self.walk(Knobs(tolerance=tolerance, max_iterations=20_000), self.plan.beyond)
        force = np.array([np.hypot(*look.force) for look in path.looks])
        drops = force_drops(force)
        return {
            "tolerance": tolerance,
            "force": float(force.mean()),
            "drop": float(drops.mean()) if len(drops) else 0.0,
            "solving": path.solving,
        }

    def _sliced(self) -> bool:
        """Whether an increment cut into slices, as a window does, comes out the same to the last bit."""
        at_once = self.walk(Knobs(tolerance=1e-4), 1).looks
        sliced = self.walk(Knobs(tolerance=1e-4, slice=SLICE), 1).looks
        return all(np.array_equal(a.state, b.state) for a, b in zip(at_once, sliced, strict=True))

    def _described(self) -> dict[str, Any]:
        """The reference, and how far one of twice its increments is off: its own error where that is in proportion to them."""
        path = self.reference
        coarser = self._compared(self.tightest[2.0 * path.step], path)
        off = [error["force"] for error in coarser]
        return {
            "increment_error": rms(off),
            "tolerance": self.sweeps.reference_tolerance,
            "step": path.step,
            "residual": float(np.max([look.residual for look in path.looks])),
            "converged": float(np.mean([look.converged for look in path.looks])),
            "seconds": path.seconds,
        }

    def _check(self) -> dict[str, float | None]:
        """The first increment of the reference by L-BFGS-B and Newton; and the slow twin's forces at the start."""
        knobs = Knobs(tolerance=CHECKED, step=self.reference.step, solve=newton)
        look = self.walk(knobs, self.reference.step).looks[0]
        found = self.errors(look, self.reference.looks[0])
        twin = None
        setup, packing = self.start.setup, self.start.packing
        if self.start.friction is None and setup.drag == 0.0 and len(packing) <= NO_TWIN:
            setup.world.place(self.start.placement)
            _, forces = reference.energy_and_forces(packing, setup.world.primitives()[0])
            smooth = reference.to_smooth_chart(packing, forces)
            twin = float(np.abs(smooth).max() / self.reference.looks[0].scale)
        return {**found, "residual": look.residual, "twin_residual": twin}


def distances(look: Look, other: Look) -> tuple[float, float]:
    """(positions of the grains that bear force in ``other``, shapes of all): roots of the mean squares over common grains [R]."""
    if np.array_equal(look.label, other.label):
        difference, mask = look.state - other.state, other.bearing
    else:
        _, mine, its = np.intersect1d(look.label, other.label, return_indices=True)
        difference, mask = look.state[:, mine] - other.state[:, its], other.bearing[its]
    if not difference.shape[1]:
        return 0.0, 0.0
    apart = np.hypot(difference[0], difference[1])[mask]
    return rms(apart) if len(apart) else 0.0, rms(np.linalg.norm(difference[2:], axis=0))


def _aspects(state: Floats) -> Floats:
    stretch = np.hypot(state[3], state[4])
    aspects: Floats = (state[2] + stretch) / (state[2] - stretch)
    return aspects

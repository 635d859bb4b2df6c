"""From a packing to a relaxation and back: allocates what the minimiser needs, runs it in slices, names why it stopped."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from core import fire, rigid_contacts
from core.endless import endless
from core.errors import InputError
from core.frictional_contacts import FrictionForces, Origin, before_lists, ended
from core.minimizer import cross, limits_for, minimizer_for, new_lists
from core.packing import Packing
from core.slip import FrictionTerms
from core.sweeps import collapsed
from core.threads import running, share

DEFAULT_TOLERANCE = 1e-2
DEFAULT_FORCE_FLOOR = 1e-3
DEFAULT_SKIN = 0.3


class StopReason(StrEnum):
    """Why a relaxation ended."""

    CONVERGED = "converged"
    BUDGET = "budget"  # of this call; the next call goes on
    ITERATION_LIMIT = "iteration limit"
    NOT_FINITE = "not finite"
    COLLAPSED = "collapsed"
    SUNK = "sunk"  # the bodies have pressed a grain into one of them, up to its centre


# An increment that ended so is taken back.
FAILED = frozenset({StopReason.NOT_FINITE, StopReason.COLLAPSED, StopReason.SUNK})

_REASONS = {
    fire.CONVERGED: StopReason.CONVERGED,
    fire.BUDGET: StopReason.BUDGET,
    fire.NOT_FINITE: StopReason.NOT_FINITE,
    fire.COLLAPSED: StopReason.COLLAPSED,
}


@dataclass(frozen=True)
class Report:
    """How a relaxation stands: energy [k R²], residual (max |force| over the mean contact force), force evaluations so far.

    ``mean_contact_force`` [k R] is what the residual is relative to: of the latest look at it, and the force floor at least.
    """

    reason: StopReason
    energy: float
    start_energy: float
    residual: float
    mean_contact_force: float
    iterations: int


class Relaxation:
    """One relaxation of ``packing`` with rigid bodies at rest. Call ``run`` until it no longer answers BUDGET.

    ``packing`` changes only when ``write_back`` is called. ``primitives`` is (M, 8), see ``rigid_contacts``, or None;
    ``gravity`` [k/R] times R0² is the weight of a grain. ``drag`` [k/R²] times R0² times the way from where a grain was
    at the start holds it back: it makes the relaxation one step of overdamped motion (implicit Euler), in which a grain that
    nothing holds falls by gravity/drag and no further. Where grains are at rest there is no drag.
    """

    def __init__(
        self,
        packing: Packing,
        primitives: NDArray[np.float64] | None = None,
        friction: Origin | None = None,
        gravity: tuple[float, float] | None = None,
        drag: float = 0.0,
        *,
        tolerance: float = DEFAULT_TOLERANCE,
        force_floor: float = DEFAULT_FORCE_FLOOR,
        skin: float = DEFAULT_SKIN,
        max_iterations: int = 20_000,
        threads: int = 1,
    ) -> None:
        """Raises InputError if the tolerance is not positive or the periodic box is too small for its grains.

        Results do not depend on ``threads`` by a bit; more than one pays from some thousand grains on.
        """
        if not tolerance > 0.0 or not force_floor > 0.0:
            raise InputError("the tolerance and the force floor must be greater than 0")
        self.packing = packing
        self.max_iterations = max_iterations
        self.iterations = 0
        count = len(packing)
        self._box = None if packing.box is None else packing.box.kernel_form()
        _check_box(packing, skin)
        given = np.zeros((0, 8)) if primitives is None else primitives
        rows = np.ascontiguousarray(endless(given, packing.box))
        self._rigid = None
        if len(rows):
            self._rigid = rigid_contacts.allocate(rows, max(count, 1))
        self._origin = friction
        self._contacts = None if friction is None else before_lists(friction, rows)
        self._weight = _weight(packing, gravity, drag)
        self._listed = False  # have there been lists yet?
        # Which grains have gone through which edges, turned over each time.
        self._crossed = np.zeros((count, len(rows)), dtype=np.bool_)
        self.threads = threads
        self._shared = share(threads, count)
        spins = friction is not None
        grains = packing.rest_radius, packing.contact_stiffness
        self._limits = limits_for(*grains, spins, float(tolerance), float(force_floor), skin)
        self._minimizer = minimizer_for(
            packing.state,
            packing.rest_radius,
            packing.poisson_ratio,
            packing.contact_stiffness,
            spins,
            self._limits.dt_max,
        )
        control = self._minimizer.control
        if not count:
            control["start_energy"] = 0.0
        self._reason = StopReason.BUDGET if count else StopReason.CONVERGED
        if not np.all(np.isfinite(packing.state)):
            # The neighbour search would lose such a grain without a word.
            control["energy"] = control["residual"] = np.nan
            self._reason = StopReason.NOT_FINITE

    def run(self, max_iterations: int) -> Report:
        """Go on for at most ``max_iterations`` force evaluations; the GIL is free meanwhile."""
        with running(self.threads):
            self._run(max_iterations)
        return self.report()

    def _run(self, max_iterations: int) -> None:
        left = min(max_iterations, self.max_iterations - self.iterations)
        while self._reason is StopReason.BUDGET and left > 0:
            if not self._listed:
                self._relist()
            code, used = self._evaluate(left)
            self.iterations += used
            left -= used
            if code == fire.LISTS_STALE:
                self._relist()
            else:
                self._reason = _REASONS[code]
        if self._reason is StopReason.BUDGET and self.iterations >= self.max_iterations:
            flat = collapsed(self._minimizer.state)
            self._reason = StopReason.COLLAPSED if flat else StopReason.ITERATION_LIMIT

    def compile(self) -> None:
        """Compile, or load from where it is kept, the largest of the kernels, before the first lists are made."""
        self._evaluate(0)

    def _evaluate(self, times: int) -> tuple[int, int]:
        code, used = fire.run(
            self._minimizer,
            self._box,
            self._rigid,
            self.friction_terms,
            self._weight,
            self._limits,
            times,
            self._shared,
        )
        return int(code), int(used)

    def report(self) -> Report:
        """How it stands now."""
        control = self._minimizer.control[0]
        return Report(
            reason=self._reason,
            energy=float(control["energy"]),
            start_energy=float(control["start_energy"]),
            residual=float(control["residual"]),
            mean_contact_force=float(control["scale"]),
            iterations=self.iterations,
        )

    def gone_through(self) -> NDArray[np.bool_]:
        """Which grains have gone through which edges (N, M) since the bodies came to rest."""
        crossed = self._crossed.copy()
        self._cross(crossed)
        return crossed

    def _cross(self, crossed: NDArray[np.bool_]) -> None:
        if self._rigid is not None and self._listed:
            cross(self._minimizer, self._rigid, self._box, crossed)

    def write_back(self) -> None:
        """Put the relaxed state into the packing, in the packing's own order."""
        self.packing.state[:, self._minimizer.identity] = self._minimizer.state[:5]

    def turned(self) -> NDArray[np.float64]:
        """How far each grain has turned (N,) [rad], in the packing's own order. Only with friction."""
        turned = np.empty(len(self.packing))
        turned[self._minimizer.identity] = self._minimizer.state[5]
        return turned

    @property
    def friction_terms(self) -> FrictionTerms | None:
        """What the kernels know of the frictional contacts of the lists as they are; None without friction."""
        return None if self._contacts is None else self._contacts.terms

    def slips(self) -> tuple[NDArray[np.int64], NDArray[np.float64], FrictionForces]:
        """What frictional contacts remember, keys and slips [R], and their forces. Only with friction."""
        assert self._contacts is not None
        keys, slips, pulls = ended(self._minimizer, self._contacts, self._box)
        return keys, slips, FrictionForces.of(pulls)

    def forces(self) -> NDArray[np.float64]:
        """Generalised forces (5, N), with friction (6, N), of the latest evaluation [k R], in the packing's own order."""
        forces = np.empty_like(self._minimizer.force)
        forces[:, self._minimizer.identity] = self._minimizer.force
        return forces

    def _relist(self) -> None:
        # At new lists, as no grain has then come far since the last: later nobody can tell a way through from one around.
        self._cross(self._crossed)
        self._listed = True
        self._minimizer, self._rigid, self._contacts = new_lists(
            self._minimizer,
            self._rigid,
            self._origin,
            self._contacts,
            self._box,
            self._limits.skin,
        )


def _check_box(packing: Packing, skin: float) -> None:
    """Raises InputError where a grain could meet two images of another."""
    if packing.box is None or not len(packing):
        return
    reach = 2.0 * float(packing.semi_axes[0].max()) + skin * float(packing.rest_radius.max())
    if min(packing.box.width, packing.box.height) < 2.0 * reach:
        raise InputError(
            f"the periodic box is too small: each side must be at least {2.0 * reach:.3g} R for these grains"
        )


def _weight(
    packing: Packing, gravity: tuple[float, float] | None, drag: float
) -> fire.Weight | None:
    """None where nothing pulls. Raises InputError for a drag that drives."""
    if not drag >= 0.0:
        raise InputError("the drag must be 0 or more")
    if gravity is None and drag == 0.0:
        return None
    x, y = (0.0, 0.0) if gravity is None else gravity
    return fire.Weight(float(x), float(y), float(drag), packing.state[:2].copy())

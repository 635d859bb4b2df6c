"""From a packing to a relaxation and back: allocates what the minimiser needs, runs it in slices, names why it stopped."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from core import fire, neighbors, rigid_contacts
from core.endless import endless
from core.errors import InputError
from core.friction import SPIN_MASS
from core.frictional_contacts import FrictionalContacts, FrictionForces, Origin
from core.material import area_modulus, deformation_stiffness, shape_modulus
from core.packing import Packing
from core.slip import TANGENTIAL_STIFFNESS, FrictionTerms
from core.sweeps import collapsed
from core.threads import running, share

DEFAULT_TOLERANCE = 1e-2
DEFAULT_FORCE_FLOOR = 1e-3
DEFAULT_SKIN = 0.3
SKIN_SPAN = 4.0  # of the smallest radius, where that is less than the largest: else small grains list far too many neighbours


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
    """How a relaxation stands: energy [k R²], residual (max |force| over the mean contact force), force evaluations so far."""

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
        self._rigid = None
        if primitives is not None and len(primitives):
            self._rigid = rigid_contacts.allocate(endless(primitives, packing.box), max(count, 1))
        self._friction = None if friction is None else FrictionalContacts(friction, self._rigid)
        self._weight = _weight(packing, gravity, drag)
        self._listed = False  # have there been lists yet?
        self._through: set[tuple[int, int]] = set()
        self.threads = threads
        self._shared = share(threads, count)
        stiffest = float(packing.contact_stiffness.max()) if count else 1.0
        if friction is not None:
            stiffest *= 1.0 + TANGENTIAL_STIFFNESS
        smallest = float(packing.rest_radius.min()) if count else 1.0
        largest = float(packing.rest_radius.max()) if count else 1.0
        self._limits = fire.Limits(
            tolerance=float(tolerance),
            force_floor=float(force_floor),
            dt_max=fire.DT_FACTOR / np.sqrt(stiffest),
            clamp=0.1 * smallest,
            skin=skin * min(largest, SKIN_SPAN * smallest),
        )
        control = fire.fresh_control(self._limits.dt_max)
        if not count:
            control["start_energy"] = 0.0
        self._minimizer = _minimizer(packing, friction is not None, control)
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
            code, used = fire.run(
                self._minimizer,
                self._box,
                self._rigid,
                self.friction_terms,
                self._weight,
                self._limits,
                left,
                self._shared,
            )
            self.iterations += used
            left -= used
            if code == fire.LISTS_STALE:
                self._relist()
            else:
                self._reason = _REASONS[code]
        if self._reason is StopReason.BUDGET and self.iterations >= self.max_iterations:
            flat = collapsed(self._minimizer.state)
            self._reason = StopReason.COLLAPSED if flat else StopReason.ITERATION_LIMIT

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

    def gone_through(self) -> set[tuple[int, int]]:
        """Grain and primitive, for the grains that have gone through an edge since the bodies came to rest."""
        return self._through ^ self._changed_sides()

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
        return None if self._friction is None else self._friction.terms

    def slips(self) -> tuple[NDArray[np.int64], NDArray[np.float64], FrictionForces]:
        """What frictional contacts remember, and their forces: see ``FrictionalContacts.end``. Only with friction."""
        assert self._friction is not None
        return self._friction.end(self._minimizer, self._box)

    def forces(self) -> NDArray[np.float64]:
        """Generalised forces (5, N), with friction (6, N), of the latest evaluation [k R], in the packing's own order."""
        forces = np.empty_like(self._minimizer.force)
        forces[:, self._minimizer.identity] = self._minimizer.force
        return forces

    def _changed_sides(self) -> set[tuple[int, int]]:
        """Grain and primitive, for the grains that have gone through an edge since the lists were made."""
        m, rigid = self._minimizer, self._rigid
        if rigid is None or not self._listed:
            return set()
        changed = np.flatnonzero(
            rigid_contacts.changed_sides(m.reference, m.state, rigid, self._box)
        )
        grains, primitives = m.identity[rigid.grain[changed]], rigid.primitive[changed]
        return set(zip(grains.tolist(), primitives.tolist(), strict=True))

    def _relist(self) -> None:
        # At new lists, as no grain has then come far since the last: later nobody can tell a way through from one around.
        self._through ^= self._changed_sides()
        self._listed = True
        friction = self._friction
        if friction is not None:
            friction.commit(self._minimizer, self._box)
        while True:
            answer = fire.relist(self._minimizer, self._box, self._rigid, self._limits.skin)
            if answer == neighbors.FIT:
                if friction is not None:
                    friction.relist(self._minimizer, self._rigid, self._box)
                return
            lists = self._minimizer.lists
            grains, pairs, slots = len(self.packing), len(lists.first), len(lists.width)
            if answer == neighbors.RIGID_FULL:
                assert self._rigid is not None
                room = 2 * len(self._rigid.grain)
                self._rigid = self._rigid._replace(
                    grain=np.zeros(room, dtype=np.int64), primitive=np.zeros(room, dtype=np.int64)
                )
                continue
            if answer == neighbors.PAIRS_FULL:
                pairs *= 2
            else:
                slots *= 2
            self._minimizer = self._minimizer._replace(
                lists=neighbors.allocate(grains, pairs, slots, half=lists.half)
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


def _minimizer(packing: Packing, spins: bool, control: NDArray[np.void]) -> fire.Minimizer:
    count = len(packing)
    nu, stiffness = packing.poisson_ratio, packing.contact_stiffness
    rest_area = packing.rest_radius**2
    shape_stiffness = 2.0 * shape_modulus(nu, stiffness)
    # A grain that resists area or shape far more than a contact does is made heavier, so that dt need not shrink for it.
    own = 2.0 * deformation_stiffness(nu, stiffness) * (1.0 + np.abs(nu))
    mass = fire.SHAPE_MASS * np.maximum(1.0, own / (fire.SHAPE_MASS * stiffness))
    rows = 6 if spins else 5
    inverse_mass = np.ones((rows, count))
    inverse_mass[2:5] = 1.0 / mass
    state = np.zeros((rows, count))
    state[:5] = packing.state
    if spins:
        inverse_mass[5] = 1.0 / (SPIN_MASS * rest_area)
    return fire.Minimizer(
        state=state,
        velocity=np.zeros((rows, count)),
        force=np.zeros((rows, count)),
        inverse_mass=inverse_mass,
        reference=np.zeros((rows, count)),
        support=np.zeros((3, count)),
        grains=fire.Grains(
            contact_stiffness=stiffness.copy(),
            rest_area=rest_area,
            area_stiffness=area_modulus(nu, stiffness) / rest_area,
            shape_stiffness=shape_stiffness,
        ),
        lists=neighbors.allocate(count, 4 * count, 24, half=spins),
        identity=np.arange(count),
        scratch=np.zeros(count),
        scratch_identity=np.zeros(count, dtype=np.int64),
        control=control,
    )

"""One increment as a plain function of one vector, for minimisers that are not FIRE: peers, checks and polishes.

Nothing of the physics is repeated here: the same kernels give energy and forces, and the same lists say who is near whom. What a
minimiser finds is put back into the relaxation, which then ends as if it had found it itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core import fire
from core.arrays import Floats
from core.jit import kernel
from core.relaxation import Relaxation
from core.sweeps import farthest


@kernel
def load(values, root_mass, identity, state):
    """``values`` (D, N) in the packing's order, over the roots of the inertias, into ``state`` in the minimiser's order."""
    for row in range(state.shape[0]):
        for k in range(state.shape[1]):
            state[row, k] = values[row, identity[k]] / root_mass[row, k]


@kernel
def unload(force, root_mass, identity, gradient):
    """Forces in the minimiser's order into a gradient (D, N) in the packing's order."""
    for row in range(force.shape[0]):
        for k in range(force.shape[1]):
            gradient[row, identity[k]] = -force[row, k] / root_mass[row, k]


class Problem:
    """Energy and gradient of the increment that ``relaxation`` is to solve; (D N,) numbers z, D is 5 or with friction 6.

    z are the degrees of freedom times the roots of the inertias that FIRE gives them, so that all are about equally stiff:
    without that a peer would be asked a harder question than FIRE is.
    """

    def __init__(self, relaxation: Relaxation, tolerance: float) -> None:
        self.relaxation = relaxation
        self.tolerance = tolerance
        self.evaluations = 0
        self.residual = np.inf  # max |force| over the mean contact force at the latest z
        self._scale = 0.0
        self._countdown = 0
        minimizer = relaxation._minimizer
        self._shape = minimizer.state.shape
        self.relist()

    def relist(self) -> None:
        """New lists for the state as it stands; every per-grain array takes their order."""
        self.relaxation._relist()
        minimizer = self.relaxation._minimizer
        minimizer.reference[:] = minimizer.state
        self._root_mass = np.sqrt(1.0 / minimizer.inverse_mass)

    def start(self) -> Floats:
        """z of the state as it stands (D N,)."""
        minimizer = self.relaxation._minimizer
        z = np.empty(self._shape)
        z[:, minimizer.identity] = minimizer.state * self._root_mass
        return z.reshape(-1)

    def __call__(self, z: Floats) -> tuple[float, Floats]:
        """Energy [k R²] and its gradient (D N,)."""
        relaxation = self.relaxation
        minimizer = relaxation._minimizer
        values = z.reshape(self._shape)
        load(values, self._root_mass, minimizer.identity, minimizer.state)
        if not farthest(minimizer.state, minimizer.reference) <= 0.5 * relaxation._limits.skin:
            self.relist()
            minimizer = relaxation._minimizer
        energy = fire.evaluate(
            minimizer,
            relaxation._box,
            relaxation._rigid,
            relaxation.friction_terms,
            relaxation._weight,
            None,
        )
        energy += self.extra(minimizer.state, minimizer.force, minimizer.identity)
        self.evaluations += 1
        self._measure(minimizer)
        gradient = np.empty(self._shape)
        unload(minimizer.force, self._root_mass, minimizer.identity, gradient)
        return float(energy), gradient.reshape(-1)

    def extra(self, state: Floats, force: Floats, identity: NDArray[np.int64]) -> float:
        """What a subclass adds to ``force`` (D, N), in the minimiser's order; returns its energy [k R²]."""
        del state, force, identity
        return 0.0

    def _measure(self, minimizer: fire.Minimizer) -> None:
        """The residual, as FIRE measures it, and as often."""
        relaxation = self.relaxation
        largest = float(np.abs(minimizer.force).max())
        self._countdown -= 1
        if self._countdown <= 0 or largest <= self.tolerance * self._scale:
            self._countdown = fire.SCALE_EVERY
            force = fire.mean_contact_force(minimizer, relaxation._box, relaxation._rigid)
            self._scale = max(float(force), relaxation._limits.force_floor)
        self.residual = largest / self._scale

    @property
    def solved(self) -> bool:
        """True if the latest z meets the tolerance."""
        return self.residual <= self.tolerance

    def put(self, z: Floats) -> None:
        """Make z the state of the relaxation, at rest; its next look at the forces will say how good that is."""
        self(z)
        self.relaxation._minimizer.velocity[:] = 0.0

"""Coulomb friction: the coefficient, every grain's spin, and the slips that contacts remember from one increment to the next.

During an increment the slip u of a contact counts how far its surfaces have moved along each other, and its force is k_t u, cut
to ± μ times the normal force: implicit Euler of Coulomb's law with a spring. Cap, tangent and the set of contacts are those of
the state itself (``slip``). Afterwards the clipped slip is remembered by the pair of grains, so that it survives new neighbour
lists and grains that leave. New contacts begin at 0.

A scene without friction has none of this: no spin, no memory, and its kernels are compiled without the term.
"""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats, Indices, twin
from core.candidates import BODY, GRAIN
from core.errors import InputError
from core.frictional_contacts import Origin
from core.packing import Packing
from core.slip import TANGENTIAL_STIFFNESS

# Inertia of a spin over R0², relative to x and y: as their stiffnesses are in a ring of like contacts, Σ k_t to Σ (C + k_t)/2. So
# neither waits for the other.
SPIN_MASS = 2.0 * TANGENTIAL_STIFFNESS / (1.0 + TANGENTIAL_STIFFNESS)


class Friction:
    """Friction of one packing: the coefficient, every grain's spin, and what every contact remembers."""

    def __init__(self, coefficient: float, grains: int) -> None:
        """Raises InputError unless the coefficient is positive and finite: without friction, give None instead of this."""
        if not (coefficient > 0.0 and np.isfinite(coefficient)):
            raise InputError(
                "the friction coefficient must be greater than 0; for no friction leave it out"
            )
        self.coefficient = float(coefficient)
        self.spin: Floats = np.zeros(grains)
        self._keys: Indices = np.zeros(0, dtype=np.int64)
        self._slips: Floats = np.zeros(0)

    @classmethod
    def of(cls, coefficient: float, grains: int) -> Friction | None:
        """The same, and for a coefficient of 0 None."""
        return None if coefficient == 0.0 else cls(coefficient, grains)

    def copy(self) -> Friction:
        """An independent copy, equal to the last bit."""
        return twin(self)

    @property
    def size(self) -> int:
        """Bytes of spins and memories."""
        return self.spin.nbytes + self._keys.nbytes + self._slips.nbytes

    def hash(self) -> str:
        """SHA-256 of spins and memories."""
        digest = hashlib.sha256(np.float64(self.coefficient).tobytes())
        for array in (self.spin, self._keys, self._slips):
            digest.update(array.tobytes())
        return digest.hexdigest()

    def select(self, keep: NDArray[np.bool_]) -> None:
        """Forget the grains that are not kept; contacts with them end by themselves."""
        self.spin = self.spin[keep]

    def rearrange(self, source: Indices) -> None:
        """Go on with other grains: ``source`` (n,) is what each was before, −1 for a new one, which has not turned yet."""
        spin = np.append(self.spin, 0.0)
        self.spin = spin[source]

    def forget_primitives(self, first: int, count: int) -> None:
        """Forget contacts with the ``count`` primitives from ``first`` on, which are taken away; later ones move up."""
        primitive = self._keys % GRAIN - BODY
        gone = (primitive >= first) & (primitive < first + count)
        keys = np.where(primitive >= first + count, self._keys - count, self._keys)
        self._keys, self._slips = keys[~gone], self._slips[~gone]

    def memory(self) -> tuple[Indices, Floats]:
        """What the contacts remember, for a file: their keys and slips ξ [R], (K,) each."""
        return self._keys.copy(), self._slips.copy()

    def remember(self, spin: Floats, keys: Indices, slips: Floats) -> None:
        """Take up spins (N,) and what ``memory`` gave. Raises InputError unless the keys are in order and all is finite."""
        whole = keys.ndim == 1 and keys.shape == slips.shape and spin.shape == self.spin.shape
        if not whole or np.any(keys < 0) or np.any(np.diff(keys) <= 0):
            raise InputError("what the frictional contacts remember is out of order")
        if not (np.all(np.isfinite(spin)) and np.all(np.isfinite(slips))):
            raise InputError("spins and slips of frictional contacts must be finite")
        self.spin, self._keys, self._slips = spin.copy(), keys.copy(), slips.copy()

    def remembered(self) -> dict[tuple[int, int], float]:
        """Slip ξ [R] by (label, label) of two grains, or (label, −1 − primitive) of a grain and a body."""
        first, second = self._keys // GRAIN, self._keys % GRAIN
        second = np.where(second >= BODY, BODY - 1 - second, second)
        return {
            (int(a), int(b)): float(s) for a, b, s in zip(first, second, self._slips, strict=True)
        }

    def begin(
        self, packing: Packing, primitives: Floats, owner: Indices, before: Floats, after: Floats
    ) -> Origin:
        """Where slips are counted from in an increment in which the bodies go from ``before`` to ``after`` (B, 3).

        ``packing``, and ``primitives`` (M, 8) with their ``owner`` (M,), as they are before anything moves.
        """
        return Origin(
            coefficient=self.coefficient,
            state=packing.state.copy(),
            box=None if packing.box is None else packing.box.kernel_form(),
            primitives=np.ascontiguousarray(primitives),
            turn=np.ascontiguousarray((after - before)[owner, 2]),
            label=packing.label,
            keys=self._keys,
            slips=self._slips,
        )

    def end(self, keys: Indices, slips: Floats, turned: Floats) -> None:
        """Remember what contacts hold, as ``frictional_contacts.ended`` says, and that grains turned by ``turned`` (N,) [rad]."""
        self._keys, self._slips = keys, slips
        self.spin += turned

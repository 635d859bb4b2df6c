"""How the hazard of a clog falls with the width: two published forms, fitted by likelihood, and which of them the runs prefer.

q(w) = exp(a − b w²): the share of flowing states decays exponentially in the width to the power of the dimension (Thomas and
Durian, doi:10.1103/PhysRevLett.114.178001; Janda et al., doi:10.1209/0295-5075/84/44002), and there is no sharp transition.
q(w) = c (w_c − w)^γ: the mean avalanche diverges at a critical width (Zuriguel et al., doi:10.1103/PhysRevE.71.051303).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from sandbox.ensemble.estimates import Student
from sandbox.sweep.sizes import MANY, hazard, memory
from sandbox.sweep.summary import Cell

LEAST_CLOGS = 5  # of a width that is fitted
# Grains that may lie on the gate of the widest of these orifices. In the packings that were made for seeds 1 to 10 they drop as
# soon as it is gone, and most arches stand right above: that is how the packing was made. A flow has begun once more have left.
ON_THE_GATE = 4
FLOOR = 1e-12  # of a hazard


@dataclass(frozen=True)
class Falls:
    """Avalanches (A,): width of their orifice in diameters, grains that left, and clogs that ended them (0 or 1)."""

    width: Floats
    size: Floats
    clogs: Floats

    @classmethod
    def of(cls, cells: Sequence[Cell]) -> Falls:
        """Of cells along an axis of widths."""
        each = [(float(cell.values[0]), *begun(cell)) for cell in cells]
        return cls(
            np.concatenate([np.full(len(sizes), width) for width, sizes, _ in each]),
            np.concatenate([sizes for _, sizes, _ in each]),
            np.concatenate([clogged.astype(np.float64) for _, _, clogged in each]),
        )

    def likelihood(self, q: Floats) -> Floats:
        """Logarithm of that of each avalanche (A,) where the hazard is q (A,)."""
        bounded = np.clip(q, FLOOR, 1.0 - FLOOR)
        return np.asarray(
            self.clogs * np.log(bounded) + (self.size - self.clogs) * np.log1p(-bounded)
        )


@dataclass(frozen=True)
class Fit:
    """One form through the avalanches: its numbers in words, its hazard at widths, its likelihood, and how many are free."""

    name: str
    words: str
    hazard: Callable[[Floats], Floats]
    likelihood: Floats  # logarithm, (A,)
    free: int

    @property
    def criterion(self) -> float:
        """Akaike's (1974, doi:10.1109/TAC.1974.1100705): less is better."""
        return 2.0 * self.free - 2.0 * float(self.likelihood.sum())


def begun(cell: Cell) -> tuple[Floats, NDArray[np.bool_]]:
    """Sizes of the avalanches in which a flow has begun, counted from there, (A,), and whether a clog ended each, (A,)."""
    sizes, clogged = cell.sizes
    more = sizes > ON_THE_GATE
    return sizes[more] - ON_THE_GATE, clogged[more]


def exponential(falls: Falls) -> Fit:
    """q = exp(a − b w²)."""
    a, b = _best(falls, lambda p, w: np.exp(p[0] - p[1] * w * w), [(0.0, 0.3), (1.0, 0.5)])
    form = _bounded(lambda w: np.exp(a - b * w * w))
    words = f"a = {a:.3g}, b = {b:.3g} per square diameter"
    return Fit("exp(a − b w²)", words, form, falls.likelihood(form(falls.width)), 2)


def divergence(falls: Falls) -> Fit:
    """q = c (w_c − w)^γ, 0 beyond w_c; w_c lies beyond every width at which a clog was seen."""
    least = float(falls.width[falls.clogs > 0].max())

    def form_of(p: Sequence[float]) -> Callable[[Floats], Floats]:
        critical = least + np.exp(p[1])
        return lambda w: np.exp(p[0]) * np.maximum(critical - w, 0.0) ** np.exp(p[2])

    starts = [(-2.0, 0.0, 0.7), (-4.0, 1.0, 1.5), (-1.0, -1.0, 0.3)]
    p = _best(falls, lambda p, w: form_of(p)(w), starts)
    form = _bounded(form_of(p))
    words = f"w_c = {least + np.exp(p[1]):.3g} diameters, γ = {np.exp(p[2]):.3g}"
    return Fit("c (w_c − w)^γ", words, form, falls.likelihood(form(falls.width)), 3)


def preference(one: Fit, other: Fit) -> Student:
    """Mean log likelihood of an avalanche, ``one`` over ``other``, each less its free numbers (Vuong, doi:10.2307/1912557)."""
    difference = one.likelihood - other.likelihood
    found = Student.mean(difference)
    return Student(found.value - (one.free - other.free) / len(difference), found.error, MANY)


def falling(cells: Sequence[Cell]) -> Student | None:
    """Slope of ln q against the squared width, weighted by clogs; None of fewer than three widths with enough of them."""
    known = [(float(c.values[0]), hazard(*begun(c))) for c in cells]
    some = [(w, q) for w, q in known if q is not None and q.hits >= LEAST_CLOGS]
    if len(some) < 3:
        return None
    x = np.array([w * w for w, _ in some])
    y = np.log([q.value for _, q in some])
    # The variance of ln q is (1 − q) / clogs; a tenth of that at least, where all grains clog at once.
    weight = np.array([q.hits / max(1.0 - q.value, 0.1) for _, q in some])
    middle = float(weight @ x / weight.sum())
    square = float(weight @ (x - middle) ** 2)
    slope = float(weight @ ((x - middle) * y)) / square
    left = y - float(weight @ y / weight.sum()) - slope * (x - middle)
    spread = max(float(weight @ left**2) / (len(x) - 2), 1.0)  # wider where a line does not fit
    return Student(slope, float(np.sqrt(spread / square)), MANY)


def pooled_memory(cells: Sequence[Cell]) -> Student | None:
    """``sizes.memory`` over all cells with enough clogs, weighted by its errors."""
    some = [begun(cell) for cell in cells]
    each = [memory(*one) for one in some if int(one[1].sum()) >= LEAST_CLOGS]
    known = [one for one in each if one is not None]
    if not known:
        return None
    weight = np.array([1.0 / one.error**2 for one in known])
    value = float(weight @ [one.value for one in known] / weight.sum())
    return Student(value, float(weight.sum() ** -0.5), MANY)


def _best(
    falls: Falls,
    form: Callable[[Sequence[float], Floats], Floats],
    starts: Sequence[tuple[float, ...]],
) -> tuple[float, ...]:
    """The numbers that make the avalanches likeliest, from the best of some starts."""
    from scipy.optimize import minimize

    def badness(p: Sequence[float]) -> float:
        with np.errstate(all="ignore"):
            return -float(falls.likelihood(np.nan_to_num(form(p, falls.width), nan=1.0)).sum())

    options = {"maxiter": 4000, "xatol": 1e-6, "fatol": 1e-9}
    found = [minimize(badness, start, method="Nelder-Mead", options=options) for start in starts]
    best = min(found, key=lambda one: float(one.fun))
    return tuple(map(float, best.x))


def _bounded(form: Callable[[Floats], Floats]) -> Callable[[Floats], Floats]:
    return lambda w: np.minimum(form(w), 1.0)

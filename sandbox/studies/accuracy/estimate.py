"""From drives to the live estimate of the force's error: fitted to some seeds, judged by others. Pure functions of plain numbers.

A bound is factor × f × (u/f)^p × m^q (``scenes.accuracy``), one for what is usual, one for what nine of ten stay within. Both
powers come from a quantile regression in logarithms (Koenker and Bassett 1978, doi:10.2307/1913643) over all tolerances, within
limits: an error does not grow where less is left, nor shrink where grains have rearranged. The factor comes from the increments
as they end: the least that the wanted share of n + 1 of them stays within. Whether q is worth having, seeds say that are left out
one by one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from core.arrays import Floats
from sandbox.ensemble.estimates import wilson
from sandbox.studies.accuracy.live import FIT, JUDGE
from scenes.accuracy import Bound, left_over

SHARES = {"usual": 0.5, "nine_of_ten": 0.9}
AIMS = {"usual": (0.4, 0.6), "nine_of_ten": (0.85, 0.95)}
POWER = (0.2, 2.0)  # an estimate that does not fall with what is left is none
MOVED_POWER = (0.0, 2.0)
FORMS = (False, True)  # without the farthest move, with it
LEAST = 1e-12  # of the mean contact force: smaller errors are rounding


@dataclass(frozen=True)
class Cases:
    """Increments in which the handle feels a force, (n,) each.

    ``level`` is 1 for an increment as it ended, and else the tolerance that it was looked at, over its own.
    """

    seed: Floats
    level: Floats
    contact_force: Floats  # mean [k R]
    left: Floats  # [k R]
    moved: Floats  # over the step
    error: Floats  # [k R]
    mean: Floats  # magnitude of the force on the handle up to there [k R]

    def where(self, chosen: Any) -> Cases:
        """Those that are chosen, a mask or indices."""
        return Cases(*(column[chosen] for column in vars(self).values()))

    @property
    def ended(self) -> Cases:
        """Those of increments as they ended."""
        return self.where(self.level == 1.0)

    @property
    def height(self) -> Floats:
        """Logarithm of the error over the mean contact force (n,)."""
        relative = np.maximum(self.error / self.contact_force, LEAST)
        height: Floats = np.log(relative)
        return height

    def __len__(self) -> int:
        return len(self.error)


def cases(drives: Mapping[int, Mapping[str, Any]]) -> Cases:
    """The cases of the drives, by seed, in which the handle feels a force."""
    rows = [
        (
            float(seed),
            reading["level"],
            reading["contact_force"],
            left_over(reading["unbalanced"], reading["residual"], reading["contact_force"]),
            row["moved"],
            reading["error"],
            row["mean"],
        )
        for seed, drive in drives.items()
        for row in drive["rows"]
        if row["force"] > 0.0
        for reading in row["readings"]
    ]
    found = np.array(rows, dtype=np.float64).reshape(-1, 7)
    usable = (found[:, 2] > 0.0) & (found[:, 3] > 0.0)
    return Cases(*found[usable].T)


def bounds(found: Cases) -> dict[str, Bound] | None:
    """What is usual, and what nine of ten stay within, of ``found``; None of nothing."""
    if not len(found.ended):
        return None
    return {name: bound(found, share) for name, share in SHARES.items()}


def bound(found: Cases, share: float) -> Bound:
    """What that share of the increments stays within, in the form that does best on seeds left out."""
    seeds = np.unique(found.seed)
    if len(seeds) < 2:
        return _bound(found, share, FORMS[0])

    def loss(form: bool) -> float:
        left_out = [
            pinball(
                _bound(found.where(found.seed != s), share, form),
                found.where(found.seed == s),
                share,
            )
            for s in seeds
            if len(found.where(found.seed != s).ended)
        ]
        return float(np.mean(np.concatenate(left_out)))

    return _bound(found, share, min(FORMS, key=loss))


def _bound(found: Cases, share: float, form: bool) -> Bound:
    """In that form: with the farthest move, or without."""
    left = np.log(found.left / found.contact_force)
    columns, limits = [left], [POWER]
    if form:
        columns, limits = [left, np.log(found.moved)], [POWER, MOVED_POWER]
    powers = quantile_regression(np.array(columns).T, found.height, share, limits)[1:]
    power, moved_power = (*powers, 0.0)[:2]
    ended = found.ended
    rest = np.sort(ended.height - np.log(_relative(Bound(1.0, power, moved_power), ended)))
    place = min(math.ceil((len(rest) + 1) * share), len(rest)) - 1
    return Bound(float(np.exp(rest[place])), power, moved_power)


def _relative(bound: Bound, found: Cases) -> Floats:
    """The bound over the mean contact force (n,)."""
    states = zip(found.contact_force, found.left, found.moved, strict=True)
    size = np.array([bound.error(*state) for state in states])
    relative: Floats = size / found.contact_force
    return relative


def pinball(bound: Bound, found: Cases, share: float) -> Floats:
    """Loss of the bound in increments as they ended (n,): least, in the mean, for the quantile of that share."""
    ended = found.ended
    over = ended.height - np.log(_relative(bound, ended))
    loss: Floats = np.where(over > 0.0, share * over, (share - 1.0) * over)
    return loss


def quantile_regression(
    features: Floats, values: Floats, share: float, limits: Sequence[tuple[float, float]]
) -> list[float]:
    """Intercept and slopes of the plane that has about that share of ``values`` (n,) below it, slopes within limits.

    ``features`` (n, k). A linear programme.
    """
    from scipy import sparse
    from scipy.optimize import linprog

    count, slopes = features.shape
    plane = np.column_stack([np.ones(count), features])
    cost = np.concatenate(
        [np.zeros(1 + slopes), np.full(count, share), np.full(count, 1.0 - share)]
    )
    meets = sparse.hstack([plane, sparse.eye(count), -sparse.eye(count)], format="csc")
    free = [(None, None), *limits, *[(0.0, None)] * (2 * count)]
    answer = linprog(cost, A_eq=meets, b_eq=values, bounds=free, method="highs")
    return [float(value) for value in answer.x[: 1 + slopes]]


def judge(found: Cases, bounds: Mapping[str, Bound]) -> dict[str, Any]:
    """How the bounds do in ``found``: size over the mean force, coverage and its interval; coverage at other tolerances, too."""
    ended = found.ended
    verdict: dict[str, Any] = {
        "increments": len(ended),
        "error": float(np.median(ended.error / ended.mean)) if len(ended) else math.nan,
    }
    for name, bound in bounds.items():
        size = _relative(bound, found) * found.contact_force
        within, level = found.error <= size, found.level
        hits, count = int(within[level == 1.0].sum()), len(ended)
        covered = hits / count if count else math.nan
        low, high = AIMS[name]
        verdict[name] = {
            "size": float(np.median((size / found.mean)[level == 1.0])) if count else math.nan,
            "coverage": covered,
            "interval": wilson(hits, count) if count else (math.nan, math.nan),
            "aim": low <= covered <= high,
            "elsewhere": {
                f"{other:g}": float(within[level == other].mean())
                for other in sorted(set(level.tolist()) - {1.0})
            },
        }
    return verdict


def calibrate(drives: Mapping[int, Mapping[str, Any]]) -> dict[str, Any] | None:
    """One packing of one scene, drives by seed: its bounds, and how they do on seeds that they have not seen.

    None where the handle feels no force.
    """
    fitted = bounds(cases({seed: drive for seed, drive in drives.items() if seed in FIT}))
    if fitted is None:
        return None
    judged = cases({seed: drive for seed, drive in drives.items() if seed in JUDGE})
    return {
        "bounds": {name: [*vars(bound).values()] for name, bound in fitted.items()},
        "judged": judge(judged, fitted),
        "unconverged": sum(drive["unconverged"] for drive in drives.values()),
        "untold": sum(drive["untold"] for drive in drives.values()),
        "drives": {
            seed: {
                "unconverged": drive["unconverged"],
                "untold": drive["untold"],
                **judge(cases({seed: drive}), fitted),
            }
            for seed, drive in drives.items()
        },
    }

"""How accurate each scene is at its defaults, as a full run of ``python -m sandbox study accuracy`` found it.

accuracy.toml beside this file is the accuracy.toml of assets/studies/accuracy, which that command writes.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

TABLE = Path(__file__).with_name("accuracy.toml")


@dataclass(frozen=True)
class Bound:
    """An error of the force on the handle that some share of all increments stays within."""

    factor: float
    power: float  # of what is left
    moved_power: float

    def error(self, contact_force: float, left: float, moved: float) -> float:
        """factor × mean contact force f × (u/f)^p × m^q [k R], u as ``left_over``.

        m: how far a grain has moved at most in the increment, over the step, 1 or more.
        """
        if contact_force <= 0.0:
            return 0.0
        share = (left / contact_force) ** self.power
        return float(self.factor * contact_force * share * moved**self.moved_power)


@dataclass(frozen=True)
class Estimate:
    """What the error of the force on the handle usually stays within, one time in two, and what nine times of ten."""

    usual: Bound
    nine_of_ten: Bound

    def errors(self, contact_force: float, left: float, moved: float) -> tuple[float, float]:
        """(usual, nine of ten) [k R], as ``Bound.error``, in order: the second is never less than the first."""
        state = contact_force, left, moved
        usual = self.usual.error(*state)
        return usual, max(usual, self.nine_of_ten.error(*state))


def left_over(unbalanced: float, residual: float, contact_force: float) -> float:
    """u [k R]: root of the sum of squares of the forces that are left on the grains, ``unbalanced``.

    It is the largest generalised force at least, ``residual`` times the mean contact force: one may be left on a shape alone.
    """
    return max(unbalanced, residual * contact_force)


# For what the study has not seen, scenes, packings, and what a person has made: about that of the worst it has.
UNKNOWN = Estimate(Bound(10.0, 1.0, 0.0), Bound(350.0, 1.0, 0.0))


@dataclass(frozen=True)
class Accuracy:
    """``statement`` is what ``list`` prints; ``estimates`` are those of the packings that the study has seen, by name."""

    statement: str = ""
    estimates: Mapping[str, Estimate] = field(default_factory=dict)

    def estimate(self, packing: str) -> Estimate:
        """That of the packing of that name."""
        return self.estimates.get(packing, UNKNOWN)


NOTHING = Accuracy()


@cache
def accuracies() -> dict[str, Accuracy]:
    """All scenes that the study has seen, by name."""
    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    return {
        name: Accuracy(
            str(row["statement"]),
            {kind: _estimate(found) for kind, found in row.items() if kind != "statement"},
        )
        for name, row in table.items()
    }


def _estimate(found: Mapping[str, tuple[float, float, float]]) -> Estimate:
    return Estimate(Bound(*found["usual"]), Bound(*found["nine_of_ten"]))


def accuracy_of(scene: str) -> Accuracy:
    """What is known about the scene of that name."""
    return accuracies().get(scene, NOTHING)

"""How accurate each scene is at its defaults, as a full run of ``python -m sandbox study accuracy`` found it.

accuracy.toml beside this file is the accuracy.toml of assets/studies/accuracy, which that command writes.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

TABLE = Path(__file__).with_name("accuracy.toml")


@dataclass(frozen=True)
class Accuracy:
    """``statement`` is what ``list`` prints; the others calibrate ``force_error``."""

    statement: str
    error_factor: float
    error_power: float

    def force_error(self, residual: float, contact_force: float) -> float:
        """Estimated error of the force on the handle [k R] that an unfinished relaxation leaves.

        A × mean contact force × residual^p: in 90 % of the increments of the study the error was below that, at any tolerance.
        """
        return self.error_factor * contact_force * float(residual**self.error_power)


# For scenes that the study has not seen: about that of the worst it has.
UNKNOWN = Accuracy("", 50.0, 1.0)


@cache
def accuracies() -> dict[str, Accuracy]:
    """All scenes that the study has seen, by name."""
    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    return {
        name: Accuracy(str(row["statement"]), float(row["error_factor"]), float(row["error_power"]))
        for name, row in table.items()
    }


def accuracy_of(scene: str) -> Accuracy:
    """What is known about the scene of that name."""
    return accuracies().get(scene, UNKNOWN)

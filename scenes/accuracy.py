"""How accurate each scene is at its defaults, as a full run of ``python -m sandbox study accuracy`` found it.

The numbers stand in assets/studies/accuracy/results.json too; a test holds them against each other.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Accuracy:
    """``statement`` is what ``list`` prints. ``error_factor`` A: the error of the force on the handle [k R] that unfinished

    relaxation leaves was below A × residual × mean contact force [k R] in 95 % of the increments of the study.
    """

    statement: str
    error_factor: float


ACCURACY: dict[str, Accuracy] = {}
# For scenes that the study has not seen: larger than that of any scene it has.
UNKNOWN = Accuracy("", 20.0)


def accuracy_of(scene: str) -> Accuracy:
    """What is known about the scene of that name."""
    return ACCURACY.get(scene, UNKNOWN)

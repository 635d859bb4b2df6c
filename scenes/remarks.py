"""What a scene says about an increment, and what it is told to say it from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.quasistatic import Increment


@dataclass(frozen=True)
class Earlier:
    """The increment before the newest one, and the labels (N,) of the grains as they were numbered then."""

    increment: Increment
    label: NDArray[np.int64]


@dataclass(frozen=True)
class Latest:
    """The newest increment, for what a scene has to say about it."""

    before: (
        Increment | None
    )  # the one before it; None if grains have left since, and numbers differ
    now: Increment
    curve: NDArray[np.float64]  # (2, M) what is plotted so far
    left: int  # grains that left in this increment
    last_exit: tuple[float, float]  # stroke and force when a grain last left
    at_rest: bool = False  # with drag: the grains have come to rest
    earlier: Earlier | None = None  # the one before it, also where grains have left since
    waited: float = 0.0  # stroke between the exits of the latest grain and of the one before it
    at_start: int = 0  # grains then


Happening = Literal["locked", "clog", "arch", "avalanche"]


@dataclass(frozen=True)
class Remarks:
    """What a scene says about an increment, in plain words, and the grains that it points at, (N,) or None.

    ``happening``: what goes on now, in plain words; it is announced when it begins.
    """

    notices: tuple[str, ...] = ()
    highlight: NDArray[np.bool_] | None = None
    happening: Mapping[Happening, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Holding:
    """What holds a locked hand, in plain words, and the grains that do, (N,) or None."""

    text: str
    grains: NDArray[np.bool_] | None = None

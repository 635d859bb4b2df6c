"""What a solver's thread publishes: all that the window may know of it at one moment."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from sandbox.session.beginning import Made
from sandbox.session.frame import Frame

Phase = Literal["building", "catching up", "running", "failed", "stopped"]


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What the window may know of the solver at one moment."""

    phase: Phase
    text: str = ""  # what is being built
    fraction: float = math.nan  # how much of that is done, or caught up, 0 to 1; nan: nobody knows
    frame: Frame | None = None  # the latest picture; kept through a rebuild and a failure
    error: str = ""  # plain words, when failed
    serial: int = 0  # counts publications
    made: Made | None = None  # what there is to be kept in a file
    ending: bool = False  # the build is broken off as soon as what is being compiled is compiled

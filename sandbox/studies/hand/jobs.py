"""One run of the study of the hand: a scripted push, a random hand, or a guided tour played to its end."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import islice
from typing import Any

import numpy as np

from sandbox import __version__
from sandbox.ensemble.pool import Stopped
from sandbox.session.commands import Grab, Move, Protocol, Release
from sandbox.session.session import Session
from sandbox.studies.hand.tour_claims import BROKEN, play
from scenes import registry
from scenes.scene import HAND_STRENGTH

DATA_VERSION = 1  # of what a run writes down
SLICE = 400  # force evaluations between two looks at whether to stop
GESTURES = 8  # of a random hand
LONGEST = 12  # increments of one gesture
MOST = (
    2  # a weak hand takes more increments than the script has; a hopper is shaken until it is empty
)
FLUNG, HELD = (
    0.25,
    100,
)  # of the gestures aim far beyond the scene, and go on for so many increments
FAR = 1e4  # [R]

Stopping = Callable[[], bool]
Row = dict[str, Any]


@dataclass(frozen=True)
class Job:
    """A run. ``part``: "push", "random" or "tour"; a tour has all packings of its own; ``strength`` None: the scene's default."""

    part: str
    scene: str
    packing: str
    seed: int
    strength: float | None = None

    def key(self) -> str:
        """Changes with all that the run depends on, the defaults of its scene too."""
        settings = sorted(registry.get(self.scene).settings().items())
        words = json.dumps([asdict(self), settings, DATA_VERSION, __version__])
        return hashlib.sha256(words.encode()).hexdigest()[:16]

    def settings(self) -> dict[str, object]:
        """For the session."""
        return {} if self.strength is None else {HAND_STRENGTH: self.strength}


def carry_out(job: Job, stopping: Stopping = lambda: False) -> Row:
    """What came of a job. Raises Stopped."""

    def check() -> None:
        if stopping():
            raise Stopped

    found = {"push": push, "random": wild, "tour": _tour}[job.part](job, check)
    return {**asdict(job), **found}


def push(job: Job, check: Callable[[], None]) -> Row:
    """The scripted drive, until it has ended or the hand is locked; at most ``MOST`` times its length: one may go on for ever."""
    session = Session(job.scene, job.packing, job.seed, job.settings())
    session.build()
    session.submit(Protocol(True))
    steps = MOST * session.scene.steps(session.settings)
    increments = itertools.islice(session.increments(SLICE, check), steps)
    forces = [session.run.hand_force for _ in increments]
    reasons = session.history.column("stop_reason")
    way = session.run.way
    pushing = np.array([force for force in forces if math.isfinite(force)])
    return {
        "ended": _ending(session),
        "way": None if way is None else round(way, 4),
        "out": session.frame().grains_out,
        "peak_force": float(pushing.max(initial=0.0)),
        "mean_force": float(pushing.mean()) if len(pushing) else 0.0,
        "increments": len(reasons) - 1,
        "unconverged": int(np.sum(reasons != "converged")),
        "failing": _failing(session),
    }


def wild(job: Job, check: Callable[[], None]) -> Row:
    """A hand that grabs, drags here and there, flings, and lets go, with the scene's own strength."""
    session = Session(job.scene, job.packing, job.seed, job.settings())
    session.build()
    rng = np.random.default_rng([job.seed, *map(ord, job.scene + job.packing)])
    x0, y0, x1, y1 = session.frame().bounds
    handles = [handle.body for handle in session.run.setup.handles]
    endings: list[str] = []
    for _ in range(GESTURES):
        handle = handles[int(rng.integers(len(handles)))]
        x, y = rng.uniform((1.5 * x0, 1.5 * y0), (1.5 * x1, 1.5 * y1))
        length = int(rng.integers(1, LONGEST + 1))
        if rng.random() < FLUNG:
            angle, length = rng.uniform(-math.pi, math.pi), HELD
            x, y = FAR * math.cos(angle), FAR * math.sin(angle)
        session.submit(Grab(handle))
        session.submit(Move(handle, float(x), float(y)))
        for _ in islice(session.increments(SLICE, check), length):
            pass
        if rng.random() < 0.5:
            session.submit(Release(handle))
        endings.append(_ending(session))
    reasons = session.history.column("stop_reason")
    return {
        "ended": next((each for each in endings if each in BROKEN), endings[-1]),
        "increments": len(reasons) - 1,
        "unconverged": int(np.sum(reasons == "iteration limit")),
        "broken": int(np.sum(np.isin(reasons, list(BROKEN)))),
        "failing": _failing(session),
    }


def _tour(job: Job, check: Callable[[], None]) -> Row:
    return {"steps": play(job.scene, job.seed, check)}


def _ending(session: Session) -> str:
    """ "locked", "went through", or what the relaxation broke on."""
    reason = session.history[-1].stop_reason
    if reason in BROKEN:
        return reason
    return "locked" if session.run.locked else "went through"


def _failing(session: Session) -> list[str]:
    """The checks of the scene that fail."""
    return [f"{c.name}: {c.measured}" for c in session.checks() if c.holds is False]

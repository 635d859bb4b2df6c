"""One run, carried out until its outcome is known, and what is written down of it: no picture, no states to go back to."""

from __future__ import annotations

import math
import platform
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from itertools import islice

import numba
import numpy as np

from core.kernel_cache import CORE, source_hash
from core.relaxation import StopReason
from sandbox import __version__
from sandbox.ensemble.clock import clock
from sandbox.ensemble.pool import Stopped, stopping
from sandbox.session.commands import Protocol
from sandbox.session.history import Row
from sandbox.session.session import Session
from sandbox.sweep.columns import AFTER, Entry
from sandbox.sweep.request import CLOG, EMPTY, LOCKED, Job

SLICE = 400  # force evaluations between two looks at whether to stop: a fraction of a second
AT_REST = 10  # increments in a row in which no grain moves on: it has come to rest

# Outcomes.
CLOGGED, EMPTIED, NEVER, THROUGH, CENSORED, FAILED = (
    "clogged",
    "emptied",
    "never started",
    "ran through",
    "censored",
    "failed",
)
STOPPED = (LOCKED, CLOGGED)  # by the grains
# What can become of grains that move: a share that stops is one of these. What never started was made so, and is no clog; of what
# was broken off or failed nobody knows what it would have come to.
DECIDED = (*STOPPED, EMPTIED, THROUGH)
OUTCOMES = (*DECIDED, NEVER, CENSORED, FAILED)
HELD = (*STOPPED, NEVER)  # an arch may stand


@dataclass(frozen=True)
class Found:
    """A row of runs.csv and rows of avalanches.csv, without the axes."""

    run: Mapping[str, Entry]
    avalanches: tuple[Mapping[str, Entry], ...] = ()


@dataclass
class Watch:
    """What is noticed of a run increment by increment."""

    session: Session
    resting: int = 0  # increments in a row
    begun: int = 0  # grains out when the present avalanche began
    held: bool = False  # something holds the grains back
    avalanches: list[dict[str, Entry]] = field(default_factory=list)
    forces: list[float] = field(default_factory=list)

    @property
    def falls(self) -> bool:
        """Do the grains move by themselves?"""
        return self.session.run.setup.drag > 0.0

    @property
    def at_rest(self) -> bool:
        """Have they come to rest? Under a piston they never go by themselves, so there it says nothing."""
        return self.falls and self.resting >= AT_REST

    @property
    def empty(self) -> bool:
        """Is nothing left that could come out? What lies on the sides of the funnel, at rest and with no arch, never will."""
        setup = self.session.run.setup
        if setup.outlet is None:
            return False
        if not len(setup.packing):
            return True
        return self.at_rest and self.session.run.course.out > 0 and self.arch is None

    @property
    def arch(self) -> int | None:
        """Grains of the arch that stands now, or None."""
        run = self.session.run
        found = run.scene.arch(run.setup, run.last)
        return None if found is None else int(found.sum())

    def look(self, row: Row) -> None:
        """At a finished increment."""
        run = self.session.run
        self.resting = 0 if run.course.moving else self.resting + 1
        curve = run.setup.curve
        self.forces.append(row.resisting if curve is None else row.magnitude)
        before = self.held
        clog = "clog" in run.course.remarks.happening
        self.held = self.at_rest if self.falls else clog or run.locked
        if self.held and not before and not self.empty:
            self.close(CLOGGED)

    def close(self, ended: str) -> None:
        """The present avalanche has ended, if there was one."""
        run = self.session.run
        out = run.course.out
        if run.setup.outlet is None or out == self.begun:
            return
        arch = self.arch if ended in HELD else None
        self.avalanches.append(
            {
                "avalanche": len(self.avalanches) + 1,
                "size": out - self.begun,
                "ended": ended,
                "arch": "" if arch is None else arch,
                "increments": self.session.finished,
            }
        )
        self.begun = out

    def known(self, until: tuple[str, ...]) -> bool:
        """Is the outcome one that was waited for?"""
        run = self.session.run
        return (
            (LOCKED in until and run.locked)
            or (CLOG in until and self.held)
            or (EMPTY in until and self.empty)
        )

    def outcome(self, steps: int) -> tuple[str, str]:
        """Of the run as it is now, which may have ``steps`` increments at most, and why it was broken off, if it was."""
        run, done = self.session.run, self.session.finished
        if run.failed:
            return CENSORED, f"{run.last.report.reason} at increment {done}"
        if run.locked:
            return LOCKED, ""
        if self.empty:
            return EMPTIED, ""
        if self.held:
            return (CLOGGED if run.course.out or not self.falls else NEVER), ""
        whole = not self.falls and steps >= run.scene.steps(run.settings)
        if run.course.script is None or (done >= steps and whole):
            return THROUGH, ""
        return CENSORED, f"after {done} increments"


def carry_out(job: Job) -> Found:
    """A run, in a process of a pool or anywhere else. Raises InputError for what cannot be built, or Stopped."""
    return carried_out(job)[0]


def carried_out(job: Job) -> tuple[Found, Session]:
    """The same, and the session as it has ended."""

    def check(*_: object) -> None:
        if stopping():
            raise Stopped

    began = clock()
    session = Session(job.scene, job.packing, job.seed, job.settings)
    watch = drive(session, job, check)
    return described(job, watch, round(clock() - began, 3)), session


def drive(session: Session, job: Job, check: Callable[..., None] = lambda *_: None) -> Watch:
    """Build and drive a session until the outcome is known."""
    session.build(check)
    session.run.checkpoints.forget_most()
    session.submit(Protocol(True))
    watch = Watch(session)
    for row in islice(session.increments(SLICE, check), job.steps):
        watch.look(row)
        if watch.known(job.until):
            break
    return watch


def described(job: Job, watch: Watch, seconds: float) -> Found:
    """What is written down of a run that has ended."""
    run = watch.session.run
    outcome, why = watch.outcome(job.steps)
    watch.close(outcome)
    arch = watch.arch if outcome in HELD else None
    reasons = run.history.column("stop_reason")[1:]
    beyond = run.history.column("beyond_cone")[1:]
    told: dict[str, Entry] = {
        "outcome": outcome,
        "why": why,
        "initial": run.course.initial,
        "out": run.course.out,
        "left": len(run.setup.packing),
        "arch": "" if arch is None else arch,
        "avalanches": len(watch.avalanches),
        "increments": watch.session.finished,
        "peak_force": _number(max(watch.forces, default=0.0)),
        "mean_force": _number(float(np.mean(watch.forces)) if watch.forces else 0.0),
        "converged": float(np.mean(reasons == str(StopReason.CONVERGED))) if len(reasons) else 1.0,
        "friction_error": _number(float(np.mean(beyond)) if len(beyond) else 0.0),
        **versions(),
        "state": run.state_hash(),
        "seconds": seconds,
    }
    common: dict[str, Entry] = {"row": job.row, "seed": job.seed, "packing": job.packing}
    return Found(
        {**common, **job.settings, **told},
        tuple({**common, **avalanche} for avalanche in watch.avalanches),
    )


def failure(job: Job, reason: str) -> Found:
    """The row of a run that came to nothing."""
    nothing: dict[str, Entry] = dict.fromkeys(AFTER, "")
    told: dict[str, Entry] = {
        **nothing,
        "outcome": FAILED,
        "why": reason,
        **versions(),
    }
    return Found({"row": job.row, "seed": job.seed, "packing": job.packing, **job.settings, **told})


@cache
def versions() -> dict[str, Entry]:
    """What the bits of a run depend on, beside the processor."""
    return {
        "version": __version__,
        "kernels": source_hash(CORE),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def _number(value: float) -> Entry:
    """Nothing that is not finite reaches a table."""
    return value if math.isfinite(value) else ""

"""Runs of scenes in several processes, each kept in a file of its own, so that an interrupted study goes on where it stopped."""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np

from core.errors import InputError
from core.files import atomic_write
from core.warmup import compile_kernels
from sandbox import __version__
from sandbox.ensemble.batch import Batch, carry_out_all
from sandbox.ensemble.pool import Pool, Stopped, stopping
from sandbox.interrupts import deferred
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from sandbox.studies.hand import jobs as hand_jobs
from sandbox.studies.paper.probes import PROBES
from scenes.parameter import Value
from scenes.scene import HAND_STRENGTH, Ingredients

DATA_VERSION = 2  # of what a run writes down; raise it when probes change
SLICE = 400  # force evaluations between two looks at whether to stop: a fraction of a second
# Reasons to stop a relaxation after which the scripted drive does not go on.
BROKEN = {
    "collapsed": "a grain was squeezed flat",
    "not finite": "the numbers blew up",
    "sunk": "a grain was pressed into a wall",
}
HAND = "hand"  # instead of a probe: a scripted hand of ``study hand``, until it locks


@dataclass(frozen=True)
class Request:
    """One run: what ``Session`` is asked, for how long, and what is looked at after each increment."""

    scene: str
    packing: str
    seed: int = 1
    settings: tuple[tuple[str, Value], ...] = ()
    steps: int | None = None  # increments of the scripted drive; None: all of it
    probe: str = "curve"

    def of(self, name: str) -> Value:
        """The value of a setting that the request names."""
        return dict(self.settings)[name]

    def key(self) -> str:
        """Name of the run's file: changes with all that the run depends on, the defaults of its scene too."""
        asked = asdict(self)
        try:
            session = Session(self.scene, self.packing, self.seed, dict(self.settings))
            asked["settings"] = sorted(session.settings.items())
            asked["steps"] = self.steps or session.scene.steps(session.settings)
        except InputError:
            pass  # the run will say so
        words = json.dumps([asked, DATA_VERSION, __version__], sort_keys=True)
        return f"{self.scene}-{hashlib.sha256(words.encode()).hexdigest()[:16]}"


@dataclass(frozen=True)
class Result:
    """What a run came to. ``columns`` hold one number an increment, row 0 is the start.

    ``failure`` says why there are none, ``ended`` why there are fewer than were asked for.
    """

    request: Request
    columns: Mapping[str, list[float]] = field(default_factory=dict)
    lists: Mapping[str, list[float]] = field(default_factory=dict)  # of no fixed length
    converged: float = 0.0  # share of the increments
    seconds: float = 0.0  # of one core
    ended: str | None = None
    failure: str | None = None

    @property
    def increments(self) -> int:
        """How many there were."""
        if "increments" in self.lists:
            return int(self.lists["increments"][0])
        return max(len(self.columns.get("stroke", ())) - 1, 0)

    @property
    def trouble(self) -> str | None:
        """Why the run is not what was asked for, or None."""
        return self.failure or self.ended

    def column(self, name: str) -> np.ndarray:
        """A column (M,) float64."""
        return np.array(self.columns[name], dtype=np.float64)


def execute(request: Request, stopping: Callable[[], bool] = lambda: False) -> Result:
    """Carry out a run. Raises InputError for a request that its scene refuses, or Stopped."""

    def check(*_: object) -> None:
        if stopping():
            raise Stopped

    began = time.process_time()
    if request.probe == HAND:
        return _push(request, check, began)
    session = Session(request.scene, request.packing, request.seed, dict(request.settings))
    steps = request.steps or session.scene.steps(session.settings)
    session.build(check)
    session.submit(Protocol(True))
    probe = PROBES[request.probe]()
    rows = [probe.look(session)]
    rows.extend(probe.look(session) for _ in islice(session.increments(SLICE, check), steps))
    reasons = session.history.column("stop_reason")[1:]
    ended = None
    if len(reasons) and str(reasons[-1]) in BROKEN:
        ended = f"{BROKEN[str(reasons[-1])]} at increment {len(reasons)} of {steps}"
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    return Result(
        request,
        columns,
        probe.lists(),
        float(np.mean(reasons == "converged")) if len(reasons) else 1.0,
        time.process_time() - began,
        ended,
    )


def _push(request: Request, check: Callable[[], None], began: float) -> Result:
    """One run of the study of the hand, of which the strength alone is set."""
    strength = float(request.of(HAND_STRENGTH))
    job = hand_jobs.Job("push", request.scene, request.packing, request.seed, strength)
    row = hand_jobs.push(job, check)
    numbers = ("way", "out", "peak_force", "mean_force", "increments")
    lists = {name: [float(row[name])] for name in numbers}
    lists["locked"] = [float(row["ended"] == "locked")]
    return Result(
        request,
        lists=lists,
        converged=1.0 - row["unconverged"] / max(row["increments"], 1),
        seconds=time.process_time() - began,
        ended=BROKEN.get(row["ended"]),
    )


class Store:
    """The files of finished runs in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def path(self, request: Request) -> Path:
        """Where a run is kept."""
        return self.folder / f"{request.key()}.json"

    def read(self, request: Request) -> Result | None:
        """The run, if it was finished; a failed one, or a damaged file, is tried again."""
        try:
            data = json.loads(self.path(request).read_text(encoding="utf-8"))
            if data["failure"] is not None:
                return None
            return Result(
                request,
                data["columns"],
                data["lists"],
                float(data["converged"]),
                float(data["seconds"]),
                data["ended"],
            )
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def write(self, result: Result) -> None:
        """Keep a run, whole or not at all."""
        text = json.dumps({**asdict(result), "data_version": DATA_VERSION})
        with deferred(), atomic_write(self.path(result.request)) as file:
            file.write(text.encode())


def run_all(
    requests: Sequence[Request],
    store: Store,
    jobs: int,
    done: Callable[[Result], None],
    known: Collection[Result] = (),
    found_before: int = 0,
) -> None:
    """Carry out what ``store`` does not hold yet, ``jobs`` at a time; ``done`` is told each, failed ones too.

    What follows from ``known`` results, which may grow meanwhile, is not carried out again. Raises KeyboardInterrupt after all
    processes have ended.
    """

    def settled(request: Request, result: Result) -> str | None:
        store.write(result)
        done(result)
        if result.trouble is None:
            return None
        what = "failed" if result.failure else "ended early"
        return f"{what}: {request.scene}, {request.packing}, seed {request.seed}: {result.trouble}"

    batch = Batch(
        _execute,
        requests,
        settled,
        lambda request, reason: settled(request, Result(request, failure=reason)),
        known=lambda request: implied(request, known),
        prepare=partial(_warm, _terms(requests)),
        label=lambda request: f"{request.scene}, {request.packing}"[:32].ljust(32),
    )
    with Pool(jobs) as pool:
        carry_out_all(batch, pool, jobs, found_before)


def implied(request: Request, known: Iterable[Result]) -> Result | None:
    """What a hand comes to if a stronger one never asked for more than it has: the same, to the last bit."""
    if request.probe != HAND:
        return None
    strength = float(request.of(HAND_STRENGTH))
    for result in known:
        other = result.request
        if other.probe == HAND and replace(other, settings=request.settings) == request:
            enough = result.lists.get("peak_force", [math.inf])[0] <= strength
            if enough and strength < float(other.of(HAND_STRENGTH)):
                return replace(result, request=request, seconds=0.0)
    return None


def _execute(request: Request) -> Result:
    return execute(request, stopping)


def _terms(requests: Sequence[Request]) -> tuple[Ingredients, ...]:
    """All sorts of kernels that the requests need, each once."""
    found: dict[Ingredients, None] = {}
    for request in requests:
        try:
            session = Session(request.scene, request.packing, request.seed, dict(request.settings))
        except InputError:
            continue
        found[session.scene.ingredients(session.settings)] = None
    return tuple(found)


def _warm(sorts: Sequence[Ingredients]) -> None:
    for terms in sorts:
        compile_kernels(**asdict(terms))

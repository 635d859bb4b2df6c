"""The study of accuracy: error against run time, scene by scene, and the live estimate of the error.

Which jobs there are, carry them out, write what they found.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.files import atomic_write
from sandbox.ensemble.batch import Batch, carry_out_all
from sandbox.ensemble.machine import machine
from sandbox.ensemble.pool import Pool, stopping
from sandbox.files.folder import write_text
from sandbox.interrupts import deferred
from sandbox.studies.accuracy import job as accuracy_job
from sandbox.studies.accuracy import live
from sandbox.studies.accuracy.estimate import calibrate
from sandbox.studies.accuracy.estimate_report import Estimates, as_runs
from sandbox.studies.accuracy.job import Job
from sandbox.studies.accuracy.live import Drive, drives
from sandbox.studies.accuracy.protocols import APART, PROTOCOLS, protocol
from sandbox.studies.accuracy.report import as_markdown, as_table, statement
from sandbox.studies.accuracy.summary import summarise
from sandbox.studies.common.finite import finite
from scenes import registry
from scenes.accuracy import accuracy_of

FORMAT = "auxetic-sandbox accuracy"
VERSION = 2
DIGITS = 6  # of a number in results.json
# One thread a process: peers and polishes call libraries that would take all cores, and wait for one another.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

Task = Job | Drive
Measure = Callable[[Task], dict[str, Any]]


@dataclass(frozen=True)
class Outcome:
    """What a study came to: a statement and, where a job failed, its reason, by scene."""

    statements: Mapping[str, str]
    failures: Mapping[str, str]
    jobs: int
    interrupted: bool


def choose(names: Sequence[str] | None) -> list[str]:
    """The scenes of those names in the order of the menu, or all that have a protocol. Raises InputError for an unknown one."""
    wanted = {registry.get(name).name for name in names or ()}
    return [name for name in registry.names() if (name in wanted if names else name in PROTOCOLS)]


def study(
    folder: Path,
    *,
    scenes: Sequence[str] | None = None,
    quick: bool = False,
    jobs: int = 2,
    only_estimate: bool = False,
    measured: int = live.MEASURED,
    measure: Measure | None = None,
) -> Outcome:
    """Measure. Jobs that were finished in ``folder`` before are not carried out again; Ctrl-C leaves what is finished.

    ``only_estimate``: nothing but the live estimate, to which about ``measured`` increments of each drive are fitted.
    """
    began = time.perf_counter()
    chosen = choose(scenes)
    walks = [Job(n, seed + 1, quick) for n in chosen for seed in range(protocol(n, quick).starts)]
    driven = [drive for name in chosen for drive in drives(name, quick, measured)]
    plan: list[Task] = [*driven] if only_estimate else [*walks, *driven]
    found: dict[Task, dict[str, Any]] = {}
    failures: dict[str, str] = {}
    for job in plan:
        kept = _read(folder, job)
        if kept is not None:
            found[job] = kept
    before = len(found)

    def done(job: Task, data: dict[str, Any]) -> None:
        found[job] = json.loads(json.dumps(data))
        _keep(folder, job, found[job])

    def failed(job: Task, reason: str) -> str:
        failures[job.scene] = reason
        return f"failed: {job.scene}, seed {job.seed}: {reason}"

    batch = Batch(
        measure or execute,
        [job for job in plan if job not in found],
        done,
        failed,
        label=lambda _: "accuracy",
        unit="job",
    )
    try:
        with _one_thread(), Pool(jobs) as pool:
            carry_out_all(batch, pool, jobs)
    except KeyboardInterrupt:
        return Outcome({}, failures, len(found), interrupted=True)
    whole = [name for name in chosen if name not in failures]
    summaries = {
        name: summarise([found[job] for job in walks if job.scene == name])
        for name in whole
        if not only_estimate
    }
    estimates = {
        name: packings
        for name in whole
        if (packings := _calibrated(found, [drive for drive in driven if drive.scene == name]))
    }
    about = {
        "quick": quick,
        "jobs": jobs,
        "finished_before": before,
        "seconds": round(time.perf_counter() - began, 1),
        **machine(),
    }
    statements = {name: accuracy_of(name).statement for name in whole}  # as they are published
    statements |= {name: statement(summary) for name, summary in summaries.items()}
    _write(folder, summaries, estimates, statements, about)
    return Outcome(statements, failures, len(found), interrupted=False)


def execute(job: Task) -> dict[str, Any]:
    """Carry a job out in a process of a pool."""
    if isinstance(job, Drive):
        return live.measure(job, stopping)
    return accuracy_job.measure(job, stopping)


def _calibrated(
    found: Mapping[Task, Mapping[str, Any]], driven: Sequence[Drive]
) -> dict[str, dict[str, Any]]:
    """The estimate of each packing of a scene in which the handle feels a force."""
    kinds = dict.fromkeys(drive.packing for drive in driven)
    one = {
        kind: calibrate({drive.seed: found[drive] for drive in driven if drive.packing == kind})
        for kind in kinds
    }
    return {kind: estimate for kind, estimate in one.items() if estimate is not None}


@contextmanager
def _one_thread() -> Iterator[None]:
    """Processes that begin within the block compute with one thread each."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _read(folder: Path, job: Task) -> dict[str, Any] | None:
    """A finished job; None for one that is not, or a damaged file."""
    try:
        data = json.loads((folder / "runs" / f"{job.key()}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return data if isinstance(data, dict) else None


def _keep(folder: Path, job: Task, data: Mapping[str, Any]) -> None:
    with deferred(), atomic_write(folder / "runs" / f"{job.key()}.json") as file:
        file.write(json.dumps(data).encode())


def _write(
    folder: Path,
    summaries: Mapping[str, Any],
    estimates: Estimates,
    statements: Mapping[str, str],
    about: Mapping[str, Any],
) -> None:
    """Pictures, numbers, tables. Raises InputError if one cannot be written."""
    from sandbox.studies.accuracy.figures import draw_scene, draw_stiffness

    for name, summary in summaries.items():
        draw_scene(name, registry.get(name).title, summary, folder / f"{name}.png")
    if summaries:
        draw_stiffness(summaries, folder / "stiffness.png")
    data = {
        "format": FORMAT,
        "version": VERSION,
        **about,
        "apart": APART,
        "statements": statements,
        "scenes": _rounded(summaries),
        "estimates": _rounded(_without_drives(estimates)),
    }
    text = json.dumps(finite(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    write_text(folder / "results.json", text)
    write_text(folder / "accuracy.md", as_markdown(summaries, estimates, about, APART))
    write_text(folder / "accuracy.toml", as_table(statements, estimates))
    if estimates:
        write_text(folder / "estimate.csv", as_runs(estimates))


def _without_drives(estimates: Estimates) -> dict[str, Any]:
    """The estimates without what each drive came to, which estimate.csv has."""
    return {
        scene: {
            kind: {name: value for name, value in one.items() if name != "drives"}
            for kind, one in packings.items()
        }
        for scene, packings in estimates.items()
    }


def _rounded(value: Any) -> Any:
    """Numbers with as many digits as anybody needs."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, Mapping):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(item) for item in value]
    return value

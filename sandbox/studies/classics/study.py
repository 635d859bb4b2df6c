"""The study of the classics: carry out the runs of all cases, hold each against its closed form or source, write it down."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from core.errors import InputError, did_you_mean
from core.warmup import compile_kernels
from sandbox.ensemble.batch import Batch, carry_out_all
from sandbox.ensemble.machine import machine
from sandbox.ensemble.pool import Pool, Stopped, stopping
from sandbox.files.folder import write_text
from sandbox.studies.classics import clogging, discs, grains, heaps, packings
from sandbox.studies.classics.case import Case, Job, Row, judged
from sandbox.studies.classics.report import Verdict, as_json, as_markdown, as_table
from sandbox.studies.common.kept import keep, read

KEPT = "unfinished.jsonl"  # runs so far, until all are there
CASES: tuple[Case, ...] = (
    *discs.CASES,
    *grains.CASES,
    *packings.CASES,
    *heaps.CASES,
    *clogging.CASES,
)


@dataclass(frozen=True)
class Study:
    """What the study came to: rows of all runs, verdicts, and what went wrong with runs that have none."""

    rows: tuple[Row, ...]
    verdicts: tuple[Verdict, ...]
    failures: tuple[str, ...]
    interrupted: bool


def choose(names: Sequence[str] | None) -> list[Case]:
    """The cases of those names, or all, in their own order. Raises InputError for an unknown name."""
    known = [case.name for case in CASES]
    for name in names or ():
        if name not in known:
            hint = did_you_mean(name, known) or f": there are {', '.join(known)}"
            raise InputError(f"--only {name}: no such case{hint}")
    return [case for case in CASES if not names or case.name in names]


def study(
    folder: Path, *, quick: bool = False, jobs: int = 2, cases: Sequence[Case] = CASES
) -> Study:
    """Carry out all runs. Ctrl-C keeps the finished ones; the same call goes on from there."""
    began = time.perf_counter()
    wanted = {job.key(): job for case in cases for job in case.jobs(quick)}
    kept = folder / KEPT
    rows = {
        key: Row(wanted[key], data["numbers"], data["seconds"])
        for key, data in read(kept).items()
        if key in wanted
    }
    found, failures = len(rows), list[str]()

    def done(job: Job, row: Row) -> None:
        rows[job.key()] = row
        keep(kept, job.key(), {"numbers": row.numbers, "seconds": row.seconds})

    def failed(job: Job, reason: str) -> str:
        failures.append(f"{job}: {reason}")
        return f"failed: {failures[-1]}"

    batch = Batch(
        carry_out,
        [job for key, job in wanted.items() if key not in rows],
        done,
        failed,
        prepare=_compile,
        label=lambda _: "classics",
    )
    try:
        with Pool(jobs) as pool:
            carry_out_all(batch, pool, jobs, found)
    except KeyboardInterrupt:
        return Study(tuple(rows.values()), (), tuple(failures), interrupted=True)
    ordered = [rows[key] for key in wanted if key in rows]
    verdicts = judge(cases, ordered, quick, failures)
    about = {
        "quick": quick,
        "seconds": round(time.perf_counter() - began, 1),
        "runs_from_before": found,
        **machine(),
    }
    write_text(folder / "runs.csv", as_table(ordered))
    write_text(folder / "results.json", as_json(verdicts, failures, about))
    write_text(folder / "classics.md", as_markdown(verdicts, ordered, failures, about))
    if not failures:
        kept.unlink(missing_ok=True)
    return Study(tuple(ordered), tuple(verdicts), tuple(failures), interrupted=False)


def judge(
    cases: Sequence[Case], rows: Sequence[Row], quick: bool, failures: list[str]
) -> list[Verdict]:
    """Verdicts on all cases together; one whose runs are not all there is a failure, and is told in ``failures``."""
    found = []
    for case in cases:
        mine = [row for row in rows if row.job.case == case.name]
        if len(mine) < len(case.jobs(quick)):
            failures.append(f"{case.name}: not judged, since not all of its runs are there")
            continue
        found += [(case, check) for check in case.judge(mine)]
    settled = judged([check for _, check in found])
    return [
        (case, check, verdict, p)
        for (case, check), (verdict, p) in zip(found, settled, strict=True)
    ]


def carry_out(job: Job) -> Row:
    """One run, in a process of the pool or in this one. Raises Stopped."""

    def check() -> None:
        if stopping():
            raise Stopped

    case = next(case for case in CASES if case.name == job.case)
    began = time.process_time()
    numbers = case.run(job, check)
    return Row(job, numbers, round(time.process_time() - began, 3))


def _compile() -> None:
    """Every sort of kernels that the cases use, once."""
    for periodic, rigid, friction, gravity in (
        (False, True, False, False),
        (True, False, False, False),
        (False, True, True, False),
        (False, True, True, True),
        (True, True, False, True),
        (True, True, True, True),
    ):
        compile_kernels(periodic=periodic, rigid=rigid, friction=friction, gravity=gravity)

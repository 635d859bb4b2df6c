"""The study of stability: hard cases, each with what is expected of it, what came of it, and a verdict."""

from __future__ import annotations

import itertools
import json
import sys
import time
from collections.abc import Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

from core.warmup import compile_kernels
from sandbox import __version__
from sandbox.bars import bar_options
from sandbox.interrupts import deferred
from sandbox.studies.common.folder import machine, write_text
from sandbox.studies.common.pool import Pool, stopping
from sandbox.studies.stability import material as stability_material
from sandbox.studies.stability import numbers as stability_numbers
from sandbox.studies.stability import paths as stability_paths
from sandbox.studies.stability import places as stability_places
from sandbox.studies.stability import report as stability_report
from sandbox.studies.stability import scenes as stability_scenes
from sandbox.studies.stability.case import CRASHED, FAILS, Case, Outcome, carry_out

UNFINISHED = "unfinished.jsonl"  # outcomes so far, until all are there
PARTS = (
    stability_paths,  # the longest first
    stability_places,
    stability_scenes,
    stability_material,
    stability_numbers,
)
LOST = "the process that ran it ended without a word"


@dataclass(frozen=True)
class Study:
    """What the study came to."""

    outcomes: tuple[Outcome, ...]
    interrupted: bool


def all_cases(quick: bool = False) -> dict[tuple[str, str], Case]:
    """All cases by group and name; ``quick`` leaves out the longest."""
    cases = itertools.chain.from_iterable(part.cases() for part in PARTS)
    return {(case.group, case.name): case for case in cases if case.quick or not quick}


def study(
    folder: Path,
    *,
    quick: bool = False,
    jobs: int = 2,
    cases: Sequence[Case] | None = None,
    warm: bool = True,
) -> Study:
    """Carry out all cases. Ctrl-C keeps the finished ones; the same call goes on from there.

    Without ``warm`` kernels are compiled as cases need them, in their time.
    """
    began = time.perf_counter()
    chosen = list(all_cases(quick).values() if cases is None else cases)
    kept = folder / UNFINISHED
    known = {(o.group, o.name): o for o in _read(kept, quick)}
    outcomes = [known[key] for case in chosen if (key := (case.group, case.name)) in known]
    waiting = [case for case in chosen if (case.group, case.name) not in known]
    try:
        _run(waiting, kept, quick, jobs, outcomes, warm)
    except KeyboardInterrupt:
        return Study(tuple(outcomes), interrupted=True)
    order = {(case.group, case.name): k for k, case in enumerate(chosen)}
    outcomes.sort(key=lambda outcome: order[outcome.group, outcome.name])
    about = {
        "quick": quick,
        "seconds": round(time.perf_counter() - began, 1),
        "jobs": jobs,
        **machine(),
    }
    write_text(folder / "results.json", stability_report.as_json(outcomes, about))
    write_text(folder / "stability.md", stability_report.as_markdown(outcomes, about))
    stability_report.draw(outcomes, folder)
    kept.unlink(missing_ok=True)
    return Study(tuple(outcomes), interrupted=False)


def _run(
    waiting: list[Case],
    kept: Path,
    quick: bool,
    jobs: int,
    outcomes: list[Outcome],
    warm: bool,
) -> None:
    from tqdm import tqdm

    known = len(outcomes)
    with (
        Pool(jobs) as pool,
        tqdm(total=len(waiting) + known, initial=known, unit="case", **bar_options()) as bar,
    ):
        if warm:
            bar.set_description_str("compiling")
            pool.call(_compile).exception()  # what fails here fails again, and is told then
        bar.set_description_str("cases")
        for case, future in pool.each(_carry_out, waiting, lambda c: (c.group, c.name, quick)):
            outcome = _outcome(future, case)
            outcomes.append(outcome)
            _keep(kept, outcome, quick)
            bar.update()
            if outcome.verdict == FAILS:
                bar.write(f"FAILS: {outcome.group}: {outcome.name}", file=sys.stderr)


def _outcome(future: Future[Outcome], case: Case) -> Outcome:
    error = future.exception()
    if error is None:
        return future.result()
    why = LOST if isinstance(error, BrokenProcessPool) else f"{type(error).__name__}: {error}"
    return Outcome(case.group, case.name, case.expectation, CRASHED, why, FAILS)


def _carry_out(group: str, name: str, quick: bool) -> Outcome:
    """In a process of the pool."""
    return carry_out(all_cases()[group, name], quick, stopping)


def _compile() -> None:
    """Every sort of kernels that cases use, once, so that their times are their own."""
    for periodic, rigid, friction, gravity in itertools.product((False, True), repeat=4):
        if gravity and periodic:
            continue
        compile_kernels(periodic=periodic, rigid=rigid, friction=friction, gravity=gravity)


def _keep(path: Path, outcome: Outcome, quick: bool) -> None:
    line = json.dumps({"version": __version__, "quick": quick, **outcome.as_data()})
    with deferred(), path.open("a", encoding="utf-8") as file:
        file.write(line + "\n")


def _read(path: Path, quick: bool) -> list[Outcome]:
    """Outcomes that an interrupted study has left; damaged lines and those of other versions are done again."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return []
    found = []
    for line in lines:
        try:
            data = json.loads(line)
            if data.pop("version") == __version__ and data.pop("quick") == quick:
                found.append(Outcome.from_data(data))
        except (ValueError, KeyError, TypeError, AttributeError):
            continue
    return found

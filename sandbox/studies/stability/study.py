"""The study of stability: hard cases, each with what is expected of it, what came of it, and a verdict."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from core.warmup import compile_kernels
from sandbox import __version__
from sandbox.ensemble.batch import Batch, carry_out_all
from sandbox.ensemble.machine import machine
from sandbox.ensemble.pool import Pool, stopping
from sandbox.files.folder import write_text
from sandbox.studies.common.kept import add, lines
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
Key = tuple[str, str]  # group and name of a case


@dataclass(frozen=True)
class Study:
    """What the study came to."""

    outcomes: tuple[Outcome, ...]
    interrupted: bool


def all_cases(quick: bool = False) -> dict[Key, Case]:
    """All cases by group and name; ``quick`` leaves out the longest."""
    cases = itertools.chain.from_iterable(part.cases() for part in PARTS)
    return _by_name(case for case in cases if case.quick or not quick)


def _by_name(cases: Iterable[Case]) -> dict[Key, Case]:
    return {(case.group, case.name): case for case in cases}


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
    chosen = all_cases(quick) if cases is None else _by_name(cases)
    kept = folder / UNFINISHED
    known = {(o.group, o.name): o for o in _read(kept, quick)}
    outcomes = {key: known[key] for key in chosen if key in known}

    def done(key: Key, outcome: Outcome) -> str | None:
        outcomes[key] = outcome
        _keep(kept, outcome, quick)
        return f"FAILS: {outcome.group}: {outcome.name}" if outcome.verdict == FAILS else None

    def failed(key: Key, reason: str) -> str | None:
        return done(key, Outcome(*key, chosen[key].expectation, CRASHED, reason, FAILS))

    batch = Batch(
        partial(_carry_out, quick=quick),
        [key for key in chosen if key not in known],
        done,
        failed,
        prepare=_compile if warm else None,
        label=lambda _: "cases",
        unit="case",
    )
    try:
        with Pool(jobs) as pool:
            carry_out_all(batch, pool, jobs, len(outcomes))
    except KeyboardInterrupt:
        return Study(tuple(outcomes.values()), interrupted=True)
    ordered = [outcomes[key] for key in chosen]
    about = {
        "quick": quick,
        "seconds": round(time.perf_counter() - began, 1),
        "jobs": jobs,
        **machine(),
    }
    write_text(folder / "results.json", stability_report.as_json(ordered, about))
    write_text(folder / "stability.md", stability_report.as_markdown(ordered, about))
    stability_report.draw(ordered, folder)
    kept.unlink(missing_ok=True)
    return Study(tuple(ordered), interrupted=False)


def _carry_out(key: Key, quick: bool) -> Outcome:
    """In a process of the pool: a case cannot be sent there, its name can."""
    return carry_out(all_cases()[key], quick, stopping)


def _compile() -> None:
    """Every sort of kernels that cases use, once, so that their times are their own."""
    for periodic, rigid, friction, gravity in itertools.product((False, True), repeat=4):
        if gravity and periodic:
            continue
        compile_kernels(periodic=periodic, rigid=rigid, friction=friction, gravity=gravity)


def _keep(path: Path, outcome: Outcome, quick: bool) -> None:
    add(path, {"version": __version__, "quick": quick, **outcome.as_data()})


def _read(path: Path, quick: bool) -> list[Outcome]:
    """Outcomes that an interrupted study has left; damaged lines and those of other versions are done again."""
    found = []
    for data in lines(path):
        if data.pop("version", None) == __version__ and data.pop("quick", None) == quick:
            with suppress(ValueError, KeyError, TypeError, AttributeError):
                found.append(Outcome.from_data(data))
    return found

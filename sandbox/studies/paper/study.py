"""The study of the paper's claims: which runs are needed, carry them out, judge, write tables and figures.

Haver, Acuña et al., "Elasticity and rheology of auxetic granular metamaterials", PNAS 2024, doi:10.1073/pnas.2317915121.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from core.errors import InputError, did_you_mean
from sandbox.ensemble.machine import machine
from sandbox.files.folder import write_text
from sandbox.studies.paper import bulk as paper_bulk
from sandbox.studies.paper import grains as paper_grains
from sandbox.studies.paper import hopper as paper_hopper
from sandbox.studies.paper import intruder as paper_intruder
from sandbox.studies.paper import quakes as paper_quakes
from sandbox.studies.paper.claims import Claim, Unmeasurable, settle
from sandbox.studies.paper.cost import estimate
from sandbox.studies.paper.report import Judged, as_json, as_markdown, as_table
from sandbox.studies.paper.runs import Request, Result, Store, run_all
from sandbox.studies.paper.shear import dilatancy, small_cycles, steady

CLAIMS: tuple[Claim, ...] = (
    *paper_grains.CLAIMS,
    *paper_bulk.CLAIMS,
    *small_cycles.CLAIMS,
    *steady.CLAIMS,
    *dilatancy.CLAIMS,
    *paper_quakes.CLAIMS,
    *paper_intruder.CLAIMS,
    *paper_hopper.CLAIMS,
)


@dataclass(frozen=True)
class Outcome:
    """What a study came to."""

    judged: tuple[Judged, ...]
    runs: int
    failed: int
    interrupted: bool


def choose(names: Sequence[str] | None, claims: Sequence[Claim] = CLAIMS) -> list[Claim]:
    """The claims of those names, or all, in their own order. Raises InputError for an unknown name."""
    known = [claim.name for claim in claims]
    for name in names or ():
        if name not in known:
            hint = did_you_mean(name, known) or f": there are {', '.join(known)}"
            raise InputError(f"--only {name}: no such claim{hint}")
    return [claim for claim in claims if not names or claim.name in names]


def study(
    folder: Path,
    *,
    quick: bool = False,
    only: Sequence[str] | None = None,
    jobs: int = 2,
    claims: Sequence[Claim] = CLAIMS,
) -> Outcome:
    """Measure the claims. Everything that was finished in ``folder`` before is not run again.

    Ctrl-C ends it with nothing but the finished runs kept; the outcome says so.
    """
    began = time.perf_counter()
    chosen = choose(only, claims)
    plans = {claim.name: tuple(claim.runs(quick)) for claim in chosen}
    store = Store(folder / "runs")
    results: dict[Request, Result] = {}
    missing: list[Request] = []
    for request in dict.fromkeys(request for plan in plans.values() for request in plan):
        kept = store.read(request)
        if kept is None:
            missing.append(request)
        else:
            results[request] = kept
    found = len(results)

    def done(result: Result) -> None:
        results[result.request] = result

    try:
        run_all(missing, store, jobs, done, results.values(), found)
    except KeyboardInterrupt:
        return Outcome((), len(results), _failures(results), interrupted=True)
    judged = judge(chosen, plans, results)
    seconds = time.perf_counter() - began
    about = {"quick": quick, "seconds": round(seconds, 1), "runs_from_before": found, **machine()}
    used: dict[Request, list[str]] = {}
    for claim in chosen:
        for request in plans[claim.name]:
            used.setdefault(request, []).append(claim.name)
    rows = [results[request] for request in used]
    write_text(folder / "runs.csv", as_table(rows, used))
    write_text(folder / "results.json", as_json(judged, rows, about))
    write_text(folder / "claims.md", as_markdown(judged, rows, about, estimate(rows)))
    _draw(chosen, plans, results, folder)
    return Outcome(judged, len(results), _failures(results), interrupted=False)


def judge(
    claims: Sequence[Claim],
    plans: dict[str, tuple[Request, ...]],
    results: dict[Request, Result],
) -> tuple[Judged, ...]:
    """Verdicts on all parts of all claims together, since each is corrected for the number of all."""
    found = [claim.find([results[request] for request in plans[claim.name]]) for claim in claims]
    settled = iter(settle([finding for findings in found for finding in findings]))
    return tuple(
        Judged(claim, tuple(islice(settled, len(findings))))
        for claim, findings in zip(claims, found, strict=True)
    )


def _draw(
    claims: Sequence[Claim],
    plans: dict[str, tuple[Request, ...]],
    results: dict[Request, Result],
    folder: Path,
) -> None:
    """The figures whose runs have all succeeded."""
    from sandbox.studies.paper.figures import draw

    for claim in claims:
        mine = [results[request] for request in plans[claim.name]]
        short = claim.bears_short_runs
        if any(result.failure or (result.ended and not short) for result in mine):
            continue
        for figure in claim.figures:
            with suppress(Unmeasurable):  # the verdicts say why
                draw(figure, mine, folder / f"{figure.file}.png")


def _failures(results: dict[Request, Result]) -> int:
    return sum(result.failure is not None for result in results.values())

"""The study of clogging: carry out its sweeps, one after the other, judge all claims together, write it down with pictures."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from core.errors import InputError, did_you_mean
from sandbox.ensemble.machine import machine
from sandbox.files.folder import write_text
from sandbox.studies.classics.case import judged
from sandbox.studies.clogging.claims import CLAIMS, Found
from sandbox.studies.clogging.figure import draw_hazard
from sandbox.studies.clogging.parts import PARTS, WIDTHS, Part
from sandbox.studies.clogging.report import Verdict, as_json, as_markdown
from sandbox.sweep.outcome import FAILED
from sandbox.sweep.page import write_page
from sandbox.sweep.pictures import draw_all
from sandbox.sweep.summary import Cell, cells
from sandbox.sweep.sweep import Ways, sweep
from sandbox.sweep.tables import Tables, is_sweep, read_request


@dataclass(frozen=True)
class Study:
    """What it came to: verdicts, runs, and how many of these failed."""

    verdicts: tuple[Verdict, ...]
    runs: int
    failed: int
    interrupted: bool


def choose(names: Sequence[str] | None) -> list[Part]:
    """The parts of those names, or all, in their own order. Raises InputError for an unknown name."""
    known = [part.name for part in PARTS]
    for name in names or ():
        if name not in known:
            hint = did_you_mean(name, known) or f": there are {', '.join(known)}"
            raise InputError(f"--only {name}: no such part{hint}")
    return [part for part in PARTS if not names or part.name in names]


def study(folder: Path, ways: Ways, parts: Sequence[Part] = PARTS, *, quick: bool = False) -> Study:
    """Carry out the sweeps of ``parts``; claims look at all that the folder holds. Ctrl-C keeps what is finished.

    Raises InputError where the folder holds other sweeps, quick ones for one.
    """
    began = time.perf_counter()
    found: dict[str, list[Cell]] = {part.name: [] for part in PARTS}
    whole = True
    for part in PARTS:
        place = folder / part.name
        asked = part.request(quick)
        if part not in parts and not is_sweep(str(place)):
            continue
        if is_sweep(str(place)):
            there = read_request(place)
            if there.key() != asked.key():
                raise InputError(
                    f"{place}: another sweep is there, a quick one perhaps; give another --out"
                )
            asked = there if there.runs > asked.runs else asked  # somebody has added seeds
        tables = Tables(place, asked)
        try:
            whole = sweep(tables, ways) if part in parts and whole else whole
            found[part.name] = cells(tables)
        finally:
            tables.close()
        if not whole:
            break
        write_page(place, asked, found[part.name], draw_all(asked, found[part.name], place), {})
    outcomes = sum((cell.outcomes for some in found.values() for cell in some), Counter[str]())
    runs, failed = outcomes.total(), outcomes[FAILED]
    if not whole:
        return Study((), runs, failed, interrupted=True)
    verdicts = judge(found)
    about = {"quick": quick, "seconds": round(time.perf_counter() - began, 1), **machine()}
    about["hazard"] = draw_hazard(found[WIDTHS.name], folder)
    write_text(folder / "results.json", as_json(verdicts, found, about))
    write_text(folder / "clogging.md", as_markdown(verdicts, found, about))
    return Study(tuple(verdicts), runs, failed, interrupted=False)


def judge(found: Found) -> list[Verdict]:
    """Verdicts on all claims together, since each is corrected for the number of all."""
    checks = [(claim, check) for claim in CLAIMS for check in claim.find(found)]
    settled = judged([check for _, check in checks])
    return [
        (claim, check, verdict, p)
        for (claim, check), (verdict, p) in zip(checks, settled, strict=True)
    ]

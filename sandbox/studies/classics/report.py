"""What the study of the classics found: a table of all cases in Markdown, one row a run as CSV, and all of it as JSON."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from sandbox.ensemble.estimates import CONFIDENCE, Exact
from sandbox.files import cells
from sandbox.studies.classics.case import FIRST, Case, Check, Row
from sandbox.studies.common.finite import finite
from sandbox.studies.common.verdicts import FAILS, HOLDS, OPEN

FORMAT = "auxetic-sandbox study of the classics"
VERSION = 1
Verdict = tuple[Case, Check, str, float]


def as_markdown(
    verdicts: Sequence[Verdict],
    rows: Sequence[Row],
    failures: Sequence[str],
    about: Mapping[str, Any],
) -> str:
    """The cases, each with its source, what was measured, what was expected, and why within that."""
    quick = " --quick" if about.get("quick") else ""
    counts = Counter(verdict for _, _, verdict, _ in verdicts)
    chance = sum(not isinstance(check.estimate, Exact) for _, check, _, _ in verdicts)
    told = ", ".join(f"{counts[v]} {v}" for v in (HOLDS, FAILS, OPEN) if counts[v])
    lines = [
        "# Classics",
        "",
        (
            f"From `python -m sandbox study classics --out DIR{quick}`: textbook and published cases, {len(verdicts)} numbers: "
            f"{told}. {len(rows)} runs, {len(failures) or 'none'} failed; "
            f"{sum(row.seconds for row in rows) / 60.0:.1f} minutes of one core. Intervals are {CONFIDENCE:.0%} each; a verdict "
            f"takes a p-value below {1.0 - CONFIDENCE:.2f} after Holm's correction over the {chance} numbers that are a matter "
            f"of chance. Seeds from {FIRST} on judge; protocols were tried on seeds "
            "below. Lengths in R, forces in k R. One row a run: [runs.csv](runs.csv)."
        ),
    ]
    for case in dict.fromkeys(case for case, _, _, _ in verdicts):
        mine = [verdict for verdict in verdicts if verdict[0] is case]
        lines += ["", f"## {case.title}", "", f"`{case.name}`. {case.source}."]
        if case.limits:
            lines += ["", f"Limits: {case.limits}."]
        lines += ["", "| measured | expected | must be | verdict |", "| --- | --- | --- | --- |"]
        for _, check, verdict, p in mine:
            sure = "" if isinstance(check.estimate, Exact) else f", p {p:.2g}"
            lines.append(
                f"| {cell(check.quantity)}: {value(check)}{_seeds(check)} | {cell(check.expected)} | {must(check)} | "
                f"**{verdict}**{sure} |"
            )
        reasons = dict.fromkeys(f"- {must(check)}: {check.reason}." for _, check, _, _ in mine)
        lines += ["", *reasons]
    if failures:
        lines += ["", "## Runs that failed", "", *(f"- {failure}" for failure in failures)]
    return "\n".join([*lines, ""])


def value(check: Check) -> str:
    """What was measured, with its interval."""
    if isinstance(check.estimate, Exact):
        return f"{check.estimate.value:.6g}"
    low, high = check.estimate.interval()
    return f"{check.estimate.value:.4g} ({low:.4g} to {high:.4g})"


def _seeds(check: Check) -> str:
    return f", {len(check.seeds)} seeds" if check.seeds else ""


def must(check: Check) -> str:
    """What is demanded of it."""
    low, high = check.demand.low, check.demand.high
    if low > float("-inf") and high < float("inf"):
        return f"{low:.6g} to {high:.6g}"
    return f"above {low:.4g}" if low > float("-inf") else f"below {high:.4g}"


def cell(text: str) -> str:
    """Text that fits a table."""
    return " ".join(text.split()).replace("|", "\\|")


def as_table(rows: Sequence[Row]) -> str:
    """One row a run: case, seed, its settings, what was measured, seconds of one core."""
    settings = sorted({name for row in rows for name, _ in row.job.settings})
    numbers = sorted({name for row in rows for name in row.numbers})
    header = ["case", "seed", *settings, *(f"measured_{name}" for name in numbers), "seconds"]
    written: list[Sequence[object]] = [header]
    for row in rows:
        asked = dict(row.job.settings)
        found = [f"{row.numbers[n]:.10g}" if n in row.numbers else "" for n in numbers]
        told = [asked.get(name, "") for name in settings]
        written.append([row.job.case, row.job.seed or "", *told, *found, f"{row.seconds:.3f}"])
    return cells.lines(written)


def as_json(verdicts: Sequence[Verdict], failures: Sequence[str], about: Mapping[str, Any]) -> str:
    """Every number with its interval, tolerance and reason."""
    data = {
        "format": FORMAT,
        "version": VERSION,
        **about,
        "failures": failures,
        "checks": [
            {
                "case": case.name,
                "source": case.source,
                **check.data(verdict, p),
                "seeds": list(check.seeds),
            }
            for case, check, verdict, p in verdicts
        ],
    }
    return json.dumps(finite(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n"

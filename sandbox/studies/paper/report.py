"""What a study found: tables in Markdown, one row a run as CSV, and JSON with the values behind every verdict."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.ensemble.estimates import CONFIDENCE, Exact
from sandbox.files import cells
from sandbox.studies.common.finite import finite
from sandbox.studies.paper.claims import (
    NOT_MEASURED,
    VERDICTS,
    Claim,
    Finding,
    Reading,
    number,
    with_interval,
)
from sandbox.studies.paper.conditions import FIRST, SETTING_UP
from sandbox.studies.paper.cost import Estimated
from sandbox.studies.paper.runs import Request, Result

FORMAT = "auxetic-sandbox study"
VERSION = 2


@dataclass(frozen=True)
class Judged:
    """A claim and what was found about each of its parts."""

    claim: Claim
    findings: tuple[Finding, ...]


def as_markdown(
    judged: Sequence[Judged],
    results: Sequence[Result],
    about: Mapping[str, Any],
    costs: Sequence[Estimated] = (),
) -> str:
    """How it was judged; verdicts claim by claim; each claim with its parts; what was not matched, and would cost."""
    lines = [
        "# Claims of the paper, measured",
        "",
        (
            "Haver, Acuña et al., *Elasticity and rheology of auxetic granular metamaterials*, PNAS 2024, "
            "[doi:10.1073/pnas.2317915121](https://doi.org/10.1073/pnas.2317915121). "
            "Lengths in R, the radius of a large grain, stresses in k, the stiffness of a grain; λ is the paper's, its μ is 0.1. "
            "One row a run: [runs.csv](runs.csv)."
        ),
        "",
        *_how(judged),
        "",
        "| claim | the paper's words | " + " | ".join(VERDICTS) + " |",
        "| --- | --- |" + " --- |" * len(VERDICTS),
    ]
    for row in judged:
        counts = Counter(finding.verdict for finding in row.findings)
        cells = " | ".join(str(counts[verdict] or "") for verdict in VERDICTS)
        lines.append(
            f"| [`{row.claim.name}`](#{row.claim.name}) | {_quoted(row.claim)} | {cells} |"
        )
    for row in judged:
        lines += ["", f"## {row.claim.name}", "", f"{row.claim.source}: {_quoted(row.claim)}", ""]
        lines += _parts(row.findings)
        lines += _notes(row.findings)
    if costs:
        lines += ["", "## What the paper's own conditions would cost", "", *_costs(costs)]
    lines += ["", _footnote(results, about), ""]
    return "\n".join(lines)


def _how(judged: Sequence[Judged]) -> list[str]:
    findings = [finding for row in judged for finding in row.findings]
    chance = [
        f for f in findings if f.reading is not None and not isinstance(f.reading.estimate, Exact)
    ]
    counts = Counter(finding.verdict for finding in findings)
    told = ", ".join(f"{counts[verdict]} {verdict}" for verdict in VERDICTS if counts[verdict])
    return [
        (
            "Each sentence is taken apart into what it asserts, and each part is judged by itself: "
            f"{len(findings)} parts, {told}. Intervals are {CONFIDENCE:.0%} each: Student's t over seeds, for ratios by "
            "Fieller's theorem seed by seed, for shares Wilson's. A verdict takes a p-value below "
            f"{1.0 - CONFIDENCE:.2f} after Holm's correction over all {len(chance)} verdicts of this study that rest on chance, "
            "for “does not hold” as well as for “holds”; what has neither is not established, and neither is what holds while a "
            "variation of size, step or pressure contradicts it. Thresholds were written down, with their reasons, on seeds "
            f"{SETTING_UP[0]} to {SETTING_UP[-1]}; seeds from {FIRST} on judge."
        )
    ]


def _parts(findings: Sequence[Finding]) -> list[str]:
    lines = [
        "| it says | measured (95 %) | must be | p (Holm) | verdict |",
        "| --- | --- | --- | --- | --- |",
    ]
    for finding in findings:
        part = finding.part
        if finding.reading is None:
            measured, p = _cell(finding.why), "–"
        else:
            measured = f"{part.quantity}: {with_interval(finding.reading.estimate)}"
            exact = isinstance(finding.reading.estimate, Exact)
            p = "no chance" if exact or finding.p is None else number(finding.p, 2)
        why = f": {finding.why}" if finding.why and finding.reading is not None else ""
        lines.append(
            f"| {part.aspect}: {_cell(part.says)} | {_cell(measured)} | {part.threshold} | {p} | "
            f"**{finding.verdict}**{_cell(why)} |"
        )
    return lines


def _notes(findings: Sequence[Finding]) -> list[str]:
    """Reasons of thresholds, means behind the ratios, remarks and variations, each once."""
    notes: dict[str, None] = {}
    for finding in findings:
        threshold = finding.part.threshold
        notes[f"Must be {threshold}: {threshold.reason}."] = None
    for finding in findings:
        if finding.reading is not None:
            notes.update(dict.fromkeys(_about(finding.part.quantity, finding.reading)))
        for varied in finding.varied:
            told = varied.why if varied.reading is None else with_interval(varied.reading.estimate)
            notes[f"{finding.part.quantity}, with {varied.condition}: {told}."] = None
    return ["", *(f"- {_cell(note)}" for note in notes)]


def _about(quantity: str, reading: Reading) -> list[str]:
    told = [str(m) for m in reading.measured]
    told += [reading.remark] if reading.remark else []
    return [f"{quantity}: {'; '.join(told)}."] if told else []


def _costs(costs: Sequence[Estimated]) -> list[str]:
    lines = [
        (
            "Extrapolated from the seconds of the runs above to the paper's number of systems and of steps. Finer steps cost "
            "what they were measured to cost where both were run, else in proportion to their number."
        ),
        "",
        "| protocol | here | the paper | runs | hours of one core |",
        "| --- | --- | --- | --- | --- |",
    ]
    lines += [
        f"| {cost.protocol} | {cost.here} | {cost.paper} | {cost.runs} | {number(cost.hours, 2)} |"
        for cost in costs
    ]
    return lines


def _footnote(results: Sequence[Result], about: Mapping[str, Any]) -> str:
    good = [result for result in results if result.failure is None]
    increments = sum(result.increments for result in good)
    converged = sum(result.converged * result.increments for result in good)
    share = f"{converged / increments:.1%}" if increments else "none"
    work = sum(result.seconds for result in good)
    quick = "quick, " if about.get("quick") else ""
    failed = len(results) - len(good)
    short = sum(result.ended is not None for result in good)
    return (
        f"{len(good)} runs ({quick}{failed or 'none'} failed, {short or 'none'} ended early), "
        f"{increments} increments, {share} of them converged to the scene's tolerance within its budget; "
        f"{work / 60.0:.1f} minutes of one core."
    )


def _quoted(claim: Claim) -> str:
    words = _cell(claim.words)
    return words if words.startswith("(") else f"“{words}”"


def _cell(text: str) -> str:
    """Text that cannot break out of a table's cell."""
    return " ".join(text.split()).replace("|", "\\|")


def as_table(results: Sequence[Result], used: Mapping[Request, Sequence[str]]) -> str:
    """One row a run: what was asked, how it ended, and for each of its columns mean, largest and last value; units as in probes.

    ``used`` names the claims that a run serves.
    """
    settings = sorted({name for r in results for name, _ in r.request.settings})
    columns = sorted({name for r in results for name in r.columns})
    lists = sorted({name for r in results for name in r.lists if "histogram" not in name})
    header = ["claims", "scene", "packing", "seed", *settings, "probe", "increments", "converged"]
    header += ["seconds", "ended_early", "failure"]
    header += [f"{name}_{what}" for name in columns for what in ("mean", "max", "last")]
    header += [f"{name}_{what}" for name in lists for what in ("count", "mean")]
    written: list[Sequence[object]] = [header]
    for result in results:
        request = result.request
        asked = dict(request.settings)
        row: list[object] = [" ".join(used.get(request, ())), request.scene, request.packing]
        row += [request.seed, *(asked.get(name, "") for name in settings), request.probe]
        row += [result.increments, f"{result.converged:.6g}", f"{result.seconds:.3f}"]
        row += [result.ended or "", result.failure or ""]
        for name in columns:
            values = result.columns.get(name)
            row += _three(values) if values else ["", "", ""]
        for name in lists:
            entries = result.lists.get(name)
            row += (
                ["", ""]
                if entries is None
                else [len(entries), _told(float(np.mean(entries))) if entries else ""]
            )
        written.append(row)
    return cells.lines(written)


def _three(values: Sequence[float]) -> list[str]:
    row = np.asarray(values, dtype=np.float64)
    return [_told(value) for value in (row.mean(), row.max(), row[-1])]


def _told(value: float) -> str:
    """Nothing that is not finite reaches the table."""
    return f"{value:.8g}" if np.isfinite(value) else ""


def as_json(judged: Sequence[Judged], results: Sequence[Result], about: Mapping[str, Any]) -> str:
    """Every verdict, with one number a seed."""
    data = {
        "format": FORMAT,
        "version": VERSION,
        **about,
        "runs": len(results),
        "claims": [
            {
                "name": row.claim.name,
                "source": row.claim.source,
                "words": row.claim.words,
                "parts": [_part(finding) for finding in row.findings],
            }
            for row in judged
        ],
    }
    return json.dumps(finite(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _part(finding: Finding) -> dict[str, Any]:
    part, demand = finding.part, finding.part.threshold.demand
    return {
        "aspect": part.aspect,
        "says": part.says,
        "quantity": part.quantity,
        "low": demand.low,
        "high": demand.high,
        "reason": part.threshold.reason,
        "verdict": finding.verdict,
        "p_holm": finding.p,
        "why": finding.why,
        **_numbers(finding.reading),
        "variations": [
            {"condition": varied.condition, "why": varied.why, **_numbers(varied.reading)}
            for varied in finding.varied
        ],
    }


def _numbers(reading: Reading | None) -> dict[str, Any]:
    if reading is None:
        return {"value": None, "interval": None, "measured": [], "remark": ""}
    return {
        "value": reading.estimate.value,
        "interval": list(reading.estimate.interval()),
        "measured": [
            {"what": m.what, "unit": m.unit, "values": list(m.values)} for m in reading.measured
        ],
        "remark": reading.remark,
    }


def summary(judged: Sequence[Judged]) -> list[str]:
    """One line a part, for a terminal."""
    width = max((len(row.claim.name) for row in judged), default=0)
    longest = max(len(verdict) for verdict in (*VERDICTS, NOT_MEASURED))
    return [
        f"{row.claim.name:<{width}}  {finding.verdict:<{longest}}  {finding.part.aspect}: {finding.decided_by}"
        for row in judged
        for finding in row.findings
    ]

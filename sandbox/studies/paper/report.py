"""What a study found: as a table in Markdown, and as JSON with everything behind it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sandbox.studies.common.folder import finite
from sandbox.studies.paper.claims import Claim, Finding
from sandbox.studies.paper.runs import Result

FORMAT = "auxetic-sandbox study"
VERSION = 1


@dataclass(frozen=True)
class Judged:
    """A claim and what was found about it."""

    claim: Claim
    finding: Finding


def as_markdown(
    judged: Sequence[Judged], results: Sequence[Result], about: Mapping[str, Any]
) -> str:
    """One row a claim; what else is to be said about it stands below the table."""
    lines = [
        "# Claims of the paper, measured",
        "",
        (
            "Haver, Acuña et al., *Elasticity and rheology of auxetic granular metamaterials*, PNAS 2024, "
            "[doi:10.1073/pnas.2317915121](https://doi.org/10.1073/pnas.2317915121). "
            "Numbers are means ± standard deviations over seeds; a ratio carries its standard error. "
            "Lengths in R, the radius of a large grain, stresses in k, the stiffness of a grain."
        ),
        "",
        "| claim | the paper's words | measured | verdict |",
        "| --- | --- | --- | --- |",
    ]
    for row in judged:
        claim, finding = row.claim, row.finding
        measured = "<br>".join(_cell(str(m)) for m in finding.measured) or "—"
        verdict = f"**{finding.verdict}**: {_cell(finding.decided_by)}"
        words = f"“{_cell(claim.words)}”" if not claim.words.startswith("(") else _cell(claim.words)
        lines.append(
            f"| `{claim.name}` ({_cell(claim.source)}) | {words} | {measured} | {verdict} |"
        )
    remarks = [row for row in judged if row.finding.remark]
    if remarks:
        lines += ["", "## Remarks", ""]
        lines += [f"- `{row.claim.name}`: {row.finding.remark}." for row in remarks]
    lines += ["", _footnote(results, about), ""]
    return "\n".join(lines)


def _footnote(results: Sequence[Result], about: Mapping[str, Any]) -> str:
    good = [result for result in results if result.failure is None]
    increments = sum(_increments(result) for result in good)
    converged = sum(result.converged * _increments(result) for result in good)
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


def _increments(result: Result) -> int:
    return max(len(result.columns.get("stroke", ())) - 1, 0)


def _cell(text: str) -> str:
    """Text that cannot break out of a table's cell."""
    return " ".join(text.split()).replace("|", "\\|")


def as_json(judged: Sequence[Judged], results: Sequence[Result], about: Mapping[str, Any]) -> str:
    """Everything, with one number a seed."""
    data = {
        "format": FORMAT,
        "version": VERSION,
        **about,
        "claims": [
            {
                "name": row.claim.name,
                "source": row.claim.source,
                "words": row.claim.words,
                "verdict": row.finding.verdict,
                "decided_by": row.finding.decided_by,
                "remark": row.finding.remark,
                "measured": [
                    {
                        "what": measured.what,
                        "unit": measured.unit,
                        "values": list(measured.values),
                        "mean": measured.mean,
                        "spread": measured.spread,
                    }
                    for measured in row.finding.measured
                ],
            }
            for row in judged
        ],
        "runs": [
            {
                "file": f"runs/{result.request.key()}.json",
                "scene": result.request.scene,
                "packing": result.request.packing,
                "seed": result.request.seed,
                "settings": dict(result.request.settings),
                "increments": _increments(result),
                "converged": result.converged,
                "seconds": round(result.seconds, 3),
                "ended_early": result.ended,
                "failure": result.failure,
            }
            for result in results
        ],
    }
    return json.dumps(finite(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n"

"""What the study of clogging found: claims with verdicts, tables of cells, what the answer depends on, what it costs."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from sandbox.ensemble.estimates import CONFIDENCE
from sandbox.studies.classics.case import Check
from sandbox.studies.classics.report import cell as escaped
from sandbox.studies.classics.report import must, value
from sandbox.studies.clogging.claims import Claim, Found
from sandbox.studies.clogging.figure import FIGURE
from sandbox.studies.clogging.parts import FIRST, PARTS, SAME, SHARES, STRENGTHS, Part
from sandbox.studies.common.finite import finite
from sandbox.studies.common.verdicts import FAILS, HOLDS, OPEN
from sandbox.sweep.sizes import mean_size
from sandbox.sweep.summary import SHARES_OF, Cell

FORMAT, VERSION = "auxetic-sandbox study of clogging", 1
Verdict = tuple[Claim, Check, str, float]


def as_markdown(verdicts: Sequence[Verdict], found: Found, about: Mapping[str, Any]) -> str:
    """All of it; pictures lie in the folders of the parts."""
    quick = " --quick" if about.get("quick") else ""
    counts = Counter(verdict for _, _, verdict, _ in verdicts)
    told = ", ".join(f"{counts[v]} {v}" for v in (HOLDS, FAILS, OPEN) if counts[v])
    runs = [run for cells in found.values() for cell in cells for run in cell.runs]
    lines = [
        "# Clogging",
        "",
        (
            f"From `python -m sandbox study clogging --out DIR{quick}`: {len(runs)} runs, {len(verdicts)} numbers: {told}. "
            f"Intervals are {CONFIDENCE:.0%} each, of shares Wilson's; a verdict takes a p-value below {1.0 - CONFIDENCE:.2f} "
            f"after Holm's correction over all of them. Seeds from {FIRST} on judge; protocols were set up with seeds 1 to 10. "
            "Each part is a sweep in a folder of its own: `play DIR/PART#ROW` opens any run, and `sweep DIR/PART --more-seeds N` "
            "adds some."
        ),
    ]
    for claim in dict.fromkeys(claim for claim, _, _, _ in verdicts):
        lines += ["", f"## {claim.title}", "", f"{claim.source}.", "", f"Limits: {claim.limits}."]
        if claim.name == "decay" and about.get("hazard"):
            lines += ["", f"![Hazard of a clog against the width, with both forms]({FIGURE})"]
        lines += ["", "| measured | expected | must be | verdict |", "| --- | --- | --- | --- |"]
        mine = [verdict for verdict in verdicts if verdict[0] is claim]
        lines += [
            f"| {escaped(check.quantity)}: {value(check)}, {len(check.seeds)} seeds | {escaped(check.expected)} "
            f"| {must(check)} | **{verdict}**, p {p:.2g} |"
            for _, check, verdict, p in mine
        ]
        lines += [
            "",
            *dict.fromkeys(f"- {must(check)}: {check.reason}." for _, check, _, _ in mine),
        ]
    lines += ["", "## Probability that the grains stop", "", f"{SHARES_OF}.", "", *_shares(found)]
    lines += [
        "",
        "## What the answer depends on",
        "",
        *_same(found),
        "",
        "## Cost",
        "",
        *_costs(found),
    ]
    return "\n".join([*lines, ""])


def _shares(found: Found) -> Iterator[str]:
    for part in PARTS:
        cells = found[part.name]
        if any(part is other for other, _ in SAME) or not cells:
            continue
        names = [axis.partition("=")[0].replace("_", " ") for axis in part.axes]
        yield f"{part.title} ([pictures]({part.name}/index.html)):"
        yield ""
        yield f"| {' | '.join([*names, 'packing', 'stopped', 'outcomes', 'grains out', 'mean avalanche'])} |"
        yield "|" + " --- |" * (len(names) + 5)
        for cell in cells:
            counts = ", ".join(f"{n} {name}" for name, n in sorted(cell.outcomes.items()))
            told = [*(f"{v:g}" for v in cell.values), cell.packing, cell.told, counts]
            told += [_out(cell), _mean_size(cell)]
            yield f"| {' | '.join(told)} |"
        yield ""


def _same(found: Found) -> Iterator[str]:
    yield "| varied | at | packing | stopped | grains out |"
    yield "| --- | --- | --- | --- | --- |"
    for base in (SHARES, STRENGTHS):
        for part in (part for part, mine in SAME if mine is base):
            name = part.axes[0].partition("=")[0]
            for cell in found[part.name]:
                yield f"| {part.title} | {name} {cell.values[0]:g} | {cell.packing} | {cell.told} | {_out(cell)} |"
        for cell in _bases(base, found):
            yield f"| {base.scene}, as in its map | | {cell.packing} | {cell.told} | {_out(cell)} |"


def _bases(base: Part, found: Found) -> Iterator[Cell]:
    """The cells of a map that the variations start from."""
    part = next(part for part, mine in SAME if mine is base)
    names = [axis.partition("=")[0] for axis in base.axes]
    at = tuple(part.settings[name] for name in names)
    kind = part.packings
    yield from (c for c in found[base.name] if c.values == at and c.packing == kind)


def _costs(found: Found) -> Iterator[str]:
    yield "| part | runs | minutes of one core | seconds a run | longest [s] |"
    yield "| --- | --- | --- | --- | --- |"
    total, runs = 0.0, 0
    for part in PARTS:
        columns = [cell.column("seconds") for cell in found[part.name]]
        seconds = np.concatenate(columns) if columns else np.zeros(0)
        if not len(seconds):
            continue
        total, runs = total + float(seconds.sum()), runs + len(seconds)
        yield (
            f"| {part.name} | {len(seconds)} | {seconds.sum() / 60.0:.1f} | {seconds.mean():.2f} | {seconds.max():.1f} |"
        )
    yield f"| all | {runs} | {total / 60.0:.1f} | {total / max(runs, 1):.2f} | |"


def _out(cell: Cell) -> str:
    """The mean number of grains that left."""
    out = cell.column("out")
    return f"{out.mean():.1f}" if len(out) else ""


def _mean_size(cell: Cell) -> str:
    if not cell.avalanches:
        return ""
    mean, low, high = mean_size(*cell.sizes)
    return f"{mean:.3g} ({low:.3g} to {high:.3g})"


def as_json(verdicts: Sequence[Verdict], found: Found, about: Mapping[str, Any]) -> str:
    """Every number with its interval, threshold and reason."""
    data = {
        "format": FORMAT,
        "version": VERSION,
        **about,
        "claims": [
            {
                "claim": claim.name,
                "source": claim.source,
                **check.data(verdict, p),
            }
            for claim, check, verdict, p in verdicts
        ],
        "cells": [
            {
                "part": name,
                "packing": cell.packing,
                "values": list(cell.values),
                "outcomes": dict(cell.outcomes),
                "stopped": None if share is None else [share.hits, share.count],
            }
            for name, cells in found.items()
            for cell in cells
            for share in (cell.stopped,)
        ],
    }
    return json.dumps(finite(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n"

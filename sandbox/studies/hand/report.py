"""What the study of the hand found: tables in Markdown, one row a run as CSV, and all of it as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from statistics import mean, median
from typing import Any

from sandbox.ensemble.estimates import wilson
from sandbox.files import cells
from sandbox.studies.common.finite import finite
from sandbox.studies.hand.jobs import Row
from sandbox.studies.hand.tour_claims import BROKEN, TENDENCIES
from scenes.scene import STRONGEST

FORMAT = "auxetic-sandbox study of the hand"
VERSION = 1
KINDS = ("regular", "mixed", "auxetic")
COLUMNS = (
    "part",
    "scene",
    "packing",
    "seed",
    "strength",
    "ended",
    "way",
    "out",
    "peak_force",
    "mean_force",
    "increments",
    "unconverged",
    "failing",
)


def as_table(rows: Sequence[Row]) -> str:
    """One row a push or random hand; lengths in R, forces in k R."""
    written: list[Sequence[object]] = [COLUMNS]
    for row in rows:
        if row["part"] != "tour":
            told = {**row, "failing": "; ".join(row.get("failing", []))}
            written.append(["" if told.get(c) is None else told[c] for c in COLUMNS])
    return cells.lines(written)


def as_json(rows: Sequence[Row], failures: Sequence[str], about: Mapping[str, Any]) -> str:
    """Everything."""
    data = {"format": FORMAT, "version": VERSION, **about, "failures": failures, "runs": rows}
    return json.dumps(finite(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def as_markdown(rows: Sequence[Row], failures: Sequence[str], about: Mapping[str, Any]) -> str:
    """The tables, each with the words that say how to read it."""
    parts = {
        part: [row for row in rows if row["part"] == part] for part in ("push", "tour", "random")
    }
    quick = " --quick" if about.get("quick") else ""
    lines = [
        "# The hand",
        "",
        (
            f"From `python -m sandbox study hand --out DIR{quick}`: {len(rows)} runs, {len(failures) or 'none'} failed. "
            "Strengths and forces in k R, lengths in R."
        ),
        "",
        "## What locks at which strength",
        "",
        (
            "Scripted drives. Locked: all the strength of the hand moved nothing in three increments, one after the other; the "
            "share has a Wilson interval of 95 %. Way and grains out are means, the peak is the largest force of any run."
        ),
        "",
        *_strengths([row for row in parts["push"] if row["strength"] < STRONGEST]),
        "",
        "## What a testing machine needs",
        "",
        "The other scenes, driven to the end of their script whatever it takes.",
        "",
        *_machines([row for row in parts["push"] if row["strength"] >= STRONGEST]),
        "",
        "## Tours",
        "",
        (
            "A hand that pulls steadily does what each step asks for; then each sentence about an outcome is held against it. "
            "A sentence about a tendency need not hold on every seed."
        ),
        "",
        *_tours(parts["tour"]),
        "",
        "## Random hands",
        "",
        (
            "Every hand makes eight gestures of up to twelve increments; one in four is flung far out of the scene and held "
            "there for a hundred. Its strength is the default of the scene."
        ),
        "",
        *_random(parts["random"]),
        "",
    ]
    if failures:
        lines += ["## Runs that failed", "", *(f"- {failure}" for failure in failures), ""]
    return "\n".join(lines)


def _share(hits: int, count: int) -> str:
    low, high = wilson(hits, count)
    return f"{hits} of {count} ({100 * low:.0f} to {100 * high:.0f} %)"


def _strengths(rows: Sequence[Row]) -> list[str]:
    lines = [
        "| scene | strength | packing | locked | way | out | peak force | increments that did not converge |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for scene, strength in sorted({(row["scene"], row["strength"]) for row in rows}):
        for kind in KINDS:
            some = [
                r
                for r in rows
                if (r["scene"], r["strength"], r["packing"]) == (scene, strength, kind)
            ]
            if not some:
                continue
            locked = sum(row["ended"] == "locked" for row in some)
            out = f"{mean(row['out'] for row in some):.0f}" if scene == "hopper" else "–"
            unconverged = sum(r["unconverged"] for r in some) / sum(r["increments"] for r in some)
            lines.append(
                f"| `{scene}` | {strength:g} | {kind} | {_share(locked, len(some))} | "
                f"{mean(r['way'] for r in some):.1f} (median {median(r['way'] for r in some):.1f}) | {out} | "
                f"{max(r['peak_force'] for r in some):.2f} | {100 * unconverged:.1f} % |"
            )
    return lines


def _machines(rows: Sequence[Row]) -> list[str]:
    lines = [
        "| scene | packing | runs | peak force: median, largest | ended otherwise than at the end of the script |",
        "| --- | --- | --- | --- | --- |",
    ]
    for scene, kind in dict.fromkeys((row["scene"], row["packing"]) for row in rows):
        some = [row for row in rows if (row["scene"], row["packing"]) == (scene, kind)]
        peaks = [row["peak_force"] for row in some]
        other = [row["ended"] for row in some if row["ended"] != "went through"]
        lines.append(
            f"| `{scene}` | {kind} | {len(some)} | {median(peaks):.3g}, {max(peaks):.3g} | {', '.join(other) or 'none'} |"
        )
    return lines


def _tours(rows: Sequence[Row]) -> list[str]:
    lines = ["| tour | step | it says | holds |", "| --- | --- | --- | --- |"]
    undone, broken = [], []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        played = [row for row in rows if row["scene"] == scene]
        for k, first in enumerate(played[0]["steps"]):
            steps = [row["steps"][k] for row in played]
            undone += [
                f"`{scene}` {first['step']}, seed {row['seed']}"
                for row, step in zip(played, steps, strict=True)
                if not step["done"]
            ]
            broken += [
                f"`{scene}` {first['step']}, seed {row['seed']}: {', '.join(step['broken'])}"
                for row, step in zip(played, steps, strict=True)
                if step["broken"]
            ]
            for words in first["claims"]:
                held = sum(step["claims"][words] for step in steps)
                tends = " (a tendency)" if (scene, first["step"]) in TENDENCIES else ""
                lines.append(
                    f"| `{scene}` | {first['step']} | {words}{tends} | {held} of {len(steps)} |"
                )
    lines += ["", f"Steps that could not be done in time: {', '.join(undone) or 'none'}."]
    lines += [f"Steps in which a relaxation broke: {', '.join(broken) or 'none'}."]
    return lines


def _random(rows: Sequence[Row]) -> list[str]:
    if not rows:
        return ["None."]
    broken = [row for row in rows if row["broken"]]
    failing = [row for row in rows if row["failing"]]
    increments = sum(row["increments"] for row in rows)
    places = len({(row["scene"], row["packing"]) for row in rows})
    limit = sum(row["unconverged"] for row in rows)
    lines = [
        (
            f"{len(rows)} hands over {places} scenes and packings, {increments} increments, "
            f"{limit} of them at the iteration limit. Hands after which a grain was sunk or squeezed flat, or numbers blew up: "
            f"{len(broken) or 'none'}. Hands after which a check of the scene fails: {len(failing) or 'none'}."
        ),
    ]
    told = [(row, row["ended"]) for row in broken]
    told += [(row, "; ".join(row["failing"])) for row in failing]
    lines += [f"- `{r['scene']}`, {r['packing']}, seed {r['seed']}: {what}" for r, what in told]
    return lines


def wrong(rows: Sequence[Row]) -> list[str]:
    """What is not as it should be: sentences that do not hold, steps that cannot be done, hands that break something."""
    found = []
    for row in rows:
        where = f"{row['scene']}, seed {row['seed']}"
        for step in row.get("steps", ()):
            if not step["done"]:
                found.append(f"tour of {where}: {step['step']} cannot be done")
            if step["broken"]:
                found.append(f"tour of {where}: {step['step']}: {', '.join(step['broken'])}")
            if (row["scene"], step["step"]) not in TENDENCIES:
                found += [
                    f"tour of {where}: {step['step']}: not so: {words}"
                    for words, holds in step["claims"].items()
                    if not holds
                ]
        if row.get("broken") or row.get("ended") in BROKEN:
            found.append(f"hand in {where}, {row['packing']}: {row['ended']}")
        found += [f"{where}, {row['packing']}: {check}" for check in row.get("failing", ())]
    return found

"""What a bench run found, as text, as JSON and as a table for a page in Markdown."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

FORMAT = "auxetic-sandbox bench"
VERSION = 1


@dataclass(frozen=True)
class Row:
    """One thing measured, in words. ``met`` is None where there is no target."""

    what: str
    measured: str
    target: str = ""
    met: bool | None = None


@dataclass(frozen=True)
class Section:
    """One part of the bench: rows to read, and the numbers behind them."""

    name: str
    title: str
    rows: tuple[Row, ...]
    data: dict[str, Any]


@dataclass
class Report:
    """A whole run."""

    machine: dict[str, Any]
    quick: bool
    sections: list[Section] = field(default_factory=list)

    def missed(self) -> list[Row]:
        """The rows whose target was not met."""
        return [row for section in self.sections for row in section.rows if row.met is False]


def as_text(section: Section) -> str:
    """A section as lines of a terminal."""
    width = max((len(row.what) for row in section.rows), default=0)
    lines = [section.title]
    for row in section.rows:
        verdict = {True: "  met: ", False: "  MISSED: ", None: ""}[row.met]
        lines.append(f"  {row.what:<{width}}  {row.measured}{verdict}{row.target}".rstrip())
    return "\n".join(lines)


def as_json(report: Report) -> str:
    """Everything, numbers in the units that their names end in."""
    sections = {
        section.name: {
            **section.data,
            "rows": [
                {"what": r.what, "measured": r.measured, "target": r.target, "met": r.met}
                for r in section.rows
            ],
        }
        for section in report.sections
    }
    whole = {
        "format": FORMAT,
        "version": VERSION,
        "quick": report.quick,
        "machine": report.machine,
        "sections": sections,
    }
    return json.dumps(whole, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def as_markdown(report: Report) -> str:
    """The table for a page."""
    machine = report.machine
    lines = [
        f"{machine['processor']}, {machine['cores']} cores, Python {machine['python']}, Numba {machine['numba']}.",
        "",
        "| | measured | target |",
        "| --- | --- | --- |",
    ]
    for section in report.sections:
        lines.append(_cells(f"**{section.title}**", "", ""))
        lines += [_cells(row.what, row.measured, _target(row)) for row in section.rows]
    return "\n".join(lines) + "\n"


def _cells(*texts: str) -> str:
    escaped = [text.replace("|", r"\|") for text in texts]
    return f"| {' | '.join(escaped)} |".replace("  ", " ")


def _target(row: Row) -> str:
    return f"{row.target} (missed)" if row.met is False else row.target


def at_most(value: float, limit: float, shown: str) -> tuple[str, bool]:
    """Target text and verdict of ``value`` ≤ ``limit``; where it is missed, by how much."""
    if value <= limit:
        return f"≤ {shown}", True
    over = value / limit - 1.0
    return f"≤ {shown}, {over:.0%} over" if over >= 0.1 else f"≤ {shown}, {over:.1%} over", False


def at_least(share: float, limit: float) -> tuple[str, bool]:
    """Target text and verdict of a share; where it is missed, by how much."""
    if share >= limit:
        return f"≥ {limit:.0%}", True
    return f"≥ {limit:.0%}, {100.0 * (limit - share):.1f} points short", False


def finite(values: Sequence[float]) -> list[float | None]:
    """For JSON, which knows no nan."""
    return [float(v) if v == v and abs(v) != float("inf") else None for v in values]

"""The live estimate of the force's error in the report: a table of packings, and one of drives."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from sandbox.files import cells
from sandbox.studies.accuracy.live import FIT, JUDGE

Estimates = Mapping[str, Mapping[str, Mapping[str, Any]]]  # by scene and packing
Row = Sequence[str]

RUNS = (
    "scene",
    "packing",
    "seed",
    "used for",
    "increments measured",
    "increments that did not converge",
    "increments left out",
    "error of the force over its mean, median",
    "usual bound, median",
    "share within it",
    "bound of nine of ten, median",
    "share within it",
)

ESTIMATE = """Scripted drives at the defaults, by a testing machine. Some increments, spread over the whole drive, are \
solved again from the same place to a thousandth of the tolerance; the difference of the force on the handle is its error, \
relative to the mean force of the drive up to there. Each bound is factor × f × (u/f)^p × m^q, with f the mean contact force, \
u the root of the sum of squares of the forces that are left on the grains (the residual times f at least), and m the farthest \
move of a grain over the step. It is fitted to the increments of seeds {fit} and judged by those of seeds {judge}, where the \
handle feels a force. “Usually” is meant to hold one time in two, “nine of ten” nine times in ten, with Wilson intervals of 95 % \
as if increments were independent; a star marks a share outside of 0.4 to 0.6, or of 0.85 to 0.95. The last two columns are the \
coverage of “nine of ten” on the way to the solution, at ten times the tolerance and at a tenth of it. {untold} of {all} \
increments were not solved to a tenth of the tolerance, and are left out. A row a drive: estimate.csv. It is the error of the \
relaxation alone: what the length of the increments does, and what increments before have left, comes on top."""


def percent(value: float | None) -> str:
    """A share as text: two digits."""
    if value is None or not math.isfinite(value):
        return "—"
    if value == 0.0:
        return "0"
    if value >= 1.0:
        return f"{100.0 * value:.0f} %"
    return f"{100.0 * value:.2g} %" if value >= 1e-5 else f"{100.0 * value:.0e} %"


def estimate_rows(found: Estimates) -> Iterator[Row]:
    """A row a packing, after a header."""
    yield (
        "scene",
        "packing",
        "error, median",
        "usually within",
        "right",
        "nine of ten within",
        "right",
        "increments",
        "at 10 ×",
        "at 0.1 ×",
    )
    for scene, packings in found.items():
        for packing, one in packings.items():
            judged = one["judged"]
            yield (
                f"`{scene}`",
                packing,
                percent(judged["error"]),
                *(
                    text
                    for name in ("usual", "nine_of_ten")
                    for text in (percent(judged[name]["size"]), _coverage(judged[name]))
                ),
                str(judged["increments"]),
                *(
                    percent(judged["nine_of_ten"]["elsewhere"].get(level))
                    for level in ("10", "0.1")
                ),
            )


def _coverage(found: Mapping[str, Any]) -> str:
    low, high = found["interval"]
    star = "" if found["aim"] else " \\*"
    return f"{100.0 * found['coverage']:.0f} % ({100.0 * low:.0f} to {100.0 * high:.0f} %){star}"


def about_estimates(found: Estimates) -> str:
    """What the table means."""
    every = [one for packings in found.values() for one in packings.values()]
    solved = sum(drive["increments"] for one in every for drive in one["drives"].values())
    untold = sum(one["untold"] for one in every)

    def seeds(of: Sequence[int]) -> str:
        there = sorted({int(seed) for one in every for seed in one["drives"]})
        return ", ".join(str(seed) for seed in there if seed in of)

    return ESTIMATE.format(fit=seeds(FIT), judge=seeds(JUDGE), untold=untold, all=solved + untold)


def as_runs(found: Estimates) -> str:
    """The coverage of each drive as CSV: those of the seeds that were fitted, too."""
    written: list[Sequence[object]] = [RUNS]
    for scene, packings in found.items():
        for packing, one in packings.items():
            for seed, drive in one["drives"].items():
                written.append(
                    [
                        scene,
                        packing,
                        seed,
                        "fitted" if int(seed) in FIT else "judging",
                        *(drive[name] for name in ("increments", "unconverged", "untold")),
                        _plain(drive["error"]),
                        *(
                            _plain(drive[name][what])
                            for name in ("usual", "nine_of_ten")
                            for what in ("size", "coverage")
                        ),
                    ]
                )
    return cells.lines(written)


def _plain(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else ""

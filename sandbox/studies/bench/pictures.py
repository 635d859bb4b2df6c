"""Pictures a second of the window while its solvers work, at the sizes of common screens: a scripted mouse drags all the time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sandbox.studies.bench.report import Row, Section
from sandbox.studies.bench.smoothness import DRAGGED, dragged


@dataclass(frozen=True)
class Case:
    """Intruders dragged through packings of so many ``grains`` side by side, in a window of ``size`` [px]."""

    packings: tuple[str, ...]
    grains: int
    size: tuple[int, int]
    aim: float  # pictures a second


CASES = (
    Case(("regular", "mixed", "auxetic"), 300, (1280, 720), 60.0),
    Case(("auxetic",), 600, (1280, 720), 60.0),
    Case(("auxetic",), 600, (1920, 1080), 60.0),
    Case(("auxetic",), 600, (2560, 1440), 40.0),
)


def watch(case: Case, *, seconds: float, rounds: int) -> list[dict[str, Any]]:
    """What was seen of each drag."""
    settings = {"grains": case.grains, **DRAGGED}
    return dragged(
        scene="intruder",
        packings=case.packings,
        size=case.size,
        settings=settings,
        seconds=seconds,
        rounds=rounds,
    )


def section(*, seconds: float, rounds: int, selected: Sequence[Case] = CASES) -> Section:
    """All cases; ``seconds`` of each drag, ``rounds`` times."""
    rows, data = [], []
    for case in selected:
        drags = watch(case, seconds=seconds, rounds=rounds)
        rates = sorted(one["rate"] for one in drags)
        middle = rates[len(rates) // 2]
        size = "×".join(map(str, case.size))
        what = f"intruder, {case.grains} grains, {', '.join(case.packings)}, {size}"
        measured = f"{middle:.0f} ({rates[0]:.0f} to {rates[-1]:.0f})"
        rows.append(Row(what, measured, f"≥ {case.aim:g}", middle >= case.aim))
        data.append(
            {"packings": case.packings, "grains": case.grains, "size": case.size} | {"drags": drags}
        )
    return Section(
        "pictures", "Pictures a second of the window, solvers at work", tuple(rows), {"cases": data}
    )

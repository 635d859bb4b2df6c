"""A scripted drag at 3 R a second of film: how many frames are in balance when their share of the solver's time is used up.

A frame is an increment of 0.05 R; 60 of them make a second, and of each the solver gets 12 ms on one core. What the residual
is by then, is what a window would show at once. The increment is then finished off the clock, as the window's solver does
too: it never moves on before the grains are in balance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from sandbox.ensemble.clock import clock
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from sandbox.studies.bench.report import Row, Section, at_least, at_most, finite
from scenes import registry
from scenes.scene import HAND_STRENGTH, STRONGEST

BUDGET = 12e-3  # [s] of solver time a frame
BALANCED, MEDIAN = 3e-2, 1e-2  # relative residuals
SLICE = 200  # iterations between two looks at the clock, as in the window; fewer where the budget runs out
LEAST_SLICE = 10
STEP = 0.05  # [R] = 3 R/s over 60 frames a second
PACKINGS = ("regular", "mixed", "auxetic")
OTHERS = 0.4  # of the frames, for scenes without a target
LEAST = 50  # scenes of fewer grains are no question of speed


@dataclass(frozen=True)
class Case:
    """A scene to drag through; ``share`` and ``middle`` are targets, None where there is none."""

    scene: str
    settings: dict[str, object]
    share: float | None = None
    middle: float | None = None


def cases() -> list[Case]:
    """The intruder at two sizes, which have targets, and every other scene as it comes."""
    intruder = [
        Case("intruder", {"grains": 300}, 0.90, MEDIAN),
        Case("intruder", {"grains": 600}, 0.75),
    ]
    others = [Case(name, {}) for name in registry.names() if name != "intruder"]
    return intruder + others


@dataclass(frozen=True)
class Drag:
    """What the frames came to: residual when the budget was used, iterations and solver time of the whole increment."""

    grains: int
    residuals: tuple[float, ...]
    iterations: tuple[int, ...]
    seconds: tuple[float, ...]
    late: int  # increments that did not converge at all

    @property
    def share(self) -> float:
        """Share of the frames that were in balance in time."""
        return sum(r < BALANCED for r in self.residuals) / max(len(self.residuals), 1)

    @property
    def middle(self) -> float:
        """Median residual; nan counts as worst."""
        return median(r if r == r else math.inf for r in self.residuals) if self.residuals else 0.0


def drag(session: Session, frames: int, *, budget: float = BUDGET) -> Drag:
    """Run the scripted drive of a session that is built, for at most ``frames`` increments."""
    session.submit(Protocol(True))
    engine = session.run.engine
    grains = len(engine.packing)
    residuals, iterations, seconds, late = [], [], [], 0
    for _ in range(frames):
        start = clock()
        done = session.advance(LEAST_SLICE)
        if not done and session.idle:
            break  # the end of the script
        begun = clock()
        while not done and (now := clock()) - start < budget:
            so_far = engine.progress()
            count = 0 if so_far is None else so_far.iterations - LEAST_SLICE
            done = session.advance(slice_that_fits(start + budget - now, now - begun, count))
        under_way = engine.progress()
        row = session.history[len(session.history) - 1]
        residuals.append(row.residual if under_way is None else under_way.residual)
        while not done:
            done = session.advance(SLICE)
        row = session.history[len(session.history) - 1]
        iterations.append(row.iterations)
        seconds.append(clock() - start)
        late += row.stop_reason != "converged"
    return Drag(grains, tuple(residuals), tuple(iterations), tuple(seconds), late)


def slice_that_fits(left: float, seconds: float, iterations: int) -> int:
    """Iterations for the next slice: no more than there is time ``left`` for [s], as ``iterations`` took ``seconds`` so far."""
    if iterations <= 0:
        return LEAST_SLICE
    return max(LEAST_SLICE, min(SLICE, int(left * iterations / seconds)))


def measure(case: Case, packing: str, frames: int) -> dict[str, Any] | None:
    """One scene with one kind of grains; None if it has so few that there is nothing to ask."""
    scene = registry.get(case.scene)
    settings = dict(case.settings)
    if any(p.name == "step" for p in scene.parameters):
        settings["step"] = STEP
    if any(p.name == HAND_STRENGTH for p in scene.parameters):
        settings[HAND_STRENGTH] = STRONGEST  # the hand is to move in every frame
    session = Session(case.scene, packing, 1, settings)
    session.build()
    if len(session.run.engine.packing) < LEAST:
        return None
    found = drag(session, frames)
    return {
        "scene": case.scene,
        "packing": packing,
        "grains": found.grains,
        "frames": len(found.residuals),
        "share_in_time": found.share,
        "median_residual": finite([found.middle])[0],
        "median_iterations": median(found.iterations) if found.iterations else 0,
        "median_ms": 1e3 * median(found.seconds) if found.seconds else 0.0,
        "not_converged": found.late,
        "residuals": finite(found.residuals),
        "iterations": list(found.iterations),
        "ms": [1e3 * s for s in found.seconds],
    }


def section(*, frames: int, selected: Sequence[Case] | None = None) -> Section:
    """Every case with every kind of grains that its scene knows; ``frames`` of each that has a target."""
    rows, data = [], []
    for case in cases() if selected is None else selected:
        count = frames if case.share is not None else max(1, round(OTHERS * frames))
        known = registry.get(case.scene).packings
        for packing in [p for p in PACKINGS if p in known]:
            found = measure(case, packing, count)
            if found is not None:
                data.append(found)
                rows.append(row_of(case, found))
    title = (
        f"Frames in balance (residual below {BALANCED:g}) after {1e3 * BUDGET:.0f} ms on one core"
    )
    return Section("frames", title, tuple(rows), {"budget_ms": 1e3 * BUDGET, "drags": data})


def row_of(case: Case, found: dict[str, Any]) -> Row:
    """What is shown of one drag, with the verdicts of both targets."""
    share, middle = found["share_in_time"], found["median_residual"]
    middle = math.inf if middle is None else middle
    verdicts = []
    if case.share is not None:
        verdicts.append(at_least(share, case.share))
    if case.middle is not None:
        text, met = at_most(middle, case.middle, f"{case.middle:g}")
        verdicts.append((f"median {text}", met))
    measured = (
        f"{share:.0%} of {found['frames']}, median {middle:.1e}; whole increment "
        f"{found['median_iterations']:.0f} iterations, {found['median_ms']:.1f} ms"
    )
    return Row(
        f"{case.scene}, {found['grains']} grains, {found['packing']}",
        measured,
        "; ".join(text for text, _ in verdicts),
        all(met for _, met in verdicts) if verdicts else None,
    )

"""A hand that drags a body through the window: in how many pictures a body that should have moved has, working ahead and not.

The window is another process, ``sandbox.window.smoothness``, on the screen if there is one. Where 3 R a second is more than the
solver can follow, slower hands are tried.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sandbox.studies.bench.report import Row, Section, at_least
from scenes.scene import HAND_STRENGTH, STRONGEST

SHARE = 0.95  # of the pictures
SPEEDS = (3.0, 2.0, 1.0)  # of the hand [R/s]; the first has a target
# A step of 0.05 R is 3 R/s over 60 pictures a second; and nothing that is dragged locks.
DRAGGED: dict[str, object] = {"step": 0.05, HAND_STRENGTH: STRONGEST}
REPOSITORY = Path(__file__).parents[3]
PATIENCE = 900.0  # [s]


@dataclass(frozen=True)
class Case:
    """What is dragged; without an ``aimed`` for share, the fastest hand that reaches it is looked for."""

    scene: str
    packing: str
    grains: int
    way: tuple[float, float] = (1.0, 0.0)
    aimed: bool = True
    settings: Mapping[str, object] = field(default_factory=dict)


CASES = (
    Case("intruder", "regular", 300),
    Case("intruder", "mixed", 300),
    Case("intruder", "auxetic", 300),
    Case("intruder", "regular", 600),
    Case("intruder", "mixed", 600, aimed=False),
    Case("intruder", "auxetic", 600, aimed=False),
    Case("hopper", "mixed", 300, (0.0, -1.0), aimed=False),
)


@dataclass(frozen=True)
class Seen:
    """Of a hand of one speed, working ahead (the later of each pair) and not."""

    speed: float  # [R/s]
    drags: tuple[dict[str, Any], ...]

    def share(self, *, ahead: bool) -> float:
        """Of the pictures in which the body should have moved, those in which it had."""
        drags = [one for one in self.drags if (one["depth"] > 0) == ahead]
        return float(sum(one["moved"] for one in drags) / max(sum(one["due"] for one in drags), 1))

    @property
    def turn(self) -> float:
        """The longest until a turn was seen, working ahead [ms]; inf: it was not."""
        turns = [one["turn"] for one in self.drags if one["depth"] > 0]
        return max((float("inf") if one is None else 1e3 * one for one in turns), default=0.0)


def watch(case: Case, speed: float, *, seconds: float, rounds: int) -> Seen:
    """A window of its own."""
    drags = dragged(
        scene=case.scene,
        packings=[case.packing],
        way=case.way,
        speed=speed,
        seconds=seconds,
        rounds=rounds,
        settings={"grains": case.grains, **DRAGGED, **case.settings},
    )
    return Seen(speed, tuple(drags))


def dragged(**case: object) -> list[dict[str, Any]]:
    """What a window in a process of its own sees of drags: fields of ``Case`` and ``Drag`` of ``sandbox.window.smoothness``."""
    paths = [str(REPOSITORY), os.environ.get("PYTHONPATH", "")]
    done = subprocess.run(
        [sys.executable, "-m", "sandbox.window.smoothness", json.dumps(case)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        timeout=PATIENCE,
    )
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


def measure(case: Case, *, seconds: float, rounds: int) -> list[Seen]:
    """At the first speed; without an aim at ever slower ones, until the share is reached."""
    seen: list[Seen] = []
    for speed in SPEEDS[:1] if case.aimed else SPEEDS:
        seen.append(watch(case, speed, seconds=seconds, rounds=rounds))
        if seen[-1].share(ahead=True) >= SHARE:
            break
    return seen


def section(*, seconds: float, rounds: int, selected: Sequence[Case] = CASES) -> Section:
    """All cases; ``seconds`` of each drag, ``rounds`` times."""
    rows, data = [], []
    for case in selected:
        load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
        seen = measure(case, seconds=seconds, rounds=rounds)
        rows += [row_of(case, one) for one in seen]
        data.append(
            {
                "scene": case.scene,
                "packing": case.packing,
                "grains": case.grains,
                "load": load,
                "hands": [{"speed_R_per_s": one.speed, "drags": one.drags} for one in seen],
            }
        )
    title = "Pictures of the window in which a body that is dragged has moved, of those in which it should have"
    return Section("smoothness", title, tuple(rows), {"cases": data})


def row_of(case: Case, seen: Seen) -> Row:
    """What is shown of a hand of one speed."""
    with_it, without = seen.share(ahead=True), seen.share(ahead=False)
    rates = [one["rate"] for one in seen.drags]
    measured = (
        f"{with_it:.0%} ({without:.0%} without working ahead), {min(rates):.0f} to {max(rates):.0f} pictures/s, "
        f"a turn seen within {seen.turn:.0f} ms"
    )
    what = f"{case.scene}, {case.grains} grains, {case.packing}, hand of {seen.speed:g} R/s"
    return Row(what, measured, *(at_least(with_it, SHARE) if case.aimed else ("", None)))

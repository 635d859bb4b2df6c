"""From the jobs of one scene to what is reported: points of the plots, fronts, leads over peers, model errors."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from sandbox.studies.accuracy.fronts import (
    extrapolate,
    first_beyond,
    front,
    lead,
    rms,
    slope,
)
from sandbox.studies.accuracy.protocols import APART

Job = Mapping[str, Any]

QUANTITIES = ("force", "stress", "position", "shape", "energy")
MOST = 0.5  # of the scene's own increments must end before a bifurcation for errors along the path to be worth a name
TIGHT = 1e-6  # a tolerance up to which walks say where paths part
FRAME = 1.0 / 60.0  # [s]


@dataclass(frozen=True)
class Dot:
    """One choice of settings: what it costs, and how far off it is over all starts and places before a bifurcation."""

    tolerance: float
    step: float  # of the scene's own increment
    budget: int
    solving: float  # processor time of the minimiser for the way of one of the scene's own increments [s]
    increment: float  # processor time of one whole increment [s]
    iterations: float
    residual: float
    converged: float
    beyond_cone: float  # mean share of contacts that pull harder than friction allows
    places: int
    force: float  # relative to the mean magnitude, rms
    force_most: float
    stress: float
    position: float  # [R]
    shape: float  # [R]
    energy: float

    @property
    def point(self) -> tuple[float, float]:
        """Cost and error of the force."""
        return self.solving, self.force


def dots(groups: Iterable[Sequence[Mapping[str, Any]]], length: float) -> list[Dot]:
    """One dot for each choice of settings; ``groups`` holds what each start measured, all in the same order."""
    return [_dot(walks, length) for walks in zip(*groups, strict=True)]


def _dot(walks: Sequence[Mapping[str, Any]], length: float) -> Dot:
    first = walks[0]
    places = [place for walk in walks for place in walk["errors"]]
    error = {name: rms([place[name] for place in places]) for name in QUANTITIES}
    increments = sum(walk["increments"] for walk in walks)
    return Dot(
        tolerance=first["tolerance"],
        step=first["step"],
        budget=first["budget"],
        solving=float(np.mean([walk["solving"] for walk in walks])) / length,
        increment=sum(walk["seconds"] for walk in walks) / max(increments, 1),
        iterations=float(np.mean([walk["iterations"] for walk in walks])),
        residual=float(np.median([walk["residual"] for walk in walks])),
        converged=float(np.mean([walk["converged"] for walk in walks])),
        beyond_cone=float(np.mean([walk["beyond_cone"] for walk in walks])),
        places=len(places),
        force_most=max((place["force"] for place in places), default=math.nan),
        **error,
    )


def summarise(jobs: Sequence[Job]) -> dict[str, Any]:
    """All about one scene. A scene in which nothing relaxes has its own few numbers."""
    first = jobs[0]
    if "contact" in first:
        return _contact(first)
    ends = [bifurcation(job) for job in jobs]
    places = sum(_default_places(job, end) for job, end in zip(jobs, ends, strict=True))
    path = places > MOST * float(first["length"]) * len(jobs)
    jobs = [
        along_path(job, end) if path else own_increments(job)
        for job, end in zip(jobs, ends, strict=True)
    ]
    length = float(first["length"])
    compared = [job for job in jobs if "peers" in job]
    grid = dots([job["walks"] for job in jobs], length)
    peers = {
        name: dots([job["peers"][name] for job in compared], length) for name in first["peers"]
    }
    # Peers are held against this program from the same starts, with the same increments.
    shown = dots([job["walks"] for job in compared], length)
    best = _front(shown if path else [dot for dot in shown if dot.step == 1.0])
    ours = _front([dot for dot in shown if dot.step == 1.0])
    default = default_dot(grid, first["tolerance"])
    return {
        "grains": first["grains"],
        "starts": len(jobs),
        "length": length,
        "increment": first["step"],
        "tolerance": first["tolerance"],
        "against": "path" if path else "increment",
        "scales": [job["scales"] for job in jobs],
        "bifurcations": ends,
        "reference": _reference(jobs),
        "check": first["check"],
        "friction": first["friction"],
        "dots": [asdict(dot) for dot in grid],
        "default": asdict(default),
        "shown": {
            "dots": [asdict(dot) for dot in shown],
            "front": [asdict(dot) for dot in best],
            "default": asdict(default_dot(shown, first["tolerance"])),
        },
        "frames": default.increment / FRAME,
        "sliced": all(job["sliced"] for job in jobs),
        "budgets": [asdict(dot) for dot in dots([job["budgets"] for job in compared], length)],
        "peers": {name: [asdict(dot) for dot in found] for name, found in peers.items()},
        "lead": {name: _lead(ours, found) for name, found in peers.items()},
        "stiffness": stiffness([job["stiffness"] for job in compared]),
        "overlap": _overlap(compared),
        "beyond": beyond([job["beyond"] for job in jobs]),
    }


def bifurcation(job: Job) -> float | None:
    """The first place where two tight walks are further apart than ``APART``, those of the sweeps included; None if nowhere.

    Friction and drag make errors in proportion to the increment, which are none of that sort: there the sweeps do not count.
    """
    apart = [walk["apart"] for walk in job["tight"]]
    if not job["memory"]:
        apart += [_apart(walk["errors"]) for walk in job["walks"] if walk["tolerance"] <= TIGHT]
    return _parting(apart)


def along_path(job: Job, end: float | None) -> Job:
    """The job with errors against the reference, before the first bifurcation."""

    def cut(walks: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
        return [{**walk, "errors": _before(walk["errors"], end)} for walk in walks]

    return _cut(job, cut, own_end(job, 1.0) if end is None else end)


def own_increments(job: Job) -> Job:
    """The job with errors against the tightest walk with the same increments, as long as tight ones stay together.

    For paths that bifurcate within an increment: what the relaxation does can be told, what the increments do cannot.
    """

    def cut(walks: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
        return [
            {**walk, "errors": _before(walk["own"], own_end(job, walk["step"]))} for walk in walks
        ]

    return _cut(job, cut, own_end(job, 1.0))


def own_end(job: Job, step: float) -> float | None:
    """Where tight walks with those increments part."""
    return _parting(
        [
            _apart(walk["own"])
            for walk in job["walks"]
            if walk["tolerance"] <= TIGHT and walk["step"] == step
        ]
    )


def _cut(job: Job, cut: Callable[[Any], list[dict[str, Any]]], end: float | None) -> Job:
    """The job with the lists of walks cut, forces of each stiffness too."""
    parts: dict[str, Any] = {name: cut(job[name]) for name in ("walks", "budgets") if name in job}
    if "peers" in job:
        parts["peers"] = {name: cut(walks) for name, walks in job["peers"].items()}
        whole = None if end is None else max(1, math.ceil(end) - 1)  # increments; one at least
        parts["stiffness"] = [
            {**row, "force": row["force"][:whole], "pressure": row["pressure"][:whole]}
            for row in job["stiffness"]
        ]
    return {**job, **parts}


def _before(rows: Sequence[Mapping[str, Any]], end: float | None) -> list[Mapping[str, Any]]:
    return [row for row in rows if end is None or row["place"] < end - 1e-9]


def _apart(rows: Sequence[Mapping[str, Any]]) -> list[tuple[float, float]]:
    return [(row["place"], row["position"]) for row in rows]


def _parting(apart: Iterable[Sequence[Sequence[float]]]) -> float | None:
    ends = [first_beyond([p for p, _ in row], [d for _, d in row], APART) for row in apart]
    known = [end for end in ends if end is not None]
    return min(known) if known else None


def _default_places(job: Job, end: float | None) -> int:
    """How many of the scene's own increments end before a bifurcation."""
    walk = next(walk for walk in job["walks"] if walk["step"] == 1.0)
    return len(_before(walk["errors"], end))


def default_dot(grid: Sequence[Dot], tolerance: float) -> Dot:
    """The dot of the scene's own increment and of the tolerance nearest to its own."""
    own = [dot for dot in grid if dot.step == 1.0]
    return min(own, key=lambda dot: abs(math.log(dot.tolerance / tolerance)))


def _front(grid: Sequence[Dot]) -> list[Dot]:
    return [grid[k] for k in front([dot.point for dot in grid])]


def _lead(ours: Sequence[Dot], theirs: Sequence[Dot]) -> dict[str, float]:
    least, middle = lead([dot.point for dot in ours], [dot.point for dot in _front(theirs)])
    return {"least": least, "middle": middle}


def _reference(jobs: Sequence[Job]) -> dict[str, float]:
    found = [job["reference"] for job in jobs]
    return {
        "tolerance": found[0]["tolerance"],
        "step": found[0]["step"],
        "residual": max(one["residual"] for one in found),
        "converged": float(np.mean([one["converged"] for one in found])),
        "seconds": sum(one["seconds"] for one in found),
        "increment_error": rms([one["increment_error"] for one in found]),
    }


def _overlap(jobs: Sequence[Job]) -> dict[str, float] | None:
    """The middle one over starts: one that gives way to another balance says nothing about the law. None with friction."""
    names = jobs[0]["overlap"]
    if names is None:
        return None
    return {name: float(np.median([job["overlap"][name] for job in jobs])) for name in names}


def stiffness(groups: Sequence[Sequence[Mapping[str, Any]]]) -> dict[str, Any]:
    """Model error against C → ∞, of the force and of the pressure; what it costs; the powers of C that both follow."""
    found: dict[str, Any] = {}
    values = [float(row["stiffness"]) for row in groups[0]]
    for name in ("force", "pressure"):
        errors: list[list[float]] = [[] for _ in values]
        doubts = []
        for rows in groups:
            curves = np.array([row[name] for row in rows])
            for curve in curves.T:
                limit, doubt = extrapolate(values, curve.tolist())
                scale = float(np.mean(np.abs(curves[-1])))
                doubts.append(doubt / scale if scale > 0.0 else math.nan)
                for error, value in zip(errors, curve, strict=True):
                    error.append((value - limit) / scale if scale > 0.0 else math.nan)
        # The middle ones: where grains have found another balance, the curve of that place says nothing about C.
        found[name] = [float(np.median(np.abs(error))) for error in errors]
        found[f"{name}_doubt"] = float(np.median(doubts))
    solving = [float(np.mean([rows[k]["solving"] for rows in groups])) for k in range(len(values))]
    middle = [k for k, value in enumerate(values) if value <= 200.0]
    return {
        "stiffness": values,
        **found,
        "solving": solving,
        "error_power": slope([values[k] for k in middle], [found["force"][k] for k in middle]),
        "cost_power": slope(values, solving),
    }


def beyond(groups: Sequence[Sequence[Mapping[str, float]]]) -> list[dict[str, float]]:
    """Mean force and mean drop over seeds, with standard deviations, for each tolerance; against the tightest, seed by seed."""
    rows = []
    for walks in zip(*groups, strict=True):
        tightest = [group[-1]["force"] for group in groups]
        force = np.array([walk["force"] for walk in walks])
        drop = np.array([walk["drop"] for walk in walks])
        several = len(force) > 1
        rows.append(
            {
                "tolerance": walks[0]["tolerance"],
                "force": float(force.mean()),
                "force_spread": float(force.std(ddof=1)) if several else math.nan,
                "drop": float(drop.mean()),
                "drop_spread": float(drop.std(ddof=1)) if several else math.nan,
                "shift": float(np.mean(force - tightest) / np.mean(tightest)),
                "solving": float(np.mean([walk["solving"] for walk in walks])),
            }
        )
    return rows


def _contact(job: Job) -> dict[str, Any]:
    return {
        "grains": job["grains"],
        "starts": 1,
        "length": job["length"],
        "contact": job["contact"],
        "halvings": job["halvings"],
    }

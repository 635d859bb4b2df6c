"""This program and others on the same files of soft discs; each peer in a process of its own, on one core.

Several files: from one start to the next the number of iterations scatters by a factor of two or three, whoever minimises.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sandbox.studies.bench import soft_discs
from sandbox.studies.bench.report import Row, Section, at_most

COUNT, STARTS = 1000, 10
TARGET = 0.6  # of LAMMPS's time, for an iteration and for the whole
NAMES = {"lammps": "LAMMPS FIRE", "ase": "ASE FIRE", "scipy": "SciPy L-BFGS-B"}
PATIENCE = 300.0  # [s] for one peer
ONE_CORE = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
REPOSITORY = Path(__file__).parents[3]


def ask(name: str, path: Path, repeats: int) -> list[dict[str, Any]]:
    """The runs of one peer; or one entry that says why there is none."""
    paths = [str(REPOSITORY), os.environ.get("PYTHONPATH", "")]
    environment = {**os.environ, **ONE_CORE, "PYTHONPATH": os.pathsep.join(filter(None, paths))}
    command = [
        sys.executable,
        "-m",
        "sandbox.studies.bench.peer_programs",
        name,
        str(path),
        str(repeats),
    ]
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        return [{"missing": f"{name} gave no answer in {PATIENCE:.0f} s"}]
    runs = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    if not runs:
        last = (done.stderr.strip().splitlines() or ["no answer"])[-1]
        return [{"missing": f"{name} failed: {last}"}]
    return runs


def best(runs: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The fastest run."""
    return min(runs, key=lambda run: run["seconds"])


def together(runs: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Runs from several starts as one."""
    seconds = sum(run["seconds"] for run in runs)
    iterations = sum(run["iterations"] for run in runs)
    return {
        "seconds": seconds,
        "iterations": iterations,
        "iteration_us": 1e6 * seconds / max(iterations, 1),
        "largest_force": max(run["largest_force"] for run in runs),
    }


def section(*, peers: bool, repeats: int, starts: int = STARTS, count: int = COUNT) -> Section:
    """Soft discs: this program, and with ``peers`` the others; the fastest of ``repeats`` runs from each start."""
    soft_discs.relax(soft_discs.random_discs(count, seed=1))  # compiles, or loads what is compiled
    own: list[dict[str, Any]] = []
    found: dict[str, list[dict[str, Any]]] = {name: [] for name in NAMES if peers}
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(1, starts + 1):
            discs = soft_discs.random_discs(count, seed)
            path = Path(folder) / f"soft-discs-{seed}.npz"
            soft_discs.write(path, discs)
            mine = [soft_discs.relax(discs).data() for _ in range(repeats)]
            for name, runs in found.items():
                if runs and "missing" in runs[0]:
                    continue
                runs.append(best_or_missing(ask(name, path, repeats)))
                mine.append(soft_discs.relax(discs).data())
            own.append(best(mine))
    return judged(own, found)


def best_or_missing(runs: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The fastest run, or what says why there is none."""
    return runs[0] if "missing" in runs[0] else best(runs)


def judged(own: list[dict[str, Any]], found: dict[str, list[dict[str, Any]]]) -> Section:
    """Rows and data from one run of each for every start."""
    mine = together(own)
    rows = [Row("this program, 5 degrees of freedom a grain", _described(mine))]
    for name, runs in found.items():
        if "missing" in runs[0]:
            rows.append(Row(NAMES[name], f"not run: {runs[0]['missing']}"))
            continue
        other = together(runs)
        rows.append(Row(NAMES[name], _described(other)))
        apart = max(
            abs(b["start_energy"] / a["start_energy"] - 1.0) for a, b in zip(own, runs, strict=True)
        )
        if apart > 1e-9:
            rows.append(
                Row(
                    f"{NAMES[name]}: energy at the start", f"differs by {apart:.0e}", "equal", False
                )
            )
        if name == "lammps":
            for what, key in (("an iteration", "iteration_us"), ("the whole", "seconds")):
                ratio = mine[key] / other[key]
                rows.append(
                    Row(
                        f"this program / LAMMPS, {what}",
                        f"{ratio:.2f}",
                        *at_most(ratio, TARGET, f"{TARGET}"),
                    )
                )
    data = {
        "this_program": own,
        "peers": {name: runs for name, runs in found.items() if "missing" not in runs[0]},
        "missing": {n: runs[0]["missing"] for n, runs in found.items() if "missing" in runs[0]},
    }
    title = f"{COUNT} soft discs from random places to max |F| < {soft_discs.TOLERANCE:g} k R, {len(own)} times, one core"
    return Section("soft_discs", title, tuple(rows), data)


def _described(run: dict[str, Any]) -> str:
    text = (
        f"{run['iteration_us']:.1f} µs an iteration, {run['iterations']} iterations, "
        f"{1e3 * run['seconds']:.0f} ms in all"
    )
    if not run["largest_force"] <= soft_discs.TOLERANCE:
        text += f"; stopped at {run['largest_force']:.0e} k R"
    return text

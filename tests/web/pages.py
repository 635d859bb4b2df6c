"""The runs that pages are tried with, what the desk makes of them, and pages themselves."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sandbox.web import building
from sandbox.web.laid_out import Blocks

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PAGE = ROOT / "sandbox" / "web" / "page"
# Scene and packing, and how many increments: in the hopper the script goes on until it is locked, or some have left; that under
# gravity is shaken, and then grains leave while nobody does anything.
RUNS = {
    ("hopper", "regular"): 140,
    ("hopper", "auxetic"): 120,
    ("gravity_hopper", "mixed"): 120,
    ("intruder", "regular"): 64,
    ("biaxial_press", "mixed"): 64,
    ("grain_row", "mixed"): 64,
    ("single_grain", "mixed"): 64,
    ("couette", "mixed"): 64,
}
Run = tuple[str, str]


def missing(*modules: str) -> list[str]:
    return [name for name in modules if importlib.util.find_spec(name) is None]


def run_exactly(run: Run, folder: Path, *more: str) -> dict[str, Any]:
    """What the session and the kernels say on the desk, both without fast math."""
    (scene, kind), out = run, folder / "run.npz"
    settings = [f"{name}={value}" for name, value in building.SCENES[scene].items()]
    command = [sys.executable, "-m", "tests.web.exact", str(out), scene, kind, "1", str(RUNS[run])]
    subprocess.run([*command, *settings, *more], check=True, cwd=ROOT, timeout=1800)
    with np.load(out) as numbers:
        return dict(numbers)


def compiled(folder: Path, *, periodic: bool = False) -> Path:
    """The kernels as WebAssembly."""
    lacking = missing("ziglang", "wasmtime")
    if lacking:
        pytest.skip(f"without {' and '.join(lacking)}: install the extra web")
    from sandbox.web.toolchain import kernels

    path = folder / "kernels.wasm"
    path.write_bytes(kernels(periodic=periodic))
    return path


def written(folder: Path, names: list[str], *, seeds: int, single: bool = False) -> list[Path]:
    """Pages, packed by this process."""
    with ThreadPoolExecutor(1) as one:
        return building.write(folder, names, one, lambda _text: None, seeds=seeds, single=single)


def blocks_of(said: dict[str, list[str]]) -> Blocks:
    ints = np.array([int(number) for number in said["ints"]], dtype=np.int64)
    floats = np.array([int(number) for number in said["floats"]], dtype=np.uint64)
    return ints, floats.view(np.float64)


def first_differing(these: Any, those: Any) -> int:
    """−1 where all are alike."""
    differing = np.flatnonzero(np.asarray(these) != np.asarray(those))
    return int(differing[0]) if len(differing) else -1

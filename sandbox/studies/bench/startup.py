"""From the start of a process to the first picture, in fresh processes: kernels and sources compiled before, and not."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

from sandbox.studies.bench.report import Row, Section, at_most

HELP, FIRST_FRAME, COLD_FRAME = 0.3, 1.2, 10.0  # [s]
SCENES = ("hopper", "intruder")
REPOSITORY = Path(__file__).parents[3]
PATIENCE = 600.0

# Run in a process of its own: packs a scene as the window does, and draws it.
CHILD = """
import json, sys, time
began = time.perf_counter()
from core.own_process import OWN
from sandbox.environment import prepare_headless
OWN.set()
prepare_headless()
from sandbox.session.session import Session
from sandbox.draw import warmup
from sandbox.draw.render import Renderer
marks = {"imported": time.perf_counter() - began}
drawing = warmup.Warmup()
drawing.start()
session = Session(sys.argv[1])
def progress(text, share):
    if text.startswith("packing"):
        marks.setdefault("solver kernels", time.perf_counter() - began)
session.build(progress)
marks["built"] = time.perf_counter() - began
assert drawing.join(600.0) and drawing.ready
marks["drawing kernels"] = time.perf_counter() - began
Renderer((1280, 720)).draw(session.frame())
marks["first frame"] = time.perf_counter() - began
print(json.dumps(marks), flush=True)
"""


def _environment(cache: str | None, bytecode: str | None = None) -> dict[str, str]:
    """``cache`` and ``bytecode`` are folders for compiled kernels and for Python's own compiled sources in place of the usual."""
    paths = [str(REPOSITORY), os.environ.get("PYTHONPATH", "")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))}
    if cache is not None:
        environment["NUMBA_CACHE_DIR"] = cache
    if bytecode is not None:
        environment["PYTHONPYCACHEPREFIX"] = bytecode
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
    return environment


def help_time(repeats: int, bytecode: str) -> float:
    """Wall time of ``--help``, the fastest of a few [s]. ``bytecode`` is a folder that Python may keep compiled sources in."""
    best = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "sandbox", "--help"],
            env=_environment(None, bytecode),
            stdout=subprocess.DEVNULL,
            check=True,
            timeout=PATIENCE,
        )
        best = min(best, time.perf_counter() - start)
    return best


def first_frame(
    scene: str, cache: str | None = None, bytecode: str | None = None
) -> dict[str, Any]:
    """Wall time from the start of a process to its first frame [s], and what it had done by when.

    ``cache`` and ``bytecode`` are folders for compiled kernels and for Python's own compiled sources in place of the usual ones.
    """
    start = time.perf_counter()
    with subprocess.Popen(
        [sys.executable, "-c", CHILD, scene],
        env=_environment(cache, bytecode),
        stdout=subprocess.PIPE,
        text=True,
    ) as child:
        assert child.stdout is not None
        patience = threading.Timer(PATIENCE, child.kill)
        patience.start()
        line = child.stdout.readline()
        seconds = time.perf_counter() - start
        rest = child.stdout.read()
        patience.cancel()
    if child.returncode != 0:
        raise subprocess.CalledProcessError(child.returncode, child.args, line + rest)
    # The child's own clock begins after its interpreter has started: that part is in the seconds only.
    return {"seconds": seconds, "marks": json.loads(line)}


def section(*, repeats: int, cold: bool) -> Section:
    """``--help``, the first frame with all compiled before, and with nothing compiled if ``cold``."""
    with tempfile.TemporaryDirectory() as bytecode:
        seconds = help_time(repeats + 1, bytecode)
        rows = [Row("--help", f"{seconds:.2f} s", *at_most(seconds, HELP, f"{HELP:g} s"))]
        data: dict[str, Any] = {"help_s": seconds, "warm": {}, "cold": {}}
        for scene in SCENES:
            first_frame(scene, bytecode=bytecode)  # what is not compiled yet, is now
            runs = [first_frame(scene, bytecode=bytecode) for _ in range(repeats)]
            data["warm"][scene] = runs
            rows.append(warm_row(scene, min(run["seconds"] for run in runs)))
    if cold:
        scene = SCENES[0]
        with tempfile.TemporaryDirectory() as cache:
            # The usual bytecode: what is installed beside the program has its own.
            run = first_frame(scene, cache)
        data["cold"][scene] = run
        rows.append(cold_row(scene, run))
    else:
        rows.append(Row("first frame, cold", "not measured (--quick)"))
    return Section("startup", "Start-up, wall time", tuple(rows), data)


def warm_row(scene: str, seconds: float) -> Row:
    """What is shown of the quickest start of a scene."""
    verdict = at_most(seconds, FIRST_FRAME, f"{FIRST_FRAME:g} s")
    return Row(f"first frame of {scene}, warm", f"{seconds:.2f} s", *verdict)


def cold_row(scene: str, run: dict[str, Any]) -> Row:
    """What is shown of a start with nothing compiled, as ``first_frame`` gives it."""
    built = run["marks"]["built"]
    return Row(
        f"first frame of {scene}, cold",
        f"{run['seconds']:.1f} s; packed and all kernels compiled after {built:.1f}",
        *at_most(run["seconds"], COLD_FRAME, f"{COLD_FRAME:g} s"),
    )

"""How fast the program is on this machine: every part of the bench, one after the other."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from sandbox.studies.bench import drains as bench_drains
from sandbox.studies.bench import drawing as bench_drawing
from sandbox.studies.bench import frames as bench_frames
from sandbox.studies.bench import kernels as bench_kernels
from sandbox.studies.bench import peers as bench_peers
from sandbox.studies.bench import pictures as bench_pictures
from sandbox.studies.bench import scaling as bench_scaling
from sandbox.studies.bench import smoothness as bench_smoothness
from sandbox.studies.bench import startup as bench_startup
from sandbox.studies.bench import terms as bench_terms
from sandbox.studies.bench import threads as bench_threads
from sandbox.studies.bench.report import Report, Section


@dataclass(frozen=True)
class Plan:
    """How long to look at each part."""

    kernel_seconds: float
    scaling_seconds: float
    frames: int
    drawing_seconds: float
    repeats: int
    starts: int
    cold: bool
    threads_seconds: float  # 0: not looked at, since its kernels are compiled for nobody else
    drag_seconds: float  # 0: no window is opened


FULL = Plan(12.0, 30.0, 150, 3.0, 3, 10, cold=True, threads_seconds=18.0, drag_seconds=3.0)
QUICK = Plan(2.0, 3.0, 15, 1.0, 1, 1, cold=False, threads_seconds=0.0, drag_seconds=0.0)


def parts(*, quick: bool, peers: bool) -> Iterator[Callable[[], Section]]:
    """The parts, in order of running; each is a function that takes its time."""
    plan = QUICK if quick else FULL
    yield lambda: bench_startup.section(repeats=plan.repeats, cold=plan.cold)
    yield lambda: bench_terms.section(whole=plan.cold)
    yield lambda: bench_kernels.section(seconds=plan.kernel_seconds)
    yield lambda: bench_peers.section(peers=peers, repeats=plan.repeats, starts=plan.starts)
    yield lambda: bench_scaling.section(quick=quick, seconds=plan.scaling_seconds)
    if plan.threads_seconds > 0.0:
        yield lambda: bench_threads.section(seconds=plan.threads_seconds)
    yield lambda: bench_frames.section(frames=plan.frames)
    yield lambda: bench_drains.section(quick=quick)
    yield lambda: bench_drawing.section(seconds=plan.drawing_seconds)
    if plan.drag_seconds > 0.0:
        yield lambda: bench_pictures.section(seconds=plan.drag_seconds, rounds=2)
        yield lambda: bench_smoothness.section(seconds=plan.drag_seconds, rounds=2)


def run(*, quick: bool, peers: bool, show: Callable[[Section], None]) -> Report:
    """Run all parts; ``show`` is told of each as soon as it is done."""
    report = Report(machine(), quick)
    for part in parts(quick=quick, peers=peers):
        section = part()
        report.sections.append(section)
        show(section)
    return report


def machine() -> dict[str, Any]:
    """What the numbers were measured on."""
    import numba
    import numpy

    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "numpy": numpy.__version__,
        "numba": numba.__version__,
    }


def _processor() -> str:
    """The processor's name; on Linux ``platform`` knows the architecture only."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:  # noqa: PTH123 - no file of ours
            names = [line.partition(":")[2] for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return names[0].strip() if names else platform.processor() or platform.machine()

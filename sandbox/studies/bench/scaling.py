"""How time and memory grow with the number of grains."""

from __future__ import annotations

import math
import time
import tracemalloc
from typing import Any

import numpy as np

from core.generate import Recipe, pack
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import Relaxation
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.system import System
from sandbox.ensemble.clock import clock
from sandbox.studies.bench.report import Row, Section, at_most
from sandbox.studies.bench.times import exponent

SEED_GRAINS, PACKING_FRACTION = 500, 0.9
TILES = {  # grains: columns and rows of copies
    500: (1, 1),
    1_000: (2, 1),
    2_000: (2, 2),
    5_000: (5, 2),
    10_000: (5, 4),
    20_000: (8, 5),
    50_000: (10, 10),
    100_000: (20, 10),
}
QUICK = (500, 2_000, 10_000)
NOISE = 0.02  # [R] that makes the copies differ
EXPONENT, BYTES = 1.1, 1000.0  # targets
MEASURED_GRAINS = 5_000  # of the packing whose memory is looked at


def tiled(seed: Packing, columns: int, rows: int, random: np.random.Generator) -> Packing:
    """Copies of a periodic packing side by side, each grain shifted a little, in one periodic box."""
    box = seed.box
    assert box is not None
    copies = columns * rows
    copy = np.repeat(np.arange(copies), len(seed))
    along, up = copy % columns, copy // columns
    noise = random.uniform(-NOISE, NOISE, (2, copies * len(seed)))
    packing = Packing(
        np.tile(seed.x, copies) + along * box.width + noise[0],
        np.tile(seed.y, copies) + up * box.height + noise[1],
        np.tile(seed.rest_radius, copies),
        np.tile(seed.poisson_ratio, copies),
        np.tile(seed.contact_stiffness, copies),
        box=PeriodicBox(columns * box.width, rows * box.height),
    )
    packing.state[2:] = np.tile(seed.state[2:], copies)
    return packing


def iteration_time(packing: Packing, seconds: float) -> float:
    """Least time of one FIRE iteration, rebuilds of the lists included where they fall due [s]."""
    relaxation = Relaxation(packing, tolerance=1e-14, max_iterations=1_000_000_000)
    relaxation.run(2)
    often = max(4, round(0.05 * seconds / (3e-8 * len(packing))))
    best, end = math.inf, time.perf_counter() + seconds
    runs = 0
    while runs < 3 or time.perf_counter() < end:
        start = clock()
        relaxation.run(often)
        best = min(best, (clock() - start) / often)
        runs += 1
    relaxation.write_back()
    return best


def increment(packing: Packing, seconds: float) -> dict[str, Any]:
    """Squeeze the periodic box by one step from both sides; iterations until it is relaxed, within about ``seconds``."""
    settings = Settings()
    engine = Quasistatic(System(packing, RigidWorld(), settings))
    box = packing.box
    assert box is not None
    goal = PeriodicBox(box.width - settings.step, box.height - settings.step)
    engine.begin({}, goal)
    end = time.perf_counter() + seconds
    done = None
    while done is None and time.perf_counter() < end:
        done = engine.relax(max(20, 200_000 // len(packing)))
    report = done.report if done is not None else engine.progress()
    assert report is not None
    return {
        "iterations": report.iterations,
        "residual": report.residual,
        "ended": str(report.reason) if done is not None else "out of time",
    }


def memory(count: int, seed: Packing) -> dict[str, float]:
    """Bytes a grain: of the packing's and the minimiser's arrays, and the most that a whole increment asked for."""
    columns, rows = TILES[count]
    packing = tiled(seed, columns, rows, np.random.default_rng(1))
    packing.box = None
    x0, x1 = float(packing.x.min()) - 2.0, float(packing.x.max()) + 2.0
    y0, y1 = float(packing.y.min()) - 2.0, float(packing.y.max()) + 2.0
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    sides = zip(corners, corners[1:] + corners[:1], strict=True)
    world = RigidWorld([RigidBody("walls", segments=[(*a, *b, 0.4) for a, b in sides])])
    relaxation = Relaxation(packing, world.primitives()[0])
    arrays = _bytes(list(vars(packing).values())) + _bytes([relaxation._minimizer])
    arrays += _bytes([relaxation._rigid])

    def work() -> None:
        engine = Quasistatic(System(packing.copy(), world, Settings(max_iterations=20)))
        for _ in range(2):
            engine.begin({})
            engine.relax(20)

    work()  # what the compiler needs does not count
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        work()
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    return {
        "grains": count,
        "arrays_bytes": arrays / count,
        "peak_bytes": (peak - before) / count,
    }


def _bytes(things: list[Any]) -> int:
    """Bytes of all arrays in nested tuples."""
    total = 0
    for thing in things:
        if isinstance(thing, np.ndarray):
            total += thing.nbytes
        elif isinstance(thing, tuple):
            total += _bytes(list(thing))
    return total


def section(*, quick: bool, seconds: float) -> Section:
    """Time per iteration, iterations per increment, memory per grain."""
    sizes = QUICK if quick else tuple(TILES)
    seed = pack(Recipe("mixed"), seed=1, count=SEED_GRAINS, packing_fraction=PACKING_FRACTION)
    times, increments = [], []
    for count in sizes:
        packing = tiled(seed, *TILES[count], np.random.default_rng(1))
        times.append(iteration_time(packing, 0.4 * seconds / len(sizes)))
        increments.append({"grains": count, **increment(packing, 0.6 * seconds / len(sizes))})
    slope = exponent(sizes, times)
    used = memory(QUICK[1] if quick else MEASURED_GRAINS, seed)
    rows = [
        Row(
            "time of an iteration at N = " + ", ".join(f"{n}" for n in sizes),
            ", ".join(_microseconds(t) for t in times) + " µs",
        ),
        Row(
            "it grows as N to the power",
            f"{slope:.2f}",
            *at_most(slope, EXPONENT, f"{EXPONENT}"),
        ),
        Row(
            "iterations of an increment: a periodic box, each side shorter by 0.05 R",
            ", ".join(
                f"{i['iterations']}" if i["ended"] == "converged" else f"> {i['iterations']}"
                for i in increments
            ),
        ),
        Row(
            "memory at its peak in an increment",
            f"{used['peak_bytes']:.0f} bytes a grain, of which arrays of packing and minimiser {used['arrays_bytes']:.0f}",
            *at_most(used["peak_bytes"], BYTES, f"{BYTES:.0f}"),
        ),
    ]
    data = {
        "grains": list(sizes),
        "iteration_us": [1e6 * t for t in times],
        "exponent": slope,
        "increments": increments,
        "memory": used,
    }
    return Section("scaling", "Growth with the number of grains", tuple(rows), data)


def _microseconds(seconds: float) -> str:
    return f"{1e6 * seconds:.1f}" if seconds < 1e-4 else f"{1e6 * seconds:.0f}"

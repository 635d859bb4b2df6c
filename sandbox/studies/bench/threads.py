"""One thread against two: the same relaxation, the same bits, taken in turn by the clock on the wall."""

from __future__ import annotations

import time
from functools import partial
from typing import Any

import numpy as np

from core.generate import Recipe, pack
from core.relaxation import Relaxation
from core.threads import most_threads
from sandbox.studies.bench.report import Row, Section
from sandbox.studies.bench.scaling import PACKING_FRACTION, SEED_GRAINS, TILES, tiled
from sandbox.studies.bench.times import in_turn

SIZES = (5_000, 20_000, 100_000)
THREADS = 2
SETTLE = 60  # iterations before the clock starts: the second thread's kernels are compiled, the packing has calmed down


def measure(sizes: tuple[int, ...], seconds: float) -> list[dict[str, Any]]:
    """Times of an iteration on one and on two threads, and whether both ended with the same bits."""
    seed = pack(Recipe("mixed"), seed=1, count=SEED_GRAINS, packing_fraction=PACKING_FRACTION)
    found = []
    for count in sizes:
        packing = tiled(seed, *TILES[count], np.random.default_rng(1))
        both = {
            threads: Relaxation(
                packing, tolerance=1e-14, max_iterations=1_000_000_000, threads=threads
            )
            for threads in (1, THREADS)
        }
        for relaxation in both.values():
            relaxation.run(SETTLE)
        times = in_turn(
            {str(threads): partial(relaxation.run) for threads, relaxation in both.items()},
            seconds=seconds / len(sizes),
            run=5e-3,
            clock=time.perf_counter,
        )
        most = max(relaxation.iterations for relaxation in both.values())
        for relaxation in both.values():
            relaxation.run(most - relaxation.iterations)
        one, several = times["1"], times[str(THREADS)]
        found.append(
            {
                "grains": count,
                "one_us": one.data(1e-6),
                "several_us": several.data(1e-6),
                "ratio": several.least / one.least,
                "ratio_of_medians": several.middle / one.middle,
                "same_bits": bool(
                    np.array_equal(both[1].forces(), both[THREADS].forces())
                    and both[1].report() == both[THREADS].report()
                ),
            }
        )
    return found


def section(*, seconds: float, sizes: tuple[int, ...] = SIZES) -> Section:
    """What a second thread gains; nobody gets one who did not ask for it."""
    title = f"{THREADS} threads against one, time on the wall"
    if most_threads() < THREADS:
        row = Row("a second thread", "this machine has one core")
        return Section("threads", title, (row,), {"threads": 1, "sizes": []})
    found = measure(sizes, seconds)
    rows = tuple(
        Row(
            f"an iteration at N = {one['grains']}",
            f"{one['several_us']['min']:.0f} / {one['one_us']['min']:.0f} µs = {one['ratio']:.2f} "
            f"(medians {one['ratio_of_medians']:.2f})",
            *_same(one["same_bits"]),
        )
        for one in found
    )
    return Section("threads", title, rows, {"threads": THREADS, "sizes": found})


def _same(bits: bool) -> tuple[str, bool]:
    return ("the same bits", True) if bits else ("the same bits: they differ", False)

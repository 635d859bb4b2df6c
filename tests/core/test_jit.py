"""Kernels: from the cache as when just compiled, and never from the cache of other sources."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from llvmlite import binding

from core import jit

REPOSITORY = Path(__file__).parents[2]
PROGRAM = """
from tests.core import examples
from core.relaxation import Relaxation
packing = examples.random_grains(30, 9.0, 5)
relaxation = Relaxation(packing, tolerance=1e-6)
report = relaxation.run(2000)
relaxation.write_back()
print(packing.hash(), report)
"""


def run_alone(cache: Path) -> tuple[str, float]:
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        cwd=REPOSITORY,
        env={**os.environ, "NUMBA_CACHE_DIR": str(cache), "PYTHONPATH": str(REPOSITORY)},
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    return done.stdout, time.perf_counter() - start


@pytest.mark.slow
def test_cached_kernels_give_the_same_bits(tmp_path: Path) -> None:
    """Compiled in one process, loaded from the disk in the next."""
    compiled, first = run_alone(tmp_path)
    files = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")}
    loaded, second = run_alone(tmp_path)
    assert len(files) > 3
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")} == files
    assert loaded == compiled
    assert second < first


@jit.kernel(cache=False)
def blown_up(values):  # type: ignore[no-untyped-def]
    """What the minimiser asks of its sums."""
    total = 0.0
    for value in values:
        total += value
    return not abs(total) < np.inf


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_fast_math_keeps_nan_and_inf(bad: float) -> None:
    values = np.arange(100.0)
    assert not blown_up(values)
    values[37] = bad
    assert blown_up(values)


def test_noalias_is_a_promise_not_another_result() -> None:
    """With and without the promise that arrays do not overlap: the same element-wise arithmetic."""

    def update(x, v, out):  # type: ignore[no-untyped-def]
        for i in range(x.shape[0]):
            out[i] = x[i] + 0.1 * v[i]

    x, v = np.random.default_rng(1).normal(size=(2, 1001))
    plain, promised = np.zeros(1001), np.zeros(1001)
    jit.kernel(cache=False)(update)(x, v, plain)
    jit.kernel(cache=False, noalias=True)(update)(x, v, promised)
    assert np.array_equal(plain, promised)
    assert plain == pytest.approx(x + 0.1 * v, rel=1e-15, abs=1e-15)


@pytest.mark.skipif(
    platform.machine().lower() not in {"x86_64", "amd64"} or binding.llvm_version_info < (18,),
    reason="nothing to ask for: another processor, or an LLVM that cannot be asked",
)
def test_scattered_values_are_loaded_one_by_one() -> None:
    """The pair forces vectorise, and without the gather instruction, which is the slower way."""
    config: Any = numba.config
    assert jit.NO_GATHER in config.CPU_FEATURES.split(",")

    def pick(chosen, values, out):  # type: ignore[no-untyped-def]
        for i in range(chosen.shape[0]):
            out[i] = 2.0 * values[chosen[i]]

    picking = jit.kernel(cache=False, noalias=True)(pick)
    chosen = np.random.default_rng(1).integers(0, 50, 101).astype(np.uint32)
    values, out = np.arange(50.0), np.zeros(101)
    picking(chosen, values, out)
    assert np.array_equal(out, 2.0 * chosen)
    (code,) = picking.inspect_asm().values()
    assert "vgather" not in code


def test_features_that_somebody_asked_for_are_left_alone() -> None:
    program = "import numba; from core import jit; print(numba.config.CPU_FEATURES)"
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=REPOSITORY,
        env={**os.environ, "NUMBA_CPU_FEATURES": "+sse2"},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert done.stdout.strip() == "+sse2"


def imports(*before: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """``core`` imported in a process of its own, after some lines."""
    return subprocess.run(
        [sys.executable, "-c", "\n".join([*before, "from core import jit"])],
        cwd=REPOSITORY,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.mark.skipif(
    platform.machine().lower() not in {"x86_64", "amd64"}, reason="no level of processors to choose"
)
def test_what_was_compiled_before_for_another_target_is_told() -> None:
    before = ("import numba", "@numba.njit", "def one(): return 1", "one()")
    assert "import core first" in imports(*before).stderr
    assert imports("import numba").stderr == ""


def test_without_a_compiler_there_is_one_sentence() -> None:
    done = imports(NUMBA_DISABLE_JIT="1")
    assert done.returncode != 0
    assert "InputError: the solver is nothing but compiled code: unset" in done.stderr

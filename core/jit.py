"""The one decorator for compiled kernels: flags, aliasing promise, and that they are kept on the disk (``kernel_cache``).

Three decisions live here and nowhere else:

- ``fastmath`` is cut down to the flags that keep ``nan`` and ``inf`` meaningful. Full fast math lets the compiler assume that
  neither occurs, and then ``isnan(nan)`` is False: a blown-up packing would look healthy.
- ``kernel(noalias=True)`` promises that no two array arguments overlap, which is what lets LLVM vectorise a loop that gathers and
  stores. Numba has the flag but no option for it; it is set by a custom compiler pipeline. Where a future Numba no longer takes
  that, the kernel is compiled without the promise: the same numbers, about half as fast.
- Values from scattered places are loaded one by one, not by the processor's gather instruction. On Zen 5 that makes the pair
  forces 11 to 18 % faster, and on many others gathers have been slow since a flaw was closed in 2023.
"""

from __future__ import annotations

import platform
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numba
from llvmlite import binding

from core.kernel_cache import keep

FAST_MATH = {"reassoc", "contract", "arcp", "nsz"}
NO_GATHER = "+prefer-no-gather"


def _noalias_pipeline() -> type | None:
    """Compiler pipeline that sets LLVM's noalias on array arguments, or None where Numba's inner workings have changed."""
    try:
        from numba.core import compiler
        from numba.core.targetconfig import Option

        if not isinstance(compiler.Flags.options["noalias"], Option):
            return None

        passes: Any = compiler.DefaultPassBuilder

        class NoAlias(compiler.CompilerBase):
            def define_pipelines(self) -> list[Any]:
                self.state.flags.noalias = True
                return [passes.define_nopython_pipeline(self.state)]

        return NoAlias
    except (ImportError, AttributeError, KeyError):
        return None


NOALIAS_PIPELINE = _noalias_pipeline()


def _load_one_by_one() -> None:
    """Ask LLVM for this processor's code without gathers, unless NUMBA_CPU_FEATURES has asked for something else."""
    config: Any = numba.config
    knows = platform.machine().lower() in {"x86_64", "amd64"} and binding.llvm_version_info >= (18,)
    if config.CPU_FEATURES is None and knows:
        with suppress(RuntimeError):  # LLVM does not know this processor
            config.CPU_FEATURES = f"{binding.get_host_cpu_features().flatten()},{NO_GATHER}"


_load_one_by_one()


def kernel(
    function: Callable[..., Any] | None = None, *, noalias: bool = False, **options: Any
) -> Any:
    """Compile a function to machine code that releases the GIL and is cached on disk.

    Use as ``@kernel`` or ``@kernel(noalias=True)``; further keywords go to ``numba.njit``. With ``cache=False`` nothing is kept.
    """

    def decorate(f: Callable[..., Any]) -> Any:
        flags: dict[str, Any] = {
            "nogil": True,
            "error_model": "numpy",
            "fastmath": FAST_MATH,
            # One copy of the code: else a first run, which has both, may call another copy of a
            # callee than a run from the cache, optimised differently in the last bit.
            "forceinline": True,
        }
        if noalias and NOALIAS_PIPELINE is not None:
            flags["pipeline_class"] = NOALIAS_PIPELINE
        flags.update(options)
        dispatcher = numba.njit(**flags)(f)
        if flags.get("cache", True):
            keep(dispatcher)
        return dispatcher

    return decorate if function is None else decorate(function)

"""The one decorator for compiled kernels: flags, cache folder, aliasing promise.

Three decisions live here and nowhere else:

- ``fastmath`` is cut down to the flags that keep ``nan`` and ``inf`` meaningful. Full fast math lets the compiler assume that
  neither occurs, and then ``isnan(nan)`` is False: a blown-up packing would look healthy.
- Numba's disk cache does not notice an edited callee in another file, so the cache folder carries a hash of every kernel source.
- ``kernel(noalias=True)`` promises that no two array arguments overlap, which is what lets LLVM vectorise a loop that gathers and
  stores. Numba has the flag but no option for it; it is set by a custom compiler pipeline. Where a future Numba no longer takes
  that, the kernel is compiled without the promise: the same numbers, about half as fast.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from platformdirs import user_cache_path

FAST_MATH = {"reassoc", "contract", "arcp", "nsz"}


def source_hash() -> str:
    """Hash of all kernel sources and of the compiler's version; changes when any of them does."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


if "NUMBA_CACHE_DIR" not in os.environ:
    _config: Any = numba.config
    _config.CACHE_DIR = str(user_cache_path("auxetic-sandbox") / f"kernels-{source_hash()}")


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


def kernel(
    function: Callable[..., Any] | None = None, *, noalias: bool = False, **options: Any
) -> Any:
    """Compile a function to machine code that releases the GIL and is cached on disk.

    Use as ``@kernel`` or ``@kernel(noalias=True)``; further keywords go to ``numba.njit``.
    """

    def decorate(f: Callable[..., Any]) -> Any:
        flags: dict[str, Any] = {
            "nogil": True,
            "cache": True,
            "error_model": "numpy",
            "fastmath": FAST_MATH,
            # One copy of the code: else a first run, which has both, may call another copy of a
            # callee than a run from the cache, optimised differently in the last bit.
            "forceinline": True,
        }
        if noalias and NOALIAS_PIPELINE is not None:
            flags["pipeline_class"] = NOALIAS_PIPELINE
        flags.update(options)
        return numba.njit(**flags)(f)

    return decorate if function is None else decorate(function)

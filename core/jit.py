"""The one decorator for compiled kernels: flags, aliasing promise, and that they are kept on the disk (``kernel_cache``).

Four decisions live here and nowhere else:

- ``fastmath`` is cut down to the flags that keep ``nan`` and ``inf`` meaningful. Full fast math lets the compiler assume that
  neither occurs, and then ``isnan(nan)`` is False: a blown-up packing would look healthy.
- ``kernel(noalias=True)`` promises that no two array arguments overlap, which is what lets LLVM vectorise a loop that gathers and
  stores. Numba has the flag but no option for it; it is set by a compiler pipeline of our own (``core.inlining``). Where a future
  Numba no longer takes that, the kernel is compiled without the promise: the same numbers, about half as fast.
- Kernels make no arrays, unless they say so with ``allocates=True``: without the code that counts references there is less to
  compile.
- Values from scattered places are loaded one by one, not by the processor's gather instruction. On Zen 5 that makes the pair
  forces 11 to 18 % faster, and on many others gathers have been slow since a flaw was closed in 2023.
"""

from __future__ import annotations

import logging
import platform
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

import numba
from llvmlite import binding
from numba.core.registry import cpu_target
from numba.extending import register_jitable

from core import inlining
from core.errors import InputError
from core.kernel_cache import keep

log = logging.getLogger(__name__)

Function = TypeVar("Function", bound=Callable[..., Any])

FAST_MATH = {"reassoc", "contract", "arcp", "nsz"}
NO_GATHER = "+prefer-no-gather"


PIPELINES = {noalias: inlining.pipelines(noalias) for noalias in (False, True)}


# Nearly every processor of the last ten years: AVX2 and fused multiplication. Wider registers make no kernel here faster.
LEVEL = "x86-64-v3"
LEVEL_FEATURES = [
    *[
        "64bit",
        "avx",
        "avx2",
        "bmi",
        "bmi2",
        "cmov",
        "crc32",
        "cx16",
        "cx8",
        "f16c",
        "fma",
        "fxsr",
        "lzcnt",
        "mmx",
        "movbe",
    ],
    *["popcnt", "sahf", "sse", "sse2", "sse3", "sse4.1", "sse4.2", "ssse3", "xsave"],
]


if getattr(numba.config, "DISABLE_JIT", False):
    raise InputError(
        "the solver is nothing but compiled code: unset the variable NUMBA_DISABLE_JIT"
    )


def _choose_processor() -> None:
    """Compile for a level of processors, if this one has it, else for this one; unless Numba's variables ask for something else.

    So the same commands give the same bits on all of them, and kernels compiled on one serve on another.
    """
    config: Any = numba.config
    asked = config.CPU_NAME is not None or config.CPU_FEATURES is not None
    if asked or platform.machine().lower() not in {"x86_64", "amd64"}:
        return
    if "_toplevel_target_context" in vars(cpu_target):
        log.warning(
            "Numba has compiled something before, for this very processor: last bits may differ from those of other starts; "
            "import core first"
        )
    with suppress(RuntimeError):  # LLVM does not know this processor
        here = binding.get_host_cpu_features()
        features = here.flatten()
        if all(here.get(name, False) for name in LEVEL_FEATURES):
            config.CPU_NAME = LEVEL
            features = ",".join(f"+{name}" for name in LEVEL_FEATURES)
        gathers = [NO_GATHER] if binding.llvm_version_info >= (18,) else []
        config.CPU_FEATURES = ",".join([features, *gathers])


_choose_processor()


def kernel(
    function: Callable[..., Any] | None = None,
    *,
    noalias: bool = False,
    allocates: bool = False,
    **options: Any,
) -> Any:
    """Compile a function to machine code that releases the GIL and is cached on disk.

    Use as ``@kernel`` or ``@kernel(noalias=True)``; ``allocates`` where it makes arrays; further keywords go to ``numba.njit``.
    With ``cache=False`` nothing is kept.
    """

    def decorate(f: Callable[..., Any]) -> Any:
        flags: dict[str, Any] = {
            "nogil": True,
            "error_model": "numpy",
            "fastmath": FAST_MATH,
            # One copy of the code: else a first run, which has both, may call another copy of a
            # callee than a run from the cache, optimised differently in the last bit.
            "forceinline": True,
            "_nrt": allocates,
        }
        flags.update(options)
        cached = flags.pop("cache", True)
        pipelines = None if flags.get("parallel") else PIPELINES[noalias]
        if pipelines is None:
            dispatcher = numba.njit(**flags)(f)
        else:
            dispatcher = numba.njit(pipeline_class=pipelines.outer, **flags)(f)
            inner = numba.njit(pipeline_class=pipelines.inner, **flags)(f)
            dispatcher.get_call_template = inner.get_call_template
            dispatcher.get_overload = inner.get_overload
        if cached:
            keep(dispatcher)
        return dispatcher

    return decorate if function is None else decorate(function)


def shared(function: Function) -> Function:
    """Python where Python calls it, and compiled where a kernel does.

    For what is done once a list or once an increment: on the desk it would take longer to compile than it ever saves; a page has
    nothing but kernels. Without fast math, so both come to the same bits.
    """
    jitable: Function = register_jitable(error_model="numpy")(function)
    return jitable

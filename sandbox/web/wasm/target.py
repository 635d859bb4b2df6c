"""Numba's own pipeline with LLVM's WebAssembly target: the same kernels, from the same Python source, for a browser.

The extra ``web`` pins Numba; it is used in a process of its own, which compiles nothing that it runs. ``aim`` must be called
before any module with kernels is imported:

- the target machine and data layout are those of wasm32; sizes and indices stay 64 bit, as in the same code on the desk;
- libraries are neither optimised nor emitted one by one: all of them are linked, and then optimised once (``linking``);
- fast math is off, as on the desk it may round otherwise on every processor;
- what allocates and counts references is left to ``runtime.c``, and what raises becomes a trap.
"""

from __future__ import annotations

import re
from typing import Any

import numba
from llvmlite import binding
from numba import extending
from numba.core import cgutils as numba_cgutils
from numba.core import codegen as numba_codegen
from numba.core import compiler as numba_compiler
from numba.core import runtime as numba_runtime
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target
from numba.np import arrayobj as numba_arrayobj

# Numba has no types.
cgutils: Any = numba_cgutils
arrayobj: Any = numba_arrayobj
codegen: Any = numba_codegen
compiler: Any = numba_compiler
rtsys: Any = numba_runtime.rtsys  # type: ignore[attr-defined]

PINNED = "0.68."  # what is used here of Numba has no promise to stay
TRIPLE = "wasm32-unknown-unknown"
# What every browser has had since 2023.
FEATURES = "+bulk-memory,+mutable-globals,+nontrapping-fptoint,+sign-ext,+simd128"
# One instruction each, if asked for as LLVM's intrinsic; by name they would be calls, and nothing around them would vectorise.
INSTRUCTIONS = ("ceil", "fabs", "floor", "rint", "sqrt", "trunc")

# Where the head of an allocation says its numbers are: see runtime.c.
_RUNTIME = """
%Held = type { i64, ptr, ptr, ptr, i64 }
define ptr @NRT_MemInfo_data_fast(ptr %held) alwaysinline {
  %place = getelementptr %Held, ptr %held, i32 0, i32 3
  %data = load ptr, ptr %place
  ret ptr %data
}
"""


def header() -> str:
    """The first lines of every module."""
    return f'target triple = "{TRIPLE}"\ntarget datalayout = "{machine().target_data}"\n'


def machine() -> Any:
    """LLVM's target machine."""
    target = binding.Target.from_triple(TRIPLE)
    return target.create_target_machine(cpu="generic", features=FEATURES, opt=3, reloc="static")


def as_instructions(text: str) -> str:
    """LLVM's code with the functions of ``INSTRUCTIONS`` as intrinsics."""
    for name in INSTRUCTIONS:
        called = rf'@"?{name}"?\('
        if not re.search(called, text):
            continue
        intrinsic = f"@llvm.{name}.f64("
        text = re.sub(rf"^declare double {called}.*$", "", text, flags=re.MULTILINE)
        text = re.sub(rf"double {called}", f"double {intrinsic}", text)
        if not re.search(rf'^declare double @"?llvm\.{name}\.f64', text, flags=re.MULTILINE):
            text += f"\ndeclare double {intrinsic}double)\n"
    return text


class Library(codegen.CPUCodeLibrary):  # type: ignore[misc]
    """Code that is never run here, and not optimised before all of it is together."""

    def add_ir_module(self, ir_module: Any) -> None:
        text = as_instructions(cgutils.normalize_ir_text(str(ir_module)))
        module = binding.parse_assembly(text)
        module.name = ir_module.name
        module.verify()
        self._final_module.link_in(module)

    def _optimize_final_module(self) -> None:
        """Later."""

    def _finalize_specific(self) -> None:
        """Nothing is loaded."""

    def get_pointer_to_function(self, name: str) -> int:
        del name
        self._ensure_finalized()
        return 8  # any number but 0: it is never called


def aim() -> None:
    """Let Numba compile for WebAssembly from now on, without fast math. It can compile for nothing else in this process then."""
    from core import jit
    from core.inlining import Pipelines

    if not numba.__version__.startswith(PINNED):
        raise RuntimeError(
            f"Numba {numba.__version__} is not the one that the extra 'web' pins, {PINNED}*"
        )
    binding.initialize_all_targets()
    binding.initialize_all_asmprinters()
    context = cpu_target.target_context  # which makes its runtime for this machine first
    own: Any = context._internal_codegen
    own._library_class = Library
    own._add_module = own.set_env = _nothing
    own._tm = machine()
    own._target_data = own._tm.target_data
    own._data_layout = str(own._target_data)
    own._create_empty_module = _empty
    with global_compiler_lock:
        runtime = Library(own, "runtime")
        runtime._final_module.link_in(binding.parse_assembly(header() + _RUNTIME))
        runtime.finalize()
    rtsys._library, rtsys._init = runtime, True
    pipelines = {noalias: pipeline(noalias) for noalias in (False, True)}
    module: Any = jit
    module.FAST_MATH = set()
    module.keep = _nothing
    module.PIPELINES = {noalias: Pipelines(each, each) for noalias, each in pipelines.items()}
    module.kernel = _once(jit.kernel)
    arrayobj.raise_with_shape_context = _mismatch


def _mismatch(source: Any, place: Any) -> None:
    """Numba's own writes the shapes into a text, which a page would carry along for nothing."""


@extending.overload(_mismatch, strict=False)
def _tell(source: Any, place: Any) -> Any:
    del source, place
    return _trap


def _trap(source: Any, place: Any) -> None:  # noqa: ARG001
    raise ValueError("an array does not fit where it is put")


def _once(kernel: Any) -> Any:
    """The decorator without its promise to put a copy of every kernel wherever one is called: a third of the size, as fast."""

    def decorator(function: Any = None, **options: Any) -> Any:
        return kernel(function, **{**options, "forceinline": False})

    return decorator


def _nothing(*_given: Any) -> None:
    """Nothing is loaded, nothing is kept."""


def _empty(name: str) -> Any:
    from llvmlite import ir

    module = ir.Module(cgutils.normalize_ir_text(name))
    module.triple, module.data_layout = TRIPLE, str(machine().target_data)
    return module


def pipeline(noalias: bool) -> type:
    """Numba's, with the promise of ``core.jit`` and without what calls a kernel from Python or C."""
    passes = compiler.DefaultPassBuilder

    class Pipeline(compiler.CompilerBase):  # type: ignore[misc]
        def define_pipelines(self) -> list[Any]:
            flags = self.state.flags
            flags.noalias = noalias
            flags.no_cfunc_wrapper = flags.no_cpython_wrapper = True
            return [passes.define_nopython_pipeline(self.state)]

    return Pipeline

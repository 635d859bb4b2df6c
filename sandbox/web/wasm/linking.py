"""Entry functions and all that they call, linked, optimised once, and written as one WebAssembly file."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numba
from llvmlite import binding
from numba import types

from sandbox.web.wasm.target import header, machine, pipeline

HERE = Path(__file__).parent
_LLVM = {"float64": "double", "int64": "i64", "none": "void"}
_DYNAMIC = (
    r'(@"?numba\.dynamic\.globals\.\S+ = )(?:linkonce )?(?:local_unnamed_addr )?'
    r"(?:global|constant) ptr inttoptr \(i64 \d+ to ptr\)"
)
# Only where an error is raised: such code becomes a trap.
_ERRORS = (
    *("PyErr_SetString", "PyErr_Format", "NRT_MemInfo_call_dtor", "numba_gil_ensure"),
    *("NRT_MemInfo_new_varsize_dtor", "NRT_MemInfo_varsize_realloc"),
)


def build(entries: Mapping[str, tuple[Any, Any]], out: Path) -> None:
    """Compile ``entries``, each a function and its signature of pointers and numbers, to the file ``out``.

    Raises RuntimeError where something is called that a browser has not.
    """
    whole = None
    for name, (function, signature) in entries.items():
        module = _compiled(name, function, signature)
        if whole is None:
            whole = module
        else:
            whole.link_in(module)
    assert whole is not None
    module = _trapping(whole)
    _optimise(module)
    with tempfile.TemporaryDirectory() as folder:
        kernels = Path(folder) / "kernels.o"
        kernels.write_bytes(machine().emit_object(module))
        _link(kernels, list(entries), out)


def _compiled(name: str, function: Any, signature: Any) -> Any:
    """LLVM's module with the function as ``name``, which returns its value, and traps where it would raise."""
    dispatcher = numba.njit(
        signature, nogil=True, error_model="numpy", pipeline_class=pipeline(noalias=False)
    )(function)
    result = dispatcher.overloads[signature.args]
    text = str(result.library._final_module)
    text = text.replace("= common ", "= internal ")
    text = re.sub(_DYNAMIC, r"\1internal global ptr null", text)
    text = re.sub(r'"target-(?:cpu|features)"="[^"]*"', "", text)
    module = binding.parse_assembly(text)
    entry = result.fndesc.llvm_func_name
    for inner in module.functions:
        if not inner.is_declaration and inner.name != entry:
            inner.linkage = "internal"
    returned = _LLVM[str(signature.return_type)]
    stored = "ptr" if returned == "void" else returned
    kinds = ["ptr" if isinstance(a, types.CPointer) else _LLVM[str(a)] for a in signature.args]
    given = ", ".join(f"{kind} %a{k}" for k, kind in enumerate(kinds))
    end = (
        "ret void"
        if returned == "void"
        else f"%value = load {returned}, ptr %result\n  ret {returned} %value"
    )
    module.link_in(
        binding.parse_assembly(f"""{header()}
declare i32 @"{entry}"({", ".join(["ptr", "ptr", *kinds])})
declare void @llvm.trap()
define {returned} @{name}({given}) {{
  %result = alloca {stored}
  %error = alloca ptr
  %status = call i32 @"{entry}"({", ".join(["ptr %result", "ptr %error", given])})
  %raised = icmp sgt i32 %status, 0
  br i1 %raised, label %trap, label %fine
trap:
  call void @llvm.trap()
  unreachable
fine:
  {end}
}}
""")
    )
    module.get_function(entry).linkage = "internal"
    return module


def _trapping(whole: Any) -> Any:
    """The module with traps in place of what reports errors to Python."""
    text = str(whole)
    for name in _ERRORS:
        found = re.search(rf"^declare (.*)@{name}\((.*?)\).*$", text, flags=re.MULTILINE)
        if found:
            kind = found[1].split()[-1]
            trap = f"define internal {kind} @{name}({found[2]}) noreturn nounwind {{\n  call void @llvm.trap()\n  unreachable\n}}"
            text = text.replace(found[0], trap)
    module = binding.parse_assembly(text)
    module.verify()
    return module


def _optimise(module: Any) -> None:
    """All of it at once, as nothing but the entries is called from outside."""
    target = machine()
    options = binding.create_pipeline_tuning_options(speed_level=3)
    options.loop_vectorization, options.slp_vectorization = True, False
    # A tenth smaller than with the defaults, and a little faster.
    options.loop_unrolling, options.inlining_threshold = False, 100
    passes = binding.create_pass_builder(target, options)
    passes.getModulePassManager().run(module, passes)


def _link(kernels: Path, names: list[str], out: Path) -> None:
    """With the runtime, by the linker that comes with Zig. Raises RuntimeError where it says no."""
    zig = [sys.executable, "-m", "ziglang"]
    exports = [f"-Wl,--export={name}" for name in names]
    command = [
        *(*zig, "cc", "--target=wasm32-freestanding", "-O2", "-fno-sanitize=all"),
        *("-Wl,--no-entry", "-Wl,--gc-sections", "-Wl,--strip-all", "-Wl,-z,stack-size=262144"),
        *(*exports, str(HERE / "runtime.c"), str(kernels), "-o", str(out)),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"the linker says:\n{done.stderr}")

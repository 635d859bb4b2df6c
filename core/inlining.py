"""Compile a kernel that other kernels call once where it ends up, and not by itself before: the first start is half as long.

Numba optimises, emits and wraps every callee before it is inlined, and all of that is thrown away. Here a kernel has two
compilers: ``outer`` for calls from Python, and ``inner`` for calls from other kernels, which stops at LLVM's code before any of
it is machine code. Their code is the same; so are their bits.

What is used of Numba has no promise to stay. Where it is not as expected, ``pipelines`` says None, and kernels are compiled the
plain way: the same numbers, later.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from core.signatures import Remembering


class Pipelines(NamedTuple):
    """Compiler pipelines of a kernel."""

    outer: type
    inner: type


def pipelines(noalias: bool) -> Pipelines | None:
    """Both pipelines; None where Numba's inner workings have changed.

    ``noalias`` promises LLVM that no two array arguments overlap. Numba has the flag but no option for it.
    """
    try:
        from numba.core import codegen
        from numba.core import compiler as numba_compiler
        from numba.core import compiler_lock as numba_lock
        from numba.core.targetconfig import Option
        from numba.core.typing.context import BaseContext

        compiler: Any = numba_compiler
        lock: Any = numba_lock.require_global_compiler_lock
        passes: Any = compiler.DefaultPassBuilder
        known = all(
            isinstance(compiler.Flags.options[name], Option)
            for name in ("noalias", "no_cfunc_wrapper", "no_cpython_wrapper")
        )
        library: Any = codegen.JITCodeLibrary
        used = (
            "_finalize_specific",
            "_optimize_final_module",
            "_get_module_for_linking",
            "_raise_if_finalized",
        )
        if not known or not all(hasattr(library, name) for name in used):
            return None
        if not hasattr(BaseContext, "resolve_function_type"):
            return None
    except (ImportError, AttributeError, KeyError):
        return None

    class NoEnvironment:
        """Of a library that is never loaded: its environments are set where it ends up."""

        def set_env(self, name: str, env: object) -> None:
            """Not here."""

    class InnerLibrary(library):  # type: ignore[misc]
        """Code that is only ever inlined into other code."""

        def finalize(self) -> None:
            lock()
            self._raise_if_finalized()
            for callee in dict.fromkeys(self._linking_libraries):
                self._reload_init.update(callee._reload_init)
                self._final_module.link_in(callee._get_module_for_linking(), preserve=True)
            if (
                noalias
            ):  # the promise is forgotten where the code is inlined: what it allows is done before
                self._optimize_final_module()
            self._finalized = True

        def get_pointer_to_function(self, name: str) -> int:
            del name
            self._ensure_finalized()
            return 0

        @property
        def codegen(self) -> Any:
            return NoEnvironment()

    class OuterLibrary(library):  # type: ignore[misc]
        """Code that Python calls. It sets the environments of what was inlined into it."""

        def _finalize_specific(self) -> None:
            super()._finalize_specific()
            for variable in self._final_module.global_variables:
                if variable.name.startswith("_ZN08NumbaEnv"):
                    environment = compiler.lookup_environment(variable.name)
                    if environment is not None:
                        self._codegen.set_env(variable.name, environment)

    def pipeline(kind: Any, wrapped: bool) -> type:
        class Pipeline(compiler.CompilerBase):  # type: ignore[misc]
            def define_pipelines(self) -> list[Any]:
                state = self.state
                state.flags.noalias = noalias
                state.flags.no_cfunc_wrapper = True
                state.flags.no_cpython_wrapper = not wrapped
                state.typingctx = Remembering(state.typingctx, state.flags)
                state.library = kind(state.targetctx.codegen(), state.func_id.func_qualname)
                if wrapped:
                    state.library.enable_object_caching()
                return [passes.define_nopython_pipeline(state)]

        return Pipeline

    return Pipelines(pipeline(OuterLibrary, True), pipeline(InnerLibrary, False))

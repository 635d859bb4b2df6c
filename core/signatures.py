"""What an operation gives for the types that it is given, asked of Numba once: a tenth of a first start.

Numba tries all that it knows of an operator, arrays, sets and strings among it, wherever the operator stands, and again whenever
the type of any variable around it becomes known. The answer is the same each time.
"""

from __future__ import annotations

from typing import Any

from numba.core import types

_ANSWERS: dict[tuple[object, ...], tuple[object, ...]] = {}


class Remembering:
    """A typing context of Numba's that remembers what operations of its own gave, for kernels with the same flags."""

    def __init__(self, context: Any, flags: Any) -> None:
        self._context = context
        self._flags = repr(flags)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def resolve_function_type(self, function: Any, args: Any, kws: Any) -> Any:
        """Signature of a call with arguments of these types. Raises what Numba raises where there is none."""
        # Operators come as they are. What kernels and methods give is remembered elsewhere.
        if kws or (isinstance(function, types.Type) and not isinstance(function, types.Function)):
            return self._context.resolve_function_type(function, args, kws)
        context = self._context
        key = id(context), id(function), tuple(args), self._flags
        if key not in _ANSWERS:
            # Kept with both, which would else leave their places, and with them their ids, to others.
            _ANSWERS[key] = context.resolve_function_type(function, args, kws), context, function
        return _ANSWERS[key][0]

"""What operations give for types is asked once, and kernels are compiled as if it were asked each time."""

from __future__ import annotations

import operator
from typing import Any

import numba
import numpy as np
import pytest
from numba.core import types
from numba.core.errors import TypingError

from core import jit
from core.signatures import Remembering


class Context:
    """Counts how often it is asked, and answers with the types."""

    name = "numba's"

    def __init__(self) -> None:
        self.asked = 0

    def resolve_function_type(self, function: Any, args: Any, kws: Any) -> Any:
        self.asked += 1
        if types.unicode_type in args:
            raise TypingError("no number")
        return function, tuple(args), tuple(kws)


def test_an_operation_is_asked_for_once_for_each_types_and_flags() -> None:
    context = Context()
    fast, plain = Remembering(context, "fast"), Remembering(context, "plain")
    floats, mixed = (types.float64, types.float64), (types.int64, types.float64)
    for _ in range(3):
        assert fast.resolve_function_type(operator.add, floats, {})[1] == floats
        assert fast.resolve_function_type(operator.add, mixed, {})[1] == mixed
        assert fast.resolve_function_type(operator.sub, mixed, {})[0] is operator.sub
        assert plain.resolve_function_type(operator.add, floats, {})[1] == floats
    assert context.asked == 4


def test_what_is_no_operation_of_its_own_is_asked_for_each_time() -> None:
    context = Context()
    remembering = Remembering(context, "flags")
    for _ in range(2):
        remembering.resolve_function_type(types.float64, (types.int64,), {})
        remembering.resolve_function_type(operator.add, (types.int64,), {"out": types.int64})
    assert context.asked == 4
    assert remembering.name == "numba's"


def test_a_mistake_is_not_remembered() -> None:
    context = Context()
    remembering = Remembering(context, "flags")
    for _ in range(2):
        with pytest.raises(TypingError, match="no number"):
            remembering.resolve_function_type(operator.add, (types.unicode_type,), {})
    assert context.asked == 2


def test_contexts_do_not_share_answers() -> None:
    one, other = Context(), Context()
    for context in (one, other):
        Remembering(context, "flags").resolve_function_type(operator.add, (types.int64,), {})
    assert one.asked == other.asked == 1


def test_a_kernel_adds_whatever_it_is_given() -> None:
    """One source, many types, in both orders: an answer for others would give another type or wrong bits."""

    def add(a, b):  # type: ignore[no-untyped-def]
        return a + b

    ours, numbas = jit.kernel(cache=False, allocates=True)(add), numba.njit(add)
    given = [3, 2.5, np.float32(0.1), np.arange(3)]
    for a in given:
        for b in given:
            found, expected = ours(a, b), numbas(a, b)
            assert type(found) is type(expected), (a, b)
            assert np.asarray(found).dtype == np.asarray(expected).dtype
            assert np.array_equal(found, expected), (a, b)


def test_a_kernel_that_cannot_be_compiled_says_so_each_time() -> None:
    @jit.kernel(cache=False)
    def add(a, b):  # type: ignore[no-untyped-def]
        return a + b

    for _ in range(2):
        with pytest.raises(TypingError):
            add(1.0, "one")
    assert add(1.0, 2.0) == 3.0

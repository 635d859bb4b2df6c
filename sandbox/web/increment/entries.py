"""What a browser calls: kernels over memory that is given by its addresses."""

from __future__ import annotations

from typing import Any

import numba
from numba import types

from core.jit import kernel
from sandbox.web.increment import course
from sandbox.web.increment.memory import Kept
from sandbox.web.increment.observe import observe

carray: Any = numba.carray  # type: ignore[attr-defined]
_I, _F = types.CPointer(types.int64), types.CPointer(types.float64)
_NUMBER, _WHOLE = types.float64, types.int64


@kernel(allocates=True)
def blocks(ints, floats, whole, others):
    """Both blocks, so and so long."""
    return Kept(carray(ints, (whole,)), carray(floats, (others,)))


def advance(ints, whole, floats, others):
    """``course.advance``, and what is to be seen of it."""
    kept = blocks(ints, floats, whole, others)
    made = course.advance(kept)
    if made:
        observe(kept)
    return made


def command(ints, whole, floats, others, kind, body, x, y):
    """``course.command``."""
    course.command(blocks(ints, floats, whole, others), kind, body, x, y)


def set_strength(ints, whole, floats, others, value):
    """``course.set_strength``."""
    course.set_strength(blocks(ints, floats, whole, others), value)


def set_friction(ints, whole, floats, others, value):
    """``course.set_friction``."""
    course.set_friction(blocks(ints, floats, whole, others), value)


def set_ratio(ints, whole, floats, others, auxetic, value):
    """``course.set_ratio``."""
    course.set_ratio(blocks(ints, floats, whole, others), auxetic, value)


def set_ratios(ints, whole, floats, others, size):
    """``course.set_ratios``."""
    course.set_ratios(blocks(ints, floats, whole, others), size)


def set_weight(ints, whole, floats, others, weight, fall):
    """``course.set_weight``."""
    course.set_weight(blocks(ints, floats, whole, others), weight, fall)


_KEPT = (_I, _WHOLE, _F, _WHOLE)
ENTRIES: dict[str, tuple[Any, Any]] = {
    "advance": (advance, _WHOLE(*_KEPT)),
    "command": (command, types.void(*_KEPT, _WHOLE, _WHOLE, _NUMBER, _NUMBER)),
    "set_strength": (set_strength, types.void(*_KEPT, _NUMBER)),
    "set_friction": (set_friction, types.void(*_KEPT, _NUMBER)),
    "set_ratio": (set_ratio, types.void(*_KEPT, _WHOLE, _NUMBER)),
    "set_ratios": (set_ratios, types.void(*_KEPT, _NUMBER)),
    "set_weight": (set_weight, types.void(*_KEPT, _NUMBER, _NUMBER)),
}

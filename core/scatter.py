"""Columns of a table added to rows of another, eight at a time.

Adding eight numbers to a row that is found by an index takes 24 loads and stores, one after another: Numba has the compiler's
pass that would join them switched off. Here eight columns of eight are loaded as vectors, transposed in registers, and each is
added at once. What is handed to the compiler is plain LLVM, which every processor has: it is cut up where vectors are shorter.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

WIDTH = 8  # numbers in a row of the target, and columns that are added at a time
_intrinsic: Any = intrinsic  # callers do not give the first argument
_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)


@_intrinsic
def add_columns(_context: Any, table: Any, first: Any, row: Any, target: Any) -> Any:
    """target[row[first + n], m] += table[m, first + n] for m and n from 0 to 7, n in this order.

    ``table`` (8, E) and ``target`` (N, 8) float64, ``row`` (E,) uint32, ``first`` uint64.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        arrays = [
            context.make_array(kind)(context, builder, value)
            for kind, value in zip(signature.args, arguments, strict=True)
            if isinstance(kind, types.Array)
        ]
        columns, rows, target = (array.data for array in arrays)
        first, length = arguments[1], builder.extract_value(arrays[0].shape, 1)
        integer = first.type

        def vector(start: Any, place: Any) -> Any:
            return builder.bitcast(builder.gep(start, [place]), _VECTOR.as_pointer())

        lines = []
        for m in range(WIDTH):
            place = builder.add(first, builder.mul(length, integer(m)))
            lines.append(builder.load(vector(columns, place), align=8))
        for n, column in enumerate(_transposed(builder, lines)):
            index = builder.load(builder.gep(rows, [builder.add(first, integer(n))]))
            place = vector(target, builder.mul(builder.zext(index, integer), integer(WIDTH)))
            builder.store(builder.fadd(builder.load(place, align=8), column), place, align=8)
        return context.get_dummy_value()

    return types.void(table, first, row, target), generate


def _transposed(builder: Any, lines: list[Any]) -> list[Any]:
    """Eight vectors of eight, transposed: blocks of 1, then of 2, then of 4 change places across the diagonal."""
    indices = ir.VectorType(ir.IntType(32), WIDTH)
    for block in (1, 2, 4):
        upper = [n if not n & block else WIDTH + n - block for n in range(WIDTH)]
        lower = [n + block if not n & block else WIDTH + n for n in range(WIDTH)]
        for m in range(WIDTH):
            if not m & block:
                both = lines[m], lines[m + block]
                lines[m], lines[m + block] = (
                    builder.shuffle_vector(*both, ir.Constant(indices, picked))
                    for picked in (upper, lower)
                )
    return lines

"""x to the power of y, to the last digits: where WebAssembly runs there is no library of functions."""

from __future__ import annotations

import math

from core.jit import kernel

LN_2 = math.log(2.0)
TERMS = 20  # of a series: the last is below 1e-17


@kernel
def power(base, exponent):
    """Of a positive base: exp(y ln x), with ln x = n ln 2 + 2 artanh((m − 1)/(m + 1)) for x = 2ⁿ m and m near 1."""
    if base <= 0.0:
        return 0.0 if exponent > 0.0 else 1.0
    twos = 0.0
    while base > 1.5:
        base *= 0.5
        twos += 1.0
    while base < 0.75:
        base *= 2.0
        twos -= 1.0
    z = (base - 1.0) / (base + 1.0)
    logarithm, term = twos * LN_2, 2.0 * z
    for k in range(TERMS):
        logarithm += term / (2 * k + 1)
        term *= z * z
    way = exponent * logarithm
    halvings = 0
    while abs(way) > 0.5:
        way *= 0.5
        halvings += 1
    result, term = 1.0, 1.0
    for k in range(1, TERMS):
        term *= way / k
        result += term
    for _ in range(halvings):
        result *= result
    return result

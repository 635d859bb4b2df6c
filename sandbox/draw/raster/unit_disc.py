"""From pixels to a grain's own frame."""

from __future__ import annotations

import math

from core.jit import kernel


@kernel
def to_unit_disc(p: float, q1: float, q2: float, scale: float, turn: float) -> tuple[float, ...]:
    """Pixel offset -> unit disc -> turned: the four entries of (u, v) = m (dx, dy), row by row."""
    s11 = scale * (p + q1)
    s22 = scale * (p - q1)
    s12 = -scale * q2  # the screen's y runs down
    determinant = s11 * s22 - s12 * s12
    cosine = math.cos(turn)
    sine = math.sin(turn)
    return (
        (cosine * s22 + sine * s12) / determinant,
        (-cosine * s12 - sine * s11) / determinant,
        (sine * s22 - cosine * s12) / determinant,
        (-sine * s12 + cosine * s11) / determinant,
    )

"""What is plotted in place of force against stroke, in the scenes that have a ``Curve`` of their own."""

from __future__ import annotations

import math

from core.jit import kernel

FORCE, ROW_OF_GRAINS, PRESS, GRAINS_OUT, SHEAR = range(5)
LEFT, RIGHT = 1, 2  # walls at the ends of a row of grains


@kernel
def plotted(kind, stroke, resisting, reactions, side, high, number, out):
    """What goes along and against it. ``stroke`` [R] and ``resisting`` [k R] are those of the driven body.

    A row of grains (``scenes.grain_row``): its compression [% of a diameter] and the force on the walls at its ends [k R].
    A press (``scenes.biaxial_press``) of that ``side`` [R]: the area lost [%] and the pressure on its lid [k].
    A shear cell (``scenes.couette``), ``side`` [R] wide, whose upper plate is ``high`` [R]: shear strain and shear stress [k].
    A hopper under gravity: the ``number`` of the increment, and how many grains are ``out``.
    """
    if kind == ROW_OF_GRAINS:
        return 50.0 * stroke, 0.5 * (reactions[RIGHT, 0] - reactions[LEFT, 0])
    if kind == PRESS:
        now = side - stroke / math.sqrt(2.0)
        return 100.0 * (1.0 - (now / side) ** 2), resisting / (math.sqrt(2.0) * now)
    if kind == SHEAR:
        return stroke / high, resisting / side
    if kind == GRAINS_OUT:
        return float(number), float(out)
    return stroke, resisting

"""How FIRE steers: after each evaluation, how long the next time step is and what becomes of the velocity.

Bitzek et al., doi:10.1103/PhysRevLett.97.170201. Velocity is turned towards the force, keeping its length, by a share α that
starts high and falls with every step; velocity that no longer goes downhill is thrown away, and α starts again. The numbers are
not those of the paper, which were chosen for atoms. At the tolerances of the scenes they need a quarter fewer evaluations than
α = 0.1, decay 0.99, a delay of 5 steps, dt halved and half a step back (mean over scenes and packings, 4 seeds, 60 increments:
0.53 of them in a row of grains, 0.79 with the intruder, 1.06 under gravity); at 1e-8 as many:

- α is high for some twenty steps only. Then the grains coast: what is left to do are slow modes, and turning would brake them.
- Velocity is thrown away a little before it stands across the force, at LEAST_COSINE: the last of the way to the turning point
  brings next to nothing. So there is no step back either, which alone saves 5 %.
- dt is bounded by the contacts' stiffness and not by what steers here: it hardly shrinks, and grows again at once.
"""

from __future__ import annotations

import math

from core.jit import kernel

ALPHA_START, ALPHA_DECAY = 0.25, 0.96
LEAST_COSINE = 0.03  # between velocity and force, lengths taken with the inertias
DT_START, DT_SHRINK_FLOOR = 0.5, 1e-3  # first and least dt, as a fraction of dt_max
DT_GROW, DT_SHRINK = 1.1, 0.8


@kernel
def steer(power, force_square, speed_square, dt, alpha, dt_max):
    """What to do next, from F·v, Σ F²/m and Σ m v². Returns (dt, α, keep, push) for the kick v ← keep v + push F/m."""
    if power > LEAST_COSINE * math.sqrt(force_square * speed_square):
        longer = min(dt * DT_GROW, dt_max)
        turn = alpha * math.sqrt(speed_square / force_square)
        return longer, alpha * ALPHA_DECAY, 1.0 - alpha, turn + 0.5 * longer
    shorter = max(dt * DT_SHRINK, DT_SHRINK_FLOOR * dt_max)
    return shorter, ALPHA_START, 0.0, 0.5 * shorter

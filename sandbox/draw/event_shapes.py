"""The shapes of the marks of events: never colour alone."""

from __future__ import annotations

# Corners of the marks, the y axis up; an arch points up, an avalanche down, a clog is a block, a locked hand a diamond.
SHAPES = {
    "locked": ((0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)),
    "arch": ((-1.0, -0.8), (1.0, -0.8), (0.0, 1.0)),
    "avalanche": ((-1.0, 0.8), (0.0, -1.0), (1.0, 0.8)),
    "clog": ((-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8)),
}

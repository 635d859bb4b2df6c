"""The scene in which nothing is relaxed: the contact distance of two ellipses, by the law and by more and more exact means."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.arrays import Floats
from core.exact import contact_distance
from core.jit import kernel
from sandbox.ensemble.clock import clock
from sandbox.studies.accuracy.exact import quadratic, tilt
from scenes.scene import Scene

HALVINGS = (
    0,
    1,
    2,
    4,
    8,
    16,
    32,
)  # of the interval in which the exact direction lies; 0: the law, which asks no further
ASPECTS = (1.05, 1.1, 1.2, 1.4, 2.0)
TIMED = 20_000  # contacts


@kernel
def distances(states, angles, halvings, times, found):
    """Contact distances [R] of pairs ``states`` (M, 5, 2) in directions ``angles`` (M,) into ``found`` (M,), ``times`` over."""
    for _ in range(times):
        for k in range(states.shape[0]):
            state = states[k]
            ex = np.cos(angles[k])
            ey = np.sin(angles[k])
            a, b, c = quadratic(state, 0, ex, ey)
            d, e, f = quadratic(state, 1, ex, ey)
            t = 0.0
            if halvings > 0:
                t = tilt(a, b, c, d, e, f, halvings)
            found[k] = np.sqrt(a + 2.0 * b * t + c * t * t) + np.sqrt(d + 2.0 * e * t + f * t * t)


def contact_job(scene: Scene, steps: int) -> dict[str, Any]:
    """Errors of the contact distance over the scripted drive, relative to a diameter, and what a contact costs."""
    return {
        "contact": [_one(scene, aspect, steps) for aspect in ASPECTS],
        "halvings": _halvings(scene, steps),
        "grains": 2,
        "length": steps,
    }


def _positions(scene: Scene, aspect: float, steps: int) -> tuple[Floats, Floats, Floats]:
    """States (M, 5, 2), directions (M,) and exact distances (M,) of ``steps`` positions: one grain turns, the other stands."""
    settings = scene.settings({"aspect": aspect})
    packing = scene.build(settings, "mixed", 1).packing
    a, b = packing.semi_axes
    states, exact = [], []
    for tilt_angle in np.linspace(0.0, np.pi, steps, endpoint=False):
        packing.set_axes(a, b, [tilt_angle, 0.6180339887 * tilt_angle])
        states.append(packing.state.copy())
        exact.append(contact_distance(packing, 0, 1, 0.0))
    return np.array(states), np.zeros(steps), np.array(exact)


def _one(scene: Scene, aspect: float, steps: int) -> dict[str, float]:
    states, angles, exact = _positions(scene, aspect, steps)
    found = np.empty(steps)
    distances(states, angles, 0, 1, found)
    early = (found - exact) / 2.0
    return {"aspect": aspect, "mean": float(early.mean()), "most": float(early.max())}


def _halvings(scene: Scene, steps: int) -> list[dict[str, float]]:
    settings = scene.settings()
    states, angles, exact = _positions(scene, float(settings["aspect"]), steps)
    found, times = np.empty(steps), max(1, TIMED // steps)
    rows = []
    for halvings in HALVINGS:
        distances(states, angles, halvings, 1, found)
        began = clock()
        distances(states, angles, halvings, times, found)
        seconds = (clock() - began) / (times * steps)
        error = np.abs(found - exact) / 2.0
        rows.append(
            {
                "halvings": halvings,
                "seconds": seconds,
                "error": float(np.sqrt(np.mean(error**2))),
                "most": float(error.max()),
            }
        )
    return rows

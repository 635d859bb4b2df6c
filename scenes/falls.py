"""Avalanches of driven scenes: the force that resists the drive falls all at once."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.avalanches import force_changes, weights
from core.packing import Packing
from core.rigid import Point
from scenes.remarks import Latest
from scenes.scene import Setup

# Chosen so that a scripted drive through 300 grains has one or two a grain diameter at most.
OF_MEAN = 0.5  # of the mean size of the force so far: smaller falls are none
OF_FORCE = 0.3  # of the force before the fall
SHORTEST = 10  # rows before which there is no mean to speak of
STRAIGHT = 0.9  # cosine: a drive that turns further feels another force because it turns


def sudden_fall(setup: Setup, latest: Latest) -> float:
    """By how much the plotted force has fallen in the newest increment, 0 if that was no avalanche.

    Only while the drive goes on as it went: where a hand turns back, or something was changed, the force falls as well.
    """
    curve = latest.curve
    if latest.earlier is None or curve.shape[1] < SHORTEST:
        return 0.0
    (first, second, third), (_, before, now) = curve[:, -3:].tolist()
    onwards = min(third - second, second - first) > 0.0
    backwards = max(third - second, second - first) < 0.0
    if not (onwards or backwards) or not _straight_on(setup, latest):
        return 0.0
    if backwards:
        before, now = -before, -now
    fall = before - now
    if not (before > 0.0 and fall > OF_FORCE * before):
        return 0.0
    return fall if fall > OF_MEAN * float(np.abs(curve[1]).mean()) else 0.0


def who_took_part(packing: Packing, latest: Latest) -> NDArray[np.bool_] | None:
    """Grains whose contact forces changed more than those of a grain on average in the newest increment, (N,)."""
    if latest.earlier is None or not len(packing):
        return None
    earlier = latest.earlier
    changes = force_changes(
        earlier.increment.grain_contacts, latest.now.grain_contacts, earlier.label, packing.label
    )
    weight = weights(changes, packing.label)
    moved: NDArray[np.bool_] = weight > weight.mean()
    return moved


def _straight_on(setup: Setup, latest: Latest) -> bool:
    """False if a body that can be dragged anywhere has turned."""
    assert latest.earlier is not None
    drive = setup.handles[0].body
    here, there = (
        increment.moved.get(drive) for increment in (latest.now, latest.earlier.increment)
    )
    if here is None or there is None:
        return here is there  # the handle of a periodic cell is no body
    return _dot(here, there) > STRAIGHT * math.sqrt(_dot(here, here) * _dot(there, there))


def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1]

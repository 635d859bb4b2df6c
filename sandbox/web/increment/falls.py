"""``scenes.falls`` as kernels: the force that resists the drive falls all at once, and who took part."""

from __future__ import annotations

import math

import numpy as np

from core.jit import kernel
from sandbox.web.increment.contacts import FORCE
from sandbox.web.increment.memory import (
    COUNTS,
    DRIVE,
    PART,
    ROW,
    SIZES,
    counts_of,
    floats_at,
    ints_at,
    row_of,
)
from sandbox.web.increment.systems import ASKED
from scenes.falls import OF_FORCE, OF_MEAN, SHORTEST, STRAIGHT

GRAIN = 2**31


@kernel(allocates=True)
def drive_of(kept):
    """The part ``drive``."""
    return floats_at(kept, PART.drive, len(DRIVE))


@kernel(allocates=True)
def sudden_fall(kept, system):
    """By how much the plotted force has fallen, 0 if that was no avalanche: see there."""
    counts, row, drive = counts_of(kept), row_of(kept), drive_of(kept)
    rows, body = counts[COUNTS.rows], counts[COUNTS.driven]
    if counts[COUNTS.changed] or rows < SHORTEST:
        return 0.0
    way = np.sign(drive[DRIVE.stroke] - drive[DRIVE.older_stroke])
    if way == 0.0 or np.sign(row[ROW.stroke] - drive[DRIVE.stroke]) != way:
        return 0.0
    if system.wanted[body, ASKED] == 0.0 or drive[DRIVE.asked] == 0.0:
        return 0.0
    x, y = system.past.moved[body]
    old_x, old_y = drive[DRIVE.moved_x], drive[DRIVE.moved_y]
    squares = (x * x + y * y) * (old_x * old_x + old_y * old_y)
    if not x * old_x + y * old_y > STRAIGHT * math.sqrt(squares):
        return 0.0
    before, now = drive[DRIVE.force] * way, row[ROW.resisting] * way
    mean = (drive[DRIVE.sum] + abs(row[ROW.resisting])) / rows
    least = max(OF_MEAN * mean, OF_FORCE * before)
    return before - now if before > 0.0 and before - now > least else 0.0


@kernel
def key(first, second):
    """Of a contact between grains with these labels."""
    return min(first, second) * GRAIN + max(first, second)


@kernel(allocates=True)
def who_took_part(kept, system, contacts):
    """1 for the grains (N,) whose contact forces changed more than those of a grain on average."""
    counts, label = counts_of(kept), system.grains.label
    n, before = label.shape[0], counts[COUNTS.before]
    keys, forces = (
        ints_at(kept, PART.pair_before, before),
        floats_at(kept, PART.force_before, before),
    )
    place = np.full(kept.ints[SIZES.capacity], -1)
    for i in range(n):
        place[label[i]] = i
    weight, there = np.zeros(n), np.zeros(before, np.bool_)
    for k in range(contacts.i.shape[0]):
        i, j, change = contacts.i[k], contacts.j[k], contacts.pair[FORCE, k]
        mine = key(label[i], label[j])
        for old in range(before):
            if keys[old] == mine:
                change -= forces[old]
                there[old] = True
                break
        weight[i] += change * change
        weight[j] += change * change
    for old in range(before):
        if not there[old]:
            for one in (keys[old] // GRAIN, keys[old] % GRAIN):
                if place[one] >= 0:
                    weight[place[one]] += forces[old] * forces[old]
    mean = 0.0
    for i in range(n):
        mean += weight[i] / n
    moved = np.zeros(n, np.int64)
    for i in range(n):
        moved[i] = 1 if weight[i] > mean else 0
    return moved


@kernel(allocates=True)
def remember(kept, system, contacts):
    """What the next increment is held against."""
    counts, row, drive = counts_of(kept), row_of(kept), drive_of(kept)
    body, label = counts[COUNTS.driven], system.grains.label
    drive[DRIVE.older_stroke], drive[DRIVE.older_force] = drive[DRIVE.stroke], drive[DRIVE.force]
    drive[DRIVE.stroke], drive[DRIVE.force] = row[ROW.stroke], row[ROW.resisting]
    drive[DRIVE.sum] += abs(row[ROW.resisting])
    fx, fy = system.past.reactions[body, 0], system.past.reactions[body, 1]
    drive[DRIVE.felt] += math.sqrt(fx * fx + fy * fy)
    drive[DRIVE.asked] = system.wanted[body, ASKED]
    drive[DRIVE.moved_x], drive[DRIVE.moved_y] = system.past.moved[body]
    pairs = min(contacts.i.shape[0], kept.ints[SIZES.contacts])
    keys, forces = (
        ints_at(kept, PART.pair_before, pairs),
        floats_at(kept, PART.force_before, pairs),
    )
    for k in range(pairs):
        keys[k] = key(label[contacts.i[k]], label[contacts.j[k]])
        forces[k] = contacts.pair[FORCE, k]
    counts[COUNTS.before] = pairs

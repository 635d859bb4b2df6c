"""Once a list: which pairs may touch with friction, what each of them remembers, and what corners share.

K pairs, each once: first P of two grains, then B of a grain and a primitive. Sums in the order that they are written in: the same
bits wherever they are compiled.
"""

from __future__ import annotations

from core.jit import kernel
from core.neighbors import SLOT_PADDING
from core.packing import MAX_LABEL
from core.rigid_contacts import EDGE, VERTEX

BODY = MAX_LABEL  # keys of primitives begin here; labels of grains stay below
GRAIN = 2 * MAX_LABEL
NONE = -1
SAME_POINT = 1e-9  # [R]


@kernel
def list_candidates(pairs, lists, identity, label, grain, primitive, at_i, at_j, keys):
    """Fill ``at_i`` (K,) and ``at_j`` (P,), places in the minimiser's order, and ``keys`` (K,) of all pairs.

    ``identity`` (N,) is who stands at each place, ``label`` (N,) is in the packing's order; ``grain`` and ``primitive`` (B,).
    """
    place, first, second = lists.place, lists.first, lists.second
    for k in range(pairs):
        i, j = place[first[k]], place[second[k]]
        a, b = label[identity[i]], label[identity[j]]
        at_i[k] = i
        at_j[k] = j
        keys[k] = min(a, b) * GRAIN + max(a, b)
    for k in range(grain.shape[0]):
        at_i[pairs + k] = grain[k]
        keys[pairs + k] = label[identity[grain[k]]] * GRAIN + BODY + primitive[k]


@kernel
def count_listed(width):
    """How many pairs (half) lists hold, and how many entries with what fills up their slots."""
    pairs = 0
    entries = 0
    for t in range(width.shape[0]):
        pairs += width[t]
        entries += (width[t] + SLOT_PADDING - 1) // SLOT_PADDING * SLOT_PADDING
    return pairs, entries


@kernel
def begin_marks(place, keys, known_keys, known_slips, marks, known):
    """Where slips are counted from: remembered slip, gap and branch vector [R] into ``marks`` (4, K) of the pairs with ``keys``.

    ``place`` (7, K) is their geometry there. A pair that remembers nothing has slip 0; ``known`` (K,) says which do.
    ``known_keys`` ascend.
    """
    for k in range(keys.shape[0]):
        low, high = 0, known_keys.shape[0]
        while low < high:
            middle = (low + high) // 2
            if known_keys[middle] < keys[k]:
                low = middle + 1
            else:
                high = middle
        known[k] = low < known_keys.shape[0] and known_keys[low] == keys[k]
        marks[0, k] = known_slips[low] if known[k] else 0.0
        marks[1, k] = max(place[0, k], 0.0)
        marks[2, k] = place[1, k]
        marks[3, k] = place[2, k]


@kernel
def find_corners(primitives, corners):
    """For each primitive into ``corners`` (M, 2): the edges that a vertex lies between; NONE where there is none.

    Others may end in the same place: an edge and its vertex have radius and direction in common.
    """
    for m in range(primitives.shape[0]):
        for side in range(2):
            corners[m, side] = NONE
            if primitives[m, 0] != VERTEX:
                continue
            x, y, radius = primitives[m, 1], primitives[m, 2], primitives[m, 7]
            ux, uy = primitives[m, 3 + 2 * side], primitives[m, 4 + 2 * side]
            for e in range(primitives.shape[0]):
                if primitives[e, 0] != EDGE or not abs(primitives[e, 7] - radius) < SAME_POINT:
                    continue
                vx, vy = primitives[e, 3], primitives[e, 4]
                at_start = max(
                    max(abs(primitives[e, 1] - x), abs(primitives[e, 2] - y)),
                    max(abs(-vx - ux), abs(-vy - uy)),
                )
                at_end = max(
                    max(abs(primitives[e, 5] - x), abs(primitives[e, 6] - y)),
                    max(abs(vx - ux), abs(vy - uy)),
                )
                if min(at_start, at_end) < SAME_POINT:
                    corners[m, side] = e
                    break


@kernel
def round_corners(pairs, at_i, primitive, corners, at, slip, gap, known):
    """An edge and the vertex at its end share, for each grain, the slip of the one that has any, and the gap.

    Of the B pairs after the first ``pairs``; ``at`` (N, M) is room for where each of them stands.
    """
    for k in range(primitive.shape[0]):  # others are never asked for, or have been silenced here
        for side in range(2):
            if corners[primitive[k], side] != NONE:
                at[at_i[pairs + k], corners[primitive[k], side]] = NONE
    for k in range(primitive.shape[0]):
        at[at_i[pairs + k], primitive[k]] = pairs + k
    for side in range(2):
        for k in range(primitive.shape[0]):
            edge = corners[primitive[k], side]
            if edge == NONE:
                continue
            e, v = at[at_i[pairs + k], edge], pairs + k
            if e == NONE:
                continue
            if known[e] and not known[v]:
                slip[v] = slip[e]
            elif known[v] and not known[e]:
                slip[e] = slip[v]
            gap[v] = min(gap[v], gap[e])  # that of an edge knows its ends already

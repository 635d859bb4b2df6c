"""Neighbour lists with a skin, rebuilt into preallocated arrays.

A rebuild sorts the grains into cells, finds all pairs closer than their extents plus the skin, and lays them out in slots (see
``contacts``): each with both of its grains, or with one, which is half a list. That layout wants grains in descending order of
their number of neighbours, so a rebuild also says in which order the grains must stand; ``minimizer.relist`` keeps its arrays
in that order, and ``Packing`` never knows.

A list stays valid until some grain has moved, or grown, by half the skin in all.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.jit import kernel, shared
from core.periodic import nearest

SLOT_PADDING = 8
FIT, PAIRS_FULL, SLOTS_FULL, RIGID_FULL = 0, 1, 2, 3  # what a rebuild answers


class Lists(NamedTuple):
    """Preallocated arrays of the neighbour search for N grains and at most P pairs in at most K slots."""

    half: bool  # is each pair listed with one of its grains only?
    width: NDArray[np.int64]  # (K,) grains that have more than t neighbours listed
    offset: NDArray[np.int64]  # (K,) where slot t begins in ``neighbor``
    neighbor: NDArray[np.uint32]  # (2 P + padding,), or half that where ``half``
    stiffness: NDArray[np.float64]  # as many, C_ij [k]
    order: NDArray[np.int64]  # (N,) the grain that must stand at each place
    cell_order: NDArray[np.int64]  # (N,)
    cell_start: NDArray[np.int64]  # (cells + 1,)
    cell_of: NDArray[np.int64]  # (N,)
    sorted: NDArray[np.float64]  # (3, N) x, y, half a reach, in cell_order
    degree: NDArray[np.int64]  # (N,) neighbours of each grain that are listed
    place: NDArray[np.int64]  # (N,) inverse of ``order``
    first: NDArray[np.int64]  # (P,) one grain of each pair
    second: NDArray[np.int64]  # (P,) the other
    filled: NDArray[np.int64]  # (N,)
    start: NDArray[np.int64]  # (K + 2,)


@shared
def allocate(grains: int, pairs: int, slots: int = 0, half: bool = False) -> Lists:
    """Arrays for ``grains`` grains with at most ``pairs`` pairs in all and ``slots`` neighbours for any one grain.

    Without slots they are enough for ``find_pairs``, and no more.
    """
    pairs = max(8, pairs)
    laid_out = grains if slots else 0
    entries = (1 if half else 2) * pairs + SLOT_PADDING * slots if slots else 0
    return Lists(
        half,
        np.zeros(slots, np.int64),
        np.zeros(slots, np.int64),
        np.zeros(entries, np.uint32),
        np.zeros(entries),
        np.zeros(laid_out, np.int64),
        np.zeros(grains, np.int64),
        np.zeros(4 * grains + 32, np.int64),
        np.zeros(grains, np.int64),
        np.zeros((3, grains)),
        np.zeros(laid_out, np.int64),
        np.zeros(laid_out, np.int64),
        np.zeros(pairs, np.int64),
        np.zeros(pairs, np.int64),
        np.zeros(laid_out, np.int64),
        np.zeros(slots + 2, np.int64),
    )


@kernel
def wrap(value, length, inverse):
    """value folded into [0, length); unchanged where the direction is open (inverse = 0)."""
    if inverse == 0.0:
        return value
    folded = value - length * math.floor(value * inverse)
    return folded if folded < length else 0.0


@kernel
def span(values):
    """Least and greatest of some values; nan where one of them is."""
    least = values[0]
    most = values[0]
    for value in values:
        least = value if value < least or value != value else least
        most = value if value > most or value != value else most
    return least, most


@kernel
def search_cells(state, skin, lists, box):
    """Sort grains into cells at least one cut-off wide. Returns (columns, rows, width of a column [R])."""
    grains = state.shape[1]
    widest = 0.0
    for i in range(grains):
        widest = max(widest, state[2, i] + math.sqrt(state[3, i] ** 2 + state[4, i] ** 2))
    reach = max(2.0 * widest + skin, 1e-12)
    x0 = 0.0
    y0 = 0.0
    width = 0.0
    height = 0.0
    open_x = True
    open_y = True
    if box is not None:
        open_x = box[1] == 0.0
        open_y = box[3] == 0.0
        width = box[0]
        height = box[2]
    if open_x:
        x0, most_x = span(state[0])
        width = most_x - x0
    if open_y:
        y0, most_y = span(state[1])
        height = most_y - y0
    # Never more cells than ``cell_start`` holds, however far one grain has been thrown.
    most = math.sqrt(lists.cell_start.shape[0] - 1.0)
    columns = int(min(max(width / reach, 1.0), most))
    rows = int(min(max(height / reach, 1.0), most))
    cell_width = width / columns if width > 0.0 else reach
    cell_height = height / rows if height > 0.0 else reach
    start, cell_of, cell_order = lists.cell_start, lists.cell_of, lists.cell_order
    for c in range(columns * rows + 1):
        start[c] = 0
    for i in range(grains):
        x = state[0, i] - x0
        y = state[1, i] - y0
        if box is not None:
            if not open_y:
                turns = math.floor(y * box[3])
                y -= turns * box[2]
                x -= turns * box[4]
            x = wrap(x, box[0], box[1])
        column = min(max(int(x / cell_width), 0), columns - 1)
        row = min(max(int(y / cell_height), 0), rows - 1)
        cell_of[i] = row * columns + column
        start[cell_of[i] + 1] += 1
    for c in range(columns * rows):
        start[c + 1] += start[c]
    sorted_x, sorted_y, half_reach = lists.sorted[0], lists.sorted[1], lists.sorted[2]
    for i in range(grains):
        c = cell_of[i]
        a = start[c]
        start[c] += 1
        cell_order[a] = i
        sorted_x[a] = state[0, i]
        sorted_y[a] = state[1, i]
        half_reach[a] = state[2, i] + math.sqrt(state[3, i] ** 2 + state[4, i] ** 2) + 0.5 * skin
    for c in range(columns * rows, 0, -1):
        start[c] = start[c - 1]
    start[0] = 0
    return columns, rows, cell_width


@kernel
def window_above(column, columns, shifted, wrap_x):
    """Columns of the next row in which partners of a cell may be: (first of them, how many), going on round a periodic side.

    ``shifted``: how many columns that row is shifted sideways.
    """
    low = column - 1 - math.ceil(shifted)
    high = column + 1 - math.floor(shifted)
    if not wrap_x:
        low = max(low, 0)
        return low, min(high, columns - 1) - low + 1
    count = high - low + 1
    return (low % columns, count) if count < columns else (0, columns)


@kernel
def append_near(a, begin, end, pairs, lists, box):
    """Append the near pairs of the grain at place ``a`` of the cells with those from ``begin`` to ``end``, without a branch.

    Returns how many pairs there are now, or -1 if they might not fit or did not before.
    """
    first, second, cell_order = lists.first, lists.second, lists.cell_order
    x, y, extent = lists.sorted[0], lists.sorted[1], lists.sorted[2]
    if pairs < 0 or pairs + end - begin > first.shape[0]:
        return -1
    for b in range(begin, end):
        dx, dy = nearest(x[b] - x[a], y[b] - y[a], box)
        reach = extent[a] + extent[b]
        first[pairs] = cell_order[a]
        second[pairs] = cell_order[b]
        pairs += 1 if dx * dx + dy * dy < reach * reach else 0
    return pairs


@kernel
def find_pairs(state, skin, lists, box):
    """List every near pair once in ``first``, ``second``. Returns their number, or -1 if the arrays are too short.

    Each cell looks at itself, to the right, and at the row above, so that no two cells meet twice.
    """
    columns, rows, cell_width = search_cells(state, skin, lists, box)
    wrap_x = False
    wrap_y = False
    shift = 0.0
    if box is not None:
        wrap_x = box[1] > 0.0
        wrap_y = box[3] > 0.0
        shift = box[4] if wrap_y else 0.0
    start = lists.cell_start
    pairs = 0
    for row in range(rows):
        here = row * columns
        above = here + columns
        has_above = row + 1 < rows
        shifted = 0.0
        anywhere = rows == 2 and shift != 0.0  # each is above the other, shifted and not shifted
        if row + 1 == rows and rows > 2 and wrap_y:
            above = 0
            has_above = True
            shifted = shift / cell_width
            # Along an open direction a shifted grain may have been put into the last column, however far it is.
            anywhere = shift != 0.0 and not wrap_x
        for column in range(columns):
            right = min(column + 1, columns - 1)
            round_x = wrap_x and column + 1 == columns and columns > 2
            low, count = window_above(column, columns, shifted, wrap_x)
            if anywhere:
                low, count = 0, columns
            beyond = max(low + count - columns, 0)
            for a in range(start[here + column], start[here + column + 1]):
                pairs = append_near(a, a + 1, start[here + right + 1], pairs, lists, box)
                if round_x:
                    pairs = append_near(a, start[here], start[here + 1], pairs, lists, box)
                if has_above:
                    end = start[above + low + count - beyond]
                    pairs = append_near(a, start[above + low], end, pairs, lists, box)
                    pairs = append_near(a, start[above], start[above + beyond], pairs, lists, box)
                if pairs < 0:
                    return -1
    return pairs


@shared
def rebuild(
    state: NDArray[np.float64],
    contact_stiffness: NDArray[np.float64],
    skin: float,
    lists: Lists,
    box: tuple[float, ...] | None,
) -> int:
    """Find all pairs and lay them out in slots for grains standing in ``lists.order``. Returns FIT, PAIRS_FULL or SLOTS_FULL."""
    pairs = find_pairs(state, skin, lists, box)
    return PAIRS_FULL if pairs < 0 else lay_out(pairs, contact_stiffness, lists)


@kernel
def lay_out(pairs, contact_stiffness, lists):
    """Lay the first ``pairs`` pairs out in slots. Returns FIT, PAIRS_FULL or SLOTS_FULL."""
    grains = contact_stiffness.shape[0]
    # Every array is fetched once: inside a loop each look into the tuple would cost two atomic reference counts.
    width, offsets, neighbor, stiffness = lists.width, lists.offset, lists.neighbor, lists.stiffness
    degree, place, order, filled = lists.degree, lists.place, lists.order, lists.filled
    first, second, cell_order = lists.first, lists.second, lists.cell_order
    slots, half = width.shape[0], lists.half
    for i in range(grains):
        degree[i] = 0
    for k in range(pairs):
        degree[first[k]] += 1
        degree[second[k]] += 0 if half else 1
    start = lists.start
    for t in range(slots + 2):
        start[t] = 0
    for i in range(grains):
        if degree[i] > slots:
            return SLOTS_FULL
        start[slots - degree[i] + 1] += 1
    # Counting sort, most neighbours first, stable in the order of the cells so that neighbours stay close in memory.
    for t in range(slots + 1):
        start[t + 1] += start[t]
    offset = 0
    for t in range(slots):
        # Grains with more than t neighbours stand before all others.
        width[t] = start[slots - t]
        offsets[t] = offset
        offset += (width[t] + SLOT_PADDING - 1) // SLOT_PADDING * SLOT_PADDING
    if offset > neighbor.shape[0]:
        return PAIRS_FULL
    for a in range(grains):
        i = cell_order[a]
        t = slots - degree[i]
        place[i] = start[t]
        order[start[t]] = i
        start[t] += 1
        filled[i] = 0
    for k in range(pairs):
        i = first[k]
        j = second[k]
        ci = contact_stiffness[i]
        cj = contact_stiffness[j]
        contact = 2.0 * ci * cj / (ci + cj)
        at = offsets[filled[i]] + place[i]
        neighbor[at] = place[j]
        stiffness[at] = contact
        filled[i] += 1
        if half:
            continue
        at = offsets[filled[j]] + place[j]
        neighbor[at] = place[i]
        stiffness[at] = contact
        filled[j] += 1
    return FIT

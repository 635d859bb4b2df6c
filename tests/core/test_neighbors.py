"""Cells and lists against looking at every pair."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core import neighbors, reference
from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation
from tests.core import examples

Pairs = set[tuple[int, int]]


def pairs_by_cells(packing: Packing, skin: float) -> Pairs:
    """What the cells find; fails if a pair is found twice."""
    count = len(packing)
    lists = neighbors.allocate(count, count * count, 1)
    box = None if packing.box is None else packing.box.kernel_form()
    used = neighbors.find_pairs(packing.state, skin, lists, box)
    found = [
        (min(i, j), max(i, j))
        for i, j in zip(lists.first[:used].tolist(), lists.second[:used].tolist(), strict=True)
    ]
    assert len(set(found)) == len(found)
    return set(found)


def scattered(
    count: int,
    size: tuple[float, float],
    radii: tuple[float, float],
    box: PeriodicBox | None,
    seed: int,
) -> Packing:
    random = np.random.default_rng(seed)
    low, high = map(math.log, radii)
    packing = Packing(
        # Some outside the box: grains are not folded back when they leave it.
        random.uniform(-0.6, 1.6, count) * size[0],
        random.uniform(-0.6, 1.6, count) * size[1],
        np.exp(random.uniform(low, high, count)),
        box=box,
    )
    a, b = packing.rest_radius * random.uniform(0.8, 1.2, (2, count))
    packing.set_axes(a, b, random.uniform(-4.0, 4.0, count))
    return packing


@settings(max_examples=300, deadline=None)
@given(
    count=st.integers(1, 40),
    columns=st.floats(1.1, 9.0),
    rows=st.floats(1.1, 9.0),
    shift=st.sampled_from([0.0, 0.3, -1.0, 5.7, -123.4]),
    kind=st.sampled_from(["open", "periodic", "x", "y"]),
    smallest=st.sampled_from([1.0, 0.7, 0.01]),
    skin=st.sampled_from([0.0, 0.3, 1.5]),
    seed=st.integers(0, 10_000),
)
def test_cells_find_every_pair(
    count: int,
    columns: float,
    rows: float,
    shift: float,
    kind: str,
    smallest: float,
    skin: float,
    seed: int,
) -> None:
    """One, few and many cells in each direction; a relaxation demands two at least along a periodic one."""
    reach = 2.0 * 1.2 + skin
    least = 1.0 if shift == 0.0 else 2.0  # else the nearest image is not the one that kernels take
    size = (max(columns, least) * reach, max(rows, least) * reach)
    box = {
        "open": None,
        "periodic": PeriodicBox(*size, shift),
        "x": PeriodicBox(size[0]),
        "y": PeriodicBox(math.inf, size[1], shift),
    }[kind]
    packing = scattered(count, size, (smallest, 1.0), box, seed)
    assert pairs_by_cells(packing, skin) == reference.near_pairs(packing, skin)


@pytest.mark.parametrize("box", [None, PeriodicBox(4000.0, 3000.0, 17.0)])
@pytest.mark.parametrize("count", [1, 2, 5, 60])
def test_dilute_packings(box: PeriodicBox | None, count: int) -> None:
    """Far more room than grains: the number of cells is bounded by that of the grains."""
    packing = scattered(count, (4000.0, 3000.0), (0.9, 1.0), box, 3)
    packing.state[:2, count // 2] = packing.state[:2, 0] + (0.5, 0.5)
    assert pairs_by_cells(packing, 0.3) == reference.near_pairs(packing, 0.3)


def test_one_grain_thrown_far() -> None:
    packing = scattered(40, (8.0, 8.0), (0.7, 1.0), None, 3)
    packing.state[:2, 7] = 1e9, -1e9
    assert pairs_by_cells(packing, 0.3) == reference.near_pairs(packing, 0.3)


def test_giant_among_dwarfs() -> None:
    """A size ratio of 1000: every dwarf is within one cell of the giant."""
    packing = scattered(100, (150.0, 150.0), (0.1, 0.2), None, 3)
    packing.rest_radius[0] = packing.state[2, 0] = 100.0
    packing.state[[0, 1, 3, 4], 0] = 75.0, 75.0, 0.0, 0.0
    found = pairs_by_cells(packing, 0.0)
    assert found == reference.near_pairs(packing, 0.0)
    assert len(found) > 10


@pytest.mark.parametrize("count", [2, 13, 50])
@pytest.mark.parametrize("box", examples.BOXES.values(), ids=examples.BOXES.keys())
def test_slots(count: int, box: PeriodicBox | None) -> None:
    """Laid out in slots, each pair stands there from both sides with its stiffness, and slots never get longer."""
    packing = examples.random_grains(count, 9.0, 4, box)
    lists = neighbors.allocate(count, count * count, count)
    form = None if box is None else box.kernel_form()
    c = packing.contact_stiffness
    assert neighbors.rebuild(packing.state, c, 0.3, lists, form) == neighbors.FIT
    assert sorted(lists.order) == list(range(count))
    assert np.all(np.diff(lists.width) <= 0)
    met: dict[tuple[int, int], float] = {}
    for width, offset in zip(lists.width, lists.offset, strict=True):
        for place in range(width):
            i = int(lists.order[place])
            j = int(lists.order[lists.neighbor[offset + place]])
            assert (i, j) not in met
            met[i, j] = float(lists.stiffness[offset + place])
    expected = reference.near_pairs(packing, 0.3)
    assert set(met) == expected | {(j, i) for i, j in expected}
    for (i, j), stiffness in met.items():
        assert stiffness == pytest.approx(2.0 / (1.0 / c[i] + 1.0 / c[j]), rel=1e-14)


@pytest.mark.parametrize(
    ("pairs", "slots", "answer"), [(8, 40, "PAIRS_FULL"), (1000, 2, "SLOTS_FULL")]
)
def test_short_arrays_are_reported(pairs: int, slots: int, answer: str) -> None:
    packing = examples.random_grains(40, 6.0, 4)
    lists = neighbors.allocate(40, pairs, slots)
    told = neighbors.rebuild(packing.state, packing.contact_stiffness, 0.3, lists, None)
    assert told == getattr(neighbors, answer)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("box", ["open", "sheared"])
def test_lists_are_never_out_of_date(seed: int, box: str) -> None:
    """From a wild start, after every iteration: no grain has moved and grown by more than half the skin since its lists
    were built, every pair that touches is in them, and no coordinate has changed by more than the clamp.

    Rounding: 1e-12 of either.
    """
    packing = examples.random_grains(30, 6.0 if box == "open" else 9.0, seed, examples.BOXES[box])
    relaxation = Relaxation(packing, max_iterations=400)
    relaxation.run(1)
    limits = relaxation._limits
    now = packing.copy()
    before = packing.state.copy()
    while relaxation.run(1).reason == "budget":
        minimizer = relaxation._minimizer
        now.state[:, minimizer.identity] = minimizer.state
        assert np.max(np.abs(now.state - before)) <= limits.clamp * (1.0 + 1e-12)
        change = minimizer.state - minimizer.reference
        moved = np.hypot(*change[:2]) + np.abs(change[2]) + np.hypot(*change[3:])
        before = now.state.copy()
        assert np.max(moved) <= 0.5 * limits.skin * (1.0 + 1e-12)
        if relaxation.iterations % 10 == 0:
            lists = minimizer.lists
            listed = {
                (int(minimizer.identity[i]), int(minimizer.identity[lists.neighbor[offset + i]]))
                for width, offset in zip(lists.width, lists.offset, strict=True)
                for i in range(width)
            }
            assert reference.near_pairs(now, -1e-12) <= listed

"""Each pair once: what it does to either of its grains is what a plain sum over every grain's own contacts says."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core import scatter
from core.jit import kernel
from core.packing import PeriodicBox
from core.periodic import nearest
from core.relaxation import Relaxation
from core.slip import TANGENTIAL_STIFFNESS
from core.sweeps import CHUNK
from tests.core.friction_examples import MU, RELATIVE, Case, Floats, case


def many(count: int, box: PeriodicBox | None) -> Case:
    """More grains than one chunk, each with some contacts that stick and some that slide."""
    return case(1, 0.05, box, bodies=False, count=count, side=1.4 * math.sqrt(count))


def stretch(p: float, q1: float, q2: float) -> Floats:
    return np.array([[p + q1, q2], [q2, p - q1]])


def own_contacts(relaxation: Relaxation) -> Floats:
    """Forces of the contacts on x, y, p, q1, q2 and spin (6, N), from equations (1) and (10) of MODEL.md, for each grain from
    its own side: with a pair (i, j) comes, by itself, the pair (j, i)."""
    m, friction = relaxation._minimizer, relaxation._contacts
    assert friction is not None
    terms, c = friction.terms, m.grains.contact_stiffness
    forces = np.zeros_like(m.force)
    pairs = zip(friction.at_i.tolist(), friction.at_j.tolist(), friction.marks.T, strict=True)
    for first, second, mark in pairs:
        for i, j, side in ((first, second, 1.0), (second, first, -1.0)):
            d = np.array(nearest.py_func(*(m.state[:2, j] - m.state[:2, i]), relaxation._box))
            r = math.hypot(*d)
            n = d / r
            t = np.array([-n[1], n[0]])
            shapes = [stretch(*m.state[2:5, k]) for k in (i, j)]
            before = [stretch(*terms.origin[:3, k]) for k in (i, j)]
            h = [math.hypot(*(shape @ n)) for shape in shapes]
            overlap = h[0] + h[1] - r
            if overlap <= 0.0:
                continue
            stiffness = 2.0 * c[i] * c[j] / (c[i] + c[j])
            e = [shape @ n / reach for shape, reach in zip(shapes, h, strict=True)]
            levers = [
                np.linalg.det(s) / reach - overlap / 2 for s, reach in zip(shapes, h, strict=True)
            ]
            u = mark[0] - t @ (d - side * mark[2:])
            for k, grain in enumerate((i, j)):
                u += levers[k] * (m.state[5, grain] - terms.origin[3, grain])
                u += t @ (shapes[k] - before[k]) @ e[k]
            slope = sum(
                t @ shape @ point for shape, point in zip(shapes, e, strict=True)
            )  # h_i′ + h_j′
            f, cap = stiffness * overlap, MU * stiffness * overlap
            pull = TANGENTIAL_STIFFNESS * stiffness * u * overlap / (overlap + mark[1])
            pull = min(max(pull, -cap), cap)
            forces[:2, i] -= f * n + (pull - f * slope / r) * t
            forces[2:5, i] -= f * along(n, e[0]) + pull * along(t, e[0])
            forces[5, i] -= pull * levers[0]
    return forces


def along(a: Floats, e: Floats) -> Floats:
    """a·∂U e for U made of p, q1, q2 (3,)."""
    return np.array([a @ e, a[0] * e[0] - a[1] * e[1], a[0] * e[1] + a[1] * e[0]])


@pytest.mark.parametrize("count", [150, CHUNK + 150])
@pytest.mark.parametrize("box", ["open", "sheared"])
def test_each_pair_once_is_as_each_from_either_side(box: str, count: int) -> None:
    side = 1.4 * math.sqrt(count)
    made = many(count, PeriodicBox(side, side, 2.3) if box == "sheared" else None)
    relaxation = made.relaxation()
    forces = relaxation._minimizer.force.copy()
    apart = made.packing.copy()
    apart.box = None
    apart.state[:2] *= 1e3
    alone = Relaxation(apart)
    alone.run(1)
    forces[:5] -= alone.forces()[:, relaxation._minimizer.identity]
    expected = own_contacts(relaxation)
    friction = relaxation.slips()[2]
    assert len(friction.i) > count
    assert 0.05 < friction.sliding.mean() < 0.95
    scale = np.abs(relaxation.forces()).max()
    assert np.abs(forces - expected).max() <= RELATIVE * scale


@kernel(cache=False)
def add_all(table, row, target):  # type: ignore[no-untyped-def]
    for first in range(0, table.shape[1], scatter.WIDTH):
        scatter.add_columns(table, np.uint64(first), row, target)


def test_columns_are_added_one_after_another() -> None:
    """To the last bit as a plain loop, also where a row is met twice."""
    random = np.random.default_rng(1)
    table, row = random.normal(size=(8, 64)), random.integers(0, 9, 64).astype(np.uint32)
    target = random.normal(size=(9, 8))
    expected = target.copy()
    for k, n in enumerate(row):
        expected[n] += table[:, k]
    add_all(table, row, target)
    assert np.array_equal(target, expected)
    assert len(set(row[:8].tolist())) < 8


def test_a_list_has_each_pair_once_or_twice() -> None:
    """With friction the slots have half as many entries as without, and the same mean contact force is found in them."""
    made = case(3, bodies=False)
    with_friction, without = made.relaxation(), made.relaxation(friction=False)
    entries = [int(one._minimizer.lists.width.sum()) for one in (with_friction, without)]
    assert 2 * entries[0] == entries[1] > 0
    assert with_friction.report().mean_contact_force == pytest.approx(
        without.report().mean_contact_force, rel=1e-13
    )

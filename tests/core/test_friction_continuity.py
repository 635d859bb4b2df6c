"""New lists, corners, and the edges of cells: nothing jumps there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core import fire
from core.friction import Friction
from core.packing import Packing, PeriodicBox
from core.relaxation import Relaxation
from core.rigid import RigidBody, RigidWorld
from tests.core.friction_examples import FEW, RELATIVE, Case, Floats, case


def again(relaxation: Relaxation) -> Floats:
    """Forces (6, N) of the state as it is, after new lists have been made for it."""
    relaxation._relist()
    fire.evaluate(
        relaxation._minimizer,
        relaxation._box,
        relaxation._rigid,
        relaxation.friction_terms,
        None,
        None,
    )
    return relaxation.forces()


@pytest.mark.parametrize("size", [0.003, 0.3])
@pytest.mark.parametrize("seed", range(4))
def test_new_lists_leave_forces_as_they_are(seed: int, size: float) -> None:
    """What contacts hold is committed: sticking, sliding and new ones, twice over."""
    made = case(seed, size, move=size)
    relaxation = made.relaxation()
    before = relaxation.forces()
    slips = relaxation.slips()
    tolerance = RELATIVE * np.abs(before).max()
    for _ in range(2):
        assert np.abs(again(relaxation) - before).max() <= tolerance
        later = relaxation.slips()
        assert np.array_equal(later[0], slips[0])
        assert np.abs(later[1] - slips[1]).max() <= RELATIVE


def follow(made: Case, path: Floats, *, commit: bool) -> Floats:
    """Forces of friction (T, 6) on the first grain of ``made`` as its centre goes along ``path`` (T, 2), without turning."""
    found = []
    for x, y in path:
        packing = made.packing.copy()
        packing.state[:2, 0] = x, y
        step = replace(made, packing=packing)
        found.append(step.forces()[1][:, 0])
        if commit:
            keys, slips, _ = step.relaxation().slips()
            made.friction.end(keys, slips, np.zeros(len(packing)))
            made = replace(made, before=packing)
    return np.array(found)


def round_the_end(steps: int, *, commit: bool, polygon: bool, meets: bool = False) -> Floats:
    """A tilted ellipse dragged along a side, over its corner and down, and pressed on all the while.

    ``meets``: two other plates end where this one does, below it.
    """
    body = RigidBody("plate", segments=[(-6.0, 0.0, 0.0, 0.0, 0.3)])
    if polygon:
        body = RigidBody(
            "plate", polygons=[(((-6.0, -4.0), (0.0, -4.0), (0.0, 0.0), (-6.0, 0.0)), 0.3)]
        )
    others = [
        RigidBody(name, segments=[(0.0, 0.0, x, -4.0, 0.3)])
        for name, x in (("under", -3.0), ("below", -2.0))
    ]
    world = RigidWorld([*others, body] if meets else [body])
    packing = Packing([-0.3], [1.2], 1.0, 0.3, 50.0)
    packing.set_axes(1.1, 0.95, 0.6)
    s = np.linspace(-0.3, 0.9 if polygon else 0.5, steps)
    angle = np.clip(s, 0.0, None) / 1.2 * 2.0
    path = np.array([np.minimum(s, 0.0) + 1.2 * np.sin(angle), 1.2 * np.cos(angle)]).T
    placed = world.placement()
    made = Case(packing, world, placed, Friction(10.0, 1), packing, np.zeros(1), placed)
    return follow(made, path, commit=commit)


@pytest.mark.parametrize(
    ("commit", "polygon"), [(False, False), (True, False), (True, True)], ids=str
)
def test_no_jump_at_a_corner(commit: bool, polygon: bool) -> None:
    """From a side onto the corner at its end, and on to the next side: the change a step goes to zero with the step."""
    most = [
        np.abs(np.diff(round_the_end(steps, commit=commit, polygon=polygon), axis=0)).max()
        for steps in (60, 120)
    ]
    assert most[0] < 4.0
    assert most[1] == pytest.approx(0.5 * most[0], rel=0.15)


def test_no_jump_at_a_corner_where_other_plates_end() -> None:
    """The corner is that of its own plate, however many there are in that place."""
    most = [
        np.abs(np.diff(round_the_end(steps, commit=True, polygon=False, meets=True), axis=0)).max()
        for steps in (60, 120)
    ]
    assert most[1] == pytest.approx(0.5 * most[0], rel=0.15)


@pytest.mark.parametrize("commit", [False, True])
def test_no_jump_where_a_grain_crosses_the_edge_of_a_cell(commit: bool) -> None:
    """Along a wall that runs through the cell: as in the open, also where another image becomes the nearest to the wall."""
    path = np.array([np.linspace(4.2, 4.8, 13), np.full(13, 0.95)]).T
    found = []
    for box, away in ((None, 0.0), (PeriodicBox(9.0), 0.0), (PeriodicBox(9.0), 18.0)):
        world = RigidWorld([RigidBody("floor", segments=[(-7.0, 0.0, 7.0, 0.0, 0.0)])])
        packing = Packing([4.1 + away], [0.95], 1.0, 0.3, 50.0, box=box)
        packing.set_axes(1.1, 0.95, 0.6)
        placed = world.placement()
        made = Case(packing, world, placed, Friction(10.0, 1), packing, np.zeros(1), placed)
        found.append(follow(made, path + np.array([away, 0.0]), commit=commit))
    assert np.abs(found[0]).max() > 1.0
    for other in found[1:]:
        assert np.abs(other - found[0]).max() < 1e-11


@given(st.integers(-2, 2), st.integers(-2, 2), st.integers(-2, 2), st.integers(-2, 2))
@FEW
def test_no_jump_where_grains_cross_the_edge_of_a_sheared_cell(
    across: int, up: int, later_across: int, later_up: int
) -> None:
    """Two grains in a cell whose shift changes, stored in any image before and in any other after: as the same two in the open.

    Of the images that touch, the way counts that they have gone.
    """
    here, there, mu = np.array([4.0, 4.5]), np.array([5.5, 5.6]), 10.0
    none, still = np.zeros((0, 3)), np.zeros(2)
    way = np.array([0.013, -0.004])

    def made(cells: tuple[PeriodicBox | None, PeriodicBox | None]) -> Case:
        packings = []
        for box, on, (k, m) in zip(
            cells, (0.0, 1.0), ((across, up), (later_across, later_up)), strict=True
        ):
            second = there + on * way
            if box is not None:
                second = second + np.array([k * box.width + m * box.shift, m * box.height])
            x, y = np.array([here, second]).T
            packing = Packing(x, y, 1.0, 0.3, 50.0, box=box)
            packing.set_axes([1.1, 1.0], [0.95, 1.05], [0.6, -0.3])
            packings.append(packing)
        return Case(packings[0], RigidWorld(), none, Friction(mu, 2), packings[1], still, none)

    _, expected = made((None, None)).forces()
    _, forces = made((PeriodicBox(9.0, 9.5, 8.8), PeriodicBox(9.0, 9.5, 9.1))).forces()
    assert np.abs(expected).max() > 0.1
    assert np.abs(forces - expected).max() < 1e-11

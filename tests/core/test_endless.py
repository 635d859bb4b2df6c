"""A wall along a periodic direction that is as long as the cell has no ends: it is felt once, everywhere."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core import observables, reference
from core.endless import endless
from core.generate import Recipe, inside, pack
from core.packing import Packing, PeriodicBox
from core.quasistatic import Quasistatic
from core.relaxation import StopReason
from core.rigid import RigidBody, RigidWorld
from core.settings import Settings
from core.system import System
from tests.core import examples

WIDTH, STIFFNESS = 11.0, 40.0
MANY = settings(max_examples=60, deadline=None)
places = st.floats(-30.0, 30.0)


@st.composite
def lattices(draw: st.DrawFn) -> tuple[PeriodicBox, tuple[float, float]]:
    """A periodic cell and a vector from the cell to one of its images, along which the wall shall run."""
    kind = draw(st.sampled_from(["x", "x sheared", "y", "y sheared", "y skewed"]))
    shift = draw(st.floats(-20.0, 20.0))
    if kind == "x":
        return PeriodicBox(WIDTH), (WIDTH, 0.0)
    if kind == "x sheared":
        return PeriodicBox(WIDTH, 9.5, shift), (WIDTH, 0.0)
    if kind == "y":
        return PeriodicBox(9.5, WIDTH), (0.0, WIDTH)
    if kind == "y sheared":
        return PeriodicBox(math.inf, WIDTH, shift), (shift, WIDTH)
    return PeriodicBox(9.5, WIDTH, shift), (shift - 9.5 * round(shift / 9.5), WIDTH)


@st.composite
def walls(draw: st.DrawFn) -> tuple[PeriodicBox, RigidBody, np.ndarray, np.ndarray, float]:
    """A wall that runs around a cell: (cell, wall, a point of it, unit vector along it, radius)."""
    box, (vx, vy) = draw(lattices())
    once = np.array([vx, vy])
    along = once / np.hypot(*once)
    start = np.array([draw(st.floats(-3.0, 3.0)), draw(st.floats(-3.0, 3.0))])
    if draw(st.booleans()):
        along = -along
    extra = draw(st.sampled_from([0.0, 1e-3, 0.7, 2.0, 10.0, 25.0]))
    end = start + (np.hypot(*once) + extra) * along
    radius = draw(st.sampled_from([0.0, 0.3]))
    pieces = draw(st.integers(1, 3)) if extra == 0.0 else 1
    corners = [start + (end - start) * k / pieces for k in range(pieces + 1)]
    ends = pairwise(corners)
    body = RigidBody("wall", segments=[(*a.tolist(), *b.tolist(), radius) for a, b in ends])
    return box, body, start, along, radius


def one_grain(box: PeriodicBox, x: float, y: float, a: float, b: float, tilt: float) -> Packing:
    packing = Packing([x], [y], 1.0, 0.0, STIFFNESS, box=box)
    packing.set_axes([a], [b], [tilt])
    return packing


@MANY
@given(walls(), places, st.floats(-0.95, 0.95), st.floats(0.75, 1.2), st.floats(0.0, 3.2))
def test_one_grain_anywhere_along_a_wall(
    wall: tuple[PeriodicBox, RigidBody, np.ndarray, np.ndarray, float],
    where: float,
    beside: float,
    b: float,
    tilt: float,
) -> None:
    """Energy, force, reaction and number of contacts are those of one straight line without ends, which are written here."""
    box, body, start, along, radius = wall
    normal = np.array([-along[1], along[0]])
    distance = math.copysign(0.3 + abs(beside), beside)
    x, y = start + where * along + distance * normal
    packing = one_grain(box, x, y, 1.0, b, tilt)
    rows, owner = RigidWorld([body]).primitives()
    angle = math.atan2(normal[1], normal[0]) - tilt
    overlap = math.hypot(math.cos(angle), b * math.sin(angle)) + radius - abs(distance)
    free, rest = examples.forces(packing)
    energy, forces = examples.forces(packing, rows)
    expected = STIFFNESS * max(overlap, 0.0)
    assert energy - free == pytest.approx(0.5 * expected**2 / STIFFNESS, abs=1e-10)
    push = (forces - rest)[:2, 0]
    assert push == pytest.approx(math.copysign(expected, distance) * normal, abs=1e-9)
    contacts = observables.body_contacts(packing, rows)
    assert len(contacts.grain) == (overlap > 0.0)
    reaction = observables.reactions(contacts, owner, np.zeros((1, 3)))[0]
    assert reaction[:2] == pytest.approx(-push, abs=1e-9)
    assert reference.energy_and_forces(packing, rows)[0] == pytest.approx(energy, abs=1e-10)


@pytest.mark.parametrize("box", [None, PeriodicBox(WIDTH)], ids=["no box", "around a cell"])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_a_grain_right_where_two_pieces_of_a_straight_wall_meet(
    box: PeriodicBox | None, angle: float
) -> None:
    """It has one contact, not one with each, wherever the body has been turned to."""
    pieces = [(-5.5, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 5.5, 0.0, 0.0)]
    body = RigidBody("wall", segments=pieces, angle=0.0 if box else angle)
    x, y = body.to_world([(0.0, 0.7)])[0]
    packing = Packing([x], [y], 1.0, 0.0, STIFFNESS, box=box)
    energy, _ = examples.forces(packing, body.primitives())
    assert energy == pytest.approx(0.5 * STIFFNESS * 0.3**2, rel=1e-12)


@pytest.mark.parametrize("radius", [0.0, 0.3])
def test_forces_are_slopes_of_the_energy_where_a_wall_ends(radius: float) -> None:
    """Central differences of 1e-6 R, of a tilted grain, across what would be an end."""
    box = PeriodicBox(WIDTH)
    rows = RigidBody("wall", segments=[(0.0, 0.0, WIDTH, 0.0, radius)]).primitives()
    for x in np.linspace(-0.6, 0.6, 41):
        packing = one_grain(box, x, radius + 0.7, 1.1, 0.8, 0.6)
        _, forces = examples.forces(packing, rows)
        for row in range(5):
            by = np.zeros((5, 1))
            by[row] = 1e-6
            energies = []
            for sign in (1.0, -1.0):
                moved = packing.copy()
                moved.state += sign * by
                energies.append(examples.energy(moved, rows))
            slope = -(energies[0] - energies[1]) / 2e-6
            assert forces[row, 0] == pytest.approx(slope, abs=1e-6)


def test_a_wall_in_zigzag_closes_around_the_cell() -> None:
    """Its first and its last corner are one, as the others are: begun elsewhere, the same wall has the same contacts."""
    box = PeriodicBox(WIDTH)
    corners = [(0.0, 0.0), (3.0, 1.0), (5.0, -0.5), (8.0, 0.5), (WIDTH, 0.0)]
    again = [*corners[2:-1], *((x + WIDTH, y) for x, y in corners[:3])]
    packing = examples.random_grains(40, WIDTH, 3, box)
    heights = np.interp(packing.x, *np.array(corners).T)
    packing.state[1] = heights + np.random.default_rng(4).uniform(0.6, 1.2, len(packing))
    found = []
    for line in (corners, again):
        pieces = [(*p, *q, 0.2) for p, q in pairwise(line)]
        rows = RigidBody("zigzag", segments=pieces).primitives()
        found.append(examples.forces(packing, rows))
        assert reference.energy_and_forces(packing, rows)[0] == pytest.approx(found[-1][0])
    assert found[0][0] == pytest.approx(found[1][0], rel=1e-12)
    assert found[0][1] == pytest.approx(found[1][1], abs=1e-9)


def test_a_bar_is_smooth_on_top() -> None:
    """A polygon around the cell: its corners are silent too, but those of a step that stands on a floor are not."""
    box = PeriodicBox(WIDTH)
    bar = RigidBody("bar", polygons=[(((0.0, -2.0), (WIDTH, -2.0), (WIDTH, 0.0), (0.0, 0.0)), 0.1)])
    for x in np.linspace(-1.5, 1.5, 31):
        packing = one_grain(box, x, 1.0, 1.0, 0.95, 0.4)
        contacts = observables.body_contacts(packing, bar.primitives())
        assert len(contacts.grain) == 1
        assert contacts.fx[0] == 0.0
    step = RigidBody("step", polygons=[(((4.0, 0.0), (6.0, 0.0), (6.0, 1.0), (4.0, 1.0)), 0.1)])
    packing = one_grain(box, 3.4, 1.8, 1.0, 1.0, 0.0)
    assert len(observables.body_contacts(packing, step.primitives()).grain) == 1


def test_what_is_left_as_it_is() -> None:
    """No cell, too short a wall, a wall askew, and discs: the very same rows."""
    box = PeriodicBox(WIDTH, 9.0, 2.0)
    rows = examples.bodies().primitives()[0]
    assert endless(rows, None) is rows
    short = RigidBody("wall", segments=[(0.0, 0.0, WIDTH - 0.1, 0.0, 0.1)]).primitives()
    askew = RigidBody("wall", segments=[(0.0, 0.0, 3.0 * WIDTH, 0.1, 0.1)]).primitives()
    upright = RigidBody("wall", segments=[(0.0, 0.0, 0.0, 9.0, 0.1)]).primitives()
    for kept in (short, askew, upright):
        assert np.array_equal(endless(kept, box), kept)
    discs = RigidBody("discs", discs=[(0.0, 0.0, 1.0), (WIDTH, 0.0, 1.0)]).primitives()
    assert endless(discs, box) is discs
    long = RigidBody("wall", segments=[(0.0, 0.0, WIDTH, 0.0, 0.1)]).primitives()
    once = endless(long, box)
    assert len(once) == len(long)
    assert np.array_equal(once[:, 0], long[:, 0])
    packing = one_grain(box, 0.1, 0.8, 1.0, 0.9, 0.3)
    assert examples.energy(packing, once) == examples.energy(packing, long) > 0.0


def test_a_packing_on_a_floor_around_the_cell() -> None:
    """Grains are placed and packed between two walls, none through them, and a piston between them feels what they feel."""
    box = PeriodicBox(WIDTH)
    floor = RigidBody("floor", segments=[(0.0, 0.0, WIDTH, 0.0, 0.0)])
    lid = RigidBody(
        "lid", "piston", (0.0, 12.0), segments=[(0.0, 0.0, WIDTH, 0.0, 0.0)], axis=(0, 1)
    )
    world = RigidWorld([floor, lid])
    outline = [(0.0, 0.0), (WIDTH, 0.0), (WIDTH, 12.0), (0.0, 12.0)]
    packing = pack(Recipe(), seed=3, outline=outline, world=world, box=box, packing_fraction=0.86)
    assert inside(outline, *packing.folded()).all()
    engine = Quasistatic(System(packing, world, Settings(0.05, 1e-8, max_iterations=100_000)))
    engine.begin({"lid": (0.0, 11.0)})
    increment = engine.relax(100_000)
    assert increment is not None
    assert increment.report.reason is StopReason.CONVERGED
    low, high = increment.reactions[:, 1]
    assert high == pytest.approx(-low, rel=1e-6)
    assert high > 0.1
    touching = increment.body_contacts
    assert len(set(zip(touching.grain.tolist(), touching.primitive.tolist(), strict=True))) == len(
        touching.grain
    )
    assert len(set(touching.grain.tolist())) == len(touching.grain)


def test_cells_that_change_around_a_wall() -> None:
    """A cell that is made narrower has a wall longer than itself, one that is sheared has it too: nothing is felt twice."""
    wall = RigidBody("floor", segments=[(-2.0, 0.0, WIDTH - 2.0, 0.0, 0.1)])
    x = 0.4 + 2.2 * np.arange(5)
    packing = Packing(x, np.ones(5), 1.0, 0.0, STIFFNESS, box=PeriodicBox(WIDTH, 10.0))
    engine = Quasistatic(
        System(packing, RigidWorld([wall]), Settings(0.05, 1e-9, max_iterations=100_000))
    )
    for _ in range(6):
        engine.begin({}, PeriodicBox(WIDTH - 0.3, 10.0, 0.3))
        increment = engine.relax(100_000)
        assert increment is not None
        assert increment.report.reason is StopReason.CONVERGED
        assert np.all(increment.body_contacts.primitive == 0)
        assert len(set(increment.body_contacts.grain.tolist())) == len(
            increment.body_contacts.grain
        )
    assert engine.packing.box == PeriodicBox(WIDTH - 0.3, 10.0, 0.3)

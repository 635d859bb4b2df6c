"""Rigid bodies: their geometry, and how hands and walls move and stop them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core import observables
from core.errors import InputError
from core.packing import Packing
from core.rigid import Point, RigidBody, RigidWorld, depth, near, offset_path, polygon_area, wall
from core.rigid_contacts import DISC, EDGE, VERTEX

SQUARE: list[Point] = [(0.0, 0.0), (14.0, 0.0), (14.0, 10.0), (0.0, 10.0)]
SUBSTEP = 0.25 / 4  # [R] how far a body may go before a collision is seen
PRESSED = 1e-3  # [R] how far a hand presses a body into a wall in the end


def intruder(at: Point = (3.0, 5.0), radius: float = 1.5, **more: float) -> RigidBody:
    body = RigidBody("intruder", "intruder", position=at, discs=[(0.0, 0.0, radius)], held=True)
    for name, value in more.items():
        setattr(body, name, value)
    return body


def piston(travel: Point = (-math.inf, math.inf)) -> RigidBody:
    return RigidBody(
        "piston",
        "piston",
        position=(0.0, 8.0),
        segments=[(-5.0, 0.0, 5.0, 0.0, 0.2)],
        axis=(0.0, 1.0),
        travel=travel,
    )


# Geometry


def test_offset_of_a_square_is_a_larger_square() -> None:
    expected = [(-0.4, -0.4), (14.4, -0.4), (14.4, 10.4), (-0.4, 10.4)]
    assert offset_path(SQUARE, 0.4, closed=True) == [pytest.approx(p) for p in expected]
    assert offset_path(SQUARE[::-1], -0.4, closed=True)[::-1] == [
        pytest.approx(p) for p in expected
    ]


def test_offset_of_an_open_path_ends_square() -> None:
    path: list[Point] = [(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)]
    expected = [(0.0, -0.5), (3.5, -0.5), (3.5, 4.0)]
    assert offset_path(path, 0.5, closed=False) == [pytest.approx(p) for p in expected]


@given(
    st.lists(st.floats(0.3, 1.2), min_size=3, max_size=8),
    st.floats(-0.3, 0.3),
    st.floats(0.0, 6.0),
)
def test_offset_sides_are_parallel(turns: list[float], distance: float, start: float) -> None:
    """Each side of the new path lies on a line parallel to the old side, ``distance`` to its right."""
    headings = start + np.cumsum([t * (-1) ** k for k, t in enumerate(turns)])
    steps = 3.0 * np.column_stack([np.cos(headings), np.sin(headings)])
    path = [(float(x), float(y)) for x, y in np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)])]
    shifted = offset_path(path, distance, closed=False)
    for k, (a, b) in enumerate(pairwise(path)):
        along = np.subtract(b, a) / 3.0
        right = np.array([along[1], -along[0]])
        for point in shifted[k : k + 2]:
            assert np.dot(np.subtract(point, a), right) == pytest.approx(distance, abs=1e-12)


def test_the_face_of_a_wall_is_its_path() -> None:
    """A grain that reaches 0.01 R over the path overlaps by just that, on every side."""
    primitives = wall("walls", SQUARE, 0.8, closed=True).primitives()
    places = [(7.0, 0.99), (13.01, 5.0), (7.0, 9.01), (0.99, 5.0)]
    for x, y in places:
        contacts = observables.body_contacts(Packing([x], [y]), primitives)
        assert contacts.overlap == pytest.approx([0.01])
    assert len(observables.body_contacts(Packing([7.0], [5.0]), primitives).grain) == 0
    corner = observables.body_contacts(Packing([0.99], [0.98]), primitives)
    assert sorted(corner.overlap) == pytest.approx([0.01, 0.02])


def test_area_of_polygons() -> None:
    assert polygon_area(SQUARE) == 140.0
    assert polygon_area(SQUARE[::-1]) == -140.0
    plate = RigidBody("plate", discs=[(9.0, 9.0, 2.0)], polygons=[(tuple(SQUARE), 0.5)])
    assert plate.area() == pytest.approx(140.0 + 48.0 * 0.5 + math.pi * 0.25 + 4.0 * math.pi)


def test_primitives_of_a_polygon() -> None:
    rows = RigidBody("plate", polygons=[(tuple(SQUARE), 0.1)]).primitives()
    assert sorted(rows[:, 0]) == [EDGE] * 4 + [VERTEX] * 4
    vertices = rows[rows[:, 0] == VERTEX]
    assert {tuple(v) for v in vertices[:, 1:3]} == set(SQUARE)
    # Both directions of each corner lead to it, along different sides.
    assert np.hypot(vertices[:, 3], vertices[:, 4]) == pytest.approx(1.0)
    assert np.hypot(vertices[:, 5], vertices[:, 6]) == pytest.approx(1.0)


def test_a_segment_without_length_is_a_disc() -> None:
    rows = RigidBody("dot", segments=[(1.0, 2.0, 1.0, 2.0, 0.3)]).primitives()
    assert rows.tolist() == [[DISC, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.3]]


def test_bodies_are_placed_and_turned() -> None:
    body = RigidBody("body", position=(1.0, 2.0), angle=0.5 * math.pi, discs=[(3.0, 0.0, 0.5)])
    assert body.primitives()[0, 1:3] == pytest.approx([1.0, 5.0])
    assert body.to_world([(0.0, 1.0)])[0] == pytest.approx([0.0, 2.0])


def test_polygons_run_counter_clockwise() -> None:
    body = RigidBody("plate", polygons=[(tuple(SQUARE[::-1]), 0.0)])
    assert list(body.polygons[0][0]) == SQUARE


@pytest.mark.parametrize(
    "corners",
    [
        ((0.0, 0.0), (4.0, 0.0), (1.0, 1.0), (0.0, 4.0)),  # a notch
        ((0.0, 0.0), (2.0, 0.0), (4.0, 0.0), (0.0, 4.0)),  # three in a line
        ((0.0, 0.0), (0.0, 0.0), (4.0, 0.0), (0.0, 4.0)),  # one twice
        ((0.0, 0.0), (4.0, 0.0)),
        ((0.0, 0.0), (1.0, 1.0), (2.0, 2.0)),
        tuple((math.cos(t), math.sin(t)) for t in np.arange(5) * 0.8 * math.pi),  # a pentagram
    ],
)
def test_polygons_must_be_convex(corners: tuple[Point, ...]) -> None:
    with pytest.raises(InputError, match=r"convex|three corners"):
        RigidBody("plate", polygons=[(corners, 0.1)])


@pytest.mark.parametrize(
    "shape",
    [
        {"position": (math.nan, 0.0)},
        {"angle": math.inf},
        {"discs": [(0.0, 0.0, math.nan)]},
        {"segments": [(0.0, 0.0, math.inf, 0.0, 0.1)]},
        {"polygons": [(((0.0, 0.0), (1.0, 0.0), (0.0, math.nan)), 0.1)]},
    ],
)
def test_sizes_must_be_finite(shape: dict[str, object]) -> None:
    with pytest.raises(InputError, match="finite"):
        RigidBody("odd", **shape)  # type: ignore[arg-type]


# The world


def test_names() -> None:
    world = RigidWorld([intruder(), piston()])
    assert world.index("piston") == 1
    with pytest.raises(InputError, match="there are: intruder, piston"):
        world["pistol"]
    world.remove("intruder")
    assert [body.name for body in world.bodies] == ["piston"]
    with pytest.raises(InputError, match="different names"):
        RigidWorld([intruder(), intruder()])


def test_primitives_name_their_owner() -> None:
    world = RigidWorld([intruder(), piston(), RigidBody("nothing"), wall("w", SQUARE, 0.8)])
    rows, owner = world.primitives()
    assert owner.tolist() == [0] + [1] * 3 + [3] * 7
    assert len(rows) == len(owner)
    assert RigidWorld().primitives()[0].shape == (0, 8)


def test_walls_cannot_be_moved() -> None:
    world = RigidWorld([wall("walls", SQUARE, 0.8, closed=True)])
    with pytest.raises(InputError, match="cannot be moved"):
        world.advance("walls", (1.0, 0.0), 0.1)


@pytest.mark.parametrize("target", [(math.nan, 0.0), (0.0, math.inf)])
@pytest.mark.parametrize("name", ["intruder", "piston"])
def test_targets_must_be_finite(name: str, target: Point) -> None:
    world = RigidWorld([intruder(), piston()])
    before = world.placement()
    with pytest.raises(InputError, match="finite"):
        world.advance(name, target, 0.1)
    assert np.array_equal(world.placement(), before)


def test_piston_goes_as_told() -> None:
    world = RigidWorld([piston()])
    assert world.advance("piston", (3.0, 7.0), 0.25) == ((0.0, -0.25), None)
    assert world.advance("piston", (0.0, 7.7), 0.25)[0] == pytest.approx((0.0, -0.05))
    assert world["piston"].position == pytest.approx((0.0, 7.7))


def test_piston_stops_at_the_end_of_its_travel() -> None:
    world = RigidWorld([piston(travel=(-0.6, 0.0))])
    moves = [world.advance("piston", (0.0, 0.0), 0.25) for _ in range(4)]
    assert [m[0][1] for m in moves] == pytest.approx([-0.25, -0.25, -0.1, 0.0])
    assert [m[1] for m in moves] == [None, None, "end of travel", "end of travel"]
    assert world.advance("piston", (0.0, 99.0), 0.25) == ((0.0, 0.25), None)
    for _ in range(3):
        _, why = world.advance("piston", (0.0, 99.0), 0.25)
    assert why == "end of travel"
    assert world["piston"].position == pytest.approx((0.0, 8.0))


def test_what_gives_way_goes_back_by_a_step() -> None:
    """Against the pull of its hand; a piston within its travel, a held body among walls."""
    world = RigidWorld([piston(travel=(-3.0, 0.1))])
    assert world.give_way("piston", (0.0, -1.0), 0.08) == pytest.approx((0.0, 0.08))
    assert world.give_way("piston", (0.0, -1.0), 0.08) == pytest.approx((0.0, 0.02))
    world = RigidWorld([intruder(), wall("walls", SQUARE, 0.8, closed=True)])
    assert world.give_way("intruder", (0.6, 0.8), 0.05) == pytest.approx((-0.03, -0.04))
    for _ in range(100):
        world.give_way("intruder", (1.0, 0.0), 0.05)
    assert world["intruder"].position[0] > 1.5 - SUBSTEP


@pytest.mark.parametrize("step", [0.02, 0.05, 0.25])
def test_intruder_follows_the_hand(step: float) -> None:
    """In free space: a step at a time, straight, and there in the end. The joint is soft to about 1e-9 of a step."""
    world = RigidWorld([intruder(), wall("walls", SQUARE, 0.8, closed=True)])
    target = (9.0, 7.0)
    whole = math.hypot(6.0, 2.0)
    for _ in range(math.ceil(whole / step) + 2):
        (dx, dy), why = world.advance("intruder", target, step)
        assert why is None
        assert math.hypot(dx, dy) <= step * (1.0 + 1e-9)
        x, y = world["intruder"].position
        assert abs((x - 3.0) * 2.0 - (y - 5.0) * 6.0) < 1e-6
    assert world["intruder"].position == pytest.approx(target, abs=1e-6)


@pytest.mark.parametrize("radius", [0.5, 1.5])
@pytest.mark.parametrize("thickness", [0.1, 0.8])
@pytest.mark.parametrize("angle", np.arange(8) * math.pi / 4.0 + 0.1)
def test_walls_stop_a_flung_intruder(radius: float, thickness: float, angle: float) -> None:
    """Pulled at something far outside, also into corners: a substep into the wall at most, and out of it again."""
    world = RigidWorld([intruder(radius=radius), wall("walls", SQUARE, thickness, closed=True)])
    target = (3.0 + 1e3 * math.cos(angle), 5.0 + 1e3 * math.sin(angle))
    why = None
    for _ in range(150):
        _, why = world.advance("intruder", target, 0.25)
        x, y = world["intruder"].position
        depth = max(radius - x, x + radius - 14.0, radius - y, y + radius - 10.0)
        assert depth <= SUBSTEP
    assert why == "wall"
    assert depth <= PRESSED


def test_an_intruder_is_stopped_by_a_piston() -> None:
    world = RigidWorld([intruder(at=(0.0, 4.0)), piston()])
    for _ in range(40):
        _, why = world.advance("intruder", (0.0, 20.0), 0.25)
    assert why == "wall"
    assert world["intruder"].position[1] == pytest.approx(8.0 - 0.2 - 1.5, abs=PRESSED)
    assert world["piston"].position == (0.0, 8.0)


@settings(max_examples=20, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-20.0, 30.0), st.floats(-20.0, 30.0)), min_size=2, max_size=8),
    st.integers(0, 30),
)
def test_where_bodies_go_depends_on_where_they_are(targets: list[Point], restart: int) -> None:
    """Bit for bit, with no memory of the way there: a world put back to some placement goes on as the first one did."""

    def fresh() -> RigidWorld:
        post = RigidBody("post", discs=[(9.0, 5.0, 0.7)])
        return RigidWorld([intruder(), wall("walls", SQUARE, 0.8, closed=True), post])

    first = fresh()
    placements = []
    script = [target for target in targets for _ in range(8)]
    for target in script:
        placements.append(first.placement())
        first.advance("intruder", target, 0.25)
    start = restart % len(script)
    second = fresh()
    second.place(placements[start])
    for target in script[start:]:
        second.advance("intruder", target, 0.25)
    assert np.array_equal(second.placement(), first.placement())


# Drawn walls


def drawn(name: str, x: float, y: float) -> RigidBody:
    return RigidBody(name, segments=[(x - 1.0, y, x + 1.0, y, 0.3)], drawn=True)


def test_drawn_walls_come_last_and_can_be_exchanged() -> None:
    world = RigidWorld([piston(), drawn("first", 0.0, 0.0)])
    first = world.drawn
    world.redraw([*first, drawn("second", 3.0, 0.0)])
    assert [body.name for body in world.bodies] == ["piston", "first", "second"]
    world.redraw(first)
    assert [body.name for body in world.bodies] == ["piston", "first"]
    assert world.drawn == first


def test_a_piston_stops_at_a_drawn_wall_and_can_be_drawn_back() -> None:
    world = RigidWorld([piston(), drawn("wall", 2.0, 5.0)])
    reasons = [world.advance("piston", (0.0, 0.0), 0.25)[1] for _ in range(40)]
    assert "wall" in reasons
    # The faces touch at 5.0 + 0.3 + 0.2, within one step.
    assert 5.5 - 1e-9 <= world["piston"].position[1] <= 5.5 + 0.25
    moved, why = world.advance("piston", (0.0, 9.0), 0.25)
    assert (moved, why) == ((0.0, 0.25), None)


def test_a_piston_with_a_wall_drawn_through_it_can_only_leave() -> None:
    world = RigidWorld([piston(), drawn("wall", 2.0, 7.7)])
    assert world.advance("piston", (0.0, 0.0), 0.1) == ((0.0, 0.0), "wall")
    moved, _ = world.advance("piston", (0.0, 9.0), 0.1)
    assert moved == pytest.approx((0.0, 0.1))


def test_shapes_for_the_kernels_follow_the_body_and_are_made_once_a_place() -> None:
    body = intruder(at=(3.0, 5.0))
    first = body.primitives()
    assert body.primitives() is first
    body.position = (4.0, 5.0)
    assert body.primitives()[0, 1] == 4.0
    assert first[0, 1] == 3.0
    body.angle = 0.5
    assert body.primitives() is not first
    with pytest.raises(ValueError, match="read-only"):
        body.primitives()[0, 1] = 0.0


def test_shapes_of_a_world_follow_its_bodies_and_are_made_once_a_place() -> None:
    body = intruder(at=(3.0, 5.0))
    world = RigidWorld([wall("walls", SQUARE, 0.8, closed=True), body])
    first, owner = world.primitives()
    assert world.primitives()[0] is first
    body.position = (4.0, 5.0)
    rows, _ = world.primitives()
    assert (first[owner == 1, 1], rows[owner == 1, 1]) == (3.0, 4.0)
    assert np.array_equal(rows[owner == 0], first[owner == 0])
    other = intruder(at=(9.0, 5.0))
    world.bodies[1] = other
    assert world.primitives()[0][owner == 1, 1] == 9.0
    world.bodies.append(body)
    assert world.primitives()[1].tolist() == [*owner, 2]
    world.bodies = [body]
    assert world.primitives()[0][:, 1].tolist() == [4.0]


def test_only_walls_that_are_near_can_be_touched() -> None:
    walls = [drawn(str(k), 3.0 * k, 7.0) for k in range(12)]
    found = near(walls, piston())
    assert [wall.name for wall in found] == ["0", "1", "2"]
    assert near(walls, intruder(at=(3.0, 2.0))) == []
    assert near([], piston()) == []


@pytest.mark.parametrize("swapped", [False, True])
def test_depth_of_an_overlap(swapped: bool) -> None:
    disc = intruder(at=(3.0, 5.0), radius=2.0)
    for x, expected in ((3.1, 2.2), (4.0, 1.3), (5.2, 0.1), (5.4, 0.0), (9.0, 0.0)):
        line = RigidBody("line", segments=[(x, 0.0, x, 9.0, 0.3)])
        pair = (line, disc) if swapped else (disc, line)
        assert depth(pair[0], pair[0].position, [pair[1]]) == pytest.approx(expected)


def test_a_held_body_stops_at_a_drawn_wall() -> None:
    wall_ahead = RigidBody("wall", segments=[(6.0, -9.0, 6.0, 19.0, 0.3)], drawn=True)
    world = RigidWorld([intruder(), wall_ahead])
    for _ in range(80):
        world.advance("intruder", (20.0, 5.0), 0.1)
    assert world["intruder"].position[0] < 6.0 - 0.3 - 1.5 + SUBSTEP

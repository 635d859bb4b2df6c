"""Contacts with edges, corners and discs: exact, one at a time, and smooth when a grain slides around a corner."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core import observables, reference
from core.packing import Packing
from core.relaxation import Relaxation
from core.rigid import RigidBody
from core.rigid_contacts import (
    EDGE,
    VERTEX,
    allocate,
    beyond,
    far_inside,
    find_rigid_pairs,
    image,
    past_end,
)
from tests.core import examples

STIFFNESS = 50.0
FEW = settings(max_examples=40, deadline=None)
Vector = tuple[float, float]


def grain(a: float, b: float, tilt: float) -> Packing:
    packing = Packing([0.0], [0.0], 1.0, 0.0, STIFFNESS)
    packing.set_axes(a, b, tilt)
    return packing


def put(packing: Packing, point: Vector, alpha: float, depth: float) -> None:
    """Move the grain so that its outline's point with inward normal n(α) lies ``depth`` deep behind ``point``."""
    (ellipse,) = reference.ellipses(packing)
    slopes = reference.half_width(ellipse, alpha)
    n, t = (math.cos(alpha), math.sin(alpha)), (-math.sin(alpha), math.cos(alpha))
    reach = slopes.h - depth
    packing.state[0] = point[0] + reach * n[0] + slopes.by_alpha * t[0]
    packing.state[1] = point[1] + reach * n[1] + slopes.by_alpha * t[1]


def around(corners: list[Vector], at: int, radius: float, steps: int) -> list[tuple[Vector, float]]:
    """(point of the bare polygon, direction of the normal) along one side, around corner ``at``, along the next side.

    Sides run counter-clockwise, so the normal is to the right of each.
    """
    before, corner, after = (np.array(corners[(at + k) % len(corners)]) for k in (-1, 0, 1))
    first, second = (
        math.atan2(s[1], s[0]) - 0.5 * math.pi for s in (corner - before, after - corner)
    )
    turn = (second - first) % (2.0 * math.pi)
    return [
        *((tuple(corner - s * (before - corner)), first) for s in np.linspace(-0.4, -1e-3, steps)),
        *((tuple(corner), first + s * turn) for s in np.linspace(0.0, 1.0, steps)),
        *((tuple(corner + s * (after - corner)), second) for s in np.linspace(1e-3, 0.4, steps)),
    ]


@FEW
@given(st.integers(0, 1000), st.floats(0.0, 0.5), st.booleans())
def test_all_that_are_near_are_listed_in_order(seed: int, reach: float, periodic: bool) -> None:
    random = np.random.default_rng(seed)
    x, y = random.uniform(0.0, 12.0, (2, 30))
    packing = Packing(x, y)
    b, a = np.sort(random.uniform(0.2, 1.5, (2, 30)), axis=0)
    packing.set_axes(a, b, 1.0)
    body = RigidBody(
        "body", discs=[(3.0, 4.0, 0.8), (9.0, 1.0, 0.1)], segments=[(1.0, 1.0, 8.0, 3.0, 0.2)]
    )
    rows, box = body.primitives().copy(), (13.0, 1.0 / 13.0, 0.0, 0.0, 0.0) if periodic else None
    expected = []
    for m, row in enumerate(rows):
        for k, (x, y) in enumerate(packing.state[:2].T):
            x, y = image(rows, m, x, y, box)
            way = np.array([x - row[1], y - row[2]])
            if row[0] == EDGE:
                length = np.dot(row[5:7] - row[1:3], row[3:5])
                way -= np.clip(np.dot(way, row[3:5]), 0.0, length) * row[3:5]
            if np.hypot(*way) < packing.semi_axes[0][k] + row[7] + reach:
                expected.append((k, m))
    terms = allocate(rows, 30)
    assert find_rigid_pairs(packing.state, terms, reach, box)
    used = terms.used[0]
    assert [*zip(terms.grain[:used], terms.primitive[:used], strict=True)] == expected


@FEW
@given(
    st.floats(0.2, 2.0),
    st.floats(0.05, 1.0),
    st.floats(0.0, math.pi),
    st.floats(-math.pi, math.pi),
    st.floats(-4.0, 4.0),
    st.floats(-3.0, 3.0),
)
def test_a_grain_far_inside_an_edge_is_not_beyond_its_end(
    a: float, share: float, tilt: float, direction: float, along: float, off: float
) -> None:
    """The short way asks for no root, and never says otherwise than the long one; far enough inside it does answer."""
    packing = grain(a, share * a, tilt)
    s, u, v = (float(c[0]) for c in observables.support_coefficients(packing.state))
    ux, uy = math.cos(direction), math.sin(direction)
    dx, dy = along * ux - off * uy, along * uy + off * ux
    inside = -(dx * ux + dy * uy)
    if far_inside(inside, s, u, v):
        assert beyond(s, u, v, dx, dy, ux, uy) < 0.0
    else:
        assert inside <= math.sqrt(2.0) * a * (1.0 + 1e-12)
    both = (f(s, u, v, dx, dy, ux, uy) for f in (past_end, beyond))
    assert len({math.copysign(1.0, value) for value in both}) == 1


def test_a_grain_that_is_nan_is_so_at_the_end_of_an_edge() -> None:
    assert math.isnan(past_end(math.nan, 0.0, 0.0, -9.0, 0.0, 1.0, 0.0))


POLYGON: list[Vector] = [(0.0, 0.0), (6.0, -1.0), (7.0, 4.0), (2.0, 6.0)]


@pytest.mark.parametrize("radius", [0.0, 0.3])
@pytest.mark.parametrize("tilt", [0.0, 0.4, 1.3, -0.9])
@pytest.mark.parametrize("at", range(4))
def test_sliding_around_a_corner(radius: float, tilt: float, at: int) -> None:
    """By construction the grain is pressed in by the same depth all along, so the force must be C Δ n(α) all along.

    Exactly one primitive acts at every step; both sides of the switch give the same force, hence no jump. Newton's steps
    find n to rounding (their last correction is below 1e-9 and convergence is quadratic).
    """
    depth = 0.05
    body = RigidBody("plate", "body", polygons=[(tuple(POLYGON), radius)])
    primitives = body.primitives()
    packing = grain(1.1, 1.1 / 1.3, tilt)
    kinds = []
    for point, alpha in around(POLYGON, at, radius, 150):
        n = np.array([math.cos(alpha), math.sin(alpha)])
        put(packing, tuple(np.array(point) + radius * n), alpha, depth)
        contacts = observables.body_contacts(packing, primitives)
        assert len(contacts.grain) == 1
        assert contacts.overlap[0] == pytest.approx(depth, abs=1e-13)
        force = np.array([contacts.fx[0], contacts.fy[0]])
        assert force == pytest.approx(STIFFNESS * depth * n, abs=STIFFNESS * 1e-13)
        kinds.append(primitives[contacts.primitive[0], 0])
    assert kinds[0] == kinds[-1] == EDGE
    assert kinds[225] == VERTEX


@pytest.mark.parametrize("tilt", [0.0, 0.4, 1.3, -0.9])
def test_sliding_around_the_end_of_a_wall(tilt: float) -> None:
    """From one face of a capsule over its round end to the other face."""
    depth, radius = 0.05, 0.2
    primitives = RigidBody("wall", segments=[(0.0, 0.0, 5.0, 1.0, radius)]).primitives()
    packing = grain(1.1, 1.1 / 1.3, tilt)
    first = math.atan2(1.0, 5.0) - 0.5 * math.pi
    path: list[tuple[Vector, float]] = [((5.0 * s, s), first) for s in np.linspace(0.5, 1.0, 100)]
    path += [((5.0, 1.0), first + s * math.pi) for s in np.linspace(0.001, 0.999, 300)]
    path += [((5.0 * s, s), first + math.pi) for s in np.linspace(1.0, 0.5, 100)]
    for point, alpha in path:
        n = np.array([math.cos(alpha), math.sin(alpha)])
        put(packing, tuple(np.array(point) + radius * n), alpha, depth)
        contacts = observables.body_contacts(packing, primitives)
        assert len(contacts.grain) == 1
        force = np.array([contacts.fx[0], contacts.fy[0]])
        assert force == pytest.approx(STIFFNESS * depth * n, abs=STIFFNESS * 1e-13)


def largest_jump(force: Callable[[float], examples.Floats], steps: int) -> float:
    """Largest change of a force along 1 R from one of ``steps`` steps to the next, over the force at the outset."""
    forces = np.array([force(s) for s in np.linspace(-0.5, 0.5, steps)])
    return float(np.max(np.hypot(*np.diff(forces, axis=0).T)) / np.hypot(*forces[0]))


def test_the_centre_line_would_jump_at_a_corner() -> None:
    """Why corners are exact: what MODEL.md says of a grain of aspect ratio 1.2 at a corner of radius 0.3 R.

    The grain is carried straight past the end of a flat wall. On the wall the force is f n; past its end, with n on the line
    of centres, a part f h'/r across n appears at once, r the distance of the centres: for this grain up to 0.14 f. With the
    exact contact the steps of the force shrink with the steps of the path.
    """
    a, radius = math.sqrt(1.2), 0.3
    packing = grain(a, 1.0 / a, math.pi / 4.0)
    (ellipse,) = reference.ellipses(packing)
    slopes = reference.half_width(ellipse, 0.5 * math.pi)
    height = slopes.h + radius - 0.05
    wall = RigidBody("wall", segments=[(-5.0, 0.0, 0.0, 0.0, radius)]).primitives()

    def exact(s: float) -> examples.Floats:
        packing.state[:2, 0] = s, height
        contacts = observables.body_contacts(packing, wall)
        return np.array([contacts.fx.sum(), contacts.fy.sum()])

    def centre_line(s: float) -> examples.Floats:
        if s <= 0.0:
            return np.array([0.0, STIFFNESS * 0.05])
        row = np.array([2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, radius])
        contact = reference.rigid_contact(STIFFNESS, ellipse._replace(x=s, y=height), row)
        return np.zeros(2) if contact is None else np.array(contact.force)

    assert abs(slopes.by_alpha) / height == pytest.approx(0.145, abs=0.001)
    assert largest_jump(centre_line, 4001) == pytest.approx(0.145, abs=0.005)
    # A jump stays when the steps get four times smaller; a slope gives a quarter.
    assert largest_jump(exact, 1001) < 0.01
    assert largest_jump(exact, 4001) < 0.3 * largest_jump(exact, 1001)


@FEW
@given(st.floats(-math.pi, math.pi), st.floats(-1.6, 1.6), st.floats(1.0, 1.4), st.floats(0.0, 0.1))
def test_exactly_one_acts(where: float, tilt: float, aspect: float, depth: float) -> None:
    """Anywhere along the outline of a polygon with rounded corners a grain meets one primitive of it, never two or none."""
    radius = 0.2
    body = RigidBody("plate", "body", polygons=[(tuple(POLYGON), radius)])
    primitives = body.primitives()
    packing = grain(math.sqrt(aspect), 1.0 / math.sqrt(aspect), tilt)
    # The farthest corner in a direction, and the outline there: a support function of the polygon.
    n = np.array([math.cos(where), math.sin(where)])
    corner = max(POLYGON, key=lambda c: float(np.dot(c, n)))
    put(packing, tuple(np.array(corner) + radius * n), where, depth + 1e-9)
    contacts = observables.body_contacts(packing, primitives)
    assert len(contacts.grain) == 1
    assert contacts.overlap[0] == pytest.approx(depth + 1e-9, abs=1e-12)


@FEW
@given(st.floats(-1.6, 1.6), st.floats(1.0, 1.4), st.floats(-math.pi, math.pi), st.floats(0.1, 3))
def test_vertex_is_the_distance_of_the_outlines(
    tilt: float, aspect: float, direction: float, gap: float
) -> None:
    """Between an ellipse and a point, Δ is minus the distance of the point from the outline, found by walking the outline.

    The walk has steps of 4e-4 R at most, so its error is at most (2e-4)²/2 (1/gap + curvature) = 3e-7.
    """
    packing = grain(math.sqrt(aspect), 1.0 / math.sqrt(aspect), tilt)
    (ellipse,) = reference.ellipses(packing)
    t = np.linspace(0.0, 2.0 * math.pi, 20_001)
    c, s = math.cos(tilt), math.sin(tilt)
    x = ellipse.a * np.cos(t) * c - ellipse.b * np.sin(t) * s
    y = ellipse.a * np.cos(t) * s + ellipse.b * np.sin(t) * c
    # From the outline outwards along the line of centres.
    polar = (
        ellipse.a
        * ellipse.b
        / reference.half_width(ellipse._replace(a=ellipse.b, b=ellipse.a), direction).h
    )
    px, py = (polar + gap) * math.cos(direction), (polar + gap) * math.sin(direction)
    distance = float(np.min(np.hypot(x - px, y - py)))
    radius = distance + 0.1
    primitives = RigidBody("knob", segments=[(px, py, px + 5.0 * px, py + 5.0 * py, radius)])
    rows = primitives.primitives()
    contacts = observables.body_contacts(packing, rows[rows[:, 0] == VERTEX][:1])
    assert contacts.overlap[0] == pytest.approx(0.1, abs=1e-6)


def test_a_wall_is_felt_from_both_sides() -> None:
    primitives = RigidBody("wall", segments=[(-5.0, 0.0, 5.0, 0.0, 0.2)]).primitives()
    for side in (1.0, -1.0):
        packing = Packing([0.0], [1.15 * side])
        contacts = observables.body_contacts(packing, primitives)
        assert contacts.overlap == pytest.approx([0.05])
        assert contacts.fy == pytest.approx([side * STIFFNESS * 0.05])


def test_a_bend_in_a_wall_is_one_corner() -> None:
    """Two segments that share an end: a grain in the crook meets both faces, one outside the bend meets the corner once."""
    bend = RigidBody("wall", segments=[(-5.0, 0.0, 0.0, 0.0, 0.1), (0.0, 0.0, 0.0, 5.0, 0.1)])
    primitives = bend.primitives()
    assert sorted(primitives[:, 0]) == [EDGE, EDGE, VERTEX, VERTEX, VERTEX]
    crook = observables.body_contacts(Packing([-1.05], [1.05]), primitives)
    assert sorted(primitives[crook.primitive, 0]) == [EDGE, EDGE]
    away = 1.05 / math.sqrt(2.0)
    outside = observables.body_contacts(Packing([away], [-away]), primitives)
    assert list(primitives[outside.primitive, 0]) == [VERTEX]
    assert outside.overlap == pytest.approx([0.05])


def test_a_point_at_the_centre_does_no_harm() -> None:
    """A corner exactly at a grain's centre, or a disc's: no direction is right, none may be nan."""
    packing = grain(1.0, 0.9, 0.3)
    for row in (
        [VERTEX, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.1],
        [2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1],
        [EDGE, -1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0],
    ):
        relaxation = Relaxation(packing, np.array([row]))
        assert np.isfinite(relaxation.run(1).energy)
        assert np.all(np.isfinite(relaxation.forces()))

"""What is done once a list, against the same in other words: sorted keys, dictionaries, and a definition taken literally."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.candidates import NONE, begin_marks, find_corners, round_corners
from core.frictional_contacts import BEYOND, FrictionForces
from core.observables import GrainContacts, RigidContacts
from core.rigid import RigidBody, RigidWorld
from core.rigid_contacts import EDGE, VERTEX


@settings(deadline=None)  # the first example compiles
@given(st.sets(st.integers(0, 40)), st.lists(st.integers(0, 40), max_size=30))
def test_a_pair_recalls_what_was_kept_under_its_key(kept: set[int], asked: list[int]) -> None:
    keys = np.array(sorted(kept), dtype=np.int64)
    slips = 1.0 + keys
    marks, known = np.full((4, len(asked)), np.nan), np.ones(len(asked), dtype=np.bool_)
    place = np.arange(7.0)[:, None] - np.arange(len(asked))
    begin_marks(place, np.array(asked, dtype=np.int64), keys, slips, marks, known)
    assert known.tolist() == [key in kept for key in asked]
    assert marks[0].tolist() == [1.0 + key if key in kept else 0.0 for key in asked]
    assert np.array_equal(marks[1:], [np.maximum(place[0], 0.0), place[1], place[2]])


def test_a_vertex_knows_the_edges_that_meet_in_it() -> None:
    square = ((0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0))
    wall = RigidBody("wall", segments=[(5.0, 0.0, 5.0, 4.0, 0.1)])
    stone = RigidBody("stone", polygons=[(square, 0.2)])
    rows, _ = RigidWorld([stone, wall]).primitives()
    corners = np.empty((len(rows), 2), dtype=np.int64)
    find_corners(rows, corners)
    for row, found in zip(rows, corners, strict=True):
        if row[0] != VERTEX:
            assert found.tolist() == [NONE, NONE]
            continue
        meeting = {
            e
            for e, edge in enumerate(rows)
            if edge[0] == EDGE
            and min(np.hypot(*(edge[1:3] - row[1:3])), np.hypot(*(edge[5:7] - row[1:3]))) < 1e-9
        }
        assert set(found.tolist()) - {NONE} == meeting
        assert len(meeting) == (1 if row[1] == 5.0 else 2)


def test_corners_share_the_slip_of_the_one_that_has_any_and_the_lesser_gap() -> None:
    corners = np.array(
        [[NONE, NONE], [0, NONE], [0, NONE]]
    )  # an edge, and the vertices at its ends
    at_i = np.array([7, 7, 4, 4, 5], dtype=np.uint32)  # the first pair is one of two grains
    primitive = np.array([0, 1, 2, 0])  # of grains 7, 4, 4 and 5
    slip = np.array([9.0, 0.5, 0.0, 0.0, 0.25])
    gap = np.array([9.0, 0.3, 0.1, 0.2, 0.4])
    known = np.array([True, True, False, False, True])
    room = np.full((8, 3), 99)
    # Grain 7 touches only the edge, grain 5 too; grain 4 a vertex and the vertex at the other end, but no edge.
    round_corners(1, at_i, primitive, corners, room, slip, gap, known)
    assert slip.tolist() == [9.0, 0.5, 0.0, 0.0, 0.25]
    primitive = np.array([0, 1, 0, 1])
    at_i = np.array([7, 7, 7, 5, 5], dtype=np.uint32)
    known = np.array([True, True, False, False, True])
    round_corners(1, at_i, primitive, corners, room, slip, gap, known)
    assert slip.tolist() == [
        9.0,
        0.5,
        0.5,
        0.25,
        0.25,
    ]  # the vertex has that of the edge, and the edge that of the vertex
    assert gap.tolist() == [9.0, 0.3, 0.1, 0.2, 0.2]


@pytest.mark.parametrize("seed", range(5))
def test_the_share_beyond_the_cone_is_that_of_its_definition(seed: int) -> None:
    random = np.random.default_rng(seed)
    pairs = {(int(min(p)), int(max(p))) for p in random.integers(0, 12, (25, 2)) if p[0] != p[1]}
    borne = {(int(g), int(m)) for g, m in random.integers(0, 5, (9, 2))}
    i, j = (np.array([p[k] for p in sorted(pairs)]) for k in (0, 1))
    swap = random.random(len(i)) < 0.5
    i, j = np.where(swap, j, i), np.where(swap, i, j)
    grain, primitive = (np.array([p[k] for p in sorted(borne)]) for k in (0, 1))
    pressed, held = random.random(len(i)), random.random(len(grain))
    z, w = np.zeros(len(i)), np.zeros(len(grain))
    contacts = GrainContacts(i, j, z, z, pressed, z, z, z)
    bodies = RigidContacts(grain, primitive, w, w, held, w, w, w, w, w)
    # Some pull that are not pressed, some are pressed and do not pull.
    one, other = random.permutation(len(i))[: len(i) - 3], random.permutation(len(grain))[:-2]
    who_i, who_j = np.append(j[one], [13, 2]), np.append(i[one], [2, 13])
    who = (
        np.append(who_i, grain[other]),
        np.append(who_j, np.full(len(other), -1)),
        np.append(np.full(len(who_i), -1), primitive[other]),
    )
    fx, fy = 0.4 * random.standard_normal((2, len(who[0])))
    none = np.zeros(len(fx))
    forces = FrictionForces(*who, fx, fy, none, none, none, none, none > 1.0)
    normal = dict(zip(zip(*np.sort([i, j], axis=0).tolist(), strict=True), pressed, strict=True))
    on_body = dict(zip(zip(grain.tolist(), primitive.tolist(), strict=True), held, strict=True))
    beyond = 0
    for a, b, m, x, y in zip(*(v.tolist() for v in (*who, fx, fy)), strict=True):
        force = normal.get((min(a, b), max(a, b)), 0.0) if b >= 0 else on_body[a, m]
        beyond += bool(np.hypot(x, y) > BEYOND * 0.5 * force)
    assert 0 < beyond < len(fx)
    assert forces.beyond_cone(0.5, 14, contacts, bodies) == beyond / len(fx)

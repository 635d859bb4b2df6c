"""A grain that has gone through a face is found, one that went around it is not."""

from __future__ import annotations

import numpy as np
import pytest

from core.observables import RigidContacts
from core.packing import Packing
from core.passage import deep_grains, pass_faces
from core.relaxation import Relaxation
from core.rigid_contacts import (
    DISC,
    EDGE,
    RigidTerms,
    allocate,
    changed_sides,
    find_rigid_pairs,
)

FACE = [EDGE, 0.0, 0.0, 1.0, 0.0, 10.0, 0.0, 0.2]


def touching(primitive: int = 0, overlap: float = 0.1, image: float = 0.0) -> RigidContacts:
    one = np.ones(1)
    index = np.zeros(1, dtype=np.int64)
    return RigidContacts(
        index, index + primitive, one, one, one, overlap * one, one, one, image * one, 0.0 * one
    )


def passed(contacts: RigidContacts, *ways: np.ndarray) -> bool:
    """Has the one grain of ``contacts`` passed the face it touches?"""
    crossed = np.zeros((1, 2), dtype=np.bool_)
    c = contacts
    pass_faces(c.grain, c.primitive, c.image_x, c.image_y, *ways, crossed)
    return bool(crossed.any())


def state(x: float, y: float) -> np.ndarray:
    return np.array([[x], [y], [1.0], [0.0], [0.0]])


@pytest.mark.parametrize(
    ("before", "after", "through"),
    [
        ((5.0, 0.5), (5.0, -0.5), True),
        ((5.0, -0.5), (6.0, 0.1), True),
        ((5.0, 0.5), (5.0, 0.1), False),
        ((9.95, 0.1), (10.2, -0.05), False),  # around its end
        ((-0.2, 0.1), (0.1, -0.1), False),
        ((10.05, 0.1), (9.9, -0.1), True),  # from beyond its end
        ((9.9, 0.1), (10.05, -0.1), True),
    ],
)
def test_from_one_side_of_a_face_to_the_other(
    before: tuple[float, float], after: tuple[float, float], through: bool
) -> None:
    rows = np.array([FACE])
    assert passed(touching(), state(*before), state(*after), rows, rows) is through


def test_a_face_that_moves_past_a_grain_counts_and_one_that_takes_it_along_does_not() -> None:
    rows, lower = np.array([FACE]), np.array([FACE])
    lower[:, [2, 6]] -= 1.0
    assert passed(touching(), state(5.0, -0.5), state(5.0, -0.6), rows, lower)
    assert not passed(touching(), state(5.0, 0.5), state(5.0, -0.5), rows, lower)


def test_the_image_of_a_grain_counts_and_discs_have_no_faces() -> None:
    rows = np.array([FACE, [DISC, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]])
    through = state(-15.0, 0.5), state(-15.0, -0.5)
    assert passed(touching(image=20.0), *through, rows, rows)
    assert not passed(touching(), *through, rows, rows)
    assert not passed(touching(primitive=1, image=20.0), *through, rows, rows)


def deep(packing: Packing, overlap: float) -> np.ndarray:
    contacts = touching(overlap=overlap)
    return deep_grains(packing.state, contacts.grain, contacts.overlap, 0.05)


def test_deep_means_that_one_more_step_could_take_the_face_past_the_centre() -> None:
    packing = Packing([0.0], [0.0])
    packing.set_axes(1.2, 0.8, 0.3)
    assert deep(packing, 0.76).all()
    assert not deep(packing, 0.74).any()


def listed(*centres: tuple[float, float]) -> tuple[np.ndarray, RigidTerms]:
    """Grains of radius 1 and the list of those near the face."""
    states = np.concatenate([state(x, y) for x, y in centres], axis=1)
    terms = allocate(np.array([FACE]), len(centres))
    assert find_rigid_pairs(states, terms, 0.15, None)
    return states, terms


def test_between_two_lists_a_grain_changes_sides_only_by_going_through() -> None:
    before, terms = listed((5.0, 0.05), (5.0, 0.2), (10.05, 0.05), (0.02, -0.02), (5.0, 9.0))
    after = before.copy()
    after[1] -= 0.1
    after[1, 3] += 0.15
    after[0, 2:4] -= (0.0, 0.1)
    changed = changed_sides(before, after, terms, None)
    assert terms.used[0] == 4
    assert terms.grain[: terms.used[0]][changed].tolist() == [0]  # the others stay, or go around


def test_through_and_back_is_not_through() -> None:
    """Only where a grain ends counts: looks at every new list add up."""
    packing = Packing([5.0], [0.4])
    relaxation = Relaxation(packing, np.array([FACE]), gravity=(0.0, -1e-3))
    relaxation.run(1)
    state_now = relaxation._minimizer.state
    state_now[1] = -0.01
    assert relaxation.gone_through().all()
    relaxation._relist()
    assert relaxation.gone_through().all()
    state_now[1] = 0.02
    assert not relaxation.gone_through().any()


def test_a_grain_shot_through_a_face_between_new_lists_is_seen() -> None:
    """Far through, by way of many lists, in one go."""
    packing = Packing([5.0], [0.05])
    packing.set_axes(1.0, 0.06, 0.0)
    relaxation = Relaxation(
        packing, np.array([FACE]), gravity=(0.0, -30.0), drag=1.0, max_iterations=2_000
    )
    relaxation.run(2_000)
    assert relaxation._minimizer.state[1, 0] < -1.0
    assert relaxation.gone_through().all()

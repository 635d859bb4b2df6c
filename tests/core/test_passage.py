"""A grain that has gone through a face is found, one that went around it is not."""

from __future__ import annotations

import numpy as np
import pytest

from core.observables import RigidContacts
from core.packing import Packing
from core.passage import deep_grains, passed_faces
from core.rigid_contacts import DISC, EDGE

FACE = [EDGE, 0.0, 0.0, 1.0, 0.0, 10.0, 0.0, 0.2]


def touching(primitive: int = 0, overlap: float = 0.1, image: float = 0.0) -> RigidContacts:
    one = np.ones(1)
    index = np.zeros(1, dtype=np.int64)
    return RigidContacts(
        index, index + primitive, one, one, one, overlap * one, one, one, image * one, 0.0 * one
    )


def state(x: float, y: float) -> np.ndarray:
    return np.array([[x], [y], [1.0], [0.0], [0.0]])


@pytest.mark.parametrize(
    ("before", "after", "passed"),
    [
        ((5.0, 0.5), (5.0, -0.5), True),
        ((5.0, -0.5), (6.0, 0.1), True),
        ((5.0, 0.5), (5.0, 0.1), False),
        ((9.0, 0.5), (10.5, -0.5), False),  # around its end
        ((-0.5, 0.5), (0.5, -0.5), False),
    ],
)
def test_from_one_side_of_a_face_to_the_other(
    before: tuple[float, float], after: tuple[float, float], passed: bool
) -> None:
    rows = np.array([FACE])
    assert passed_faces(touching(), state(*before), state(*after), rows, rows) is passed


def test_a_face_that_moves_past_a_grain_counts_and_one_that_takes_it_along_does_not() -> None:
    rows, lower = np.array([FACE]), np.array([FACE])
    lower[:, [2, 6]] -= 1.0
    assert passed_faces(touching(), state(5.0, -0.5), state(5.0, -0.6), rows, lower)
    assert not passed_faces(touching(), state(5.0, 0.5), state(5.0, -0.5), rows, lower)


def test_the_image_of_a_grain_counts_and_discs_have_no_faces() -> None:
    rows = np.array([FACE, [DISC, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]])
    through = state(-15.0, 0.5), state(-15.0, -0.5)
    assert passed_faces(touching(image=20.0), *through, rows, rows)
    assert not passed_faces(touching(), *through, rows, rows)
    assert not passed_faces(touching(primitive=1, image=20.0), *through, rows, rows)


def test_deep_means_that_one_more_step_could_take_the_face_past_the_centre() -> None:
    packing = Packing([0.0], [0.0])
    packing.set_axes(1.2, 0.8, 0.3)
    assert deep_grains(packing, touching(overlap=0.76), 0.05) == {0}
    assert deep_grains(packing, touching(overlap=0.74), 0.05) == set()

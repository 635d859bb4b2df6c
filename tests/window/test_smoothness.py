"""The scripted mouse that looks at every picture: what counts, and that it drags in a window. No test asks how smooth it is."""

from __future__ import annotations

import pytest

from sandbox.window.smoothness import Case, Picture, _told, _turned, drag


def pictures(bodies: list[float], hands: list[float]) -> list[Picture]:
    """Ten a second, along a line [R]."""
    return [
        Picture(0.1 * k, (body, 0.0), (hand, 0.0))
        for k, (body, hand) in enumerate(zip(bodies, hands, strict=True))
    ]


def test_a_picture_counts_where_the_hand_was_elsewhere_before() -> None:
    seen = _told(6, pictures([0.0, 0.0, 0.5, 0.5, 0.5, 1.0], [0.0, 1.0, 1.0, 1.0, 1.0, 1.0]), 0.03)
    # In the second picture the body was where the hand had been; it stood in the fourth and the fifth.
    assert (seen.pictures, seen.due, seen.moved) == (6, 4, 2)
    assert seen.stood == pytest.approx(0.2)
    assert seen.rate == pytest.approx(10.0)
    assert seen.lag == pytest.approx((0.0 + 1.0 + 0.5 + 0.5 + 0.5 + 0.0) / 6)
    assert seen.turn == 0.03


def test_a_turn_is_seen_in_the_first_picture_of_the_way_back() -> None:
    there = pictures([0.0, 0.1, 0.2, 0.1, 0.0], [0.0] * 5)
    assert _turned(there, (1.0, 0.0)) == pytest.approx(0.3)
    assert _turned(there[:3], (1.0, 0.0)) is None
    assert _turned(there[:3], (-1.0, 0.0)) == pytest.approx(0.1)


def test_a_hand_drags_in_a_window_ahead_and_not() -> None:
    settings = {"grains": 60, "intruder_radius": 2.0, "hand_strength": 1000.0}
    alone = Case("intruder", ("mixed",), settings, seconds=0.4, rounds=1)
    beside = Case(
        "intruder", ("regular", "auxetic"), settings, seconds=0.4, rounds=1, size=(900, 600)
    )
    seen = [*drag(alone), *drag(beside)]
    assert [one.depth for one in seen] == [0, 6, 0, 6]
    for one in seen:
        assert 0 <= one.moved <= one.due < one.pictures
        assert 0.0 < one.lag < 3.0

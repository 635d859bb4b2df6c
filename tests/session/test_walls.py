"""Walls that are drawn and erased: grains make way, hands and contacts know of it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.session.commands import (
    DrawWall,
    EraseWall,
    Protocol,
)
from sandbox.session.editing import LEAST, WALL, line_of
from sandbox.session.session import Session
from tests.session.edited import DENSE, assert_refused, assert_whole, built, do, empty


def test_a_wall_is_drawn_with_as_few_corners_as_it_needs() -> None:
    session = empty()
    line = [(10.0 + 0.1 * k, 5.0 + 0.02 * math.sin(k)) for k in range(80)]
    line += [(17.9, 5.0 + 0.1 * k) for k in range(60)]
    do(session, DrawWall(tuple(line)))
    (wall,) = session.run.setup.world.drawn
    assert len(wall.segments) == 2
    assert line_of(wall)[0] == line[0]
    assert line_of(wall)[-1] == line[-1]
    assert session.frame().bodies[-1].name == wall.name


def test_a_short_line_is_a_peg() -> None:
    session = empty()
    do(session, DrawWall(((15.0, 10.0), (15.1, 10.1))))
    (wall,) = session.run.setup.world.drawn
    assert wall.discs == [(15.0, 10.0, WALL)]


@pytest.mark.parametrize("kind", ["regular", "auxetic"])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_grains_make_way_for_a_wall_and_stay_on_their_sides(kind: str, friction: float) -> None:
    session = built("intruder", kind, friction=friction, **DENSE)
    x0, _, x1, y1 = session.run.setup.bounds
    middle = 0.5 * (x0 + x1) + 1.0
    before = {int(k): x for k, x in zip(*_labels(session), strict=True)}
    do(session, DrawWall(((middle, 0.5), (middle, y1 - 1.5))))
    assert session.frame().refusals == 0
    assert session.frame().converged
    assert_whole(session)
    for label, x in zip(*_labels(session), strict=True):
        if abs(before[int(label)] - middle) > 1.5:
            assert (x > middle) == (before[int(label)] > middle)
    aside = np.abs(session.run.setup.packing.x - middle)
    assert aside.min() > WALL + 0.5 * LEAST


def _labels(session: Session) -> tuple[np.ndarray, np.ndarray]:
    packing = session.run.setup.packing
    return packing.label, packing.x


def test_a_wall_stops_what_a_hand_moves() -> None:
    session = empty()
    do(session, DrawWall(((15.0, 2.0), (15.0, 18.0))), Protocol(True))
    while not session.idle:
        session.advance(100_000)
        x = session.run.setup.world["intruder"].position[0]
        assert x < 15.0 - WALL - 2.0 + 0.05


def test_walls_that_cannot_be() -> None:
    session = empty()
    assert_refused(session, DrawWall(((3.0, 5.0), (3.0, 15.0))), "body that moves")
    assert_refused(session, DrawWall(((-50.0, 5.0), (-40.0, 15.0))), "inside the scene")
    assert_refused(session, EraseWall(15.0, 10.0), "no drawn wall")
    zigzag = tuple((8.0 + 0.02 * k, 8.0 + 4.0 * (k % 2)) for k in range(500))
    assert_refused(session, DrawWall(zigzag), "too many corners")


def test_a_wall_that_would_crush_grains_is_refused() -> None:
    session = built("grain_row", grains=1)
    # One grain in a box of its own size: half of it is enough to be squeezed into, a quarter is not.
    do(session, DrawWall(((0.0, 0.3), (0.0, 1.7))))
    assert_whole(session)
    x = float(session.run.setup.packing.x[0])
    assert_refused(session, DrawWall(((x, 0.3), (x, 1.7))), "cannot make way")


def test_walls_are_erased_where_they_are_pointed_at() -> None:
    session = empty()
    do(session, DrawWall(((8.0, 4.0), (12.0, 4.0))), DrawWall(((8.0, 16.0), (12.0, 16.0))))
    assert_refused(session, EraseWall(10.0, 10.0), "no drawn wall")
    do(session, EraseWall(10.0, 4.5))
    assert [line_of(w)[0] for w in session.run.setup.world.drawn] == [(8.0, 16.0)]
    do(session, DrawWall(((8.0, 4.0), (12.0, 4.0))))
    names = [body.name for body in session.run.setup.world.bodies]
    assert len(set(names)) == len(names)


def test_contacts_with_later_walls_remember_when_an_earlier_one_goes() -> None:
    session = built("intruder", friction=0.5, **DENSE)
    _, _, x1, y1 = session.run.setup.bounds
    do(session, DrawWall(((0.75 * x1, 3.0), (0.75 * x1, 6.0))))
    do(session, DrawWall(((0.6 * x1, y1 - 5.0), (0.8 * x1, y1 - 5.0))))
    do(session, *[Protocol(True)] * 3)
    world, friction = session.run.setup.world, session.run.engine.friction
    assert friction is not None
    counts = [len(body.primitives()) for body in world.bodies]
    first, last = sum(counts[:-1]), sum(counts)
    held = {k: v for k, v in friction.remembered().items() if first <= -1 - k[1] < last}
    assert held
    session.submit(EraseWall(0.75 * x1, 4.5))
    session.settle()
    now = session.run.engine.friction.remembered()  # type: ignore[union-attr]
    shift = counts[-2]
    assert {(a, b + shift): v for (a, b), v in held.items()}.items() <= now.items()
    assert all(-1 - b < last - shift for _, b in now)
    do(session)
    assert_whole(session)

"""How many checkpoints stay: all of late, ever fewer of long ago, never more bytes than allowed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sandbox.session.checkpoints import Checkpoint, Checkpoints
from sandbox.session.history import History
from sandbox.session.session import Session
from tests.session.test_time import built


@pytest.fixture(scope="module")
def session() -> Session:
    return built()


def course(session: Session, rows: int) -> list[Checkpoint]:
    """Checkpoints of one course of events."""
    first, history = session.run.present(), History()
    for _ in range(rows):
        history.append(replace(session.history[0]))
    return [replace(first, history=history, length=n + 1) for n in range(rows)]


def test_late_ones_all_stay_and_early_ones_at_ever_wider_distances(session: Session) -> None:
    kept = Checkpoints(dense=8)
    for one in course(session, 201):
        kept.add(one)
        newest = one.increment
        for increment in range(newest + 1):
            age = newest - increment
            every = 1
            while age >= 8 * every:
                every *= 2
            assert (increment in kept.increments) == (increment % every == 0)
    assert kept.increments[:4] == (0, 32, 64, 80)
    assert (kept.first, kept.last) == (0, 200)
    assert kept.size == sum(kept.at(n).size for n in kept.increments)


def test_bytes_are_bounded_whatever_the_length(session: Session) -> None:
    some = course(session, 400)
    most = 30 * some[0].size
    kept = Checkpoints(dense=100, most_bytes=most)
    for one in some:
        kept.add(one)
        assert kept.size <= most
    assert kept.first == 0
    assert kept.last == 399
    assert kept.increments[-3:] == (397, 398, 399)


def test_the_nearest_before_is_found(session: Session) -> None:
    kept = Checkpoints(dense=2)
    for one in course(session, 40):
        kept.add(one)
    for asked in (0, 1, 17, 38, 39, 1000):
        assert kept.at(asked).increment == max(n for n in kept.increments if n <= asked)


def test_going_on_cuts_the_future(session: Session) -> None:
    kept = Checkpoints()
    some = course(session, 10)
    for one in some:
        kept.add(one)
    kept.travel(some[4])
    assert kept.last == 9
    kept.add(some[5])
    assert kept.increments == tuple(range(6))


def test_what_lies_on_another_course_is_forgotten(session: Session) -> None:
    kept = Checkpoints()
    some = course(session, 10)
    other = some[3].history.upto(4)
    for _ in range(6):
        other.append(replace(session.history[0]))
    for one in some:
        kept.add(one)
    kept.travel(replace(some[0], history=other, length=8))
    assert kept.increments == (0, 1, 2, 3, 7)


def test_squeezing_frees_memory_and_keeps_the_ends(session: Session) -> None:
    kept = Checkpoints(dense=50)
    some = course(session, 60)
    for one in some[:50]:
        kept.add(one)
    kept.squeeze(10 * some[0].size)
    assert kept.size <= 10 * some[0].size
    assert (kept.first, kept.last) == (0, 49)
    before = len(kept)
    for one in some[50:]:
        kept.add(one)
    assert len(kept) == before + 10


def test_checkpoints_share_material_but_nothing_with_the_run(session: Session) -> None:
    twin = built()
    first = twin.run.checkpoints.at(0).engine.packing
    second = twin.run._checkpoint(twin.run.checkpoints.at(0)).engine.packing
    assert second.rest_radius is first.rest_radius
    assert second.state is not first.state
    twin.run.restore(twin.run.checkpoints.at(0))
    now = twin.run.setup.packing
    for name in ("state", "rest_radius", "poisson_ratio", "contact_stiffness", "label"):
        assert not np.shares_memory(getattr(now, name), getattr(first, name))


def test_a_history_goes_on_from_an_earlier_row() -> None:
    rows = built().history
    history = History()
    for k in range(300):
        history.append(replace(rows[0], increment=k, stroke=0.1 * k))
    early = history.upto(270)
    assert len(early) == 270
    assert early[269] is history[269]
    assert np.array_equal(early.curve, history.curve[:, :270])
    early.append(replace(rows[0], increment=270, stroke=-1.0))
    assert history[270].stroke == 27.0
    assert early.curve[0, 270] == -1.0
    assert history.upto(300) is history

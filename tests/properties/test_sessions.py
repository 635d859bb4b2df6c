"""Whatever anybody does in any scene: all that is kept is sound, it can be replayed to the last bit, and Reset leads back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sandbox.files.log_file import read_log, write_log
from sandbox.session.commands import (
    Change,
    Command,
    DrawWall,
    Erase,
    EraseWall,
    Grab,
    Move,
    Place,
    Protocol,
    Recall,
    Redo,
    Release,
    Reset,
    Retype,
    Undo,
)
from sandbox.session.replay import replay
from sandbox.session.session import Session
from sandbox.studies.stability.scenes import small
from sandbox.studies.stability.watch import Watch
from scenes import registry

SCENES = registry.names()
KINDS = ("regular", "auxetic")
BOUNDED = settings(
    max_examples=6,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
PATIENCE = 60.0  # seconds of a core for one example: a hang is a failure

lengths = st.one_of(
    st.floats(-30.0, 30.0),
    st.sampled_from([0.0, 1e-300, 5e-324, 1e6, -1e6, 1e300, -1e300, math.inf, math.nan]),
)
values = st.one_of(
    st.floats(0.0, 20.0),
    st.sampled_from([0.0, -1.0, 0.05, 0.5, 10.0, 1e9, 1e-9, math.nan, math.inf, True, "x"]),
)


def commands(session: Session) -> st.SearchStrategy[Command]:
    """Anything that this session may be told, sense and nonsense."""
    handles = st.sampled_from([h.body for h in session.run.setup.handles] + ["nothing"])
    live = st.sampled_from([p.name for p in session.scene.parameters if p.live] + ["nothing"])
    inside = st.floats(-1.0, 12.0)
    kinds = st.sampled_from(KINDS)
    radius = st.floats(0.0, 4.0)
    points = st.lists(st.tuples(inside, inside), min_size=1, max_size=4).map(tuple)
    hand: st.SearchStrategy[Command] = st.one_of(
        st.builds(Grab, handles),
        st.builds(Move, handles, lengths, lengths),
        st.builds(Release, handles),
        st.builds(Protocol, st.booleans()),
    )
    time: st.SearchStrategy[Command] = st.one_of(
        st.just(Reset()),
        st.just(Undo()),
        st.just(Redo()),
        st.builds(Recall, st.integers(0, 12)),
        st.builds(Change, live, values),
    )
    making: st.SearchStrategy[Command] = st.one_of(
        st.builds(Place, inside, inside, kinds, st.booleans()),
        st.builds(Erase, inside, inside, radius, st.booleans()),
        st.builds(Retype, inside, inside, radius, kinds, st.booleans()),
        st.builds(DrawWall, points),
        st.builds(EraseWall, inside, inside),
    )
    return st.one_of(hand, hand, time, making)


def obey(session: Session, watch: Watch, steps: Sequence[tuple[Command, int]]) -> None:
    """Each command, and so many increments after it."""
    for command, increments in steps:
        session.submit(command)
        watch.run(session, increments)
        session.settle()
        packing = session.run.setup.packing
        assert np.all(np.isfinite(packing.state))
        frame = session.frame()
        assert frame.grains == len(packing) == len(frame.x)
        assert math.isfinite(float(frame.curve_force[-1]))
    assert not watch.broken, watch.broken


@pytest.mark.parametrize("name", SCENES)
@BOUNDED
@given(data=st.data())
def test_any_sequence_of_commands(name: str, data: st.DataObject, tmp_path: Path) -> None:
    scene = registry.get(name)
    kind = data.draw(st.sampled_from(scene.packings))
    friction = data.draw(st.sampled_from([0.0, 0.5]))
    session = small(scene, kind, friction=friction, max_iterations=3_000)
    start = session.state_hash()
    step = st.tuples(commands(session), st.integers(0, 3))
    steps = data.draw(st.lists(step, min_size=1, max_size=8))
    watch = Watch(PATIENCE)
    # To begin with, somebody pulls: else most examples would do nothing at all.
    handle = session.run.setup.handles[0].body
    obey(session, watch, [(Grab(handle), 0), (Move(handle, 3.0, 3.0), 3), *steps])
    path = tmp_path / "run.jsonl"
    write_log(path, session.log())
    log = read_log(path)
    again = list(replay(log, slice_iterations=97))[-1]
    assert again.state_hash() == log.hash == session.state_hash()
    assert list(again.history.rows()) == list(session.history.rows())
    session.submit(Reset())
    session.settle()
    changed = any(isinstance(command, Change) for command, _ in steps)
    assert changed or session.state_hash() == start
    session.submit(Protocol(True))
    watch.run(session, 2)
    assert not watch.broken, watch.broken

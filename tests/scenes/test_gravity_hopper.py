"""Grains that sink by themselves: they go on without a hand, clog, hang on nothing, and a shaken funnel lets them go."""

from __future__ import annotations

import math
from itertools import islice

import numpy as np
import pytest

from core.errors import InputError
from sandbox.files.log_file import read_log, write_log
from sandbox.lessons.tours import tour
from sandbox.session.commands import Grab, Move, Protocol
from sandbox.session.replay import replay
from sandbox.session.session import Session
from scenes.checks import Check, Track
from scenes.gravity_hopper import REST, TREMBLE


def hopper(kind: str = "mixed", seed: int = 1, **settings: object) -> Session:
    session = Session("gravity_hopper", kind, seed, {"grains": 60, "width": 14.0, **settings})
    session.build()
    return session


def settle(session: Session, most: int = 2_000) -> int:
    """Let the grains sink until nothing moves; how many increments that took."""
    done = 0
    while not session.idle:
        done += session.advance(20_000)
        assert done < most, "it never comes to rest"
    return done


def test_a_wide_orifice_runs_empty_without_a_hand() -> None:
    session = hopper(orifice=5.0, friction=0.2, fall=0.3)
    assert not session.idle
    settle(session)
    assert len(session.run.setup.packing) <= 3
    curve = session.history.curve[1]
    assert np.all(np.diff(curve) >= 0.0)
    assert curve[-1] == session.history[-1].grains_out
    assert not [check for check in session.checks() if check.holds is False]


def test_a_narrow_orifice_clogs_with_an_arch() -> None:
    session = hopper(orifice=2.2)
    filled = session.frame().grains
    settle(session)
    frame = session.frame()
    assert frame.grains > filled // 3  # how many go before depends on the last bits
    assert any(notice.startswith("clogged") for notice in frame.notices)
    assert frame.highlight is not None
    arch = np.flatnonzero(frame.highlight)
    assert 1 <= len(arch) <= 8
    # It stands over the orifice, from one side of it to the other.
    assert frame.x[arch].min() < 0.0 < frame.x[arch].max()
    assert np.abs(frame.x[arch]).max() < 7.0
    assert not [check for check in session.checks() if check.holds is False]
    # A relaxed pile stays as it is.
    assert not session.advance(1_000)


@pytest.mark.parametrize("seed", range(1, 5))
def test_never_started_is_not_clogged(seed: int) -> None:
    """Where no grain has ever left, nothing has flowed that could clog; once one has, a rest under an arch is a clog."""
    kinds = set()
    for orifice in (0.6, 1.6):
        session = hopper(orifice=orifice, seed=seed)
        settle(session)
        (notice,) = session.frame().notices
        events = {event.kind for event in session.history.events}
        started = session.run.course.out > 0
        assert notice.startswith("clogged" if started else "never started")
        assert events == {"clog" if started else "arch"}
        kinds.add(started)
    assert False in kinds


def test_shaking_breaks_an_arch() -> None:
    session = hopper("auxetic", orifice=2.2, friction=0.3)
    settle(session)
    held = session.frame().grains
    assert held > 10
    handle = session.frame().handles[0]
    session.submit(Grab("funnel"))
    for k in range(12):
        session.submit(Move("funnel", handle.x + (0.8 if k % 2 else -0.8), handle.y))
        settle(session)
    assert session.frame().grains < held


def test_some_arches_break_when_shaken_and_some_hold() -> None:
    """As the tour says of its own hopper: once it has clogged by itself, the script shakes it."""
    lesson = tour("gravity_hopper")
    assert lesson is not None
    shake = next(step for step in lesson.steps if step.key == "clog")
    more = []
    for seed in range(1, 5):
        session = Session("gravity_hopper", "mixed", seed, dict(shake.settings))
        session.build()
        session.submit(Protocol(True))
        out = [row.grains_out for row in islice(session.increments(20_000), REST + TREMBLE)]
        more.append(out[-1] - out[REST - 1])
    assert max(more) > 0
    assert min(more) == 0


@pytest.mark.parametrize("tilt", [0.0, 20.0])
def test_weight_rests_on_the_funnel(tilt: float) -> None:
    """Newton: what stands still is carried. The funnel feels the weight of all grains in it, along gravity."""
    session = hopper(orifice=0.5, tolerance=1e-4, friction=0.0, tilt=tilt)
    settle(session)
    run = session.run
    weight = 0.01 * float(np.sum(run.setup.packing.rest_radius**2))
    angle = math.radians(tilt)
    fx, fy, _ = run.last.reactions[0]
    assert fx == pytest.approx(weight * math.sin(angle), abs=0.02 * weight)
    assert fy == pytest.approx(-weight * math.cos(angle), abs=0.02 * weight)


def test_a_film_of_shaking_is_the_same_when_replayed(tmp_path: object) -> None:
    session = hopper(orifice=2.0)
    session.submit(Protocol(True))
    while session.finished < 40:
        session.advance(500)
    path = f"{tmp_path}/run.jsonl"
    write_log(path, session.log())
    states = list(replay(read_log(path)))
    assert states[-1].state_hash() == session.state_hash()


def test_shapes_that_cannot_be_are_refused_before_anything_is_built() -> None:
    for name, settings in {
        "orifice": {"orifice": 8.0, "width": 8.0},
        "few": {"grains": 20, "width": 60.0},
    }.items():
        with pytest.raises(InputError, match=name):
            Session("gravity_hopper", "mixed", 1, settings)


def test_a_grain_that_sinks_does_not_hang() -> None:
    """Let go by a shaken funnel at any time; what hangs is a grain that touches nothing and stays."""
    session = hopper()
    setup = session.run.setup
    long = 100
    none = np.zeros(long)
    track = Track(none, none, none, none, np.ones(long, dtype=bool), 60)
    setup.packing.state[:2, 0] = 0.0, setup.bounds[3] - 1.0

    def hanging() -> Check:
        return next(c for c in session.scene.checks(setup, track) if "hangs" in c.name)

    assert hanging().holds, hanging().measured
    before = setup.packing.state.copy()
    setup.gravity = (0.0, 0.0)
    assert hanging().holds is False
    assert np.array_equal(setup.packing.state, before)

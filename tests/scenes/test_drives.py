"""Drives one way: in whole steps, to their end and no further, and never without an increment."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.session.commands import Change, Protocol
from sandbox.session.session import Session
from scenes.drives import HAIR, depth_after, steps_to, there_and_back


def driven(scene: str, settings: dict[str, float]) -> Session:
    """A scene whose script is about to begin."""
    session = Session(scene, "regular", 1, settings)
    session.build()
    session.submit(Protocol(True))
    return session


def to_the_end(session: Session) -> None:
    """Until nothing wants another increment."""
    for _ in session.increments(1000):
        pass


@given(st.floats(1e-6, 100.0), st.floats(1e-3, 0.25))
def test_as_many_steps_as_are_said_lead_to_the_end(end: float, step: float) -> None:
    depths: list[float] = []
    while (depth := depth_after(len(depths), step, end)) is not None:
        depths.append(depth)
    assert len(depths) in (steps_to(end, step), steps_to(end, step) - 1)  # as rounding has it
    assert depths == sorted(depths)
    assert 0.0 < depths[0] <= depths[-1] <= end + HAIR
    assert depths[-1] > end - step - 1e-5 * step


@pytest.mark.parametrize(
    ("scene", "settings", "way"),
    [
        ("single_grain", {"compression": 1e-4}, 2e-4),
        ("grain_row", {"compression": 1e-3}, 2e-3),
        ("biaxial_press", {"grains": 10, "compression": 0.01, "step": 0.06}, None),
        ("avalanches", {"grains": 60, "strain": 0.01, "step": 0.15}, None),
    ],
)
def test_a_drive_shorter_than_a_step_is_one_shorter_step(
    scene: str, settings: dict[str, float], way: float | None
) -> None:
    session = driven(scene, settings)
    to_the_end(session)
    run = session.run
    assert len(run.history) - 1 == run.scene.steps(run.settings) == 1
    body, box = run.setup.handles[0].body, run.setup.packing.box
    moved = math.hypot(*run.last.moved[body]) if box is None else box.shift
    assert 0.0 < moved < run.setup.solver.step
    if way is not None:
        assert moved == pytest.approx(way)


@pytest.mark.parametrize(
    ("scene", "settings", "longer"),
    [
        ("single_grain", {"compression": 0.1}, 0.15),
        ("grain_row", {"compression": 0.02}, 0.03),
        ("biaxial_press", {"grains": 20, "compression": 0.05, "step": 0.01}, 0.15),
        ("hopper", {"grains": 100, "stroke": 0.5, "step": 0.01}, 0.15),
    ],
)
def test_a_longer_step_on_the_way_leads_as_far(
    scene: str, settings: dict[str, float], longer: float
) -> None:
    session, whole = driven(scene, settings), driven(scene, {**settings, "step": longer})
    while len(session.history) < 3:
        session.advance()
    session.submit(Change("step", longer))
    to_the_end(session)
    to_the_end(whole)
    there, end = (abs(each.run.way or 0.0) for each in (session, whole))
    assert there == pytest.approx(end, abs=1e-9)
    most = session.run.setup.solver.step + 1e-9
    assert all(math.hypot(*each) <= most for each in session.run.last.moved.values())


def test_there_and_back_is_a_triangular_wave() -> None:
    assert [there_and_back(q) for q in (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 3.5, 4.0, 5.0)] == [
        *(0.0, 0.5, 1.0, 0.5, 0.0, -1.0, -0.5, 0.0, 1.0)
    ]

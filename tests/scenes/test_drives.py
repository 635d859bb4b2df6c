"""Drives one way: in whole steps, to their end and no further, and never without an increment."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from scenes.drives import HAIR, depth_after, steps_to, there_and_back


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
    ],
)
def test_a_drive_shorter_than_a_step_is_one_shorter_step(
    scene: str, settings: dict[str, float], way: float | None
) -> None:
    session = Session(scene, "regular", 1, settings)
    session.build()
    session.submit(Protocol(True))
    for _ in session.increments(10, lambda *_: None):
        pass
    run = session.run
    assert (
        len(run.history) == run.scene.steps(run.settings) + 1 == 2
    )  # as it is at the start, and one more
    moved = run.last.moved[run.setup.handles[0].body]
    assert 0.0 < -moved[1] < run.setup.solver.step
    if way is not None:
        assert -moved[1] == pytest.approx(way)


def test_there_and_back_is_a_triangular_wave() -> None:
    assert [there_and_back(q) for q in (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 3.5, 4.0, 5.0)] == [
        *(0.0, 0.5, 1.0, 0.5, 0.0, -1.0, -0.5, 0.0, 1.0)
    ]

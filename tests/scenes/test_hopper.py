"""The hopper with a piston: it clogs with an arch that is pointed at; impossible shapes are refused at once."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from scenes import registry
from scenes.scene import STRONGEST


def test_a_clogged_hopper_points_at_its_arch() -> None:
    settings: dict[str, object] = {
        "grains": 100,
        "width": 14.0,
        "orifice": 1.5,
        "step": 0.1,
        "stroke": 5.0,
        "friction": 0.8,
        "hand_strength": STRONGEST,
    }
    session = Session("hopper", "regular", 1, settings)
    session.build()
    assert session.frame().highlight is None
    session.submit(Protocol(True))
    while not session.idle:
        session.advance(20_000)
    frame = session.frame()
    clogged = [notice for notice in frame.notices if notice.startswith("clogged")]
    assert clogged
    assert frame.highlight is not None
    arch = np.flatnonzero(frame.highlight)
    assert f"an arch of {len(arch)} grains" in clogged[0]
    assert 2 <= len(arch) <= 8
    assert frame.x[arch].min() < 0.0 < frame.x[arch].max()
    # It is the lowest loaded chain: it stands within a few diameters of the orifice.
    assert frame.y[arch].min() < 3.0


@pytest.mark.parametrize(
    ("scene", "settings", "words"),
    [
        ("hopper", {"orifice": 8.0, "width": 8.0}, "wider than the channel"),
        ("hopper", {"grains": 20}, "too few grains"),
        ("intruder", {"grains": 50, "intruder_radius": 20.0}, "does not fit"),
    ],
)
def test_impossible_shapes_are_refused_before_anything_is_built(
    scene: str, settings: dict[str, object], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        registry.get(scene).settings(settings)


def test_length_of_the_scripted_drive_follows_the_settings() -> None:
    hopper, intruder = registry.get("hopper"), registry.get("intruder")
    assert hopper.steps(hopper.settings()) == 440
    assert hopper.steps(hopper.settings({"stroke": 10.0, "step": 0.1})) == 100
    assert hopper.steps(hopper.settings({"stroke": 200.0})) < 2_000  # the piston's travel ends
    assert intruder.steps(intruder.settings()) == 400
    assert intruder.steps(intruder.settings({"stroke": 1.0})) == 20


@pytest.mark.parametrize("name", ["hopper", "intruder"])
def test_as_many_increments_as_said(name: str) -> None:
    settings: dict[str, object] = {"stroke": 0.6, "step": 0.15, "grains": 150, "tolerance": 0.3}
    session = Session(name, "mixed", 1, settings)
    session.build()
    session.submit(Protocol(True))
    while not session.idle:
        session.advance(20_000)
    assert len(session.history) - 1 == session.scene.steps(session.settings) == 4

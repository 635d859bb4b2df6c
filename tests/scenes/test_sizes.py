"""Sizes of grains as parameters of every scene with many of them: all alike, large and small, or spread evenly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from core.generate import Recipe
from core.settings import LONGEST_STEP
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import Change, Place, Protocol
from sandbox.session.editing import radii
from sandbox.session.replay import replay
from sandbox.session.session import Session
from scenes import registry
from scenes.grains import SIZES, recipe
from scenes.relaxing import step
from scenes.scene import HAND_STRENGTH, STRONGEST
from tests.scenes.test_registry import small

BULK = [
    name
    for name in registry.names()
    if any(p.name == "size_ratio" for p in registry.get(name).parameters)
]
MACHINE: dict[str, object] = {HAND_STRENGTH: STRONGEST}
# What a scene needs besides, so that few grains of which half are tiny fill it.
MORE: dict[str, dict[str, object]] = {
    "couette": {"grains": 320},
    "intruder": {"grains": 200},
    "hopper": {"grains": 200},
    "gravity_hopper": {"grains": 300},
}


def few(name: str, **settings: object) -> dict[str, object]:
    return {**small(registry.get(name)), **MACHINE, **MORE.get(name, {}), **settings}


def after(name: str, increments: int, **settings: object) -> Session:
    session = Session(name, "mixed", 2, few(name, **settings))
    session.build()
    session.submit(Protocol(True))
    done = 0
    while done < increments and not session.idle:
        done += session.advance(5_000)
    return session


def test_all_scenes_that_pack_have_them() -> None:
    assert set(BULK) == {
        "avalanches", "biaxial_periodic", "biaxial_press", "couette",
        "gravity_hopper", "hopper", "intruder", "workshop",
    }  # fmt: skip
    for name in BULK:
        own = {p.name: p for p in registry.get(name).parameters}
        assert all(own[p.name] is p for p in SIZES)
        settings = registry.get(name).settings()
        assert recipe(settings, "mixed") == Recipe(auxetic_contact_stiffness=50.0)
        assert step(settings) == settings["step"]


@pytest.mark.parametrize("name", BULK)
def test_single_sized(name: str) -> None:
    session = after(name, 3, size_ratio=1.0)
    assert set(session.run.setup.packing.rest_radius) == {1.0}
    assert not [c for c in session.checks() if c.holds is False]


@pytest.mark.parametrize("name", BULK)
def test_few_large_among_many_small(name: str) -> None:
    """Also with a step that is too long for the small ones: then bodies go a quarter of their radius an increment."""
    session = after(name, 10, size_ratio=6.0, small_fraction=0.75, step=0.15)
    radius = session.run.setup.packing.rest_radius
    assert np.sum(radius < 1.0) == round(0.75 * len(radius))
    assert set(radius) == {1.0, 1.0 / 6.0}
    assert session.run.setup.solver.step == LONGEST_STEP / 6.0
    assert not [c for c in session.checks() if c.holds is False]
    stroke = session.history.column("stroke")
    if name in ("hopper", "intruder", "workshop"):
        assert np.diff(stroke).max() == pytest.approx(LONGEST_STEP / 6.0)


@pytest.mark.parametrize("name", BULK)
def test_a_spread_of_sizes(name: str) -> None:
    session = after(name, 0, size_ratio=1.0, size_width=0.5)
    radius = np.sort(session.run.setup.packing.rest_radius)
    session = after(name, 3, size_ratio=1.0, size_width=0.5)
    assert len(set(radius)) == len(radius)
    assert np.diff(radius).max() == pytest.approx(0.5 / len(radius))
    assert 0.5 < radius[0] < radius[-1] < 1.0
    assert not [c for c in session.checks() if c.holds is False]


@pytest.mark.parametrize("name", BULK)
def test_the_script_is_as_long_as_it_says(name: str) -> None:
    """``steps`` knows of shorter steps too."""
    scene = registry.get(name)
    usual = scene.settings({"size_ratio": 1.0})
    short = scene.settings({"size_ratio": 10.0, "small_fraction": 0.01})
    if name == "gravity_hopper":  # it goes by pauses
        return
    assert scene.steps(short) / scene.steps(usual) == pytest.approx(
        step(usual) / step(short), rel=0.03
    )


def test_a_change_of_the_step_is_cut_too() -> None:
    session = after("workshop", 1, size_ratio=5.0)
    session.submit(Change("step", 0.12))
    session.settle()
    assert session.settings["step"] == 0.12
    assert session.run.setup.solver.step == pytest.approx(0.05)


@pytest.mark.parametrize("small_fraction", [0.0, 0.5, 1.0])
def test_the_brush_places_sizes_that_there_are(small_fraction: float) -> None:
    session = after("workshop", 0, grains=4, size_ratio=4.0, small_fraction=small_fraction)
    for k in range(4):
        session.submit(Place(6.0 + 2.5 * k, 4.0, "auxetic"))
        session.settle()
    there = {0.0: {1.0}, 0.5: {1.0, 0.25}, 1.0: {0.25}}[small_fraction]
    assert set(session.run.setup.packing.rest_radius) == there
    assert set(radii(session.settings)) == there
    session.submit(Protocol(True))
    while not session.advance(1_000):
        pass
    assert session.history[-1].stop_reason == "converged"


def test_a_scene_file_and_a_log_keep_them(tmp_path: Path) -> None:
    session = after("intruder", 4, grains=300, size_ratio=3.0, small_fraction=0.7, size_width=0.2)
    write_scene(tmp_path / "it.toml", session.made())
    again = Session.from_file(read_scene(tmp_path / "it.toml"))
    again.build()
    for name in ("size_ratio", "small_fraction", "size_width"):
        assert again.settings[name] == session.settings[name]
    assert np.array_equal(
        again.run.setup.packing.rest_radius, session.run.setup.packing.rest_radius
    )
    assert list(replay(session.log()))[-1].state_hash() == session.state_hash()


@pytest.mark.parametrize("name", ["couette", "biaxial_press"])
def test_too_few_for_a_cell(name: str) -> None:
    """One line, before anything is packed."""
    settings: dict[str, object] = {"grains": 160, "size_ratio": 10.0, "small_fraction": 1.0}
    with pytest.raises(InputError, match=r"it takes \d+, or larger ones"):
        registry.get(name).settings(settings)

"""Every scene in every packing that it offers: it builds, runs, keeps its claims, resets and repeats itself to the last bit."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from sandbox.session.commands import Protocol, Reset
from sandbox.session.frame import Frame
from sandbox.session.session import Session
from scenes import registry
from scenes.parameter import Parameter
from scenes.scene import Scene
from tests.scenes.told import TOLD, check_table, tilt

INCREMENTS = 15
REPOSITORY = Path(__file__).parents[2]
FEWEST = 60  # grains of a scene whose number is a parameter
# What a scene needs besides, so that so few grains fit.
SMALL: dict[str, dict[str, object]] = {
    "grain_row": {"grains": 5},
    "intruder": {"intruder_radius": 2.0},
    "hopper": {"width": 12.0},
}
SCENES = [(name, kind) for name in registry.names() for kind in registry.get(name).packings]
PARAMETERS = [
    (registry.get(name), p) for name in registry.names() for p in registry.get(name).parameters
]


def small(scene: Scene) -> dict[str, object]:
    """Settings for few grains."""
    settings: dict[str, object] = {}
    for parameter in scene.parameters:
        if parameter.name == "grains":
            settings["grains"] = max(int(parameter.low), min(int(parameter.default), FEWEST))
    return {**settings, **SMALL.get(scene.name, {})}


def run(name: str, kind: str) -> Session:
    """A session at the end of the first increments of its scripted drive."""
    session = Session(name, kind, 3, small(registry.get(name)))
    session.build()
    session.submit(Protocol(True))
    done = 0
    while done < INCREMENTS and not session.idle:
        done += session.advance(2_000)
    return session


def assert_finite(frame: Frame) -> None:
    """Every number of a frame, those of its parts included; what is open, is open."""
    assert frame.grains == len(frame.y) == len(frame.rest_radius)
    pending: list[object] = [frame]
    while pending:
        part = pending.pop()
        for field in fields(part):  # type: ignore[arg-type]
            value = getattr(part, field.name)
            if field.name == "box" or value is None:
                continue
            if field.name in ("usual_error", "force_error") and not np.any(frame.curve_force):
                continue  # relative to a force that there has not been yet
            if isinstance(value, tuple):
                pending += [v for v in value if hasattr(v, "__dataclass_fields__")]
                value = [v for v in value if isinstance(v, float)]
            if hasattr(value, "__dataclass_fields__"):
                pending.append(value)
            elif isinstance(value, (float, list, np.ndarray)):
                assert np.all(np.isfinite(value)), field.name


@pytest.mark.parametrize(("name", "kind"), SCENES)
def test_plays(name: str, kind: str) -> None:
    session = run(name, kind)
    assert len(session.history) > 1
    frame = session.frame()
    assert_finite(frame)
    check_table(session)
    assert frame.scene == name
    assert frame.packing == kind
    low_x, low_y, high_x, high_y = frame.bounds
    assert low_x < high_x
    assert low_y < high_y
    for handle in frame.handles:
        assert handle.label
        assert handle.radius > 0.0
        assert low_x <= handle.x <= high_x, handle.name
        assert low_y <= handle.y <= high_y, handle.name
    astray = next(c.measured for c in session.checks() if "no grain is lost" in c.name)
    assert ("outlet" in astray) == (session.run.setup.outlet is not None)
    # Where one place takes a few increments to let go, so few increments cannot tell nine of ten.
    broken = [c for c in session.checks() if c.holds is False and "converge" not in c.name]
    assert not broken
    assert np.mean(session.history.column("stop_reason")[1:] == "converged") >= 0.75
    for check in session.checks():
        assert check.name
        assert check.measured


def test_a_scene_that_nobody_has_told_of_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    session = run("two_ellipses", "mixed")
    monkeypatch.delitem(TOLD, "two_ellipses")
    with pytest.raises(AssertionError, match=r"no entry for two_ellipses in TOLD of .*told\.py"):
        check_table(session)
    monkeypatch.setitem(TOLD, "two_ellipses", {"tilt": tilt})
    with pytest.raises(AssertionError, match=r"no columns \['tilt'\] for two_ellipses"):
        check_table(session)


@pytest.mark.parametrize(("name", "kind"), SCENES)
def test_repeats_and_resets(name: str, kind: str) -> None:
    """The same seed gives the same bits at the start and after some increments; a reset goes back to the start."""
    first, second = run(name, kind), run(name, kind)
    assert first.state_hash() == second.state_hash()
    assert list(first.history.rows()) == list(second.history.rows())
    fresh = Session(name, kind, 3, small(registry.get(name)))
    fresh.build()
    start = fresh.state_hash()
    assert start != first.state_hash()
    first.submit(Reset())
    first.settle()
    assert first.state_hash() == start
    assert list(first.history.rows()) == list(fresh.history.rows())
    first.submit(Protocol(True))
    done = 0
    while done < INCREMENTS and not first.idle:
        done += first.advance(2_000)
    assert first.state_hash() == second.state_hash()


@pytest.mark.parametrize(("scene", "parameter"), PARAMETERS, ids=lambda x: x.name)
def test_parameters(scene: Scene, parameter: Parameter) -> None:
    assert parameter.check(parameter.default) == parameter.default
    assert parameter.parse(str(parameter.default)) == parameter.default
    assert parameter.low < parameter.high
    assert parameter.help
    assert parameter.help == parameter.help.strip()
    assert parameter.unit == parameter.unit.strip()
    assert "[" not in parameter.unit
    assert parameter.name.isidentifier()
    if parameter.kind != "switch":
        for beyond in (parameter.low - 1, parameter.high + 1):
            with pytest.raises(InputError, match=parameter.name):
                scene.settings({parameter.name: beyond})
    with pytest.raises(InputError, match=parameter.name):
        scene.settings({parameter.name: "wide"})
    with pytest.raises(InputError, match=parameter.name):
        scene.settings({parameter.name: float("nan")})


@pytest.mark.parametrize("name", registry.names())
def test_says_what_it_is(name: str) -> None:
    scene = registry.get(name)
    assert scene.name == name
    assert scene.title
    assert scene.question.endswith("?")
    assert scene.about.endswith(".")
    assert scene.packings
    names = [parameter.name for parameter in scene.parameters]
    assert len(set(names)) == len(names)
    assert scene.default_steps == scene.steps(scene.settings())  # the list of scenes tells the one
    with pytest.raises(InputError, match="choose"):
        scene.check_packing("steel")


def test_unknown_names() -> None:
    with pytest.raises(InputError, match="did you mean single_grain"):
        registry.get("single_grian")
    with pytest.raises(InputError, match="did you mean"):
        registry.get("single_grain").settings({"poison_ratio": 0.1})


def test_a_scene_is_read_alone() -> None:
    """Of the other scenes' files none is, unless it is made from them."""
    program = (
        "import json, sys\n"
        "from sandbox.session.session import Session\n"
        "from scenes import registry\n"
        "Session('single_grain', 'regular', 1)\n"
        "print(json.dumps([name for name in registry.names() if f'scenes.{name}' in sys.modules]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=REPOSITORY
    )
    assert json.loads(done.stdout) == ["single_grain"]

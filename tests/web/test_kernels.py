"""The kernels of pages, on the desk and as WebAssembly, against the session: bit for bit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sandbox.web import building
from sandbox.web.host import Host
from sandbox.web.increment import course
from sandbox.web.increment.memory import COUNTS, ROW, Kept
from sandbox.web.increment.systems import PLACES
from sandbox.web.laid_out import Blocks, laid_out, part, state_hash
from sandbox.web.pages import SLIDES
from scenes import registry
from tests.web.exact import AROUND, BEGUN, CHANGED, commands, entries
from tests.web.pages import RUNS, Run, first_differing

pytestmark = pytest.mark.slow


def test_a_page_for_every_scene_is_tried() -> None:
    assert {scene for scene, _ in RUNS} == set(building.SCENES)


@pytest.mark.parametrize("run", RUNS)
def test_kernels_on_the_desk_do_what_the_session_does(exact: dict[Run, Any], run: Run) -> None:
    said = exact[run]
    assert first_differing(said["session"], said["kernels"]) == -1
    assert len(set(said["session"].tolist())) > 40  # it has moved
    stroke, own_stroke, force, own_force = said["curve"].T
    np.testing.assert_allclose(own_stroke, stroke, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(own_force, force, rtol=1e-9, atol=1e-12)


def test_the_runs_show_what_they_are_for(exact: dict[Run, Any]) -> None:
    assert 0.0 in exact["hopper", "regular"]["shares"]  # all the hand has moves nothing
    assert exact["hopper", "auxetic"]["left"][-1] > 5
    assert exact["gravity_hopper", "mixed"]["left"][-1] > 5
    assert min(exact["intruder", "regular"]["shares"]) < 1.0  # the hand is not strong enough


def test_every_slider_that_acts_where_grains_stand_is_tried() -> None:
    assert set(CHANGED) == set(building.SCENES)
    tried = {name for changed in CHANGED.values() for name in changed}
    assert {slide.command[0] for slide in SLIDES if slide.name in tried} | {"set_ratio"} == {
        slide.command[0] for slide in SLIDES
    }


@pytest.mark.parametrize("run", RUNS)
def test_webassembly_gives_the_bits_of_the_desk(
    exact: dict[Run, Any], program: Path, periodic_program: Path, run: Run
) -> None:
    said = exact[run]
    kernels = periodic_program if building.is_periodic(run[0]) else program
    assert first_differing(said["session"], replayed(kernels, said, run[0])) == -1


def started(program: Path, said: dict[str, Any]) -> tuple[Host, int]:
    """A run in compiled kernels after its first increment, and the body that is driven."""
    first: Blocks = said["ints"], said["floats"]
    host = Host(program, first)
    assert host.call("advance") == 1
    return host, int(part(first, "counts", len(COUNTS))[COUNTS.driven])


def moved_by(
    host: Host, body: int, way: float, direction: tuple[float, float], around: float = 0.0
) -> None:
    """A hand takes the body and wants it so far along its drive, up or to the right [R], as an image so far ``around`` says."""
    x, y = part(host.blocks(), "places", PLACES * (body + 1))[PLACES * body :][:2]
    x, y = float(x) + way * abs(direction[0]) + around, float(y) + way * abs(direction[1])
    host.call("command", course.GRAB, body, 0.0, 0.0)
    host.call("command", course.MOVE, body, x, y)


def direction_of(said: dict[str, Any]) -> tuple[float, float]:
    """That of the drive, as it is at first."""
    row = part((said["ints"], said["floats"]), "row", len(ROW))
    return float(row[ROW.direction_x]), float(row[ROW.direction_y])


def replayed(program: Path, said: dict[str, Any], name: str) -> list[str]:
    """The same commands to the compiled kernels: hashes after each increment."""
    host, driven = started(program, said)
    hashes = [state_hash(host.blocks())]
    steps = len(said["session"]) - 1
    for step in range(steps):
        what, where = commands(steps).get(step, ("", 0.0))
        if what == "script":
            host.call("command", course.SCRIPT_ON, driven, 0.0, 0.0)
            blocks = host.blocks()
            part(blocks, "counts", len(COUNTS))[COUNTS.script] = BEGUN.get(name, 0)
            host.write(blocks)
        elif what == "move":
            moved_by(host, driven, where, direction_of(said), AROUND.get(name, 0.0))
        elif what == "set":
            settings = registry.get(name).settings(dict(building.SCENES[name]))
            for entry, values in entries(name, settings):
                host.call(entry, *values)
        host.call("advance")
        hashes.append(state_hash(host.blocks()))
    return hashes


def test_kernels_need_no_more_memory_the_longer_they_run(
    exact: dict[Run, Any], program: Path
) -> None:
    host, driven = started(program, exact["hopper", "auxetic"])
    sizes = []
    for _ in range(12):
        for way in (-0.5, 0.5):  # the same ten increments there and back, again and again
            moved_by(host, driven, way, (0.0, 1.0))
            for _ in range(10):
                host.call("advance")
        sizes.append(host.size)
    assert len(set(sizes[2:])) == 1, sizes
    assert sizes[-1] < 2_000_000


def test_a_disc_that_is_dragged_stays_out_of_walls_and_slides_along_them() -> None:
    scene = registry.get("intruder")
    settings = scene.settings({"grains": 60, "intruder_radius": 2.0})
    setup = scene.build(settings, "mixed", 1)
    setup.packing = setup.packing.select(np.zeros(len(setup.packing), dtype=np.bool_))
    blocks = laid_out(scene, setup, settings, "mixed")
    kept, driven = Kept(*blocks), setup.world.index("intruder")
    course.advance(kept)
    right, top = setup.outline[2]
    x = setup.world["intruder"].position[0]
    course.command(kept, course.GRAB, driven, 0.0, 0.0)
    course.command(kept, course.MOVE, driven, x, top + 30.0)  # through the wall
    count = 0
    while course.advance(kept):
        count += 1
        assert count < 1000
    places = part(blocks, "places", PLACES * (driven + 1))[PLACES * driven :]
    np.testing.assert_allclose(places[:2], (x, top - 2.0), atol=1e-9)
    course.command(
        kept, course.MOVE, driven, right + 30.0, top + 30.0
    )  # and along it, into the corner
    while course.advance(kept):
        count += 1
        assert count < 2000
    np.testing.assert_allclose(places[:2], (right - 2.0, top - 2.0), atol=1e-9)

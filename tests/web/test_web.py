"""Pages that run in a browser: the kernels on the desk and as WebAssembly against the session, bit for bit; and the page itself.

What needs the extra ``web``, Node.js or Chromium is skipped where that is missing, and says so.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError
from sandbox.lessons import tours
from sandbox.web import building
from sandbox.web.host import Host
from sandbox.web.increment import course
from sandbox.web.increment.memory import COUNTS, ROW, Kept
from sandbox.web.increment.systems import PLACES
from sandbox.web.laid_out import Blocks, laid_out, part, state_hash
from sandbox.web.menu import menu
from sandbox.web.pages import SLIDES, STEPS, sliders
from scenes import registry
from tests.web.exact import BEGUN, commands

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PAGE = ROOT / "sandbox" / "web" / "page"
CHROMIUM = next(
    (
        found
        for name in ("chromium", "chromium-browser", "google-chrome")
        if (found := shutil.which(name))
    ),
    None,
)
# Scene and packing, and how many increments: in the hopper the script goes on until it is locked, or some have left; that under
# gravity is shaken, and then grains leave while nobody does anything.
RUNS = {
    ("hopper", "regular"): 140,
    ("hopper", "auxetic"): 120,
    ("gravity_hopper", "mixed"): 120,
    ("intruder", "regular"): 64,
    ("biaxial_press", "mixed"): 64,
    ("grain_row", "mixed"): 64,
    ("single_grain", "mixed"): 64,
}
Run = tuple[str, str]
pytestmark = pytest.mark.slow


def missing(*modules: str) -> list[str]:
    return [name for name in modules if importlib.util.find_spec(name) is None]


def run_exactly(run: Run, folder: Path, *more: str) -> dict[str, Any]:
    """What the session and the kernels say on the desk, both without fast math."""
    (scene, kind), out = run, folder / "run.npz"
    settings = [f"{name}={value}" for name, value in building.SCENES[scene].items()]
    command = [sys.executable, "-m", "tests.web.exact", str(out), scene, kind, "1", str(RUNS[run])]
    subprocess.run([*command, *settings, *more], check=True, cwd=ROOT, timeout=1800)
    with np.load(out) as numbers:
        return dict(numbers)


@pytest.fixture(scope="session")
def exact(tmp_path_factory: pytest.TempPathFactory) -> dict[Run, dict[str, Any]]:
    """That of all runs."""
    return {run: run_exactly(run, tmp_path_factory.mktemp("exact")) for run in RUNS}


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The kernels as WebAssembly."""
    lacking = missing("ziglang", "wasmtime")
    if lacking:
        pytest.skip(f"without {' and '.join(lacking)}: install the extra web")
    from sandbox.web.toolchain import kernels

    path = tmp_path_factory.mktemp("kernels") / "kernels.wasm"
    path.write_bytes(kernels())
    return path


def first_differing(these: Any, those: Any) -> int:
    """−1 where all are alike."""
    differing = np.flatnonzero(np.asarray(these) != np.asarray(those))
    return int(differing[0]) if len(differing) else -1


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


@pytest.mark.parametrize("run", RUNS)
def test_webassembly_gives_the_bits_of_the_desk(
    exact: dict[Run, Any], program: Path, run: Run
) -> None:
    said = exact[run]
    assert first_differing(said["session"], replayed(program, said, BEGUN.get(run[0], 0))) == -1


def started(program: Path, said: dict[str, Any]) -> tuple[Host, int]:
    """A run in compiled kernels after its first increment, and the body that is driven."""
    first: Blocks = said["ints"], said["floats"]
    host = Host(program, first)
    assert host.call("advance") == 1
    return host, int(part(first, "counts", len(COUNTS))[COUNTS.driven])


def moved_by(host: Host, body: int, way: float, direction: tuple[float, float]) -> None:
    """A hand takes the body and wants it so far along its drive, up or to the right [R]."""
    x, y = part(host.blocks(), "places", PLACES * (body + 1))[PLACES * body :][:2]
    x, y = float(x) + way * abs(direction[0]), float(y) + way * abs(direction[1])
    host.call("command", course.GRAB, body, 0.0, 0.0)
    host.call("command", course.MOVE, body, x, y)


def direction_of(said: dict[str, Any]) -> tuple[float, float]:
    """That of the drive, as it is at first."""
    row = part((said["ints"], said["floats"]), "row", len(ROW))
    return float(row[ROW.direction_x]), float(row[ROW.direction_y])


def replayed(program: Path, said: dict[str, Any], begun: int) -> list[str]:
    """The same commands to the compiled kernels: hashes after each increment."""
    host, driven = started(program, said)
    hashes = [state_hash(host.blocks())]
    steps = len(said["session"]) - 1
    for step in range(steps):
        what, where = commands(steps).get(step, ("", 0.0))
        if what == "script":
            host.call("command", course.SCRIPT_ON, driven, 0.0, 0.0)
            blocks = host.blocks()
            part(blocks, "counts", len(COUNTS))[COUNTS.script] = begun
            host.write(blocks)
        elif what == "move":
            moved_by(host, driven, where, direction_of(said))
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


def test_what_a_page_cannot_run_is_refused() -> None:
    scene = registry.get("biaxial_periodic")
    settings = scene.settings({"grains": 100})
    setup = scene.build(settings, "mixed", 1)
    with pytest.raises(InputError, match="a page runs scenes in an open box"):
        laid_out(scene, replace(setup, curve=None), settings)
    with pytest.raises(InputError, match="there is no page of couette: choose hopper, "):
        building.scene_named("couette")


def test_a_disc_that_is_dragged_stays_out_of_walls_and_slides_along_them() -> None:
    scene = registry.get("intruder")
    settings = scene.settings({"grains": 60, "intruder_radius": 2.0})
    setup = scene.build(settings, "mixed", 1)
    setup.packing = setup.packing.select(np.zeros(len(setup.packing), dtype=np.bool_))
    blocks = laid_out(scene, setup, settings)
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


def test_the_menu_has_pictures_for_both_themes() -> None:
    text = menu(list(building.SCENES))
    for theme in ("dark", "light"):
        assert text.count(f'class="for-{theme}"') == len(building.SCENES)
    assert not re.search(r'src="(?!data:)', text)
    assert len(text) < building.SINGLE


def test_every_slider_begins_where_the_scene_does() -> None:
    for name, changed in building.SCENES.items():
        scene = registry.get(name)
        settings = scene.settings(dict(changed))
        for slide in sliders(scene, settings):
            value = min(float(settings[slide["name"]]), slide["most"])
            assert slide["least"] <= slide["value"] == value, f"{name}: {slide['name']}"


def test_a_tour_on_a_page_asks_for_nothing_that_cannot_be_done_there() -> None:
    on_a_page = {slide.name for slide in SLIDES}
    for name, settings in building.SCENES.items():
        for k in STEPS.get(name, range(len(tours.steps(name)))):
            asked = {
                key: value
                for key, value in tours.steps(name)[k].settings.items()
                if key not in on_a_page and value != settings.get(key)
            }
            first = k == 0  # which says how the scene is set up on the desk
            assert not asked or first, f"{name}, step {k}: {asked}"


def test_the_page_computes_no_forces() -> None:
    force = r"(?:force|bearing|resisting|reactions?|hand_[xy]|push|residual)"
    arithmetic = re.compile(
        rf'\b{force}\b["\])]*\s*(?:[-+*/]|\*\*)\s*\w|\w\s*[-+*/]\s*(?:\w+\.)*{force}\b',
        re.IGNORECASE,
    )
    sources = sorted((PAGE / "src").glob("*.ts"))
    assert len(sources) > 4
    for path in sources:
        code = re.sub(
            r"//.*|/\*[\s\S]*?\*/|`[^`]*`|\"[^\"]*\"", '""', path.read_text(encoding="utf-8")
        )
        found = [line for line in code.splitlines() if arithmetic.search(line)]
        assert not found, f"{path.name}: {found}"


@pytest.fixture(scope="session")
def tried(program: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the page of the hopper does in a browser."""
    if CHROMIUM is None or shutil.which("npm") is None:
        pytest.skip("without Chromium or npm: no page can be tried")
    folder = tmp_path_factory.mktemp("page")
    (path,) = building.write(folder, ["hopper"], lambda _text, _share: None, single=True)
    for name in ("package.json", "package-lock.json"):
        shutil.copyfile(PAGE / name, folder / name)
    subprocess.run(
        ["npm", "ci", "--no-audit", "--no-fund"], cwd=folder, check=True, capture_output=True
    )
    done = subprocess.run(
        ["node", str(HERE / "try_page.mjs"), str(path), str(folder)],
        env={**os.environ, "CHROMIUM": CHROMIUM},
        capture_output=True,
        text=True,
        check=True,
        timeout=900,
    )
    found: dict[str, Any] = json.loads(done.stdout)
    return found | {"size": path.stat().st_size}


def blocks_of(said: dict[str, list[str]]) -> Blocks:
    ints = np.array([int(number) for number in said["ints"]], dtype=np.int64)
    floats = np.array([int(number) for number in said["floats"]], dtype=np.uint64)
    return ints, floats.view(np.float64)


def test_a_page_asks_for_nothing_and_says_nothing(tried: dict[str, Any]) -> None:
    assert tried["faults"] == []
    assert tried["size"] <= building.SINGLE


def test_in_the_page_the_regular_hopper_locks_and_the_auxetic_one_flows(
    tried: dict[str, Any],
) -> None:
    regular, _, auxetic = tried["dragged"]
    assert regular["locked"]
    assert not auxetic["locked"]
    assert auxetic["out"] > 0
    assert auxetic["stroke"] > regular["stroke"]


def test_a_reset_is_the_start_to_the_last_bit(tried: dict[str, Any]) -> None:
    assert tried["again"] == tried["first"]


@pytest.mark.parametrize(("kind", "place"), [("regular", 0), ("auxetic", 2)])
def test_the_page_has_the_bits_of_the_desk(
    tried: dict[str, Any], tmp_path: Path, kind: str, place: int
) -> None:
    laid = blocks_of(tried["laid"][place])
    np.savez(tmp_path / "laid.npz", ints=laid[0], floats=laid[1])
    said = run_exactly(("hopper", kind), tmp_path, f"from={tmp_path / 'laid.npz'}")["session"]
    start, driven = (blocks_of(some[place]) for some in tried["blocks"])
    assert state_hash(start) == said[0]
    assert state_hash(driven) == said[60]

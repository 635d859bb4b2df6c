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
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError
from sandbox.draw.numbers import ONE_DIGIT, percent
from sandbox.lessons import tours
from sandbox.session.course import BLEW_UP, PRESSED_IN, SQUEEZED_FLAT
from sandbox.web import building
from sandbox.web.host import Host
from sandbox.web.increment import course, relaxation, remarks
from sandbox.web.increment.memory import COUNTS, ROW, Kept
from sandbox.web.increment.observe import observe
from sandbox.web.increment.systems import PLACES
from sandbox.web.laid_out import Blocks, laid_out, packing_in, part, state_hash
from sandbox.web.menu import menu
from sandbox.web.packed import GRID, packed
from sandbox.web.pages import SLIDES, STEPS, sliders
from sandbox.web.sentences import ALL, said_in, told
from sandbox.words import language, words
from scenes import registry
from tests.web.exact import AROUND, BEGUN, CHANGED, commands, entries

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
    ("couette", "mixed"): 64,
}
SEEDS = 2  # of the pages that are tried
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


def compiled(folder: Path, *, periodic: bool = False) -> Path:
    """The kernels as WebAssembly."""
    lacking = missing("ziglang", "wasmtime")
    if lacking:
        pytest.skip(f"without {' and '.join(lacking)}: install the extra web")
    from sandbox.web.toolchain import kernels

    path = folder / "kernels.wasm"
    path.write_bytes(kernels(periodic=periodic))
    return path


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Those for open cells."""
    return compiled(tmp_path_factory.mktemp("kernels"))


@pytest.fixture(scope="session")
def periodic_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """And for periodic ones."""
    return compiled(tmp_path_factory.mktemp("periodic"), periodic=True)


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
def test_kernels_say_and_show_what_the_desk_does(exact: dict[Run, Any], run: Run) -> None:
    said = exact[run]
    for desk, kernels in said["said"]:
        assert kernels == desk
    assert max(said["apart"]) < 1e-12


def test_the_runs_have_much_to_say(exact: dict[Run, Any]) -> None:
    said = {run: " ".join(desk for desk, _ in exact[run]["said"]) for run in RUNS}
    for kind in ("locked", "arch", "clog"):
        assert f"('{kind}', " in said["hopper", "regular"], kind
    assert "('avalanche', " in said["intruder", "regular"]
    assert "all the hand has" in said["intruder", "regular"]
    assert "flowing" in said["gravity_hopper", "mixed"]
    assert "end of travel" in said["gravity_hopper", "mixed"]
    assert "sideways: " in said["grain_row", "mixed"]
    assert "Poisson's ratio" in said["single_grain", "mixed"]
    assert "shear stress over pressure" in said["couette", "mixed"]


def test_every_sentence_has_its_words_and_its_scene() -> None:
    assert len(ALL) == remarks.STRESS_FELL + 1
    for code in language.available():
        with language.speaking(code):
            for sentence in ALL:
                text = sentence.text("piston")
                values = dict.fromkeys(sentence.values, 3)
                assert "{" not in language.Word(text).format(**values), (code, text)
    everything = frozenset().union(*(said_in(name) for name in building.SCENES))
    assert everything == frozenset(range(len(ALL)))


def test_what_is_taken_back_is_said_as_on_the_desk() -> None:
    scene = registry.get("single_grain")
    settings = scene.settings({})
    setup = scene.build(settings, "regular", 1)
    blocks = laid_out(scene, setup, settings, "regular")
    kept = Kept(*blocks)
    course.advance(kept)
    for reason, text in (
        (relaxation.COLLAPSED, SQUEEZED_FLAT),
        (relaxation.NOT_FINITE, BLEW_UP),
        (relaxation.SUNK, PRESSED_IN),
    ):
        part(blocks, "counts", len(COUNTS))[COUNTS.reason] = reason
        observe(kept)
        assert told(blocks, "plate") == ([text], [])


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


def test_what_a_page_cannot_run_is_refused() -> None:
    scene = registry.get("biaxial_periodic")
    settings = scene.settings({"grains": 100})
    setup = scene.build(settings, "mixed", 1)
    with pytest.raises(InputError, match="a page runs scenes whose cell is open"):
        laid_out(scene, replace(setup, curve=None), settings, "mixed")
    with pytest.raises(InputError, match="there is no page of avalanches: choose hopper, "):
        building.scene_named("avalanches")


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
    force = r"(?:force|bearing|resisting|reactions?|hand_[xy]|push|residual|pressure|stress)"
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


def written(folder: Path, names: list[str], *, seeds: int, single: bool = False) -> list[Path]:
    """Pages, packed by this process."""
    with ThreadPoolExecutor(1) as one:
        return building.write(folder, names, one, lambda _text: None, seeds=seeds, single=single)


@pytest.fixture(scope="session")
def tried(program: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the pages do in a browser."""
    if CHROMIUM is None or shutil.which("npm") is None:
        pytest.skip("without Chromium or npm: no page can be tried")
    pages, folder = tmp_path_factory.mktemp("pages"), tmp_path_factory.mktemp("node")
    written(pages, list(building.SCENES), seeds=SEEDS)
    for name in ("package.json", "package-lock.json"):
        shutil.copyfile(PAGE / name, folder / name)
    subprocess.run(
        ["npm", "ci", "--no-audit", "--no-fund"], cwd=folder, check=True, capture_output=True
    )
    done = subprocess.run(
        ["node", str(HERE / "try_page.mjs"), str(pages), str(folder)],
        env={**os.environ, "CHROMIUM": CHROMIUM},
        capture_output=True,
        text=True,
        check=True,
        timeout=1800,
    )
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def blocks_of(said: dict[str, list[str]]) -> Blocks:
    ints = np.array([int(number) for number in said["ints"]], dtype=np.int64)
    floats = np.array([int(number) for number in said["floats"]], dtype=np.uint64)
    return ints, floats.view(np.float64)


def test_the_pages_ask_for_nothing_say_nothing_and_are_open_to_all(tried: dict[str, Any]) -> None:
    assert tried["faults"] == []
    assert set(tried["others"]) == set(building.SCENES)


@pytest.mark.parametrize("name", building.SCENES)
def test_a_single_page_is_small(
    program: Path, periodic_program: Path, tmp_path: Path, name: str
) -> None:
    (path,) = written(tmp_path, [name], seeds=1, single=True)
    assert path.stat().st_size <= building.SINGLE


def test_a_single_page_has_as_many_seeds_as_it_has_room_for(
    program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def size(seeds: int) -> int:
        (path,) = written(tmp_path, ["grain_row"], seeds=seeds, single=True)
        return path.stat().st_size

    one, eight = size(1), size(8)
    assert one < eight <= building.SINGLE
    monkeypatch.setattr(building, "SINGLE", eight - 1)
    assert one < size(8) < eight
    assert size(40) == size(7)
    monkeypatch.setattr(building, "SINGLE", 0)
    assert size(8) == one


def test_a_seed_that_cannot_be_packed_is_left_out_and_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    packings_of = building.packings_of

    def fails(asked: building.Asked) -> tuple[Blocks, ...]:
        if asked[1] != 2:
            raise InputError("there is no room")
        return packings_of(asked)

    monkeypatch.setattr(building, "packings_of", fails)
    with ThreadPoolExecutor(1) as one:
        built = building.build("grain_row", (1, 2), one)
        assert built.seeds == (2,)
        assert "grain_row is without seed 1: there is no room" in capsys.readouterr().err
        with pytest.raises(InputError, match="no packing of grain_row can be made"):
            building.build("grain_row", (1, 3), one)


def test_packings_of_pages_are_those_of_the_desk_to_half_a_millionth_of_a_radius() -> None:
    scene = registry.get("couette")
    packing = scene.build(scene.settings(dict(building.SCENES["couette"])), "auxetic", 3).packing
    _, _, auxetic, *_ = building.packings_of(("couette", 3))
    moved = np.abs(packing_in(auxetic).state - packing.state)
    assert 0.0 < moved.max() <= 0.5 / GRID <= 0.5e-6
    with pytest.raises(ValueError, match="not on the grid"):
        packed(
            [
                [
                    laid_out(
                        scene,
                        scene.build(scene.settings({}), "auxetic", 3),
                        scene.settings({}),
                        "auxetic",
                    )
                ]
            ]
        )


def test_in_the_page_the_regular_hopper_locks_and_the_auxetic_one_flows(
    tried: dict[str, Any],
) -> None:
    regular, _, auxetic = tried["dragged"]
    assert regular["locked"]
    assert not auxetic["locked"]
    assert auxetic["out"] > 0
    assert auxetic["stroke"] > regular["stroke"]


def test_the_page_says_what_happens(tried: dict[str, Any]) -> None:
    regular = dict(map(tuple, tried["dragged"][0]["events"]))
    assert set(regular) >= {"locked", "arch", "clog"}
    assert re.fullmatch(r"locked at 8 k R: an arch of \d grains holds", regular["locked"])
    assert tried["told"][0].startswith(f"regular {regular['locked']}")
    assert any(line.startswith("regular · increment ") for line in tried["events"])
    for said, (usual, most) in zip(tried["trust"], tried["errors"], strict=True):
        often, bound = (percent(max(error, 1e-6), ONE_DIGIT) for error in (usual, most))
        text = words.HANDLE_FORCE_ERROR.format(usual=often, error=bound)
        within = words.HANDLE_FORCE_WITHIN.format(error=bound)
        assert said in (f"settled · {text}", f"settled · {within}")
    assert tried["slow"] == [["settling", "lamp working"]] * 3
    for line in tried["events"]:
        assert "{" not in line
        assert "NaN" not in line


def test_a_page_in_use_sets_undoes_and_resets(tried: dict[str, Any]) -> None:
    assert tried["softer"][0]["ratios"] == [0.6]
    assert tried["softer"][0]["rows"] > tried["dragged"][0]["rows"]
    assert tried["again"] == tried["first"]
    for name, seen in tried["others"].items():
        played, pulled = ([pane["rows"] for pane in seen[when]] for when in ("played", "pulled"))
        assert min(played) > 4, name
        assert min(more - rows for rows, more in zip(played, pulled, strict=True)) > 4, name
        assert seen["back"] == seen["before"], name
        assert seen["redone"] == seen["far"] != seen["back"], name
        still, later = seen["paused"]
        assert still == [pane["rows"] for pane in seen["pulled"]], name
        assert min(more - rows for rows, more in zip(still, later, strict=True)) > 0, name
        assert any(0.6 in pane["ratios"] for pane in seen["softer"]), name
        assert seen["end"] == seen["start"], name
        if seen["shares"]:
            assert seen["shares"][1] == pytest.approx(0.75, abs=0.05), name


def test_clumsy_hands_leave_a_page_in_order(tried: dict[str, Any]) -> None:
    hands = tried["hands"]
    assert not hands["byOther"]
    assert hands["keptHold"]
    assert hands["after"] < 5
    assert hands["aloud"].startswith("regular: ")
    assert "an event" not in hands["aloud"]
    for rows, drawn in hands["curves"]:
        assert rows == drawn > 1
    assert hands["friction"] == "0.5"
    with language.speaking("de"):
        assert hands["inGerman"].startswith(f"{words.PACKINGS['regular']}: ")
    assert hands["focus"] == "undo"
    assert hands["lamps"][0] == hands["lamps"][1]
    assert min(hands["printed"]) > 100
    assert hands["pulled"] == [True, 0]
    assert hands["scrolled"] == [False]


def test_a_seed_is_chosen_by_hand_by_key_and_by_address(tried: dict[str, Any]) -> None:
    seeds = tried["seeds"]
    assert seeds["offered"] == ["1", "2"]
    assert seeds["named"] == language.table("en")["words"]["panel_seed"]
    assert seeds["begun"] == [
        ["1", 0],
        ["2", 1],
        ["1", 0],
    ]  # as such, by address, and by one that is not there
    unknown = language.table("en")["player"]["unknown_seed"].format(asked="77", seed=1)
    assert seeds["told"] == ["", "", unknown, ""]  # until one is chosen
    assert seeds["chosen"] == [1, 0]  # from the list, and by the key
    assert seeds["start"] == [
        1,
        1,
        1,
    ]  # increments: what is chosen while paused is shown, and stands still


def test_the_page_unfolds_what_was_laid_out(tried: dict[str, Any]) -> None:
    for seed, laid in enumerate(tried["laid"], 1):
        for there, blocks in zip(laid, building.packings_of(("hopper", seed)), strict=False):
            for block, other in zip(blocks_of(there), blocks, strict=True):
                assert block.tobytes() == other.tobytes()


def test_a_page_that_cannot_go_on_says_so(tried: dict[str, Any]) -> None:
    table = language.table("en")
    assert tried["hands"]["never"] == table["player"]["cannot_run"]
    again = table["player"]["silent"].format(reset=table["buttons"]["reset"])
    assert tried["hands"]["silent"] == again


@pytest.mark.parametrize(("kind", "place"), [("regular", 0), ("auxetic", 2)])
def test_the_page_has_the_bits_of_the_desk(
    tried: dict[str, Any], tmp_path: Path, kind: str, place: int
) -> None:
    laid = blocks_of(tried["laid"][0][place])
    np.savez(tmp_path / "laid.npz", ints=laid[0], floats=laid[1])
    said = run_exactly(("hopper", kind), tmp_path, f"from={tmp_path / 'laid.npz'}")["session"]
    start, driven = (blocks_of(some[place]) for some in tried["blocks"])
    assert state_hash(start) == said[0]
    assert state_hash(driven) == said[60]

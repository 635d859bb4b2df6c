"""The real command, in a process of its own, as a person or a script would run it."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import imageio.v2
import numpy as np
import pytest

from sandbox.cli.main import main

pytestmark = pytest.mark.end_to_end

REPOSITORY = Path(__file__).parents[2]
STEPS = 5
SHORT = ["hopper", "--steps", str(STEPS)]
QUICK = [*SHORT, "--size", "320x240"]
# Long enough for the slowest machine to compile all kernels.
PATIENCE = 600.0


def environment(**extra: str) -> dict[str, str]:
    """The environment of a machine without a screen."""
    screen = {"DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER", "SDL_AUDIODRIVER"}
    kept = {name: value for name, value in os.environ.items() if name not in screen}
    path = os.pathsep.join(filter(None, [extra.pop("PYTHONPATH", ""), str(REPOSITORY)]))
    return {**kept, "PYTHONPATH": path, **extra}


def sandbox(folder: Path, *words: str, **extra: str) -> subprocess.CompletedProcess[str]:
    """``python -m sandbox WORDS`` in ``folder``."""
    return subprocess.run(
        [sys.executable, "-m", "sandbox", *words],
        cwd=folder,
        env=environment(**extra),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )


def state(output: str) -> str:
    """The state hash that a run has printed."""
    found = re.search(r"state ([0-9a-f]{8,})", output)
    assert found, output
    return found[1]


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def clock() -> float:
    """Processor time of this process and of those it has waited for [s]: what runs beside it does not count.

    Windows does not count children; there it is the time on the wall.
    """
    return time.perf_counter() if sys.platform == "win32" else sum(os.times()[:4])


@pytest.mark.parametrize("words", [["--help"], ["list", "--help"], ["record", "--help"]])
def test_help_answers_at_once(tmp_path: Path, words: list[str]) -> None:
    times = []
    for _ in range(3):
        start = clock()
        done = sandbox(tmp_path, *words)
        times.append(clock() - start)
        assert done.returncode == 0
        assert done.stdout.startswith("usage: python -m sandbox")
    assert min(times) < 0.3


def test_list_says_the_same_to_people_and_to_programs(tmp_path: Path) -> None:
    text = sandbox(tmp_path, "list").stdout
    scenes = json.loads(sandbox(tmp_path, "list", "--json").stdout)["scenes"]
    assert {"hopper", "intruder"} <= {scene["name"] for scene in scenes}
    for scene in scenes:
        assert scene["name"] in text
        assert scene["title"] in text
        assert scene["default_steps"] >= 1
        assert {"regular", "auxetic", "mixed"} <= set(scene["packings"])
        for parameter in scene["parameters"]:
            assert parameter["name"] in text
            assert parameter["help"]
            if parameter["type"] != "bool":
                assert parameter["low"] <= parameter["default"] <= parameter["high"]


def test_list_ends_quietly_when_nobody_reads_on(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "sandbox", "list", "--json"],
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout
    assert process.stderr
    process.stdout.close()
    with process.stderr:
        assert process.stderr.read() == ""
    assert process.wait(PATIENCE) == 0


def test_record_writes_film_and_table_and_says_what_came_of_it(tmp_path: Path) -> None:
    done = sandbox(tmp_path, "record", *QUICK, "--out", "film.mp4", "--data", "run.csv")
    assert done.returncode == 0, done.stderr
    frames = imageio.v2.mimread(tmp_path / "film.mp4", memtest=False)
    assert len(frames) == STEPS
    assert frames[0].shape == (240, 320, 3)
    assert all(np.asarray(frame).std() > 10.0 for frame in frames)
    rows = rows_of(tmp_path / "run.csv")
    assert [int(row["increment"]) for row in rows] == list(range(STEPS + 1))
    assert {
        "increment",
        "stroke [R]",
        "force on the piston [k R]",
        "force of the grains on right wall, x [k R]",
        "grains out",
        "energy [k R^2]",
        "relative residual",
        "FIRE iterations",
        "stop reason",
    } <= set(rows[0])
    summary = done.stdout.splitlines()[0]
    assert f"{STEPS} frames, {STEPS} increments" in summary
    assert "did not converge" in summary
    assert "100%" in done.stderr  # the progress bar
    assert sorted(path.name for path in tmp_path.iterdir()) == ["film.mp4", "run.csv"]


def test_same_seed_same_state_with_and_without_frames(tmp_path: Path) -> None:
    drawn = sandbox(tmp_path, "record", *QUICK, "--out", "last.png", "--data", "drawn.csv")
    plain = sandbox(tmp_path, "record", *SHORT, "--data", "plain.csv")
    other = sandbox(tmp_path, "record", *SHORT, "--data", "other.csv", "--seed", "2")
    assert state(drawn.stdout) == state(plain.stdout) != state(other.stdout)
    assert (tmp_path / "drawn.csv").read_bytes() == (tmp_path / "plain.csv").read_bytes()
    assert plain.stdout.startswith(f"{STEPS} increments")  # and not a word of frames
    assert imageio.v2.imread(tmp_path / "last.png").shape == (240, 320, 3)


@pytest.mark.parametrize("kinds", [["--packing", "mixed"], ["--compare", "regular,mixed"]])
def test_record_whose_scene_fails_its_check_writes_all_and_says_so(
    tmp_path: Path, kinds: list[str]
) -> None:
    words = [*QUICK, *kinds, "--set", "max_iterations=10", "--set", "tolerance=1e-6"]
    done = sandbox(tmp_path, "record", *words, "--out", "film.gif", "--data", "run.csv")
    assert done.returncode == 1, done.stderr
    assert "  FAILS  at least nine of ten increments converge: 0" in done.stdout
    assert len(imageio.v2.mimread(tmp_path / "film.gif", memtest=False)) == STEPS
    assert len(rows_of(tmp_path / "run.csv")) == (STEPS + 1) * (1 + kinds[-1].count(","))
    assert "Traceback" not in done.stderr


def test_record_makes_an_animation(tmp_path: Path) -> None:
    done = sandbox(tmp_path, "record", *QUICK, "--out", "film.gif", "--packing", "auxetic")
    assert done.returncode == 0, done.stderr
    assert len(imageio.v2.mimread(tmp_path / "film.gif", memtest=False)) == STEPS


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_leaves_whole_files(tmp_path: Path, number: signal.Signals) -> None:
    words = ["record", "hopper", "--steps", "100000", "--size", "320x240"]
    process = subprocess.Popen(
        [sys.executable, "-m", "sandbox", *words, "--out", "film.mp4", "--data", "run.csv"],
        cwd=tmp_path,
        env=environment(),
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    # The part file appears with the first frame.
    limit = time.monotonic() + PATIENCE
    while not list(tmp_path.glob(".film.*.part.mp4")) and time.monotonic() < limit:
        assert process.poll() is None, process.communicate()
        time.sleep(0.05)
    time.sleep(1.0)
    process.send_signal(number)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    message = errors.splitlines()[-1]
    frames = imageio.v2.mimread(tmp_path / "film.mp4", memtest=False)
    assert f"wrote {len(frames)} frames to film.mp4" in message
    assert len(rows_of(tmp_path / "run.csv")) == len(frames) + 1 >= 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["film.mp4", "run.csv"]


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_while_building_writes_nothing(tmp_path: Path) -> None:
    (tmp_path / "film.mp4").write_bytes(b"earlier")
    process = subprocess.Popen(
        [sys.executable, "-m", "sandbox", "record", "hopper", "--out", "film.mp4"],
        cwd=tmp_path,
        env=environment(),
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr
    process.stderr.read(1)  # the first sign of the progress bar
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    assert "nothing was written" in errors.splitlines()[-1]
    assert (tmp_path / "film.mp4").read_bytes() == b"earlier"
    assert [path.name for path in tmp_path.iterdir()] == ["film.mp4"]


TABLE = ["record", "hopper", "--data", "run.csv"]
MISTAKES = {
    "scene": (["record", "hoper", "--out", "film.mp4"], "hopper"),
    "scene to play": (["play", "hoper"], "hopper"),
    "scene as command": (["hopper"], "play hopper"),
    "packing": (["record", "hopper", "--out", "film.mp4", "--packing", "auxtic"], "auxetic"),
    "packing to play": (["play", "--packing", "auxtic"], "auxetic"),
    "parameter": (["record", "hopper", "--out", "film.mp4", "--set", "orfice=3"], "orifice"),
    "parameter's form": (["record", "hopper", "--out", "film.mp4", "--set", "orifice"], "NAME="),
    "type": (["record", "hopper", "--out", "film.mp4", "--set", "orifice=wide"], "'wide'"),
    "range": (["record", "hopper", "--out", "film.mp4", "--set", "orifice=1e9"], "0.3 and 8"),
    "not a number": (["record", "hopper", "--data", "run.csv", "--set", "orifice=nan"], "nan"),
    "parameter of no scene": (["play", "--set", "orifice=3"], "play SCENE"),
    "no output": (["record", "hopper"], "--out FILE.mp4"),
    "suffix": (["record", "hopper", "--out", "film.avi"], ".mp4"),
    "suffix of the table": (["record", "hopper", "--data", "run.txt"], ".csv"),
    "end of no animation": (["record", "hopper", "--out", "a.mp4", "--gif", "once"], "FILE.gif"),
    "form of no table": (
        ["record", "hopper", "--out", "a.png", "--csv", "excel"],
        "--data FILE.csv",
    ),
    "softness beside stiffness": (
        [*TABLE, "--set", "softness=0.02", "--set", "contact_stiffness=80"],
        "not both: leave one of them",
    ),
    "ratio beside Poisson's ratios": (
        [*TABLE, "--set", "stiffness_ratio=2", "--set", "auxetic_poisson_ratio=-0.5"],
        "not both: leave one of them",
    ),
    "form of no table of a log": (["replay", "missing.jsonl", "--csv", "excel"], "--data FILE.csv"),
    "view of no picture": ([*TABLE, "--view", "pressure"], "--view: there is no picture"),
    "theme of no picture": ([*TABLE, "--theme", "light"], "--theme: there is no picture"),
    "size of no picture": ([*TABLE, "--size", "640x360"], "--out FILE.mp4"),
    "size of a page": (["record", "hopper", "--out", "a.html", "--size", "640x360"], "--size: "),
    "speed of no film": ([*TABLE, "--fps", "20"], "--fps: there is no film"),
    "speed of one picture": (["record", "hopper", "--out", "a.png", "--fps", "20"], "no film"),
    "pictures left out of none": ([*TABLE, "--every", "3"], "--every: there is no picture"),
    "view of nothing": (["record", "hopper", "--view", "pressure"], "--view: there is no picture"),
    "view of a trajectory": (
        ["record", "hopper", "--trajectory", "a.xyz", "--view", "pressure"],
        "--view: there is no picture",
    ),
    "view of a log": (["replay", "missing.jsonl", "--view", "pressure"], "--out FILE.mp4"),
    "folder or scene of a sweep": (["sweep", "nodir"], "there is no folder nodir, and no scene"),
    "scene of a sweep": (["sweep", "hoper"], "did you mean hopper?"),
    "run of no folder": (["record", "nodir#3", *TABLE[2:]], "nodir#3: there is no folder nodir"),
    "run of no folder to play": (["play", "nodir#3"], "nodir#3: there is no folder nodir"),
    "several trajectories": (
        ["record", "hopper", "--trajectory", "a.xyz", "--compare", "regular,mixed"],
        "leave --compare out",
    ),
    "suffix of the trajectory": (["record", "hopper", "--trajectory", "a.dump"], ".npz"),
    "suffix of the log": (["play", "hopper", "--log", "run.txt"], ".jsonl"),
    "folder": (["record", "hopper", "--out", "nowhere/film.mp4"], "make it first"),
    "size": (["record", "hopper", "--out", "film.mp4", "--size", "641x361"], "even"),
    "speed": (["record", "hopper", "--out", "film.gif", "--fps", "100"], "50"),
    "log": (["replay", "missing.jsonl", "--data", "run.csv"], "missing.jsonl"),
    "screen": (["play", "hopper"], "record SCENE --out film.mp4"),
    "screen of the menu": ([], "record SCENE --out film.mp4"),
}


Ended = tuple[int, str, str]  # exit code, output, errors


def in_a_process(folder: Path, words: list[str]) -> Ended:
    """As a person has it."""
    done = sandbox(folder, *words)
    return done.returncode, done.stdout, done.stderr


@pytest.fixture
def in_this_process(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[[Path, list[str]], Ended]:
    """The same without the start of an interpreter, a second each."""

    def run(folder: Path, words: list[str]) -> Ended:
        monkeypatch.chdir(folder)
        return main(words), *capsys.readouterr()

    return run


def refused_at_once(
    run: Callable[[Path, list[str]], Ended], folder: Path, words: list[str], advice: str
) -> None:
    """One line, code 2, and neither written nor compiled anything."""
    before = list(folder.iterdir())
    start = clock()
    code, said, error = run(folder, words)
    assert clock() - start < 10.0  # nothing was compiled or packed
    assert code == 2, error
    assert said == ""
    assert len(error.splitlines()) == 1, error
    assert error.startswith("error: ")
    assert advice in error
    assert list(folder.iterdir()) == before


# A screen is looked for in the environment; and one that needs the exit code of a process.
IN_A_PROCESS = {"screen", "screen of the menu", "scene"}


@pytest.mark.parametrize("name", sorted(IN_A_PROCESS))
def test_mistakes_are_one_line_and_code_2(tmp_path: Path, name: str) -> None:
    refused_at_once(in_a_process, tmp_path, *MISTAKES[name])


@pytest.mark.parametrize("name", [name for name in MISTAKES if name not in IN_A_PROCESS])
def test_all_mistakes_are(
    tmp_path: Path, name: str, in_this_process: Callable[[Path, list[str]], Ended]
) -> None:
    refused_at_once(in_this_process, tmp_path, *MISTAKES[name])


@pytest.mark.parametrize("row", ["3", "0", "three"])
@pytest.mark.parametrize("command", [["record", "--data", "run.csv"], ["play"]])
def test_a_run_of_a_folder_without_a_sweep_is_told_of_that_folder(
    tmp_path: Path,
    command: list[str],
    row: str,
    in_this_process: Callable[[Path, list[str]], Ended],
) -> None:
    (tmp_path / "mine").mkdir()
    words = [*command, f"mine#{row}"]
    refused_at_once(in_this_process, tmp_path, words, f"mine#{row}: the folder mine holds no sweep")


@pytest.mark.parametrize(
    ("missing", "advice"),
    [("ziglang", "auxetic-sandbox[web]"), ("npm", "install Node.js"), ("node", "install Node.js")],
)
def test_what_pages_are_made_with_is_missed_before_anything_begins(
    tmp_path: Path,
    missing: str,
    advice: str,
    in_this_process: Callable[[Path, list[str]], Ended],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def found(name: str) -> str | None:
        return None if name == missing else name

    (tmp_path / "cache").mkdir()
    modules = SimpleNamespace(util=SimpleNamespace(find_spec=found))
    monkeypatch.setattr("sandbox.extras.importlib", modules)
    monkeypatch.setattr("sandbox.web.toolchain.shutil", SimpleNamespace(which=found))
    monkeypatch.setattr("sandbox.web.toolchain.user_cache_path", lambda _: tmp_path / "cache")
    refused_at_once(in_this_process, tmp_path, ["web", "--out", "pages"], advice)


def write_log(path: Path, *records: dict[str, object]) -> None:
    path.write_text("".join(json.dumps(record) + "\n" for record in records))


HEAD: dict[str, object] = {
    "format": "auxetic-sandbox log",
    "version": 1,
    "scene": "hopper",
    "packing": "mixed",
    "seed": 1,
    "settings": {"grains": 60, "width": 12.0},
}
PUSH: list[dict[str, object]] = [
    {"at": 0, "command": "grab", "handle": "piston"},
    {"at": 0, "command": "move", "handle": "piston", "x": 0.0, "y": -100.0},
    {"at": 3, "command": "release", "handle": "piston"},
]


def test_replay_repeats_a_log_to_the_last_bit(tmp_path: Path) -> None:
    log = tmp_path / "run.jsonl"
    write_log(log, HEAD, *PUSH, {"end": 3, "hash": "0" * 64})
    other = sandbox(tmp_path, "replay", "run.jsonl", "--data", "run.csv", "--out", "last.png")
    assert other.returncode == 1
    assert "NOT the state of the log" in other.stdout
    assert len(rows_of(tmp_path / "run.csv")) == 4
    assert (tmp_path / "last.png").exists()
    write_log(log, HEAD, *PUSH, {"end": 3, "hash": state(other.stdout)})
    same = sandbox(tmp_path, "replay", "run.jsonl")
    assert same.returncode == 0, same
    assert "the same state as in the log" in same.stdout


def test_replay_carries_out_what_came_after_the_last_increment(tmp_path: Path) -> None:
    end: dict[str, object] = {"end": 3, "hash": "0" * 64}
    reset: dict[str, object] = {"at": 3, "command": "reset"}
    write_log(tmp_path / "start.jsonl", HEAD, {"end": 0, "hash": "0" * 64})
    write_log(tmp_path / "reset.jsonl", HEAD, *PUSH, reset, end)
    start = sandbox(tmp_path, "replay", "start.jsonl")
    back = sandbox(tmp_path, "replay", "reset.jsonl")
    assert state(start.stdout) == state(back.stdout)


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("", "empty"),
        ("not json\n", "line 1 is not valid JSON"),
        (f'{json.dumps(HEAD)}\n{json.dumps(PUSH[0])[:20]}\n{{"end": 0, "hash": ""}}', "line 2"),
        (json.dumps({**HEAD, "scene": "hoper"}) + '\n{"end": 0, "hash": ""}', "hopper"),
        (json.dumps({**HEAD, "settings": {"x": 1}}) + '\n{"end": 0, "hash": ""}', "'x'"),
    ],
)
def test_a_damaged_log_is_told_at_once(
    tmp_path: Path, text: str, advice: str, in_this_process: Callable[[Path, list[str]], Ended]
) -> None:
    (tmp_path / "run.jsonl").write_text(text)
    words = ["replay", "run.jsonl", "--data", "run.csv"]
    refused_at_once(in_this_process, tmp_path, words, advice)


def test_pygame_beside_pygame_ce_is_told(tmp_path: Path) -> None:
    metadata = tmp_path / "site" / "pygame-2.6.1.dist-info" / "METADATA"
    metadata.parent.mkdir(parents=True)
    metadata.write_text("Metadata-Version: 2.1\nName: pygame\nVersion: 2.6.1\n")
    site = str(tmp_path / "site")
    done = sandbox(tmp_path, "record", *QUICK, "--out", "film.mp4", PYTHONPATH=site)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert "uninstall -y pygame," in done.stderr

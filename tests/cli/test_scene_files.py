"""``play`` and ``record`` with a scene file: it runs, its log replays, and what is wrong with it is one line."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from sandbox.cli.main import main, parse
from sandbox.files import kinds
from sandbox.files.log_file import read_log, write_log
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.record.record import Output, record
from sandbox.session.commands import DrawWall, Erase, Place, Protocol
from sandbox.session.replay import replay
from sandbox.session.session import Session
from tests.cli.test_commands import rows_of, sandbox, state
from tests.session.edited import built, do


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    session = built(grains=12)
    do(session, DrawWall(((12.0, 16.0), (18.0, 15.0))), Place(9.0, 10.0, "auxetic"))
    where = tmp_path_factory.mktemp("made")
    write_scene(where / "made.scene", session.made())
    return where


@pytest.mark.end_to_end
def test_record_goes_on_with_the_file(folder: Path) -> None:
    words = ("record", "made.scene", "--steps", "40", "--size", "320x240")
    done = sandbox(folder, *words, "--data", "made.csv", "--out", "made.png")
    assert done.returncode == 0, done.stderr
    already = len(read_scene(folder / "made.scene").state.going_on.history)  # type: ignore[union-attr]
    assert len(rows_of(folder / "made.csv")) == already + 40
    assert (folder / "made.png").stat().st_size > 1000
    session = Session.from_file(read_scene(folder / "made.scene"))
    session.build()
    session.submit(Protocol(True))
    increments = 0
    while increments < 40:
        increments += session.advance(1000)
    assert state(done.stdout) == session.state_hash()
    assert float(rows_of(folder / "made.csv")[-1]["force on the disc [k R]"]) >= 0.0


@pytest.mark.end_to_end
def test_a_log_of_a_file_replays_without_it(folder: Path, tmp_path: Path) -> None:
    session = Session.from_file(read_scene(folder / "made.scene"))
    session.build()
    grains = session.frame().grains
    do(session, DrawWall(((20.0, 5.0), (22.0, 5.0))), Erase(15.0, 15.0, 8.0))
    assert session.frame().grains < grains
    write_log(tmp_path / "it.jsonl", session.log())
    done = sandbox(tmp_path, "replay", "it.jsonl")
    assert done.returncode == 0, done.stderr
    assert "the same state" in done.stdout
    last = list(replay(read_log(tmp_path / "it.jsonl")))[-1]
    assert last.frame().grains == session.frame().grains


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("record", "none.scene", "--out", "a.png"), "no such file"),
        (("record", "made.scene", "--out", "a.png", "--seed", "1"), "leave this out"),
        (("record", "made.scene", "--out", "a.png", "--packing", "mixed"), "leave this out"),
        (
            ("record", "made.scene", "--out", "a.png", "--set", "friction=1"),
            "change them in the window",
        ),
        (("play", "none.scene"), "no such file"),
        (("play", "made.scene", "--set", "friction=1"), "change them in the window"),
    ],
)
def test_mistakes_are_one_line(folder: Path, words: tuple[str, ...], why: str) -> None:
    done = sandbox(folder, *words)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("error: ")
    assert why in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.end_to_end
@pytest.mark.parametrize("name", ["it.toml", "it.scene", "it"])
@pytest.mark.parametrize("content", [b"", b"\xff", b"PK\x03\x04", b"x = [[[", b"version = 1"])
def test_files_that_are_none_are_one_line(
    tmp_path: Path, content: bytes, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / name).write_bytes(content)
    assert main(["record", str(tmp_path / name), "--data", str(tmp_path / "a.csv")]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"error: {tmp_path / name}")
    assert said.count("\n") == 1


PYTHONS = re.compile(r"TOML|key/value|zip file|codec|byte 0x|Expect|CRC|Traceback")
NO_SCENE, CUT, SCENE, LOG = (
    "this is no scene file",
    "cut off, damaged, or",
    "a scene file and no log: play or record it",
    "a log and no scene file: replay it",
)


@pytest.mark.parametrize(
    ("command", "name", "why"),
    [
        ("record", "plain.scene", NO_SCENE),
        ("play", "plain.scene", NO_SCENE),
        ("record", "picture.scene", NO_SCENE),
        ("record", "table.scene", NO_SCENE),
        ("record", "half.scene", CUT),
        ("record", "tail.scene", CUT),
        ("record", "bent.scene", CUT),
        ("replay", "made.scene", SCENE),
        ("replay", "pair.toml", SCENE),
        ("replay", "half.scene", "it is no text"),
        ("replay", "picture.scene", "it is no text"),
        ("record", "it.jsonl", LOG),
        ("play", "it.jsonl", LOG),
        ("record", "log.scene", LOG),
    ],
)
def test_a_file_of_another_kind_is_told_in_words_of_this_program(
    folder: Path,
    tmp_path: Path,
    command: str,
    name: str,
    why: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """What it is, and what it is for; nothing of what a library says about it."""
    made = (folder / "made.scene").read_bytes()
    log = f'{{"format": "{kinds.LOG}", "version": 1}}\n{{"end": 0, "hash": ""}}\n'.encode()
    content = {
        "plain.scene": b"Dear all,\nhere are the grains.\n",
        "picture.scene": b"\x89PNG\r\n\x1a\n" + bytes(range(256)),
        "table.scene": b"increment,force\n0,0.1\n",
        "half.scene": made[: len(made) // 2],
        "tail.scene": made[:-1],
        "bent.scene": made[:600] + bytes([made[600] ^ 255]) + made[601:],
        "made.scene": made,
        "pair.toml": f'format = "{kinds.SCENE}"\nversion = 1\nscene = "workshop"\n'.encode(),
        "it.jsonl": log,
        "log.scene": b"\xef\xbb\xbf" + log,
    }[name]
    path = tmp_path / name
    path.write_bytes(content)
    words = [command, str(path)]
    words += [] if command == "play" else ["--data", str(tmp_path / "a.csv")]
    assert main(words) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"error: {path}")
    assert why in said
    assert said.count("\n") == 1
    assert not PYTHONS.search(said), said


def test_renamed_it_is_the_same_file(
    folder: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Also to what ends otherwise, or in nothing; the name of a scene is the scene."""
    monkeypatch.chdir(tmp_path)
    states = set()
    for name in ("made.scene", "made.zip", "made", "./intruder"):
        Path(name).write_bytes((folder / "made.scene").read_bytes())
        assert main(["record", name, "--data", "a.csv", "--steps", "2"]) == 0
        states.add(state(capsys.readouterr().out))
    assert len(states) == 1


def test_a_drive_that_was_left_in_the_middle_is_gone_on_with(tmp_path: Path) -> None:
    session = built(grains=5)
    session.submit(Protocol(True))
    do(session, Protocol(True), Place(20.0, 3.0, "regular"))
    assert session.frame().protocol
    rows = len(session.history)
    write_scene(tmp_path / "it.scene", session.made())
    again = Session.from_file(read_scene(tmp_path / "it.scene"))
    record([again], 3, Output(None, tmp_path / "it.csv", (320, 240)))
    table = rows_of(tmp_path / "it.csv")
    assert len(table) == rows + 3
    for _ in range(3):
        while not session.advance(1000):
            pass
    assert again.state_hash() == session.state_hash()


def log_with(folder: Path, line: str) -> Path:
    """A log of nothing done, with one more command in it."""
    session = built(grains=5)
    path = folder / "it.jsonl"
    write_log(path, session.log())
    head, end = path.read_text(encoding="utf-8").splitlines()
    path.write_text(f"{head}\n{line}\n{end}\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "command",
    [
        '"command": "grab", "handle": "extruder"',
        '"command": "release", "handle": "nobody"',
        '"command": "change", "name": "colour", "value": 3',
        '"command": "change", "name": "friction", "value": 1e300',
        '"command": "change", "name": "scene", "value": "trampoline"',
        '"command": "undo"',
        '"command": "place", "x": -50.0, "y": 3.0, "kind": "regular", "goes_on": false',
    ],
)
def test_a_replay_says_what_was_refused(
    tmp_path: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log_with(tmp_path, f'{{"at": 0, {command}}}')
    assert main(["replay", str(path)]) == 1
    said = capsys.readouterr()
    assert "1 command of the log could not be carried out" in said.out
    assert "Traceback" not in said.err


@pytest.mark.parametrize(
    "line",
    [
        '{"at": 0, "command": "reset", "command": "reset"}',
        '{"at": 0, "at": 0, "command": "reset"}',
        '{"at": 0, "command": "move", "handle": "intruder", "x": 1e400, "y": 0}',
        '{"at": 0, "command": "move", "handle": "intruder", "x": NaN, "y": 0}',
    ],
)
def test_logs_that_say_too_much_are_refused(
    tmp_path: Path, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log_with(tmp_path, line)
    assert main(["replay", str(path)]) == 2
    said = capsys.readouterr().err
    assert f"{path}: line 2" in said
    assert said.count("\n") == 1


def test_help_tells_of_it() -> None:
    with pytest.raises(SystemExit):
        parse(["play", "--help"])

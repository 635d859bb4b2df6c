"""``play`` and ``record`` with a scene file: it runs, its log replays, and what is wrong with it is one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.cli.main import parse
from sandbox.files.log_file import read_log, write_log
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import DrawWall, Erase, Place, Protocol
from sandbox.session.replay import replay
from sandbox.session.session import Session
from tests.cli.test_commands import rows_of, sandbox, state
from tests.session.test_editing import built, do


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    session = built(grains=12)
    do(session, DrawWall(((12.0, 16.0), (18.0, 15.0))), Place(9.0, 10.0, "auxetic"))
    where = tmp_path_factory.mktemp("made")
    write_scene(where / "made.toml", session.made())
    return where


@pytest.mark.end_to_end
def test_record_goes_on_with_the_file(folder: Path) -> None:
    words = ("record", "made.toml", "--steps", "40", "--size", "320x240")
    done = sandbox(folder, *words, "--data", "made.csv", "--out", "made.png")
    assert done.returncode == 0, done.stderr
    assert len(rows_of(folder / "made.csv")) == 41
    assert (folder / "made.png").stat().st_size > 1000
    session = Session.from_file(read_scene(folder / "made.toml"))
    session.build()
    session.submit(Protocol(True))
    increments = 0
    while increments < 40:
        increments += session.advance(1000)
    assert state(done.stdout) == session.state_hash()
    assert float(rows_of(folder / "made.csv")[-1]["force against the drive [k R]"]) >= 0.0


@pytest.mark.end_to_end
def test_a_log_of_a_file_replays_without_it(folder: Path, tmp_path: Path) -> None:
    session = Session.from_file(read_scene(folder / "made.toml"))
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
        (("record", "none.toml", "--out", "a.png"), "no such file"),
        (("record", "made.toml", "--out", "a.png", "--seed", "1"), "leave this out"),
        (("record", "made.toml", "--out", "a.png", "--packing", "mixed"), "leave this out"),
        (("record", "made.toml", "--out", "a.png", "--set", "friction=1"), "write them there"),
        (("play", "none.toml"), "no such file"),
        (("play", "made.toml", "--set", "friction=1"), "write them there"),
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
@pytest.mark.parametrize("content", [b"", b"\xff", b"x = [[[", b"version = 1"])
def test_files_that_are_none_are_one_line(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "it.toml").write_bytes(content)
    done = sandbox(tmp_path, "record", "it.toml", "--out", "a.png")
    assert done.returncode == 2
    assert done.stderr.startswith("error: it.toml")
    assert done.stderr.count("\n") == 1


def test_help_tells_of_it() -> None:
    with pytest.raises(SystemExit):
        parse(["play", "--help"])

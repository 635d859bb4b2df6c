"""Scenes as older programs wrote them, a pair of files: they still open, and nothing else gets in."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sandbox.files.log_file import read_log, write_log
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import Reset
from sandbox.session.replay import replay
from sandbox.session.session import Session
from tests.files.scene_files import (
    PAIRS,
    assert_refused,
    drive,
)
from tests.session.edited import do


@pytest.fixture(params=["workshop", "hopper", "avalanches"])
def pair(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A pair of files of version 1, to be renamed and spoilt."""
    for suffix in (".toml", ".npz"):
        source = PAIRS / f"{request.param}{suffix}"
        (tmp_path / source.name).write_bytes(source.read_bytes())
    return tmp_path / f"{request.param}.toml"


def test_a_pair_opens_and_goes_on(pair: Path, tmp_path: Path) -> None:
    file = read_scene(pair)
    session = Session.from_file(file)
    session.build()
    assert session.scene.name == pair.stem
    assert len(session.history) == 1  # relaxed where it was, and counted anew
    assert file.grains.label.tolist() == session.frame().label.tolist()
    assert np.abs(file.grains.state - session.run.setup.packing.state).max() < 0.1
    start = session.state_hash()
    drive(session, 3)
    do(session, Reset())
    assert session.state_hash() == start
    write_scene(tmp_path / "new", session.made())
    again = Session.from_file(read_scene(tmp_path / "new"))
    again.build()
    assert again.state_hash() == start
    write_log(tmp_path / "it.jsonl", session.log())
    assert list(replay(read_log(tmp_path / "it.jsonl")))[-1].state_hash() == session.state_hash()


def test_a_pair_may_be_renamed_together_and_edited_elsewhere(pair: Path) -> None:
    grains = read_scene(pair).grains.hash()
    for suffix in (".toml", ".npz"):
        pair.with_suffix(suffix).rename(pair.with_name(f"another{suffix}"))
    renamed = pair.with_name("another.toml")
    assert read_scene(renamed).grains.hash() == grains
    text = renamed.read_bytes().replace(b"\n", b"\r\n")
    renamed.write_bytes(b"\xef\xbb\xbf" + text)
    assert read_scene(renamed).grains.hash() == grains


@pytest.mark.parametrize("pair", ["workshop"], indirect=True)
@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ('format = "auxetic-sandbox scene"', 'format = "another"', "not a scene file"),
        ("version = 1", "version = 3", "update the program"),
        ("version = 1", "version = true", "version"),
        ('scene = "workshop"', 'scene = "workshob"', "did you mean"),
        ("seed = 1", "seed = 1\nspeed = 3", "unknown key 'speed'"),
        ("seed = 1", "seed = 1\nseed = 1", "not a readable"),
        ("friction = 0.4", "friction = inf", "friction"),
        ('name = "intruder"', 'name = "walls"', "name of its own"),
        ('name = "intruder"', 'name = "extruder"', "no body"),
        ('name = "intruder"', 'name = "intruder"\nspeed = 1', "nothing else"),
        ("angle = 0.0", "angle = nan", "finite"),
        ("y = 10.0", "y = 1e4", "cannot be where"),
        ("points = [", "points = [[25.0, inf], ", "two finite"),
        ("points = [", "colour = 1\npoints = [", "nothing else"),
        ('grains = "workshop.npz"', 'grains = "../workshop.npz"', "plain name"),
        ('grains = "workshop.npz"', 'grains = "C:workshop.npz"', "plain name"),
        ('grains = "workshop.npz"', f'grains = "{"m" * 300}.npz"', "plain name"),
        ('grains_sha256 = "', 'grains_sha256 = "0', "checksum"),
    ],
)
def test_pairs_that_are_none(pair: Path, old: str, new: str, why: str) -> None:
    text = pair.read_text(encoding="utf-8")
    assert old in text
    pair.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert_refused(pair, why)


def test_an_older_log_holds_its_pair() -> None:
    log = read_log(PAIRS / "workshop.jsonl")
    assert log.start is not None
    session = list(replay(log))[-1]
    assert session.finished == log.end == 2
    assert session.refusals == (0, "")

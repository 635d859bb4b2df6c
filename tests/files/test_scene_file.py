"""Scene files: what was written comes back to the last bit, and writing is whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from sandbox.files.log_file import read_log, write_log
from sandbox.files.scene_file import content_of, read_scene, write_scene
from sandbox.session.commands import Change, Erase, Place, Protocol, Reset, Undo
from sandbox.session.editing import line_of
from sandbox.session.replay import replay
from sandbox.session.session import Session
from tests.files.scene_files import (
    parts,
    put,
    workshop,
)
from tests.session.edited import assert_whole, do

# What comes back


def test_what_was_made_comes_back(made: tuple[Path, Session]) -> None:
    path, session = made
    file = read_scene(path)
    assert (file.scene, file.packing, file.seed) == ("workshop", "mixed", 1)
    assert file.settings == session.settings
    assert file.grains.hash() == session.run.setup.packing.hash()
    assert file.state.walls == tuple(line_of(wall) for wall in session.run.setup.world.drawn)
    again = Session.from_file(file)
    again.build()
    assert_whole(again)
    assert again.state_hash() == session.state_hash()
    assert again.frame().increment == session.frame().increment


def test_reset_and_undo_go_back_to_the_file(made: tuple[Path, Session]) -> None:
    session = Session.from_file(read_scene(made[0]))
    session.build()
    start, grains = session.state_hash(), session.frame().grains
    do(session, Erase(15.0, 10.0, 30.0), *[Protocol(True)] * 3, Reset())
    assert session.state_hash() == start
    do(session, Change("seed", 5))
    assert session.made().file is None
    assert len(session.run.setup.world.drawn) == 0
    do(session, Undo())
    assert session.made().file is not None
    assert session.frame().grains == grains
    assert session.state_hash() == start


def test_a_log_of_it_needs_no_other_file(made: tuple[Path, Session], tmp_path: Path) -> None:
    for kind in ("mixed", "auxetic"):
        file = read_scene(made[0])
        session = Session.from_file(file if kind == "mixed" else file.of_kind(kind))
        session.build()
        do(session, Protocol(True), Protocol(True), Place(20.0, 10.0, "regular"))
        write_log(tmp_path / "it.jsonl", session.log())
        log = read_log(tmp_path / "it.jsonl")
        assert log.start is not None
        if kind == "mixed":
            assert content_of(log.start) == made[0].read_bytes()
        assert list(replay(log, slice_iterations=37))[-1].state_hash() == session.state_hash()
        write_log(tmp_path / "again.jsonl", log)
        assert (tmp_path / "again.jsonl").read_bytes() == (tmp_path / "it.jsonl").read_bytes()


def test_a_log_with_a_spoilt_start_is_refused(made: tuple[Path, Session], tmp_path: Path) -> None:
    session = Session.from_file(read_scene(made[0]))
    session.build()
    path = tmp_path / "it.jsonl"
    write_log(path, session.log())
    text = path.read_text()
    for old, new in (
        ('"version": 3', '"version": 1'),
        ('"version": 3', '"version": 2'),
        ('"version": 3', '"version": 4'),
        ('"start"', '"stert"'),
        ('"start": "UEsD', '"start": "UEsE'),
        ('"start": "UEsD', '"start": "%%'),
        ('"start": "UEsD', '"start": 3, "it": "'),
        ('"seed": 1', '"seed": 1, "seed": 1'),
    ):
        assert old in text
        path.write_text(text.replace(old, new, 1))
        with pytest.raises(InputError, match="it.jsonl"):  # noqa: RUF043
            read_log(path)


def test_the_same_places_with_grains_of_another_kind(made: tuple[Path, Session]) -> None:
    file = read_scene(made[0])
    for kind, share in (("regular", 0.0), ("auxetic", 1.0), ("mixed", None)):
        other = file.of_kind(kind)
        assert share is None or np.mean(other.grains.auxetic) == share
        assert other.grains.x.tobytes() == file.grains.x.tobytes()
        session = Session.from_file(other)
        session.build()
        assert session.frame().packing == kind
        assert len(session.history) == 1  # all begin together
        assert_whole(session)
    assert file.of_kind("mixed").grains is file.grains
    mixed = file.of_kind("regular").of_kind("mixed")
    assert np.mean(mixed.grains.auxetic) == pytest.approx(0.5, abs=1.0 / len(mixed.grains))


# Writing


def test_a_file_has_texts_that_people_read(made: tuple[Path, Session]) -> None:
    content = parts(made[0])
    head, state = (json.loads(content[f"{part}.json"]) for part in ("scene", "state"))
    assert head["format"] == "auxetic-sandbox scene"
    assert state["settings"]["friction"] == 0.4
    assert [body["name"] for body in state["bodies"]] == ["walls", "intruder"]
    assert state["walls"][1] == [[25.0, 5.0]]
    assert b"\n" in content["scene.json"]


def test_writing_fails_whole(made: tuple[Path, Session], tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        write_scene(tmp_path / "nowhere" / "it.scene", made[1].made())
    assert not list(tmp_path.iterdir())


def test_a_writing_that_is_interrupted_leaves_the_file_before(
    made: tuple[Path, Session], copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wherever it stops there is one version or the other."""
    before = copy.read_bytes()
    session = workshop()
    for step in ("replace", "chmod"):
        with monkeypatch.context() as broken:

            def stop(*_: object) -> None:
                raise OSError("the disk is full")

            broken.setattr(Path, step, stop)
            with pytest.raises(OSError, match="full"):
                write_scene(copy, session.made())
        assert copy.read_bytes() == before
        assert list(copy.parent.iterdir()) == [copy]
    write_scene(copy, session.made())
    assert read_scene(copy).grains.hash() == session.run.setup.packing.hash()


def test_its_name_means_nothing(made: tuple[Path, Session], tmp_path: Path) -> None:
    for name in ("Grüße 'x' \u2028#[1].scene", "it", "it.zip", "it.toml", "\udcff.scene"):
        path = tmp_path / name
        write_scene(path, made[1].made())
        assert path.read_bytes() == made[0].read_bytes()
        assert read_scene(path).grains.hash() == made[1].run.setup.packing.hash()


def test_a_byte_order_mark_and_other_line_ends_are_no_error(copy: Path) -> None:
    content = parts(copy)
    before = content_of(read_scene(copy))
    for name, text in content.items():
        if name.endswith(".json"):
            content[name] = b"\xef\xbb\xbf" + text.replace(b"\n", b"\r\n")
    put(copy, content)
    assert content_of(read_scene(copy)) == before

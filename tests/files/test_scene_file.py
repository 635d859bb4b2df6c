"""Scene files: what was written comes back to the last bit, and nothing else gets in."""

from __future__ import annotations

import io
import json
import os
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError
from core.packing import Packing
from sandbox.files.log_file import read_log, write_log
from sandbox.files.scene_file import content_of, read_scene, write_scene
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Change, DrawWall, Erase, Place, Protocol, Reset, Undo
from sandbox.session.editing import line_of
from sandbox.session.replay import replay
from sandbox.session.session import Session
from tests.session.test_editing import assert_whole, built, do

Arrays = dict[str, np.ndarray]
PAIRS = Path(__file__).parent / "pairs"


def workshop(**values: Any) -> Session:
    """A session in which something was made."""
    session = built(grains=20, **values)
    do(session, Place(15.0, 3.0, "auxetic"), Erase(20.0, 10.0, 2.0))
    do(session, DrawWall(((12.0, 16.0), (16.0, 14.0), (20.0, 16.0))), DrawWall(((25.0, 5.0),)))
    drive(session, 4)
    return session


def drive(session: Session, increments: int) -> None:
    """So much of the scripted drive."""
    session.submit(Protocol(True))
    done = 0
    while done < increments:
        done += session.advance(100_000)
    session.submit(Protocol(False))
    session.settle()


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Session]:
    session = workshop(friction=0.4)
    path = tmp_path_factory.mktemp("scenes") / "made.scene"
    write_scene(path, session.made())
    return path, session


@pytest.fixture
def copy(made: tuple[Path, Session], tmp_path: Path) -> Path:
    """The file, to be spoilt."""
    (tmp_path / made[0].name).write_bytes(made[0].read_bytes())
    return tmp_path / made[0].name


def parts(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {info.filename: archive.read(info) for info in archive.infolist()}


def put(path: Path, content: dict[str, bytes]) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, part in content.items():
            archive.writestr(name, part)


def spoil(path: Path, part: str, old: str, new: str) -> None:
    """Another text in one of the texts."""
    content = parts(path)
    text = content[f"{part}.json"].decode()
    assert old in text, text
    put(path, {**content, f"{part}.json": text.replace(old, new, 1).encode()})


def change(path: Path, part: str, edit: Callable[[Any], object]) -> None:
    """Other data in one of the texts."""
    content = parts(path)
    data = json.loads(content[f"{part}.json"])
    edit(data)
    put(path, {**content, f"{part}.json": json.dumps(data).encode()})


def rewrite(path: Path, edit: Callable[[Arrays], object]) -> None:
    """Other arrays, named without the part that they belong to."""
    content = parts(path)
    texts = {name: part for name, part in content.items() if name.endswith(".json")}
    arrays = {n: np.load(io.BytesIO(c)) for n, c in content.items() if n not in texts}
    short = {name.removeprefix("state.").removesuffix(".npy"): a for name, a in arrays.items()}
    edit(short)
    for name, array in short.items():
        packed = io.BytesIO()
        np.save(packed, array)
        texts[f"state.{name}.npy"] = packed.getvalue()
    put(path, texts)


def assert_refused(path: Path, why: str | None = None) -> None:
    """Reading or building ends in one line that names the file."""
    with pytest.raises(InputError, match=why) as caught:
        Session.from_file(read_scene(path)).build()
    assert "\n" not in str(caught.value)
    assert path.stem in str(caught.value)


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


# Pairs of files, as older programs wrote them


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


# What does not get in


def at(*path: str | int) -> Callable[[Any], Any]:
    """What is at the end of that path."""

    def found(data: Any) -> Any:
        for step in path:
            data = data[step]
        return data

    return found


@pytest.mark.parametrize(
    ("part", "old", "new", "why"),
    [
        ("scene", '"auxetic-sandbox scene"', '"another"', "not a scene file"),
        ("scene", '"version": 2', '"version": 3', "update the program"),
        ("scene", '"version": 2', '"version": true', "version"),
        ("scene", '"scene": "workshop"', '"scene": "workshob"', "did you mean"),
        ("scene", '"scene": "workshop"', '"scene": ["workshop"]', "scene"),
        ("scene", '"scene": "workshop"', '"scene": "hopper"', None),
        ("scene", '"packing": "mixed"', '"packing": "wooden"', "choose"),
        ("scene", '"packing": "mixed"', '"packing": 3', "packing"),
        ("scene", '"seed": 1', '"seed": -1', "seed"),
        ("scene", '"seed": 1', '"seed": 9223372036854775808', "seed"),
        ("scene", '"seed": 1', '"seed": true', "seed"),
        ("scene", '"seed": 1', '"seed": 1.5', "seed"),
        ("scene", '"seed": 1', '"seed": 1, "seed": 1', "twice"),
        ("scene", '"seed": 1', '"seed": 1, "speed": 3', "unknown key 'speed'"),
        ("scene", '"seed": 1,', "", "seed is missing"),
        ("scene", '"friction": 0.4', '"friction": -1.0', "friction"),
        ("scene", '"friction": 0.4', '"friction": 0.4, "friction": 0.5', "twice"),
        ("state", '"friction": 0.4', '"friction": -1.0', "friction"),
        ("state", '"friction": 0.4', '"friction": NaN', "no number"),
        ("state", '"friction": 0.4', '"friction": 1e400', "friction"),
        ("state", '"friction": 0.4', f'"friction": 1{"0" * 400}', "friction"),
        ("state", '"friction": 0.4', '"friction": "0.4"', "friction"),
        ("state", '"friction": 0.4', '"frictoin": 0.4', "did you mean friction"),
        ("state", '"friction": 0.4', '"friction": [0.4]', "friction"),
        ("state", '"contact_stiffness": 50.0', '"contact_stiffness": 1e300', "finite number"),
        ("state", '"contact_stiffness": 50.0', '"contact_stiffness": 5000.0', "between"),
        ("state", '"settings"', '"setings"', "settings"),
        ("state", '"name": "intruder"', '"name": "walls"', "name of its own"),
        ("state", '"name": "intruder"', '"name": "extruder"', "intruder"),
        ("state", '"name": "intruder"', '"name": 3', "name"),
        ("state", '"angle": 0.0', '"angle": 1.0', "cannot be where"),
    ],
)
def test_texts_that_are_none(copy: Path, part: str, old: str, new: str, why: str | None) -> None:
    spoil(copy, part, old, new)
    assert_refused(copy, why)


@pytest.mark.parametrize(
    ("where", "value", "why"),
    [
        (("bodies", 0, "position"), [1.0, 0.0], "cannot be where"),
        (("bodies", 1, "position"), [3.0, 1e4], "cannot be where"),
        (("bodies", 1, "position"), [3.0], "position"),
        (("bodies", 1, "position"), [3.0, "nan"], "position"),
        (("bodies", 1, "home"), [3.0, 1.0], "cannot be where"),
        (("bodies", 1, "axis"), [1.0, 0.0], "cannot be where"),
        (("bodies", 1, "speed"), 3, "unknown"),
        (("bodies", 1), None, "bodies"),
        (("walls", 1), [], "points"),
        (("walls", 1), [[25.0]], "walls"),
        (("walls", 1), [[25.0, "inf"]], "walls"),
        (("walls", 1), [[25.0, 1e300]], "far away"),
        (("walls", 1), [[2.0, 5.0], [2.0, 5.0]], "twice"),
        (("walls", 1), [[3.0, 9.0], [3.0, 11.0], [2.5, 8.0]], "goes through"),
        (("walls",), [[[25.0, 5.0]]] * 101, "more drawn walls"),
        (("going_on", "course", "script"), -1, "counted"),
        (("going_on", "course", "touched"), 10**9, "counted"),
        (("going_on", "course", "next_label"), 0, "counted"),
        (("going_on", "course", "next_label"), 2.0, "next_label"),
        (("going_on", "course", "out"), 10**6, "counted"),
        (("going_on", "course", "held"), ["extruder"], "called"),
        (("going_on", "course", "targets"), {"intruder": [1e300, 0.0]}, "further away"),
        (("going_on", "course", "targets"), {"extruder": [1.0, 0.0]}, "called"),
        (("going_on", "course", "notices"), ["x" * 200_000], "notices"),
        (("going_on", "course", "colour"), 3, "unknown"),
        (("going_on", "report", "reason"), "budget", "has not ended"),
        (("going_on", "report", "reason"), "boredom", "reason"),
        (("going_on", "report", "iterations"), True, "iterations"),
        (("going_on", "events"), [3], "events"),
        (("going_on", "hand_force"), "much", "hand_force"),
        (("going_on", "share"), "nan", "share"),
        (("going_on",), 3, "going_on"),
        (("speed",), 3, "unknown"),
    ],
)
def test_states_that_no_command_leads_to(
    copy: Path, where: tuple[str | int, ...], value: Any, why: str
) -> None:
    change(copy, "state", lambda data: at(*where[:-1])(data).__setitem__(where[-1], value))
    assert_refused(copy, why)


@pytest.mark.parametrize(
    ("template", "values"),
    [
        ("{x.__class__}", {"x": "a"}),
        ("{x[0]}", {"x": "a"}),
        ("{x!r}", {"x": "a"}),
        ("{x:>99999999999}", {"x": "a"}),
        ("{x:{y}}", {"x": "a", "y": "b"}),
        ("{y}", {"x": "a"}),
        ("{x:.2f}", {"x": "a"}),
        ("{x:grain|grains}", {"x": "a"}),
        ("{x:grain|{y}}", {"x": 1, "y": "b"}),
        ("{", {}),
        ("{x}", {"x": [1]}),
    ],
)
def test_templates_that_ask_for_more_than_their_values(
    copy: Path, template: str, values: dict[str, Any]
) -> None:
    text = {"text": "a", "template": template, "values": values}
    event = {"kind": "arch", "increment": 0, "stroke": 0.0, "force": 0.0, "text": text}
    change(copy, "state", lambda data: data["going_on"].update(events=[event]))
    assert_refused(copy, "events.0.text")
    values = {"x": 1.0, "y": "b", "n": 2}
    good = {"text": "a", "template": "{x:+.2f} of {y} {n:grain|grains}", "values": values}
    change(copy, "state", lambda data: data["going_on"].update(events=[{**event, "text": good}]))
    (kept,) = Session.from_file(read_scene(copy))._first.file.state.going_on.events  # type: ignore[union-attr]
    assert kept.text == "+1.00 of b grains"


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"\xff\xfe",
        b"PK\x03\x04",
        b"PK\x03\x04" + bytes(100),
        b"x = ",
        b"x = 1\nx = 2",
        b"x = " + b"[" * 100_000,
        b"x = 1" + b"0" * 10_000,
        b"[" + b"a." * 50_000 + b"a]",
    ],
    ids=["nothing", "bytes", "head", "zip", "half", "twice", "brackets", "digits", "dots"],
)
def test_files_that_are_none(copy: Path, text: bytes) -> None:
    copy.write_bytes(text)
    assert_refused(copy)


@pytest.mark.parametrize(
    "text", [b"", b"\xff", b"[" * 100_000, b"3", b'{"a": 1' + b"0" * 10_000 + b"}"]
)
@pytest.mark.parametrize("part", ["scene", "state"])
def test_texts_that_are_no_json(copy: Path, part: str, text: bytes) -> None:
    put(copy, {**parts(copy), f"{part}.json": text})
    assert_refused(copy)


def test_parts_that_nobody_knows(copy: Path) -> None:
    content = parts(copy)
    for name in ("../../evil.json", "more.json", "code.py", "state.more.npy", "before_edit.x.npy"):
        put(copy, {**content, name: content["state.json"]})
        if name.endswith(".npy"):
            put(copy, {**content, name: content["state.grains.label.npy"]})
        assert_refused(copy, "nobody knows")
    with zipfile.ZipFile(copy, "w") as archive:
        for name, part in content.items():
            archive.writestr(name, part)
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("scene.json", content["scene.json"])
    assert_refused(copy, "twice")
    with zipfile.ZipFile(copy, "w", zipfile.ZIP_BZIP2) as archive:
        for name, part in content.items():
            archive.writestr(name, part)
    assert_refused(copy, "packed in a way")


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_scene(tmp_path / "nothing.scene")
    with pytest.raises(InputError, match="no file"):
        read_scene(tmp_path)
    with pytest.raises(InputError):
        read_scene(tmp_path / "with\0zero.scene")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_a_pipe_is_not_waited_for(copy: Path) -> None:
    copy.unlink()
    os.mkfifo(copy)
    assert_refused(copy, "no file")


def test_files_that_are_too_large(copy: Path) -> None:
    content = parts(copy)
    put(copy, {**content, "state.json": b" " * ((1 << 25) + 1)})
    assert_refused(copy, "longer than any text")
    with copy.open("r+b") as file:
        file.truncate((1 << 28) + 1)
    assert_refused(copy, "larger than")


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda a: a.pop("grains.state"), "not a readable packing"),
        (lambda a: a.update({"grains.state": a["grains.state"][:4]}), None),
        (lambda a: a["grains.state"].__setitem__((0, 0), np.nan), "finite"),
        (lambda a: a["grains.state"].__setitem__((0, 0), 500.0), "outside"),
        (lambda a: a["grains.state"].__setitem__((0, 0), -4.0), "outside"),
        (lambda a: a["grains.state"].__setitem__((0, 0), 1e8), "outside"),
        (lambda a: a["grains.state"].__setitem__((2, 0), 0.0), "flatter"),
        (lambda a: a["grains.state"].__setitem__((3, 0), 5.0), "flatter"),
        (lambda a: a["grains.state"].__setitem__((2, 0), 1e6), "longer"),
        (lambda a: a["grains.rest_radius"].__setitem__(0, 1e-3), "rest radii"),
        (lambda a: a["grains.rest_radius"].__setitem__(0, 1e3), "rest radii"),
        (lambda a: a["grains.rest_radius"].__setitem__(0, 0.1), "increment must be"),
        (lambda a: a["grains.poisson_ratio"].__setitem__(0, 1.0), "Poisson"),
        (lambda a: a["grains.poisson_ratio"].__setitem__(0, 0.999), "Poisson"),
        (lambda a: a["grains.contact_stiffness"].__setitem__(0, 1.0), "stiffness"),
        (lambda a: a["grains.contact_stiffness"].__setitem__(0, 1e300), "stiffness"),
        (lambda a: a["grains.label"].__setitem__(0, a["grains.label"][1]), "labels"),
        (lambda a: a.update({"grains.label": a["grains.label"].astype(float)}), "whole numbers"),
        (lambda a: a.update({"grains.box": np.array([30.0, 20.0, 0.0])}), "periodic cell"),
        (lambda a: a.pop("contact_keys"), "memory"),
        (lambda a: a.update(spin=a["spin"][1:]), "memory"),
        (lambda a: a.update(spin=np.full_like(a["spin"], np.inf)), "finite"),
        (lambda a: a.update(contact_keys=a["contact_keys"].astype(float)), "contact_keys"),
        (lambda a: a.update(contact_keys=np.array(3)), "memory"),
        (lambda a: a.update(contact_keys=np.arange(10_000)), "out of order"),
        (lambda a: a.update(contact_keys=np.array([2, 1])), "out of order"),
        (lambda a: a.update(spin=np.array([print], dtype=object)), "plain numbers"),
        (lambda a: a.pop("going_on.reactions"), "reactions"),
        (lambda a: a["going_on.reactions"].fill(np.nan), "reactions"),
        (lambda a: a.update({"going_on.displacement": np.zeros((5, 1))}), "displacement"),
        (lambda a: a.pop("going_on.history.increment"), "increment"),
        (lambda a: a["going_on.history.increment"].__setitem__(0, 3), "numbered"),
        (lambda a: a["going_on.history.stroke"].__setitem__(0, np.inf), "finite"),
        (lambda a: a.update({"going_on.history.fx": np.zeros(1)}), "one length"),
        (lambda a: a.update({"going_on.history.colour": np.zeros(1)}), "unknown column"),
        (lambda a: a["going_on.history.stop_reason"].fill("boredom"), "nobody knows"),
    ],
)
def test_grains_that_are_none(
    copy: Path, change: Callable[[Arrays], object], why: str | None
) -> None:
    rewrite(copy, change)
    assert_refused(copy, why)


def test_grains_in_one_heap(copy: Path) -> None:
    many = Packing(np.full(200, 10.0), np.full(200, 3.0))
    rewrite(copy, lambda a: a.update({f"grains.{n}": v for n, v in many.arrays().items()}))
    assert_refused(copy, "on top of one another")


def test_grains_that_would_fill_the_memory(copy: Path) -> None:
    content = parts(copy)
    put(copy, {**content, "state.spin.npy": bytes(200_000_000), "more.npy": bytes(200_000_000)})
    assert_refused(copy, "unpack to more")


def test_too_many_grains(copy: Path) -> None:
    many = np.arange(110_000.0)
    grains = Packing(many % 400, many // 400, 0.1).arrays()
    rewrite(copy, lambda a: a.update({f"grains.{n}": v for n, v in grains.items()}))
    assert_refused(copy, "more than a scene holds")


def test_the_cell_must_be_that_of_the_scene(tmp_path: Path) -> None:
    session = built("avalanches", grains=60)
    path = tmp_path / "it.scene"
    for box in (np.array([100.0, 100.0, 0.0]), np.array([12.0, np.inf, 0.0]), np.zeros(0)):
        write_scene(path, session.made())
        rewrite(path, partial(dict.update, **{"grains.box": box}))
        assert_refused(path, "periodic cell")


def test_walls_through_grains_are_no_danger(copy: Path) -> None:
    change(copy, "state", lambda data: data["walls"].__setitem__(1, [[9.0, 1.0], [30.0, 19.0]]))
    session = Session.from_file(read_scene(copy))
    session.build()
    drive(session, 2)
    session.run.setup.packing.validate()


def test_reading_gives_what_is_needed_and_runs_nothing(copy: Path) -> None:
    assert isinstance(read_scene(copy), SceneFile)

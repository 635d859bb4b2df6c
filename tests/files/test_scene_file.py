"""Scene files: what was written comes back to the last bit, and nothing else gets in."""

from __future__ import annotations

import hashlib
import io
import os
import tomllib
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.errors import InputError
from core.packing import Packing, PeriodicBox
from sandbox.files.log_file import read_log, write_log
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.files.toml_text import toml_text
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Change, DrawWall, Erase, Place, Protocol, Reset, Undo
from sandbox.session.editing import line_of
from sandbox.session.replay import replay
from sandbox.session.session import Session
from tests.session.test_editing import assert_whole, built, do

Arrays = dict[str, np.ndarray]


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
    path = tmp_path_factory.mktemp("scenes") / "made.toml"
    write_scene(path, session.made())
    return path, session


@pytest.fixture
def copy(made: tuple[Path, Session], tmp_path: Path) -> Path:
    """The pair of files, to be spoilt."""
    for suffix in (".toml", ".npz"):
        source = made[0].with_suffix(suffix)
        (tmp_path / source.name).write_bytes(source.read_bytes())
    return tmp_path / made[0].name


def spoil(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def rewrite(path: Path, change: Callable[[Arrays], object]) -> None:
    """Other arrays in the grains' file, with the checksum that they then have."""
    grains = path.with_suffix(".npz")
    with np.load(grains) as data:
        arrays = dict(data)
    change(arrays)
    np.savez(grains, **arrays)
    seal(path)


def seal(path: Path) -> None:
    head = tomllib.loads(path.read_text(encoding="utf-8"))
    digest = hashlib.sha256(path.with_suffix(".npz").read_bytes()).hexdigest()
    spoil(path, head["grains_sha256"], digest)


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
    assert file.walls == tuple(line_of(wall) for wall in session.run.setup.world.drawn)
    again = Session.from_file(read_scene(path))
    again.build()
    assert_whole(again)
    old, new = session.run, again.run
    assert new.setup.packing.hash() == old.setup.packing.hash()
    assert new.setup.world.placement().tobytes() == old.setup.world.placement().tobytes()
    assert new.engine.friction is not None
    assert old.engine.friction is not None
    assert new.engine.friction.spin.tobytes() == old.engine.friction.spin.tobytes()
    assert again.frame().increment == 0


@pytest.mark.parametrize(
    ("scene", "values"),
    [
        ("hopper", {"grains": 60, "width": 12.0}),
        ("gravity_hopper", {"grains": 40}),
        ("couette", {"grains": 160}),
        ("avalanches", {"grains": 60}),
        ("biaxial_periodic", {"grains": 60}),
        ("biaxial_press", {"grains": 30}),
        ("grain_row", {}),
        ("single_grain", {"four_plates": True}),
        ("two_ellipses", {}),
        ("workshop", {"grains": 0}),
    ],
)
def test_every_scene_goes_on_from_its_file(
    scene: str, values: dict[str, Any], tmp_path: Path
) -> None:
    session = built(scene, **values)
    drive(session, 6)
    write_scene(tmp_path / "it.toml", session.made())
    again = Session.from_file(read_scene(tmp_path / "it.toml"))
    again.build()
    one, other = session.run.setup, again.run.setup
    assert one.packing.label.tolist() == other.packing.label.tolist()
    assert one.packing.box == other.packing.box
    # The start is that state relaxed once more, which the first session can do as well.
    session.run.touched()
    while not session.advance(100_000):
        pass
    # Who has fallen through the outlet is counted after the next increment.
    same = np.isin(other.packing.label, one.packing.label)
    assert np.abs(one.packing.state - other.packing.state[:, same]).max(initial=0.0) < 1e-12
    assert np.abs(one.world.placement() - other.world.placement()).max(initial=0.0) < 1e-12
    start = again.state_hash()
    drive(again, 4)
    assert again.state_hash() != start
    do(again, Reset())
    assert again.state_hash() == start
    assert all(check.holds is not False for check in again.checks()[:2])


def test_frictional_contacts_go_on_as_they_were(tmp_path: Path) -> None:
    session = built("intruder", grains=80, intruder_radius=2.0, friction=0.6)
    drive(session, 8)
    write_scene(tmp_path / "it.toml", session.made())
    again = Session.from_file(read_scene(tmp_path / "it.toml"))
    again.build()
    assert session.run.engine.friction is not None
    assert again.run.engine.friction is not None
    remembered = session.run.engine.friction.remembered()
    assert len(remembered) > 50
    kept = again.run.engine.friction.remembered()
    common = set(remembered) & set(kept)
    assert len(common) > 0.9 * len(remembered)
    slips = np.array([[remembered[k], kept[k]] for k in common])
    # The state was balanced within the tolerance; so it stays.
    assert np.abs(slips[:, 0] - slips[:, 1]).max() < 1e-3
    assert np.abs(slips[:, 0]).max() > 0.0


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
    session = Session.from_file(read_scene(made[0]))
    session.build()
    do(session, Protocol(True), Protocol(True), Place(20.0, 10.0, "regular"))
    write_log(tmp_path / "it.jsonl", session.log())
    log = read_log(tmp_path / "it.jsonl")
    assert log.start is not None
    assert log.start.text == made[0].read_bytes()
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
        ('"version": 2', '"version": 1'),
        ('"version": 2', '"version": 3'),
        ('"start"', '"stert"'),
        ('"grains": "UEsD', '"grains": "UEsE'),
        ('"grains": "UEsD', '"grains": "%%'),
        ('"text": "# A scene', '"text": "! A scene'),
        ('workshop\\"\\n', 'workshob\\"\\n'),
    ):
        assert old in text
        path.write_text(text.replace(old, new, 1))
        with pytest.raises(InputError, match="it.jsonl"):  # noqa: RUF043
            read_log(path)


def test_the_same_places_with_grains_of_another_kind(made: tuple[Path, Session]) -> None:
    file = read_scene(made[0])
    assert file.of_kind("mixed") is file
    for kind, share in (("regular", 0.0), ("auxetic", 1.0)):
        other = file.of_kind(kind)
        assert np.mean(other.grains.auxetic) == share
        assert other.grains.x.tobytes() == file.grains.x.tobytes()
        session = Session.from_file(other)
        session.build()
        assert session.frame().packing == kind
        assert_whole(session)
    mixed = file.of_kind("regular").of_kind("mixed")
    assert np.mean(mixed.grains.auxetic) == pytest.approx(0.5, abs=1.0 / len(mixed.grains))


# Writing


def test_a_file_is_text_that_people_read(made: tuple[Path, Session]) -> None:
    head = tomllib.loads(made[0].read_text(encoding="utf-8"))
    assert head["grains"] == "made.npz"
    assert head["settings"]["friction"] == 0.4
    assert [body["name"] for body in head["bodies"]] == ["walls", "intruder"]
    assert head["walls"][1] == {"points": [[25.0, 5.0]]}
    assert Packing.load(made[0].with_suffix(".npz")).hash() == made[1].run.setup.packing.hash()


def test_writing_fails_whole(made: tuple[Path, Session], tmp_path: Path) -> None:
    session = made[1]
    with pytest.raises(InputError, match="end in"):
        write_scene(tmp_path / "it.json", session.made())
    with pytest.raises(InputError, match="plain letters"):
        write_scene(tmp_path / "\udcff.toml", session.made())
    with pytest.raises(FileNotFoundError):
        write_scene(tmp_path / "nowhere" / "it.toml", session.made())
    assert not list(tmp_path.iterdir())


def test_within_an_increment_it_is_the_state_before(tmp_path: Path) -> None:
    session = built("intruder", grains=80, intruder_radius=2.0)
    before = session.run.setup.packing.hash()
    session.submit(Protocol(True))
    session.advance(1)
    write_scene(tmp_path / "it.toml", session.made())
    assert len(session.history) == 1  # it has not ended
    assert read_scene(tmp_path / "it.toml").grains.hash() == before


def test_odd_names_survive(made: tuple[Path, Session], tmp_path: Path) -> None:
    path = tmp_path / "Grüße 'x' \u2028#[1].toml"
    write_scene(path, made[1].made())
    assert read_scene(path).grains.hash() == made[1].run.setup.packing.hash()
    session = Session.from_file(read_scene(path))
    session.build()
    write_log(tmp_path / "it.jsonl", session.log())
    assert read_log(tmp_path / "it.jsonl").start is not None


texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=30)
scalars = st.one_of(
    texts, st.booleans(), st.integers(-(2**63), 2**63 - 1), st.floats(allow_nan=False, width=64)
).filter(lambda v: not isinstance(v, float) or abs(v) != float("inf"))
tables = st.dictionaries(texts, st.one_of(scalars, st.lists(st.lists(scalars, max_size=3))))


@given(tables, st.dictionaries(texts, tables), st.dictionaries(texts, st.lists(tables, min_size=1)))
def test_toml_that_is_written_is_read(
    plain: dict[str, Any], nested: dict[str, Any], rows: dict[str, Any]
) -> None:
    data = {**plain, **nested, **rows}
    # A list of tables that are all empty is written as what it is.
    assert tomllib.loads(toml_text(data)) == data


@pytest.mark.parametrize("value", [None, float("nan"), float("inf"), b"x", {1}])
def test_toml_knows_no_more_than_that(value: object) -> None:
    with pytest.raises(ValueError, match="no place"):
        toml_text({"x": value})


# What does not get in


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ('format = "auxetic-sandbox scene"', "", "not a scene file"),
        ('format = "auxetic-sandbox scene"', 'format = "another"', "not a scene file"),
        ("version = 1", "version = 2", "update the program"),
        ("version = 1", "version = true", "version"),
        ("version = 1", "version = 1.0", "version"),
        ("version = 1", "", "version"),
        ('scene = "workshop"', 'scene = "workshob"', "did you mean"),
        ('scene = "workshop"', 'scene = ["workshop"]', "scene is missing"),
        ('scene = "workshop"', 'scene = "hopper"', None),
        ('packing = "mixed"', 'packing = "wooden"', "choose"),
        ("seed = 1", "seed = -1", "seed"),
        ("seed = 1", "seed = 9223372036854775808", "seed"),
        ("seed = 1", "seed = true", "seed"),
        ("seed = 1", "seed = 1.5", "seed"),
        ("seed = 1", "seed = 1\nspeed = 3", "unknown key 'speed'"),
        ("friction = 0.4", "friction = -1.0", "friction"),
        ("friction = 0.4", "friction = nan", "friction"),
        ("friction = 0.4", "friction = inf", "friction"),
        ("friction = 0.4", f"friction = 1{'0' * 400}", "friction"),
        ("friction = 0.4", 'friction = "0.4"', "friction"),
        ("friction = 0.4", "frictoin = 0.4", "did you mean friction"),
        ("friction = 0.4", "friction = [0.4]", "friction"),
        ("[settings]", "[setings]", "unknown key"),
        ("[settings]", "[settings]\nsettings = {}", "settings"),
        ('name = "intruder"', 'name = "walls"', "name of its own"),
        ('name = "intruder"', 'name = "extruder"', "no body"),
        ('name = "intruder"', "name = 3", "name of its own"),
        ('name = "intruder"', 'name = "intruder"\nspeed = 1', "nothing else"),
        ("angle = 0.0", "angle = 1.0", "cannot be where"),
        ("angle = 0.0", "angle = nan", "finite"),
        ("y = 10.0", "y = 1e4", "cannot be where"),
        ("y = 10.0", 'y = "10"', "finite"),
        ("x = 0.0", "x = 1.0", "cannot be where"),
        ("points = [[25.0, 5.0]]", "points = []", "points"),
        ("points = [[25.0, 5.0]]", "points = [[25.0]]", "two finite"),
        ("points = [[25.0, 5.0]]", "points = [[25.0, inf]]", "two finite"),
        ("points = [[25.0, 5.0]]", "points = [[25.0, 1e300]]", "two finite"),
        ("points = [[25.0, 5.0]]", "points = [[2.0, 5.0], [2.0, 5.0]]", "twice"),
        ("points = [[25.0, 5.0]]", "points = [[25.0, 5.0]]\ncolour = 1", "nothing else"),
        ('grains = "made.npz"', 'grains = "../made.npz"', "plain name"),
        ('grains = "made.npz"', 'grains = "/etc/made.npz"', "plain name"),
        ('grains = "made.npz"', 'grains = "..\\\\made.npz"', "plain name"),
        ('grains = "made.npz"', 'grains = "C:made.npz"', "plain name"),
        ('grains = "made.npz"', 'grains = "made.toml"', "plain name"),
        ('grains = "made.npz"', 'grains = "ma\\u0000de.npz"', "plain name"),
        ('grains = "made.npz"', 'grains = ""', "plain name"),
        ('grains = "made.npz"', f'grains = "{"m" * 300}.npz"', "plain name"),
        ('grains = "made.npz"', 'grains = "other.npz"', "no such file"),
    ],
)
def test_texts_that_are_none(copy: Path, old: str, new: str, why: str | None) -> None:
    spoil(copy, old, new)
    with pytest.raises(InputError, match=why) as caught:
        Session.from_file(read_scene(copy)).build()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"\xff\xfe",
        b"x = ",
        b"x = 1\nx = 2",
        b"x = " + b"[" * 100_000,
        b"x = 1" + b"0" * 10_000,
        b"[" + b"a." * 50_000 + b"a]",
    ],
    ids=["nothing", "bytes", "half", "twice", "brackets", "digits", "dots"],
)
def test_texts_that_are_no_toml(copy: Path, text: bytes) -> None:
    copy.write_bytes(text)
    assert_refused(copy)


def test_files_that_are_not_there(copy: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_scene(tmp_path / "nothing.toml")
    with pytest.raises(InputError, match="no file"):
        read_scene(tmp_path)
    with pytest.raises(InputError):
        read_scene(tmp_path / "with\0zero.toml")
    copy.with_suffix(".npz").unlink()
    assert_refused(copy, "no such file")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_a_pipe_is_not_waited_for(copy: Path) -> None:
    copy.unlink()
    os.mkfifo(copy)
    assert_refused(copy, "no file")


def test_files_that_are_too_large(copy: Path) -> None:
    with copy.open("ab") as file:
        file.write(b"#" * (1 << 20))
    assert_refused(copy, "larger than")
    with copy.with_suffix(".npz").open("r+b") as file:
        file.truncate(1 << 27)
    spoil(copy, "#" * (1 << 20), "")
    assert_refused(copy, "larger than")


def test_other_grains_are_not_taken(copy: Path) -> None:
    grains = copy.with_suffix(".npz")
    grains.write_bytes(grains.read_bytes() + b"\0")
    assert_refused(copy, "checksum")


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda a: a.pop("state"), "not a readable packing"),
        (lambda a: a.update(state=a["state"][:4]), None),
        (lambda a: a["state"].__setitem__((0, 0), np.nan), "finite"),
        (lambda a: a["state"].__setitem__((0, 0), 500.0), "outside"),
        (lambda a: a["state"].__setitem__((0, 0), -4.0), "outside"),
        (lambda a: a["state"].__setitem__((0, 0), 1e8), "outside"),
        (lambda a: a["state"].__setitem__((2, 0), 0.0), "flatter"),
        (lambda a: a["state"].__setitem__((3, 0), 5.0), "flatter"),
        (lambda a: a["state"].__setitem__((2, 0), 1e6), "longer"),
        (lambda a: a["state"].__setitem__(slice(0, 2), 10.0), "on top of one another"),
        (lambda a: a["rest_radius"].__setitem__(0, 1e-3), "rest radii"),
        (lambda a: a["rest_radius"].__setitem__(0, 1e3), "rest radii"),
        (lambda a: a["rest_radius"].__setitem__(0, 0.1), "increment must be"),
        (lambda a: a["poisson_ratio"].__setitem__(0, 1.0), "Poisson"),
        (lambda a: a["contact_stiffness"].__setitem__(0, 1.0), "stiffness"),
        (lambda a: a["label"].__setitem__(0, a["label"][1]), "labels"),
        (lambda a: a.update(label=a["label"].astype(float)), "whole numbers"),
        (lambda a: a.update(box=np.array([30.0, 20.0, 0.0])), "periodic cell"),
        (lambda a: a.pop("contact_keys"), "memory"),
        (lambda a: a.update(spin=a["spin"][1:]), "memory"),
        (lambda a: a.update(spin=np.full_like(a["spin"], np.inf)), "finite"),
        (lambda a: a.update(contact_keys=a["contact_keys"].astype(float)), "memory"),
        (lambda a: a.update(contact_keys=np.array(3)), "memory"),
        (lambda a: a.update(contact_keys=np.arange(10_000)), "memory"),
        (lambda a: a.update(contact_keys=np.array([2, 1])), "out of order"),
        (lambda a: a.update(spin=np.array([print], dtype=object)), None),
    ],
)
def test_grains_that_are_none(
    copy: Path, change: Callable[[Arrays], object], why: str | None
) -> None:
    rewrite(copy, change)
    assert_refused(copy, why)


def test_grains_that_would_fill_the_memory(copy: Path) -> None:
    bomb = io.BytesIO()
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in ("state", "rest_radius", "spin"):
            archive.writestr(f"{name}.npy", bytes(200_000_000))
    copy.with_suffix(".npz").write_bytes(bomb.getvalue())
    seal(copy)
    assert_refused(copy, "more than any packing")


def test_too_many_grains(copy: Path) -> None:
    many = np.arange(110_000.0)
    Packing(many % 400, many // 400, 0.1).save(copy.with_suffix(".npz"))
    seal(copy)
    assert_refused(copy, "more than a scene holds")


def test_the_cell_must_be_that_of_the_scene(tmp_path: Path) -> None:
    session = built("avalanches", grains=60)
    path = tmp_path / "it.toml"
    for box in (PeriodicBox(100.0, 100.0), PeriodicBox(12.0), None):
        write_scene(path, session.made())
        packing = session.run.setup.packing.copy()
        packing.box = box
        packing.save(path.with_suffix(".npz"))
        seal(path)
        assert_refused(path, "periodic cell")


def test_walls_through_everything_are_relaxed_or_refused(copy: Path) -> None:
    spoil(copy, "points = [[25.0, 5.0]]", "points = [[1.0, 1.0], [30.0, 19.0], [1.0, 19.0]]")
    session = Session.from_file(read_scene(copy))
    try:
        session.build()
    except InputError as error:
        assert "relaxed" in str(error)  # noqa: PT017
    else:
        session.run.setup.packing.validate()


def test_reading_gives_what_is_needed_and_runs_nothing(copy: Path) -> None:
    assert isinstance(read_scene(copy), SceneFile)
    rewrite(copy, lambda arrays: arrays.update(extra=np.arange(3)))
    read_scene(copy)

"""Scene files with a wrong byte, a false promise or half of themselves: read as they were, or refused in one line, quickly."""

from __future__ import annotations

import contextlib
import io
import json
import resource
import time
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.errors import InputError
from sandbox.cli import main as cli
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import DrawWall, Place, Protocol
from sandbox.session.session import Session

QUICK = 5.0  # seconds of a core: nothing was built
ROOM = 1 << 20  # kilobytes of memory that reading may add
BOUNDED = settings(
    max_examples=200,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A scene that somebody has made, with friction, in a file that nothing compresses: each byte is what it says."""
    session = Session("workshop", "mixed", 1, {"grains": 8, "friction": 0.4})
    session.build()
    for command in (Place(9.0, 10.0, "auxetic"), DrawWall(((12.0, 4.0), (18.0, 5.0)))):
        session.submit(command)
        while not session.idle:
            session.advance(1000)
    path = tmp_path_factory.mktemp("made") / "made.scene"
    write_scene(path, session.made(), lasting=False)
    return path.read_bytes()


def put(folder: Path, content: bytes) -> Path:
    path = folder / "made.scene"
    path.write_bytes(content)
    return path


def parts_of(content: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {info.filename: archive.read(info) for info in archive.infolist()}


def sealed(parts: dict[str, bytes]) -> bytes:
    """A file of these parts, with the checksums that fit: whoever alters a file can do that too."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    return packed.getvalue()


def spoilt(content: bytes, place: int, change: int, how: str) -> bytes:
    """With a wrong byte, or half of itself, or a piece twice."""
    altered = bytearray(content)
    place %= len(altered)
    if how == "cut":
        del altered[place:]
    elif how == "double":
        altered[place:place] = altered[place : place + change]
    else:
        altered[place] ^= change
    return bytes(altered)


def reading(path: Path) -> str:
    """What reading says, in one line; "fine" if nothing."""
    message = "fine"
    try:
        read_scene(path).grains.validate()
    except InputError as error:
        message = str(error)
    assert len(message.splitlines()) == 1
    return message


def told(path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The one line with which ``record`` refuses the file."""
    began, memory = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    table = path.parent / "run.csv"
    assert cli.main(["record", str(path), "--data", str(table), "--steps", "1"]) == 2
    assert time.process_time() - began < QUICK
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory < ROOM
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1, said.err
    assert not table.exists()
    return said.err


def test_what_was_written_is_fine(made: bytes, tmp_path: Path) -> None:
    assert reading(put(tmp_path, made)) == "fine"
    assert reading(put(tmp_path, sealed(parts_of(made)))) == "fine"


DAMAGE = (
    st.integers(0, 10**7),
    st.integers(1, 255),
    st.sampled_from(["change", "change", "cut", "double"]),
)


@BOUNDED
@given(*DAMAGE)
def test_damaged_files(made: bytes, tmp_path: Path, place: int, change: int, how: str) -> None:
    reading(put(tmp_path, spoilt(made, place, change, how)))


@BOUNDED
@given(st.integers(0, 10**6), *DAMAGE)
def test_damaged_parts(
    made: bytes, tmp_path: Path, part: int, place: int, change: int, how: str
) -> None:
    parts = parts_of(made)
    name = sorted(parts)[part % len(parts)]
    parts[name] = spoilt(parts[name], place, change, how)
    reading(put(tmp_path, sealed(parts)))


@BOUNDED
@given(st.data())
def test_other_words_in_the_texts(made: bytes, tmp_path: Path, data: st.DataObject) -> None:
    """Any value in any place: it is refused, or what is built from it can run."""
    parts = parts_of(made)
    state = json.loads(parts["state.json"])
    here = state
    while True:
        keys = sorted(here) if isinstance(here, dict) else range(len(here))
        key = data.draw(st.sampled_from(list(keys)))
        if not isinstance(here[key], (dict, list)) or not here[key] or data.draw(st.booleans()):
            break
        here = here[key]
    odd: list[Any] = [
        None,
        True,
        -1,
        0,
        3,
        1e300,
        -0.5,
        2**62,
        "nan",
        "inf",
        "",
        "x",
        [],
        [1.0, 2.0],
        {},
    ]
    here[key] = data.draw(st.sampled_from(odd))
    parts["state.json"] = json.dumps(state).encode()
    path = put(tmp_path, sealed(parts))
    if reading(path) != "fine":
        return
    session = Session.from_file(read_scene(path))
    with contextlib.suppress(InputError):
        session.build()
        session.submit(Protocol(True))
        for _ in range(2):
            session.advance(1000)
        session.frame()


@pytest.mark.parametrize("length", [10**10, 10**12, 10**18, -1])
@pytest.mark.parametrize("member", ["grains.state", "grains.label", "spin", "contact_keys"])
def test_promises_of_terabytes(
    made: bytes,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    member: str,
    length: int,
) -> None:
    kind = "<i8" if member in ("grains.label", "contact_keys") else "<f8"
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": kind, "fortran_order": False, "shape": (length,)}
    )
    parts = {**parts_of(made), f"state.{member}.npy": header.getvalue() + bytes(80)}
    told(put(tmp_path, sealed(parts)), capsys)


@pytest.mark.parametrize(
    "line", ["step = 1e-300", "tolerance = 1e-300", "max_iterations = 99999999999999999999"]
)
@pytest.mark.parametrize("part", ["scene", "state"])
def test_settings_that_would_never_end(
    made: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str], part: str, line: str
) -> None:
    name, _, value = line.split(" ")
    parts = parts_of(made)
    data = json.loads(parts[f"{part}.json"])
    data["settings" if part == "state" else "built"][name] = json.loads(value)
    parts[f"{part}.json"] = json.dumps(data).encode()
    told(put(tmp_path, sealed(parts)), capsys)

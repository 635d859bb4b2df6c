"""Scene files with a wrong byte, a false promise or half of themselves: read as they were, or refused in one line, quickly."""

from __future__ import annotations

import hashlib
import io
import re
import resource
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.errors import InputError
from sandbox.cli import main as cli
from sandbox.files.scene_file import read_scene, write_scene
from sandbox.session.commands import DrawWall, Place
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
def parts(tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, bytes]:
    """Text and grains of a scene that somebody has made, with friction."""
    session = Session("workshop", "mixed", 1, {"grains": 8, "friction": 0.4})
    session.build()
    for command in (Place(9.0, 10.0, "auxetic"), DrawWall(((12.0, 4.0), (18.0, 5.0)))):
        session.submit(command)
        while not session.idle:
            session.advance(1000)
    path = tmp_path_factory.mktemp("made") / "made.toml"
    write_scene(path, session.made())
    return path.read_bytes(), path.with_suffix(".npz").read_bytes()


def put(folder: Path, text: bytes, grains: bytes) -> Path:
    """Both parts, with the checksum that fits: whoever alters a file can do that too."""
    digest = hashlib.sha256(grains).hexdigest().encode()
    path = folder / "made.toml"
    path.write_bytes(re.sub(rb'(grains_sha256 = ")[0-9a-f]{64}', rb"\g<1>" + digest, text))
    path.with_suffix(".npz").write_bytes(grains)
    return path


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


def test_what_was_written_is_fine(parts: tuple[bytes, bytes], tmp_path: Path) -> None:
    assert reading(put(tmp_path, *parts)) == "fine"


@BOUNDED
@given(st.integers(0, 10**6), st.integers(1, 255), st.sampled_from(["change", "cut", "double"]))
def test_damaged_text(
    parts: tuple[bytes, bytes], tmp_path: Path, place: int, change: int, how: str
) -> None:
    text = bytearray(parts[0])
    place %= len(text)
    if how == "cut":
        del text[place:]
    elif how == "double":
        text[place:place] = text[place : place + change]
    else:
        text[place] ^= change
    reading(put(tmp_path, bytes(text), parts[1]))


@BOUNDED
@given(st.integers(0, 10**6), st.integers(1, 255), st.booleans())
def test_damaged_grains(
    parts: tuple[bytes, bytes], tmp_path: Path, place: int, change: int, cut: bool
) -> None:
    grains = bytearray(parts[1])
    place %= len(grains)
    if cut:
        del grains[place:]
    else:
        grains[place] ^= change
    reading(put(tmp_path, parts[0], bytes(grains)))


@pytest.mark.parametrize("length", [10**10, 10**12, 10**18, -1])
@pytest.mark.parametrize("member", ["state", "label", "spin", "contact_keys", "box"])
def test_promises_of_terabytes(
    parts: tuple[bytes, bytes],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    member: str,
    length: int,
) -> None:
    kind = "<i8" if member in ("label", "contact_keys") else "<f8"
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": kind, "fortran_order": False, "shape": (length,)}
    )
    with zipfile.ZipFile(io.BytesIO(parts[1])) as archive:
        members = {info.filename: archive.read(info) for info in archive.infolist()}
    members[f"{member}.npy"] = header.getvalue() + bytes(80)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    told(put(tmp_path, parts[0], packed.getvalue()), capsys)


@pytest.mark.parametrize(
    "line", ["step = 1e-300", "tolerance = 1e-300", "max_iterations = 99999999999999999999"]
)
def test_settings_that_would_never_end(
    parts: tuple[bytes, bytes], tmp_path: Path, capsys: pytest.CaptureFixture[str], line: str
) -> None:
    name = line.split(" ", maxsplit=1)[0].encode()
    text = re.sub(rb"(?m)^" + name + rb" = .*$", line.encode(), parts[0])
    assert text != parts[0]
    told(put(tmp_path, text, parts[1]), capsys)

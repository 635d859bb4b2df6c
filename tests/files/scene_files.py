"""Scene files to be spoilt: what is in them, other things put in, and how they are refused."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError
from sandbox.files.scene_file import read_scene
from sandbox.session.commands import DrawWall, Erase, Place, Protocol
from sandbox.session.session import Session
from tests.session.edited import built, do

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

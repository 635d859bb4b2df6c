"""What a person has made, as one file to keep and to share. Opened, it goes on to the last bit as if it had never been closed.

It is a zip with readable texts: ``scene.json`` says what was built, ``state.json`` how it stood, and arrays beside them have the
grains and the rows of the history. All are data; nothing in them is run. What is read may come from anyone: all of it is looked
at before anything is built, and what does not fit is one line of InputError. The name of the file means nothing.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from pathlib import Path
from typing import Any, get_type_hints

from numpy.typing import NDArray

from core.errors import InputError
from core.files import atomic_write
from core.packing import Packing
from core.relaxation import Report
from sandbox.files.archive import LARGEST, ZIP, first_text, pack, unpack
from sandbox.files.kinds import SCENE, is_log
from sandbox.files.older_pairs import is_pair, parse_pair, scene_of_pair
from sandbox.files.plain import Arrays, Form, Plain
from sandbox.files.scene_checks import check_history, check_scene, check_state
from sandbox.session.beginning import Made, SceneFile, State
from sandbox.session.history import History, Row
from scenes import registry

VERSION = 2  # 1 were pairs of files
SUFFIX = ".scene"
SUFFIXES = (SUFFIX, ".toml")  # of files to be opened, the older ones too
MOST_SHOWN = 24  # files of a folder that a menu has, the newest first
MOST_LOOKED_AT = 400
HEAD, STATE, BEFORE_EDIT = "scene", "state", "before_edit"
_HEAD_KEYS = ("format", "version", "scene", "packing", "seed", "built")


def write_scene(path: str | os.PathLike[str], made: Made, *, lasting: bool = True) -> None:
    """Write ``path`` whole, or leave what is there. During an increment it is the state that this began with.

    ``lasting``: see ``core.files``; without, it is not compressed either. Raises OSError as the system does.
    """
    content = content_of(made.to_file(os.fspath(path)), compressed=lasting)
    with atomic_write(path, lasting=lasting) as file:
        file.write(content)


def content_of(file: SceneFile, *, compressed: bool = True) -> bytes:
    """The bytes of a scene file: always the same for the same scene."""
    arrays: Arrays = {}
    head = {
        "format": SCENE,
        "version": VERSION,
        "scene": file.scene,
        "packing": file.packing,
        "seed": file.seed,
        "built": dict(file.built),
    }
    texts: dict[str, object] = {HEAD: head, STATE: _PLAIN.write(file.state, STATE, arrays)}
    if file.before_edit is not None:
        texts[BEFORE_EDIT] = _PLAIN.write(file.before_edit, BEFORE_EDIT, arrays)
    return pack(texts, arrays, compressed=compressed)


def read_scene(path: str | os.PathLike[str]) -> SceneFile:
    """Read what ``write_scene`` wrote, or a pair of files of an older program.

    Raises InputError for what is missing, malformed, altered, hostile or newer.
    """
    path = Path(path)
    content = _read(path, LARGEST)
    if not is_pair(content):
        return parse_scene(str(path), content)
    if is_log(content):
        raise InputError(f"{path}: this is a log and no scene file: replay it")
    return parse_pair(str(path), content, lambda name: _read_beside(path, name))


def parse_scene(name: str, content: bytes) -> SceneFile:
    """A scene file from its bytes. Raises InputError as ``read_scene`` does."""
    try:
        if not content.startswith(ZIP):
            raise InputError("not a scene file of this program")
        texts, arrays = unpack(content)
        head = _head(texts.pop(HEAD, None))
        scene = registry.get(head["scene"])
        packing, seed, built = check_scene(scene, head["packing"], head["seed"], head["built"])
        states = {}
        for part in (STATE, BEFORE_EDIT):
            if part == STATE or part in texts:
                state = _PLAIN.read(State, texts.pop(part, None), part, arrays)
                states[part] = check_state(scene, state)
        if unknown := [*texts, *arrays]:
            raise InputError(f"it has a part {unknown[0][:80]!r}, which nobody knows")
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    return SceneFile(name, scene.name, packing, seed, built, states[STATE], states.get(BEFORE_EDIT))


def _head(head: object) -> dict[str, Any]:
    """What a file says that it is."""
    if not isinstance(head, dict) or head.get("format") != SCENE:
        raise InputError(f"not a scene file of this program (no format {SCENE!r})")
    version = head.get("version")
    if isinstance(version, bool) or version != VERSION:
        raise InputError(
            f"version {version!r} of the format, this program reads {VERSION}; update the program"
        )
    if set(head) != set(_HEAD_KEYS):
        odd = min(set(head) ^ set(_HEAD_KEYS))
        raise InputError(f"unknown key {odd[:80]!r}" if odd in head else f"{odd} is missing")
    if not (isinstance(head["scene"], str) and isinstance(head["built"], dict)):
        raise InputError("scene or built is not what it should be")
    return head


def _rows_of(history: History) -> Mapping[str, NDArray[Any]]:
    """The columns of a history's table."""
    return {field.name: history.column(field.name) for field in fields(Row)}


def _history_of(columns: Mapping[str, NDArray[Any]]) -> History:
    """A history from its columns. What an older program has not measured is as it is by itself."""
    kinds = get_type_hints(Row)
    # A number may be whole in all rows; the tuples of all rows are a table.
    letters = {bool: "b", int: "i", float: "fi", str: "U", tuple[float, ...]: "f"}
    known = [f for f in fields(Row) if f.name in columns or f.default is MISSING]
    lists = []
    for field in known:
        column = columns.get(field.name)
        if (
            column is None
            or column.ndim != 1 + (kinds[field.name] == tuple[float, ...])
            or column.dtype.kind not in letters[kinds[field.name]]
        ):
            raise InputError(f"column {field.name} of the rows is missing, or of another kind")
        lists.append(column.tolist() if column.ndim == 1 else [*map(tuple, column.tolist())])
    if unknown := set(columns) - set(kinds):
        raise InputError(f"the rows have an unknown column {min(unknown)[:80]!r}")
    if len({len(values) for values in lists}) != 1:
        raise InputError("the columns of the rows are not of one length")
    names = [field.name for field in known]
    history = History()
    for values in zip(*lists, strict=True):
        history.append(Row(**dict(zip(names, values, strict=True))))
    check_history(history)
    return history


_PLAIN = Plain(
    {
        Packing: Form(Packing.arrays, lambda arrays: Packing.of_arrays(arrays, "its grains")),
        History: Form(_rows_of, _history_of),
    },
    # Nothing was pulled at, or the numbers blew up.
    frozenset({"hand_force", *(field.name for field in fields(Report))}),
)


def _read_beside(path: Path, name: str) -> bytes:
    """The grains of an older pair, also where both files have another name now."""
    beside = path.with_name(name)
    renamed = path.with_suffix(".npz")
    return _read(renamed if renamed.is_file() and not beside.is_file() else beside, LARGEST)


def _read(path: Path, most: int) -> bytes:
    """A whole file that is not larger than ``most`` bytes. Raises InputError."""
    try:
        if not path.is_file():
            kind = "this is no file" if path.exists() else "no such file"
            raise InputError(f"{path}: {kind}")
        with path.open("rb") as file:
            content = file.read(most + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{str(path)!r}: cannot be read ({error})") from None
    if len(content) > most:
        raise InputError(f"{path}: larger than any file of this kind; not opened")
    return content


@dataclass(frozen=True, slots=True)
class SceneHere:
    """A scene file: where it is, and the name of the scene that it was made from."""

    path: Path
    scene: str


def scenes_here(folder: Path) -> tuple[SceneHere, ...]:
    """The scene files of a folder, the newest first; what cannot be read is left out."""
    try:
        paths = sorted(p for suffix in SUFFIXES for p in folder.glob(f"*{suffix}"))
        dated = sorted(((p.stat().st_mtime, p) for p in paths[:MOST_LOOKED_AT]), reverse=True)
    except OSError:
        return ()
    found = (_look(path) for _, path in dated)
    return tuple(scene for scene in found if scene is not None)[:MOST_SHOWN]


def is_scene(path: Path) -> bool:
    """Does a file say that it is one of a scene? What else is wrong with it, reading it tells."""
    return _look(path) is not None


def _look(path: Path) -> SceneHere | None:
    try:
        if not path.is_file():
            return None
        with path.open("rb") as file:
            zipped = file.read(len(ZIP)) == ZIP
            file.seek(0)
            scene = _head(first_text(file, HEAD))["scene"] if zipped else scene_of_pair(file)
    except (OSError, InputError):
        return None
    return None if scene is None else SceneHere(path, scene)

"""What a person has made, as a file to keep and to share: a readable NAME.toml, and beside it NAME.npz with the grains.

Both are data; nothing in them is run. What is read may come from anyone: each key, each number and the grains' checksum are
looked at before anything is built, and what does not fit is one line of InputError.
"""

from __future__ import annotations

import hashlib
import io
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from core.errors import InputError
from core.files import atomic_write
from core.packing import Packing
from sandbox.files.scene_checks import check_grains, friction_of, numbers, placements_of, walls_of
from sandbox.files.toml_text import toml_text
from sandbox.session.beginning import Made, SceneFile
from sandbox.session.editing import line_of
from scenes import registry
from scenes.parameter import check_seed

FORMAT = "auxetic-sandbox scene"
VERSION = 1
SUFFIX = ".toml"
LARGEST_TEXT = 1 << 20  # bytes
LARGEST_GRAINS = 1 << 26
MOST_SHOWN = 24  # files of a folder that a menu has, the newest first
MOST_LOOKED_AT = 400
ABOUT = (
    "# A scene of the auxetic sandbox: open it with `python -m sandbox play THIS_FILE`.\n"
    "# The grains are in the file beside it; keep both together. Lengths are in radii of a large grain.\n"
)
_KEYS = {
    "format": str,
    "version": int,
    "scene": str,
    "packing": str,
    "seed": int,
    "grains": str,
    "grains_sha256": str,
    "settings": dict,
    "bodies": list,
    "walls": list,
}


def write_scene(
    path: str | os.PathLike[str],
    made: Made,
    grains: str | None = None,
    *,
    lasting: bool = True,
) -> None:
    """Write ``path`` and the grains' file beside it, both or neither; ``grains`` is its name if not that of ``path``.

    During an increment it is the state before. ``lasting``: see ``core.files``. Raises InputError for a name that does not end
    in .toml, OSError as the system does.
    """
    path = Path(path)
    if path.suffix != SUFFIX:
        raise InputError(f"{path}: the name of a scene file must end in {SUFFIX}")
    name = grains or path.with_suffix(".npz").name
    friction, bodies = made.state.friction, made.state.bodies
    extra: dict[str, NDArray[Any]] = {}
    if friction is not None:
        keys, slips = friction.memory()
        extra = {"spin": friction.spin, "contact_keys": keys, "contact_slips": slips}
    packed = io.BytesIO()
    made.state.packing.write(packed, extra, compressed=lasting)
    text = toml_text(
        {
            "format": FORMAT,
            "version": VERSION,
            "scene": made.scene,
            "packing": made.packing,
            "seed": made.seed,
            "grains": name,
            "grains_sha256": hashlib.sha256(packed.getvalue()).hexdigest(),
            "settings": dict(made.settings),
            "bodies": [
                {"name": b.body.name, "x": b.position[0], "y": b.position[1], "angle": b.angle}
                for b in bodies
                if not b.body.drawn
            ],
            "walls": [{"points": line_of(b.body)} for b in bodies if b.body.drawn],
        }
    )
    try:
        written = (ABOUT + text).encode()
    except UnicodeEncodeError:
        raise InputError(f"{str(path)!r}: choose a name with plain letters") from None
    # The grains come first, so that there is never a text without them.
    with (
        atomic_write(path, lasting=lasting) as toml,
        atomic_write(path.with_name(name), lasting=lasting) as npz,
    ):
        npz.write(packed.getvalue())
        toml.write(written)


def read_scene(path: str | os.PathLike[str]) -> SceneFile:
    """Read what ``write_scene`` wrote. Raises InputError for what is missing, malformed, altered, hostile or newer."""
    path = Path(path)
    text = _read(path, LARGEST_TEXT)
    head = _head(str(path), text)
    return parse_scene(str(path), text, _read(path.with_name(head["grains"]), LARGEST_GRAINS), head)


def parse_scene(
    name: str, text: bytes, data: bytes, head: Mapping[str, Any] | None = None
) -> SceneFile:
    """A scene file from the bytes of its two parts. ``head``: what ``text`` says, if that is known."""
    head = _head(name, text) if head is None else head
    if hashlib.sha256(data).hexdigest() != head["grains_sha256"]:
        raise InputError(
            f"{name}: {head['grains']} is not the file that was written with it (other checksum)"
        )
    try:
        scene = registry.get(head["scene"])
        settings = scene.settings(numbers(head["settings"]))
        packing = scene.check_packing(head["packing"])
        seed = check_seed(head["seed"])
        placements = placements_of(head.get("bodies", []))
        walls = walls_of(head.get("walls", []))
        grains = Packing.load(head["grains"], io.BytesIO(data))
        spin, memory = friction_of(data, len(grains))
        check_grains(grains)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    return SceneFile(
        name,
        scene.name,
        packing,
        seed,
        settings,
        placements,
        walls,
        grains,
        spin,
        memory,
        text,
        data,
    )


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


def _head(name: str, text: bytes) -> dict[str, Any]:
    """What the text says, its keys and types checked."""
    try:
        head = tomllib.loads(text.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{name}: not a readable scene file ({reason})") from None
    if head.get("format") != FORMAT:
        raise InputError(f"{name}: not a scene file of this program (no format = {FORMAT!r})")
    version = head.get("version")
    if isinstance(version, bool) or version != VERSION:
        raise InputError(
            f"{name}: version {version!r} of the format, this program reads {VERSION}; update the program"
        )
    for key in head:
        if key not in _KEYS:
            raise InputError(f"{name}: unknown key {key!r}")
    for key, kind in _KEYS.items():
        if key in ("bodies", "walls") and key not in head:
            continue
        if not isinstance(head.get(key), kind) or isinstance(head[key], bool):
            raise InputError(f"{name}: {key} is missing, or not what it should be")
    grains = head["grains"]
    plain = grains == Path(grains).name and not set(grains) & set('/\\:*?"<>|\0')
    if not plain or not grains.endswith(".npz") or len(grains) > 255:
        raise InputError(f"{name}: grains must be the plain name of an .npz file beside this one")
    return head


@dataclass(frozen=True, slots=True)
class SceneHere:
    """A scene file: where it is, and the name of the scene that it was made from."""

    path: Path
    scene: str


def scenes_here(folder: Path) -> tuple[SceneHere, ...]:
    """The scene files of a folder, the newest first; what cannot be read is left out."""
    try:
        paths = sorted(folder.glob(f"*{SUFFIX}"))[:MOST_LOOKED_AT]
        dated = sorted(((path.stat().st_mtime, path) for path in paths), reverse=True)
    except OSError:
        return ()
    found = (_look(path) for _, path in dated)
    return tuple(scene for scene in found if scene is not None)[:MOST_SHOWN]


def _look(path: Path) -> SceneHere | None:
    try:
        if not path.is_file() or path.stat().st_size > LARGEST_TEXT:
            return None
        head = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    scene = head.get("scene")
    if head.get("format") != FORMAT or not isinstance(scene, str):
        return None
    return SceneHere(path, scene)

"""Scene files of version 1: a text NAME.toml, and beside it NAME.npz with the grains. They are read, and no longer written.

They say where everything was; it is relaxed there once more, and counted anew.
"""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from core.errors import InputError
from core.packing import Packing
from sandbox.files.archive import ZIP, unpack, why_unread
from sandbox.files.kinds import SCENE
from sandbox.files.scene_checks import check_scene, check_state, places_of, walls_of
from sandbox.session.beginning import SceneFile, State
from scenes import registry
from scenes.parameter import shown

VERSION = 1
LARGEST_TEXT = 1 << 20  # bytes
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


def is_pair(content: bytes) -> bool:
    """Is it the text of a pair, or meant to be?"""
    return not content.startswith(ZIP)


def parse_pair(name: str, text: bytes, grains_called: Callable[[str], bytes]) -> SceneFile:
    """A scene from the text and the grains' file, which ``grains_called`` reads. Raises InputError."""
    head = _head(name, text)
    data = grains_called(head["grains"])
    if hashlib.sha256(data).hexdigest() != head["grains_sha256"]:
        raise InputError(
            f"{name}: {head['grains']} is not the file that was written with it (other checksum)"
        )
    try:
        scene = registry.get(head["scene"])
        packing, seed, settings = check_scene(
            scene, head["packing"], head["seed"], head["settings"]
        )
        places, walls = places_of(head.get("bodies", [])), walls_of(head.get("walls", []))
        _, arrays = unpack(data)
        grains = Packing.of_arrays(arrays, head["grains"])
        state = State(
            settings,
            places,
            walls,
            grains,
            spin=arrays.get("spin"),
            contact_keys=arrays.get("contact_keys"),
            contact_slips=arrays.get("contact_slips"),
        )
        state = check_state(scene, state)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    return SceneFile(name, scene.name, packing, seed, settings, state)


def scene_of_pair(file: BinaryIO) -> str | None:
    """The scene that a text says that it is of; None if it is no such text."""
    text = file.read(LARGEST_TEXT + 1)
    head = _table(text) if len(text) <= LARGEST_TEXT else {}
    scene = head.get("scene")
    return scene if head.get("format") == SCENE and isinstance(scene, str) else None


def _table(text: bytes) -> Mapping[str, Any]:
    """Raises InputError for what is no TOML: what is wrong in it helps only somebody who has edited a scene file."""
    try:
        return tomllib.loads(text.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        why = f"not a readable scene file ({why_unread(error)})"
        raise InputError(why if SCENE.encode() in text else "this is no scene file") from None


def _head(name: str, text: bytes) -> Mapping[str, Any]:
    """What the text says, its keys and types checked."""
    if len(text) > LARGEST_TEXT:
        raise InputError(f"{name}: larger than any file of this kind; not opened")
    try:
        head = _table(text)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    if head.get("format") != SCENE:
        raise InputError(f"{name}: not a scene file of this program (no format = {SCENE!r})")
    version = head.get("version")
    if isinstance(version, bool) or version != VERSION:
        raise InputError(
            f"{name}: version {shown(version)} of a text, this program reads {VERSION}; update the program"
        )
    for key in head:
        if key not in _KEYS:
            raise InputError(f"{name}: unknown key {shown(key)}")
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

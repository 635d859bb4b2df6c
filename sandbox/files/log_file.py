"""The log of a run: which scene, and every command with the number of increments after which it took effect. JSON lines.

A log replays to the same state bits, on a slower machine too, since it names increments and not times.
"""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeGuard

from core.errors import InputError
from core.files import atomic_write
from sandbox.files.scene_file import parse_scene
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Command, from_data, to_data
from sandbox.session.log import Log

FORMAT = "auxetic-sandbox log"
VERSION = 1
VERSION_WITH_START = 2  # of a log that holds a scene file
LARGEST = 256 * 1024 * 1024  # bytes
MOST_LINES = 2_000_000  # a hand at a window gives 60 commands a second
MOST_INCREMENTS = 10_000_000


def write_log(path: str | os.PathLike[str], log: Log) -> None:
    """Write a log whole or not at all. Raises OSError as the system does."""
    start = log.start
    head = {
        "format": FORMAT,
        "version": VERSION if start is None else VERSION_WITH_START,
        "scene": log.scene,
        "packing": log.packing,
        "seed": log.seed,
        "settings": log.settings,
    }
    if start is not None:
        data = base64.b64encode(start.data).decode("ascii")
        head["start"] = {"text": start.text.decode("utf-8"), "grains": data}
    lines = [
        head,
        *({"at": at, **to_data(command)} for at, command in log.commands),
        {"end": log.end, "hash": log.hash},
    ]
    with atomic_write(path) as file:
        file.write("".join(json.dumps(line) + "\n" for line in lines).encode())


def read_log(path: str | os.PathLike[str]) -> Log:
    """Read a log. Raises InputError for one that is missing, malformed, truncated, hostile or of another version."""
    path = Path(path)
    entries = list(_entries(path))
    if not entries:
        raise InputError(f"{path}: the log is empty")
    head, last = entries[0], entries[-1]
    if head.get("format") != FORMAT:
        raise InputError(
            f"{path}: not a log of this program (its first line does not say {FORMAT!r})"
        )
    version = head.get("version")
    if isinstance(version, bool) or version not in (VERSION, VERSION_WITH_START):
        raise InputError(
            f"{path}: log version {version!r}, this program reads {VERSION_WITH_START}; update the program"
        )
    scene, packing, seed, settings = (
        head.get(key) for key in ("scene", "packing", "seed", "settings")
    )
    if not (
        isinstance(scene, str)
        and isinstance(packing, str)
        and _whole(seed)
        and isinstance(settings, dict)
    ):
        raise InputError(f"{path}: line 1 must name scene, packing, seed and settings")
    if ("start" in head) != (version == VERSION_WITH_START):
        raise InputError(f"{path}: line 1: a log of version {VERSION_WITH_START} has a start")
    if len(entries) < 2 or "end" not in last:
        raise InputError(
            f"{path}: the log is truncated (its last line does not say where the run ended)"
        )
    commands: list[tuple[int, Command]] = []
    before = 0
    for number, entry in enumerate(entries[1:-1], 2):
        at = entry.pop("at", None)
        if not _whole(at) or at < before:
            raise InputError(
                f"{path}: line {number}: 'at' must be a whole number that never decreases"
            )
        try:
            commands.append((at, from_data(entry)))
        except InputError as error:
            raise InputError(f"{path}: line {number}: {error}") from None
        before = at
    end, digest = last["end"], last.get("hash")
    if not _whole(end) or not before <= end <= MOST_INCREMENTS or not isinstance(digest, str):
        raise InputError(
            f"{path}: the last line must give 'end', a number of increments, and 'hash'"
        )
    start = _start(path, head["start"]) if version == VERSION_WITH_START else None
    return Log(scene, packing, seed, settings, tuple(commands), end, digest, start)


def _start(path: Path, start: object) -> SceneFile:
    """The scene file that a log holds. Raises InputError as for the file itself."""
    if not isinstance(start, dict) or set(start) != {"text", "grains"}:
        raise InputError(f"{path}: line 1: start must have text and grains")
    text, grains = start["text"], start["grains"]
    if not isinstance(text, str) or not isinstance(grains, str):
        raise InputError(f"{path}: line 1: start must have text and grains")
    try:
        data = base64.b64decode(grains, validate=True)
        return parse_scene(f"{path}: start", text.encode(), data)
    except ValueError as error:  # an InputError is one, too
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: line 1: the grains of start are damaged") from None


def _entries(path: Path) -> Iterator[dict[str, Any]]:
    """Line after line, so that a hostile file is refused at its first bad line and not after it has filled the memory."""
    try:
        if not path.is_file():
            raise InputError(f"{path}: {'this is no file' if path.exists() else 'no such file'}")
        if path.stat().st_size > LARGEST:
            raise InputError(f"{path}: larger than any log of this program; not opened")
        with path.open(encoding="utf-8", newline="\n") as file:
            for number, line in enumerate(file, 1):
                if number > MOST_LINES:
                    raise InputError(f"{path}: more lines than any log of this program has")
                yield _entry(path, number, line)
    except InputError:
        raise
    except (
        OSError,
        ValueError,
    ) as error:  # also for bytes that are no text, and names that are none
        reason = " ".join(str(error).split())
        raise InputError(f"{str(path)!r}: cannot be read ({reason})") from None


def _entry(path: Path, number: int, line: str) -> dict[str, Any]:
    try:
        entry = json.loads(line, parse_constant=lambda name: _refuse(name))
    except (ValueError, RecursionError):
        raise InputError(
            f"{path}: line {number} is not valid JSON; the log is damaged or truncated"
        ) from None
    if not isinstance(entry, dict):
        raise InputError(f"{path}: line {number} is not a JSON object")
    return entry


def _refuse(name: str) -> float:
    raise ValueError(name)


def _whole(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0

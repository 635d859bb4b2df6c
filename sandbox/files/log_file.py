"""The log of a run: which scene, and every command with the number of increments after which it took effect. JSON lines.

A log replays to the same state bits, on a slower machine too, since it names increments and not times.
"""

from __future__ import annotations

import base64
import json
import logging
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeGuard

from core.errors import InputError
from core.files import atomic_write
from sandbox.files.archive import data_of, why_unread
from sandbox.files.kinds import LOG
from sandbox.files.older_pairs import parse_pair
from sandbox.files.scene_file import content_of, is_scene, parse_scene
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Command, from_data, to_data
from sandbox.session.log import Log

log = logging.getLogger(__name__)

VERSION = 1
VERSION_WITH_PAIR = 2  # of older logs that hold a pair of files
VERSION_WITH_START = 3  # of a log that holds a scene file
_VERSIONS = (VERSION, VERSION_WITH_PAIR, VERSION_WITH_START)
LARGEST = 256 * 1024 * 1024  # bytes
MOST_LINES = 2_000_000  # a hand at a window gives 60 commands a second
MOST_INCREMENTS = 10_000_000


def write_log(path: str | os.PathLike[str], log: Log) -> None:
    """Write a log whole or not at all. Raises OSError as the system does."""
    start = log.start
    head = {
        "format": LOG,
        "version": VERSION if start is None else VERSION_WITH_START,
        "scene": log.scene,
        "packing": log.packing,
        "seed": log.seed,
        "settings": log.settings,
    }
    if start is not None:
        head["start"] = base64.b64encode(content_of(start)).decode("ascii")
    with atomic_write(path) as file:
        file.write(_line(head) + lines_of(log.commands) + last_line(log))


def lines_of(commands: Sequence[tuple[int, Command]]) -> bytes:
    """A line for each command."""
    return b"".join(_line({"at": at, **to_data(command)}) for at, command in commands)


def last_line(log: Log) -> bytes:
    """Where the run ended."""
    return _line({"end": log.end, "hash": log.hash})


def _line(data: Mapping[str, object]) -> bytes:
    return json.dumps(data).encode() + b"\n"


def read_log(path: str | os.PathLike[str]) -> Log:
    """Read a log. Raises InputError for one that is missing, malformed, hostile or of another version.

    Where it breaks off, as a power cut may leave it, what is whole of it is read, and that is said; the hash is empty then.
    """
    path = Path(path)
    try:
        entries = list(_entries(path))
    except InputError:
        if is_scene(path):
            raise InputError(
                f"{path}: this is a scene file and no log: play or record it"
            ) from None
        raise
    if not entries:
        raise InputError(f"{path}: the log is empty")
    head, last = entries[0], entries[-1]
    if head.get("format") != LOG:
        raise InputError(f"{path}: not a log of this program (its first line does not say {LOG!r})")
    version = head.get("version")
    if isinstance(version, bool) or version not in _VERSIONS:
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
    if ("start" in head) == (version == VERSION):
        raise InputError(
            f"{path}: line 1: a log has a start if it began with a file, and only then"
        )
    whole = len(entries) > 1 and "end" in last
    commands: list[tuple[int, Command]] = []
    before = 0
    for number, entry in enumerate(entries[1:-1] if whole else entries[1:], 2):
        try:
            commands.append(_command(entry, before))
        except InputError as error:
            if number == len(entries):  # the beginning of one line and the end of another
                break
            raise InputError(f"{path}: line {number}: {error}") from None
        before = commands[-1][0]
    end, digest = (last["end"], last.get("hash")) if whole else (before, "")
    if not _whole(end) or not before <= end <= MOST_INCREMENTS or not isinstance(digest, str):
        raise InputError(
            f"{path}: the last line must give 'end', a number of increments, and 'hash'"
        )
    if not whole:
        log.warning(
            "%s: the log breaks off: what is whole goes up to increment %d, not to where the run ended",
            path,
            end,
        )
    start = None if version == VERSION else _start(path, head["start"], version)
    return Log(scene, packing, seed, settings, tuple(commands), end, digest, start)


def _start(path: Path, start: object, version: int) -> SceneFile:
    """The scene file that a log holds. Raises InputError as for the file itself."""
    name = f"{path}: start"
    if version == VERSION_WITH_START:
        return parse_scene(name, _bytes(path, start))
    if not isinstance(start, dict) or set(start) != {"text", "grains"}:
        raise InputError(f"{path}: line 1: start must have text and grains")
    if not isinstance(start["text"], str):
        raise InputError(f"{path}: line 1: start must have text and grains")
    grains = _bytes(path, start["grains"])
    return parse_pair(name, start["text"].encode(), lambda _: grains)


def _command(entry: dict[str, Any], before: int) -> tuple[int, Command]:
    at = entry.pop("at", None)
    if not _whole(at) or at < before:
        raise InputError("'at' must be a whole number that never decreases")
    return at, from_data(entry)


def _bytes(path: Path, text: object) -> bytes:
    try:
        if isinstance(text, str):
            return base64.b64decode(text, validate=True)
    except ValueError:
        pass
    raise InputError(f"{path}: line 1: the start is damaged")


def _entries(path: Path) -> Iterator[dict[str, Any]]:
    """Line after line, so that a hostile file is refused at its first bad line and not after it has filled the memory.

    The last one may be torn, and is left out then.
    """
    torn: InputError | None = None
    try:
        if not path.is_file():
            raise InputError(f"{path}: {'this is no file' if path.exists() else 'no such file'}")
        if path.stat().st_size > LARGEST:
            raise InputError(f"{path}: larger than any log of this program; not opened")
        with path.open(encoding="utf-8-sig", newline="\n") as file:
            for number, line in enumerate(file, 1):
                if number > MOST_LINES:
                    raise InputError(f"{path}: more lines than any log of this program has")
                if torn is not None:  # which is not the last
                    raise torn
                try:
                    entry = _entry(path, number, line)
                except InputError as error:
                    if number == 1:
                        raise
                    torn = error
                else:
                    yield entry
    except InputError:
        raise
    except UnicodeDecodeError:
        raise InputError(f"{path}: this is no log (it is no text)") from None
    except (OSError, ValueError) as error:  # also for names that are none
        raise InputError(f"{str(path)!r}: cannot be read ({why_unread(error)})") from None


def _entry(path: Path, number: int, line: str) -> dict[str, Any]:
    try:
        entry = data_of(line.encode())
    except InputError as error:
        raise InputError(
            f"{path}: line {number} is not valid JSON; the log is damaged: {error}"
        ) from None
    if not isinstance(entry, dict):
        raise InputError(f"{path}: line {number} is not a JSON object")
    return entry


def _whole(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0

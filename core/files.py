"""Writing a file so that an interruption or a full disk never leaves half of one, and what stood there is respected.

While it is written a file has a hidden name beside its own, and its writer a lock on it (where the system has such) that
goes with the writer: what a killed program has left can be told from what is being written. ``clear`` takes it away; a film
that can be played is offered.
"""

from __future__ import annotations

import itertools
import logging
import os
import re
import secrets
import shutil
import stat
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

try:
    import fcntl
except ImportError:  # Windows: nothing is told apart, and nothing cleared
    LOCKS = False
else:
    LOCKS = True

log = logging.getLogger(__name__)

LONGEST = 100  # bytes of a name that are repeated in the hidden one; systems take 255, some 143
SETTLED = (
    1.0  # [s] since a file was written to: between its last byte and its own name no lock is held
)
_HIDDEN = re.compile(r"\.(.*)\.[0-9a-f]{8}\.(tmp|part\.(mp4|gif|mkv|png))", re.DOTALL)


@contextmanager
def atomic_write(path: str | os.PathLike[str], *, lasting: bool = True) -> Iterator[BinaryIO]:
    """Open a temporary file beside ``path`` for writing bytes; give it that name if all went well, else remove it.

    What stood at ``path`` before stays until then; the new file has its permissions. Links are followed; a pipe or a device is
    written to. Without ``lasting`` nobody waits until the disk has it: quick, and safe from whatever may happen to this
    program, not to the computer. Raises OSError as the system does.
    """
    target = followed(path)
    if is_special(target):
        with target.open("wb") as file:
            yield file
        return
    temporary = hidden(target, "tmp")
    try:
        with temporary.open("xb") as file:
            lock(file.fileno())
            yield file
            file.flush()
            if lasting:
                os.fsync(file.fileno())
        publish(temporary, target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def followed(path: str | os.PathLike[str]) -> Path:
    """Where a path leads, through all links. Raises OSError if it leads nowhere at all, in a circle for one."""
    with suppress(FileNotFoundError, NotADirectoryError):
        os.stat(path)  # noqa: PTH116 - of what it leads to
    return Path(os.path.realpath(path))


def is_special(target: Path) -> bool:
    """Is there something that is no file, as a pipe or a device, and is not to be replaced by one?"""
    return target.exists() and not target.is_file() and not target.is_dir()


def hidden(target: Path, kind: str) -> Path:
    """A new hidden name beside ``target``, short enough wherever that is."""
    start = os.fsencode(target.name)[:LONGEST].decode(errors="ignore")
    return target.with_name(f".{start}.{secrets.token_hex(4)}.{kind}")


def publish(temporary: Path, target: Path) -> None:
    """Give a whole file its name, with owner and permissions of what had it; or copy it into a pipe or a device."""
    if is_special(target):
        with temporary.open("rb") as source, target.open("wb") as drain:
            shutil.copyfileobj(source, drain)
        temporary.unlink()
        return
    try:
        earlier = target.stat()
    except FileNotFoundError:
        temporary.chmod(0o666 & ~_umask())
    else:
        if hasattr(os, "chown"):
            with suppress(OSError):  # only root can, for others
                os.chown(temporary, earlier.st_uid, earlier.st_gid)
        temporary.chmod(stat.S_IMODE(earlier.st_mode))
    temporary.replace(target)


def lock(descriptor: int) -> None:
    """Say of an open file that somebody is writing it, as long as it is open."""
    if LOCKS:
        with suppress(OSError):  # a file system without locks
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


def clear(folder: Path, name: str | None = None) -> list[Path]:
    """Remove the hidden files that killed programs have left there, of all files or of one. What cannot be removed stays.

    A film that its encoder has brought to an end all the same is no longer hidden, but ``NAME.unfinished.mp4``, or with the next
    number that is free, ``NAME.unfinished-2.mp4``; these are returned. What becomes of films is said, in one line each.
    """
    start = None if name is None else hidden(folder / name, "").name[1 : -len(".00000000.")]
    return _clear(folder, lambda found: start is None or found == start)


def clear_beginning(folder: Path, prefix: str) -> list[Path]:
    """The same for all files whose names begin like that."""
    return _clear(folder, lambda found: found.startswith(prefix))


def _clear(folder: Path, belongs: Callable[[str], bool]) -> list[Path]:
    kept: list[Path] = []
    if not LOCKS:
        return kept
    with suppress(OSError):
        for path in folder.iterdir():
            found = _HIDDEN.fullmatch(path.name)
            if found and belongs(found[1]):
                with suppress(OSError):
                    kept += _clear_if_dead(path, found[1], found[2])
    return kept


def _clear_if_dead(path: Path, name: str, kind: str) -> list[Path]:
    about = path.lstat()
    if not stat.S_ISREG(about.st_mode) or time.time() - about.st_mtime < SETTLED:
        return []
    with path.open("rb") as file:
        # Raises OSError where somebody has it.
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
        if kind == "part.mp4" and _is_film(file):
            visible = _free_name(path, f"{Path(name).stem}.unfinished")
            path.rename(visible)
            log.warning("what a program that was killed had filmed is now %s", visible)
            return [visible]
        path.unlink()
        if kind != "tmp":
            log.warning("removed half a film, %s, of a program that was killed", path.name)
    return []


def _free_name(beside: Path, stem: str) -> Path:
    """The first of ``STEM.mp4``, ``STEM-2.mp4``, … that nothing has."""
    names = itertools.chain([stem], (f"{stem}-{number}" for number in itertools.count(2)))
    paths = (beside.with_name(f"{name}.mp4") for name in names)
    return next(path for path in paths if not os.path.lexists(path))


def _is_film(file: BinaryIO) -> bool:
    """Can it be played? The index of an mp4 file, its box "moov", is written last."""
    while len(head := file.read(8)) == 8:
        size, kind = int.from_bytes(head[:4], "big"), head[4:]
        if kind == b"moov":
            return True
        if size == 1:  # too large for four bytes
            size = int.from_bytes(file.read(8), "big") - 8
        if size < 8:
            return False
        file.seek(size - 8, os.SEEK_CUR)
    return False


def try_writing(path: str | os.PathLike[str]) -> None:
    """Raise OSError if ``path`` cannot be written: its very name is tried, and a hidden one. Leaves all as it was."""
    target = followed(path)
    if target.exists():
        if not os.access(target, os.W_OK):
            raise PermissionError(13, "write-protected", str(path))
        if is_special(target):
            return
    else:
        target.open("xb").close()
        target.unlink()
    trial = hidden(target, "part.mp4")
    trial.open("xb").close()
    trial.unlink()


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask

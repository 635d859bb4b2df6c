"""Writing a file so that an interruption or a full disk never leaves half of one, and what stood there is respected.

While it is written a file has a hidden name beside its own, and its writer a lock on it (where the system has such) that
goes with the writer: what a killed program has left can be told from what is being written, and ``clear`` takes it away.
"""

from __future__ import annotations

import os
import re
import secrets
import shutil
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

try:
    import fcntl
except ImportError:  # Windows: nothing is told apart, and nothing cleared
    LOCKS = False
else:
    LOCKS = True

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


def clear(folder: Path, name: str | None = None) -> None:
    """Remove the hidden files that killed programs have left there, of all files or of one. What cannot be removed stays."""
    if not LOCKS:
        return
    start = None if name is None else hidden(folder / name, "").name[: -len(".00000000.")]
    with suppress(OSError):
        for path in folder.iterdir():
            found = _HIDDEN.fullmatch(path.name)
            if found and (start is None or f".{found[1]}" == start):
                with suppress(OSError):
                    _remove_if_dead(path)


def _remove_if_dead(path: Path) -> None:
    about = path.lstat()
    if not stat.S_ISREG(about.st_mode) or time.time() - about.st_mtime < SETTLED:
        return
    with path.open("rb") as file:
        fcntl.flock(
            file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB
        )  # raises OSError where somebody has it
        path.unlink()


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

"""What a crash leaves: while a person works, a scene file is written every second, and taken away again at a clean end.

The state after each increment is handed over, which costs nothing, as that state is kept for going back anyway; a thread of
its own writes the newest. Each running program has files of its own, named by its number, and holds a lock that
the system lets go of however the program ends: files without a lock are of a program that is gone.
"""

from __future__ import annotations

import contextlib
import logging
import os
import re
import secrets
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock
from platformdirs import user_data_path

from core.errors import InputError
from sandbox.files.scene_file import SUFFIX, read_scene, write_scene
from sandbox.session.beginning import Made, SceneFile

log = logging.getLogger(__name__)

EVERY = 1.0  # [s]
SHARE = 0.02  # of the time is spent on writing at most: large scenes are written less often
PATIENCE = 2.0  # with the writing thread at the end [s]
ASIDE = "unreadable"  # folder for those that nobody could read, beside the others
_NAME = re.compile(r"autosave-\d{1,10}-[0-9a-f]{8}\.(scene|toml)")


def folder() -> Path:
    """Where autosaves lie: in the data folder of the person who runs the program."""
    return user_data_path("auxetic-sandbox", appauthor=False) / "autosave"


@dataclass(frozen=True)
class Leftover:
    """The autosave of a program that is gone."""

    path: Path
    saved: float  # when, in seconds since the epoch
    file: SceneFile

    @property
    def scene(self) -> str:
        """Name of the scene."""
        return self.file.scene

    @property
    def grains(self) -> int:
        """How many grains there are."""
        return len(self.file.grains)

    def remove(self) -> None:
        """Take it away: it was declined, or somebody went on with it."""
        _remove(self.path)


@dataclass(frozen=True)
class SetAside:
    """An autosave that this program cannot read: of a newer one, of a scene that is gone, damaged, forbidden."""

    path: Path  # where it lies now
    why: str


@dataclass(frozen=True)
class Found:
    """What programs that are gone have left, the latest first, and what of it could not be read."""

    leftovers: tuple[Leftover, ...] = ()
    set_aside: tuple[SetAside, ...] = ()


def find(where: Path | None = None) -> Found:
    """What crashed programs have left. What cannot be read is put into a folder of its own, for whoever can."""
    where = where or folder()
    found, aside = [], []
    for path in sorted(where.glob("autosave-*")) if where.is_dir() else ():
        if not _NAME.fullmatch(path.name):
            continue
        # A lock that somebody has is a Timeout, which is an OSError too.
        with contextlib.suppress(OSError), FileLock(path.with_suffix(".lock"), timeout=0):
            try:
                found.append(Leftover(path, path.stat().st_mtime, read_scene(path)))
            except InputError as error:
                log.warning("an autosave could not be read: %s", error)
                why = str(error).removeprefix(f"{path}: ")
                aside.append(SetAside(_put_aside(path), why))
                path.with_suffix(".lock").unlink(missing_ok=True)
    return Found(tuple(sorted(found, key=lambda one: -one.saved)), tuple(aside))


class Autosave:
    """The autosave of this program."""

    def __init__(self, where: Path | None = None, every: float = EVERY) -> None:
        """Raises OSError if nothing can be written there."""
        where = where or folder()
        where.mkdir(parents=True, exist_ok=True)
        # Numbers of processes come again, and in a container soon; the rest of the name does not.
        self.path = where / f"autosave-{os.getpid()}-{secrets.token_hex(4)}{SUFFIX}"
        self._lock = FileLock(self.path.with_suffix(".lock"), timeout=0)
        self._lock.acquire()
        self._every = every
        self._newest: Made | None = None
        self._written: Made | None = None
        self._instead_of: list[Leftover] = []
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="autosave", daemon=True)
        self._thread.start()

    def keep(self, made: Made | None) -> None:
        """What there is to be saved now; takes no time. None, or what nobody has done anything with: as before."""
        if made is None or not made.worth_keeping:
            return
        # Where nothing has happened the state is the same object.
        if self._newest is None or made.kept.engine is not self._newest.kept.engine:
            self._newest = made

    def adopt(self, leftover: Leftover) -> None:
        """A person goes on with ``leftover``: it is taken away once it runs, and the own autosave holds it."""
        self._instead_of.append(leftover)

    def close(self, clean: bool = True) -> None:
        """The end. A clean one takes the autosave away; any other writes the newest state and leaves it."""
        self._stop.set()
        self._thread.join(PATIENCE)
        if not clean and self._newest is not None:
            with contextlib.suppress(OSError):
                self.write()
            self._lock.release()
            return
        self._remove_adopted(self._newest)
        self._lock.release()
        _remove(self.path)

    def _run(self) -> None:
        took, trouble = 0.0, ""
        while not self._stop.wait(max(self._every, took / SHARE)):
            begun = time.perf_counter()
            try:
                if self.write():
                    trouble = ""
            except OSError as error:
                if str(error) != trouble:
                    log.warning("autosave: %s", error)
                trouble = str(error)
            took = time.perf_counter() - begun

    def write(self) -> bool:
        """Write what is new, if anything is. True if something was written. Raises OSError as the system does."""
        newest = self._newest
        if newest is None or newest is self._written:
            return False
        write_scene(self.path, newest, lasting=False)
        self._written = newest
        self._remove_adopted(newest)
        return True

    def _remove_adopted(self, newest: Made | None) -> None:
        """Those that ``newest`` has gone on from. One that could not be built is still there next time."""
        for leftover in [*self._instead_of]:
            if newest is not None and newest.file is leftover.file:
                leftover.remove()
                self._instead_of.remove(leftover)


def begin(where: Path | None = None) -> Autosave | None:
    """An autosave for this program; None where nothing can be written, which is no reason not to go on."""
    try:
        return Autosave(where)
    except OSError as error:
        log.warning("no autosave: %s", error)
        return None


def _parts(path: Path) -> list[Path]:
    """An autosave and, of an older program, what belongs to it."""
    return [path, path.with_name(f"{path.stem}.0.npz"), path.with_name(f"{path.stem}.1.npz")]


def _put_aside(path: Path) -> Path:
    """Move an autosave out of the way; returns where it lies now."""
    place = path.parent / ASIDE
    try:
        place.mkdir(exist_ok=True)
        for part in reversed(_parts(path)):
            if part.exists():
                part.rename(place / part.name)
    except OSError as error:
        log.warning("an autosave could not be set aside: %s", error)
        return path
    return place / path.name


def _remove(path: Path) -> None:
    """Take an autosave away, all its files."""
    for part in (*_parts(path), path.with_suffix(".lock")):
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)

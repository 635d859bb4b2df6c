"""Where compiled kernels are kept on the disk: a folder for each state of the sources that they are made of.

Numba's disk cache does not notice an edited callee in another file, so the name of the folder carries a hash of all sources that
a kernel may call: those of ``core`` and those beside it. Every edit leaves a folder behind; the ones that nobody has used for
a month are removed.

Keeping them saves time and nothing else: where nothing can be written, what is kept cannot be read, or the disk is full, the
kernels are compiled as at a first start.
"""

from __future__ import annotations

import hashlib
import logging
import os
import shutil
import tempfile
import time
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import NullCache
from platformdirs import user_cache_path

from core.errors import reason_of

log = logging.getLogger(__name__)

PREFIX = "kernels-"
UNUSED = 30 * 86_400.0  # [s] after which a folder goes
CORE = Path(__file__).parent


def source_hash(*folders: Path) -> str:
    """Hash of all sources in some folders and of the compiler's version; changes when any of them does."""
    digest = hashlib.sha256(numba.__version__.encode())
    for folder in folders:
        for path in sorted(folder.glob("*.py")):
            digest.update(path.name.encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def place(folder: Path) -> Path:
    """Where the kernels of the sources in ``folder`` are kept, marked as used today."""
    sources = (CORE,) if folder == CORE else (CORE, folder)
    kept = user_cache_path("auxetic-sandbox") / (PREFIX + source_hash(*sources))
    with suppress(OSError):
        os.utime(kept)
    return kept


def keep(dispatcher: Any) -> None:
    """Keep what a dispatcher compiles in the place of its source, unless NUMBA_CACHE_DIR names another; if it can be kept."""
    config: Any = numba.config
    before = config.CACHE_DIR
    if "NUMBA_CACHE_DIR" in os.environ:
        where = Path(before).absolute()
    else:
        where = place(Path(dispatcher.py_func.__code__.co_filename).parent)
    if not _usable(where):
        return
    config.CACHE_DIR = str(where)
    try:
        dispatcher.enable_caching()
    except RuntimeError:  # its own folder in there cannot be used, and Numba knows no other
        return
    finally:
        config.CACHE_DIR = before
    inner = dispatcher._cache
    # Else Numba has gone on to a folder beside the source, where an edited callee is not noticed.
    inside = Path(inner.cache_path).is_relative_to(where)
    dispatcher._cache = _Lenient(inner) if inside else NullCache()


@cache
def _usable(where: Path) -> bool:
    """Can something be kept there? If not, it is said, once."""
    try:
        if not where.is_absolute():
            raise OSError("nobody's home is known")
        where.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=where).close()
    except OSError as error:
        reason = reason_of(error)
        log.warning(
            "compiled code cannot be kept in %s (%s): every start compiles it anew", where, reason
        )
        return False
    return True


class _Lenient:
    """Numba's cache of one function: what cannot be read is missing, what cannot be written is not kept."""

    def __init__(self, inner: Any) -> None:
        self._inner = inner

    def __getattr__(self, name: str) -> Any:
        return getattr(self._inner, name)

    def load_overload(self, *arguments: Any) -> Any:
        """What was compiled before, or None."""
        try:
            return self._inner.load_overload(*arguments)
        # A pickle that is damaged, or comes from elsewhere, may raise anything.
        except Exception as error:  # noqa: BLE001
            log.info("kept code cannot be read: %r", error)
            with suppress(OSError):
                self._inner.flush()  # else the index stands in the way of saving
            return None

    def save_overload(self, *arguments: Any) -> None:
        """Keep it, if that is possible."""
        try:
            self._inner.save_overload(*arguments)
        except Exception as error:  # noqa: BLE001  saving reads the index
            log.info("compiled code cannot be kept: %r", error)


def prune(caches: Path | None = None) -> None:
    """Remove the folders that nobody has used for a month.

    Other processes may do the same, or come back to a folder meanwhile: it is renamed first, which only one of them can do,
    and who misses a kernel compiles it. What cannot be removed stays.
    """
    caches = caches or user_cache_path("auxetic-sandbox")
    now = time.time()
    with suppress(OSError):
        for folder in caches.glob(PREFIX + "*"):
            with suppress(OSError):
                if folder.is_symlink() or now - folder.stat().st_mtime < UNUSED:
                    continue
                doomed = folder.with_name(f"{folder.name[:64]}.{os.getpid()}")
                folder.rename(doomed)
                shutil.rmtree(doomed, ignore_errors=True)

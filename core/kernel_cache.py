"""Where compiled kernels are kept on the disk: a folder for each state of the sources that they are made of.

Numba's disk cache does not notice an edited callee in another file, so the name of the folder carries a hash of all sources that
a kernel may call: those of ``core`` and those beside it. Every edit leaves a folder behind; the ones that nobody has used for
a month are removed.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

import numba
from platformdirs import user_cache_path

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


@contextmanager
def kept(source: str) -> Iterator[None]:
    """Kernels declared inside, all in the file ``source``, are kept in their place, unless NUMBA_CACHE_DIR names another."""
    config: Any = numba.config
    before = config.CACHE_DIR
    if "NUMBA_CACHE_DIR" not in os.environ:
        config.CACHE_DIR = str(place(Path(source).parent))
    try:
        yield
    finally:
        config.CACHE_DIR = before


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

"""Where compiled kernels are kept on the disk: a folder for each state of the sources that they are made of.

Numba's disk cache does not notice an edited callee in another file, so the name of the folder carries a hash of all sources that
a kernel may call, of the compiler's version, and of the processor that it compiles for. Every edit leaves a folder behind; the
ones that nobody has used for a month are removed. A wheel can bring such folders with it (``SHIPPED``), made where the same
compiler compiled for the same processor: what fits is used, all else is compiled.

Keeping them saves time and nothing else: where nothing can be written, what is kept cannot be read, or the disk is full, the
kernels are compiled as at a first start.
"""

from __future__ import annotations

import hashlib
import logging
import os
import platform
import shutil
import sys
import tempfile
import time
from contextlib import suppress
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Any

import llvmlite
import numba
from llvmlite import binding
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from platformdirs import user_cache_path

from core.errors import reason_of

log = logging.getLogger(__name__)

PREFIX = "kernels-"
UNUSED = 30 * 86_400.0  # [s] after which a folder goes
CORE = Path(__file__).resolve().parent
SHIPPED = CORE / "compiled"  # folders that came with the program
BUSY = 10.0  # [s] to wait for another process that keeps the same kernel


def target() -> str:
    """What the compiler compiles for: its own version, and the processor's."""
    config: Any = numba.config
    name = config.CPU_NAME or binding.get_host_cpu_name()
    features = config.CPU_FEATURES
    if features is None:
        with suppress(RuntimeError):  # LLVM does not know this processor
            features = binding.get_host_cpu_features().flatten()
    return " ".join(
        (
            numba.__version__,
            llvmlite.__version__,
            sys.implementation.cache_tag,
            platform.system(),
            platform.machine(),
            name,
            str(features),
        )
    )


def source_hash(*folders: Path) -> str:
    """Hash of all sources in some folders and of the ``target``; changes when any of them does."""
    digest = hashlib.sha256(target().encode())
    for folder in folders:
        for path in sorted(folder.glob("*.py")):
            digest.update(path.name.encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def place(folder: Path) -> Path:
    """Where the kernels of the sources in ``folder`` are kept, marked as used today; NUMBA_CACHE_DIR names another root."""
    config: Any = numba.config
    own = "NUMBA_CACHE_DIR" in os.environ
    root = Path(config.CACHE_DIR).absolute() if own else user_cache_path("auxetic-sandbox")
    sources = (CORE,) if folder == CORE else (CORE, folder)
    kept = root / (PREFIX + source_hash(*sources))
    with suppress(OSError):
        os.utime(kept)
    return kept


def keep(dispatcher: Any) -> None:
    """Keep what a dispatcher compiles in the place of its source, if it can be kept, and take what came with the program."""
    # The module's file: in a program packed for machines without Python, a function knows no whole path.
    module = sys.modules[dispatcher.py_func.__module__]
    # Named now, while the sources are those that were imported.
    dispatcher._cache = _Kept(
        dispatcher.py_func, place(Path(str(module.__file__)).resolve().parent)
    )


class _Place:
    """Says what Numba asks of a place: a folder that stands for all that the code depends on."""

    def __init__(self, where: Path, function: Any = None) -> None:
        self._where, self._function = where, function

    def from_function(self, function: Any, source: str) -> _Place:
        """The place of a function's code: the same, wherever its source is."""
        del source
        return _Place(self._where, function)

    def ensure_cache_path(self) -> None:
        """Make the folder."""
        self._where.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._where)

    def get_source_stamp(self) -> str:
        """What changes with the source: neither its time nor its place matter."""
        return self._where.name

    def get_disambiguator(self) -> str:
        """What tells functions of one name apart."""
        return str(self._function.__code__.co_firstlineno)


_FunctionCache: Any = FunctionCache
_CacheImpl: Any = CompileResultCacheImpl


class _Impl(_CacheImpl):  # type: ignore[misc]
    def __init__(self, where: Path, function: Any) -> None:
        self._locator_classes = (_Place(where),)
        super().__init__(function)


class _Cache(_FunctionCache):  # type: ignore[misc]
    """Numba's cache of a function in a folder."""

    def __init__(self, function: Any, where: Path) -> None:
        self._impl_class = partial(_Impl, where)
        super().__init__(function)


@cache
def trouble(where: Path) -> str:
    """Why nothing can be kept there; empty: it can."""
    try:
        if not where.is_absolute():
            raise OSError("nobody's home is known")
        where.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=where).close()
    except OSError as error:
        return reason_of(error)
    return ""


def usable(where: Path) -> bool:
    """Can something be kept there? If not, it is said, once for all that would lie side by side."""
    reason = trouble(where)
    if reason:
        _warn(where.parent, reason)
    return not reason


@cache
def _warn(root: Path, reason: str) -> None:
    log.warning(
        "compiled code cannot be kept in %s (%s): every start compiles it anew", root, reason
    )


@cache
def _came(where: Path) -> bool:
    """Did that folder come with the program?"""
    return where.is_dir()


class _Kept:
    """Cache of one function: what cannot be read is missing, what cannot be written is not kept.

    The disk is left alone until the function is asked for: most commands compile nothing.
    """

    def __init__(self, function: Any, where: Path) -> None:
        self._function, self._where = function, where

    @cached_property
    def _own(self) -> Any:
        return _Cache(self._function, self._where) if usable(self._where) else None

    @cached_property
    def _shipped(self) -> Any:
        where = SHIPPED / self._where.name
        return _Cache(self._function, where) if _came(where) else None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._own or self._shipped, name)

    def load_overload(self, *arguments: Any) -> Any:
        """What was compiled before, or None."""
        return self._load(self._shipped, arguments) or self._load(self._own, arguments)

    def _load(self, cache: Any, arguments: tuple[Any, ...]) -> Any:
        if cache is None:
            return None
        try:
            return cache.load_overload(*arguments)
        # A pickle that is damaged, or comes from elsewhere, may raise anything.
        except Exception as error:  # noqa: BLE001
            log.info("kept code cannot be read: %r", error)
            if cache is self._own:
                with suppress(OSError):
                    cache.flush()  # else the index stands in the way of saving
            return None

    def save_overload(self, *arguments: Any) -> None:
        """Keep it, if that is possible.

        One process at a time: Numba reads an index, chooses a file, and writes both; two would choose the same file.
        """
        if self._own is None:
            return
        from filelock import FileLock  # with asyncio behind it: only where something is compiled

        try:
            with FileLock(Path(self._own.cache_path) / "lock", timeout=BUSY):
                self._own.save_overload(*arguments)
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

"""The folder that a study writes to, what it writes there whole or not at all, and what machine it ran on."""

from __future__ import annotations

import math
import os
import platform
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.files import atomic_write, clear
from sandbox import __version__

LIBRARIES = ("numpy", "numba", "pymunk", "matplotlib")


def prepare_folder(text: str, inside: str = "runs") -> Path:
    """The folder for the output, made if need be, with one ``inside`` it. Raises InputError if it cannot be written to."""
    if not text:
        raise InputError("--out needs a folder: . is the one you are in")
    folder = Path(text)
    try:
        (folder / inside).mkdir(parents=True, exist_ok=True)
        trial = folder / inside / f".trial-{os.getpid()}"
        trial.write_bytes(b"")
        trial.unlink()
        clear(folder)
        clear(folder / inside)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(f"--out {text}: cannot write there ({reason})") from error
    return folder


def machine() -> dict[str, Any]:
    """What the study ran on."""
    versions = {"auxetic-sandbox": __version__}
    for name in LIBRARIES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            continue
    return {
        "machine": {
            "system": platform.platform(),
            "processor": platform.processor() or platform.machine(),
            "cores": os.cpu_count(),
            "python": platform.python_version(),
        },
        "versions": versions,
    }


def finite(value: Any) -> Any:
    """Numbers that JSON cannot carry become null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return value


def write_text(path: Path, text: str) -> None:
    """Write a file whole or not at all; what is no text gets question marks. Raises InputError if it cannot be written."""
    write_bytes(path, text.encode(errors="replace"))


def write_bytes(path: Path, content: bytes) -> None:
    """As ``write_text``, of anything."""
    try:
        with atomic_write(path) as file:
            file.write(content)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(f"cannot write {path}: {reason}") from error

"""A folder for what a command makes, and what is written there whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

from core.errors import InputError, reason_of
from core.files import atomic_write, clear


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
        reason = reason_of(error)
        raise InputError(f"--out {text}: cannot write there ({reason})") from error
    return folder


def write_text(path: Path, text: str) -> None:
    """Write a file whole or not at all; what is no text gets question marks. Raises InputError if it cannot be written."""
    write_bytes(path, text.encode(errors="replace"))


def write_bytes(path: Path, content: bytes) -> None:
    """As ``write_text``, of anything."""
    try:
        with atomic_write(path) as file:
            file.write(content)
    except OSError as error:
        reason = reason_of(error)
        raise InputError(f"cannot write {path}: {reason}") from error

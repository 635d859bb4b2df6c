"""Files that grow by whole lines, whatever may end the program, and to which others may add as well."""

from __future__ import annotations

import os
from pathlib import Path
from typing import BinaryIO

from core.errors import InputError, reason_of
from sandbox.interrupts import deferred


def append_lines(path: Path, lines: str) -> None:
    """Add them in one piece, or nothing of them; what a kill has left of a line before is none of theirs.

    Raises InputError if that cannot be.
    """
    if not lines:
        return
    try:
        with deferred(), path.open("a+b", buffering=0) as file:
            end = file.seek(0, os.SEEK_END)
            file.seek(max(end - 1, 0))
            cut_off = end > 0 and file.read(1) != b"\n"
            append(file, (b"\n" if cut_off else b"") + lines.encode())
    except OSError as error:
        raise InputError(f"cannot write {path}: {reason_of(error)}") from error


def append(file: BinaryIO, data: bytes) -> None:
    """Add all of it to the end of a file that is not buffered, or nothing. Raises OSError."""
    size = os.fstat(file.fileno()).st_size
    try:
        while data:  # a disk that has room for a part takes that
            data = data[file.write(data) :]
    except OSError:
        file.truncate(size)
        raise

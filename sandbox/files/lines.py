"""Adding whole lines to a file that others may add to as well."""

from __future__ import annotations

import os
from pathlib import Path

from core.errors import InputError


def append_lines(path: Path, lines: str) -> None:
    """Whole lines in one piece, or nothing of them. Raises InputError if that cannot be."""
    if not lines:
        return
    try:
        with path.open("ab", buffering=0) as file:
            size = os.fstat(file.fileno()).st_size
            data = lines.encode()
            if file.write(data) < len(data):  # a disk that has room for a part takes that
                file.truncate(size)
                raise OSError(28, "no room left on the disk")
    except OSError as error:
        raise InputError(
            f"cannot write {path}: {(error.strerror or str(error)).lower()}"
        ) from error

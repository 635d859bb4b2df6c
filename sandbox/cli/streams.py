"""The terminal as it is: closed, broken, or with few letters. What a command makes does not depend on it."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TextIO


class _Optional:
    """Standard error: bars and remarks. Where nobody takes them any more, they are not written."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """As a stream does."""
        with suppress(OSError, ValueError):  # the latter from a closed stream
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """As a stream does."""
        with suppress(OSError, ValueError):
            self._stream.flush()


@contextmanager
def prepared() -> Iterator[None]:
    """Within the block standard streams are there; letters that they cannot show become ``?``."""
    before = sys.stdin, sys.stdout, sys.stderr
    # In this order, so that on POSIX each takes the number that is free: else the next file that is opened would.
    nowhere = Path(os.devnull)
    sys.stdin = sys.stdin or nowhere.open()
    sys.stdout = sys.stdout or nowhere.open("w")
    sys.stderr = sys.stderr or nowhere.open("w")
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError):  # a stream that somebody has put there
            stream.reconfigure(errors="replace")  # type: ignore[union-attr]
    sys.stderr = _Optional(sys.stderr)
    try:
        yield
    finally:
        sys.stdin, sys.stdout, sys.stderr = before

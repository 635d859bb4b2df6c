"""The logs of the runs of one window: the first in the file that was named, each further one in a numbered file beside it."""

from __future__ import annotations

import os
from pathlib import Path

from core.errors import InputError
from core.files import is_special
from sandbox.files.growing_log import GrowingLog


class RunLogs:
    """At most one grows at a time. A run in which nothing was done leaves its file to the next one."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.paths = [Path(path)]  # in the order of the runs; the last is written to
        self._log: GrowingLog | None = None
        self.lost = ""  # why the log before could not be written to its end

    def begin(self) -> GrowingLog:
        """That of another run; the one before is at its end."""
        if self._log is not None:
            self.lost = ""
            try:
                self._log.close()
            except InputError as error:
                self.lost = str(error)
            if self._log.begun and not is_special(self._log.path):
                self.paths.append(self._free())
        self._log = GrowingLog(self.paths[-1])
        return self._log

    @property
    def trouble(self) -> str:
        """Why this one cannot be written at the moment; empty: it can."""
        return "" if self._log is None else self._log.trouble

    def close(self) -> None:
        """The end of all. Raises InputError if the last one cannot be written."""
        if self._log is not None:
            self._log.close()

    def _free(self) -> Path:
        """The first number from 2 on for which nothing is there."""
        first, number = self.paths[0], 2
        while (path := first.with_stem(f"{first.stem}-{number}")).exists() or path in self.paths:
            number += 1
        return path

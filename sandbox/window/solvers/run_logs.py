"""The logs of the runs of one window: the first in the file that was named, each further one in a numbered file beside it."""

from __future__ import annotations

import os
from pathlib import Path

from core.errors import InputError
from core.files import is_special
from sandbox.files.growing_log import GrowingLog
from sandbox.session.log import Log
from sandbox.words import words


class RunLogs:
    """At most one grows at a time. A run in which nothing was done leaves its file to the next one."""

    def __init__(self, path: str | os.PathLike[str] | None) -> None:
        """Without a path there are none."""
        self._paths = [] if path is None else [Path(path)]  # in the order of the runs
        self._log: GrowingLog | None = None
        self._news = ""  # of it, to be told
        self._trouble = ""  # with it, that was told

    @property
    def there(self) -> list[Path]:
        """Those that have been written, in the order of the runs."""
        return [path for path in self._paths if path.exists()]

    def begin(self) -> GrowingLog | None:
        """That of another run; the one before is at its end."""
        if not self._paths:
            return None
        self._news, before = "", self._log
        if before is not None:
            lost = self._ended(before)
            if before.begun and not is_special(before.path):
                self._paths.append(self._free())
            if len(self._paths) > 1:
                self._news = words.LOG_FURTHER.format(name=self._paths[-1].name)
            if lost:
                self._news = words.LOG_LOST.format(reason=lost)
        self._log = GrowingLog(self._paths[-1])
        return self._log

    def keep(self, newest: Log) -> None:
        """What there is to be written of this run."""
        if self._log is not None:
            self._log.keep(newest)

    def tell(self) -> str:
        """What to say, once: that it cannot be written at the moment, that one is lost, or where a further run is logged."""
        trouble = "" if self._log is None else self._log.trouble
        known, self._trouble = self._trouble, trouble
        if trouble and not known:
            return words.LOG_TROUBLE.format(reason=trouble)
        news, self._news = self._news, ""
        return news

    def close(self) -> None:
        """The end of all. Raises InputError if the last one cannot be written."""
        if self._log is not None:
            self._log.close()

    @staticmethod
    def _ended(log: GrowingLog) -> str:
        """End it; why that cannot be, if so."""
        try:
            log.close()
        except InputError as error:
            return str(error)
        return ""

    def _free(self) -> Path:
        """The first number from 2 on for which nothing is there."""
        first, number = self._paths[0], 2
        while (path := first.with_stem(f"{first.stem}-{number}")).exists() or path in self._paths:
            number += 1
        return path

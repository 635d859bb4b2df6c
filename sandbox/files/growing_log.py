"""The log of a run on the disk while the run goes on, so that a crash costs a moment.

What is in the file is always a whole log, to be replayed: its last line, which says where the run ended, is overwritten by
the next commands and a new last line. The solver's thread hands over what there is; a thread of its own writes it.
"""

from __future__ import annotations

import logging
import os
import threading
from pathlib import Path
from typing import BinaryIO

from core.errors import InputError, reason_of
from core.files import followed, is_special
from sandbox.files.log_file import last_line, lines_of, write_log
from sandbox.files.pipes import with_reader
from sandbox.session.log import Log

log = logging.getLogger(__name__)

EVERY = 0.5  # [s] between two looks at what is new


class GrowingLog:
    """One run's log. A pipe or a device gets all at the end."""

    def __init__(self, path: str | os.PathLike[str], every: float = EVERY) -> None:
        self.path = Path(path)
        self.trouble = ""  # why it cannot be written at the moment
        self._newest: Log | None = None
        self._written: Log | None = None
        self._file: BinaryIO | None = None
        self._last = 0  # bytes of the last line
        self._size = 0  # of the file, in bytes
        self._every = every
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()

    @property
    def begun(self) -> bool:
        """Has anything been done in this run?"""
        return self._newest is not None and bool(self._newest.commands or self._newest.end)

    def keep(self, newest: Log) -> None:
        """What there is to be written now; takes no time."""
        self._newest = newest

    def write(self) -> None:
        """Write what is new, if anything is. Raises OSError as the system does; what had been written before is whole then."""
        newest, written = self._newest, self._written
        if newest is None or newest is written:
            return
        if written is None or not self.path.exists() or not self._as_left():
            self._release()
            write_log(self.path, newest)
            self._file = followed(self.path).open("r+b", buffering=0)
            self._last = len(last_line(newest))
        else:
            last = last_line(newest)
            self._overwrite(lines_of(newest.commands[len(written.commands) :]) + last)
            self._last = len(last)
        assert self._file is not None
        self._size = os.fstat(self._file.fileno()).st_size
        self._written = newest

    def close(self) -> None:
        """The end: write what is left, and wait until the disk has it. Raises InputError if that cannot be.

        Where somebody has put another file in its place, or written to it, all is written anew.
        """
        self._stop.set()
        self._thread.join()
        newest = self._newest
        if newest is None:
            return
        try:
            if is_special(self.path):
                with with_reader(self.path):
                    write_log(self.path, newest)
            else:
                self._finish(newest)
        except OSError as error:
            held = ""
            if self._written is not None and self._in_place():
                held = f"; it holds the run up to increment {self._written.end}"
            raise InputError(f"{self.path}: {reason_of(error)}{held}") from error
        finally:
            self._release()

    def _finish(self, newest: Log) -> None:
        self.write()
        if self._file is not None and self._in_place() and self._as_left():
            os.fsync(self._file.fileno())
        else:
            write_log(self.path, newest)

    def _as_left(self) -> bool:
        """Is the file that is being written as long as it was? Somebody may have cut it, or added to it."""
        return self._file is not None and os.fstat(self._file.fileno()).st_size == self._size

    def _in_place(self) -> bool:
        """Is the file that is being written still the one of that name?"""
        if self._file is None:
            return False
        try:
            return os.path.samestat(self.path.stat(), os.fstat(self._file.fileno()))
        except OSError:
            return False

    def _release(self) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None

    def _overwrite(self, lines: bytes) -> None:
        """Put lines in the place of the last one, all of them or none."""
        file = self._file
        assert file is not None
        size = file.seek(0, os.SEEK_END)
        file.seek(size - self._last)
        before = file.read(self._last)
        file.seek(size - self._last)
        try:
            while lines:  # a disk that has room for a part takes that
                lines = lines[file.write(lines) :]
        except OSError:
            file.seek(size - self._last)
            file.write(before)
            file.truncate(size)
            raise

    def _run(self) -> None:
        while not self._stop.wait(self._every):
            if is_special(self.path):
                continue
            try:
                self.write()
            except OSError as error:
                reason = reason_of(error)
                if not self.trouble:
                    log.warning("%s cannot be written now: %s", self.path, reason)
                self.trouble = reason
            else:
                self.trouble = ""

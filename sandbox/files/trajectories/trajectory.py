"""A run as a file for other people's programs: which kind, its name says."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Protocol, Self

from core.errors import InputError, reason_of
from core.files import followed, is_special
from sandbox.files.pipes import with_reader
from sandbox.files.trajectories.arrays import Arrays
from sandbox.files.trajectories.extxyz import ExtendedXYZ
from sandbox.files.trajectories.paraview import ParaView
from sandbox.files.trajectories.state import State
from sandbox.interrupts import deferred
from sandbox.session.session import Session


class Writer(Protocol):
    """One kind of file. What is written is put aside; ``finish`` makes the file whole or not at all."""

    def write(self, state: State) -> None: ...

    def finish(self) -> None: ...


_WRITERS: dict[str, Callable[[Path, BinaryIO], Writer]] = {
    ".xyz": ExtendedXYZ,
    ".extxyz": ExtendedXYZ,
    ".npz": Arrays,
    ".pvd": ParaView,
}


class Trajectory:
    """Writes frames to ``path``: .xyz or .extxyz, .npz, or .pvd.

    A context manager: leaving it normally, or by Ctrl-C, publishes the file; leaving it by any other exception, or by kill -9,
    leaves what was there. With no frame nothing is published. Raises InputError where something cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.frames = 0
        self._begun: list[State] = []
        target = followed(self.path)
        # Beside the file, where there is room if there is any, and without a name: it goes with the program.
        near = None if is_special(target) else target.parent
        self._aside = tempfile.TemporaryFile(dir=near)  # noqa: SIM115 - closed by __exit__
        self._writer: Writer = _WRITERS[path.suffix.lower()](target, self._aside)

    def begin(self, session: Session) -> None:
        """Where the session stands is the first frame, once there is another."""
        self._begun = [State.of(session)]

    def write(self, session: Session) -> None:
        """Where the session stands."""
        with deferred():
            states, self._begun = [*self._begun, State.of(session)], []
            try:
                for state in states:
                    self._writer.write(state)
            except OSError as error:
                raise self._failed(error) from error
            self.frames += len(states)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with deferred():
            try:
                if self.frames and (kind is None or issubclass(kind, KeyboardInterrupt)):
                    with with_reader(self.path):
                        self._writer.finish()
            except OSError as failed:
                raise self._failed(failed) from failed
            finally:
                with suppress(OSError):  # a full disk, that has been told
                    self._aside.close()

    def _failed(self, error: OSError) -> InputError:
        kept = "; the earlier file was kept" if self.path.is_file() else ""
        return InputError(f"cannot write {self.path}: {reason_of(error)}{kept}")

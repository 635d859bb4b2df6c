"""What is kept of the runs while they go on: an autosave of the latest, and the logs."""

from __future__ import annotations

import os

from core.errors import InputError
from sandbox.files.autosave import Autosave
from sandbox.session.beginning import Made
from sandbox.window.solvers.pane_row import Pane
from sandbox.window.solvers.run_logs import RunLogs


class Keeping:
    """Either may be missing."""

    def __init__(self, autosave: Autosave | None, log: str | os.PathLike[str] | None) -> None:
        """``log``: where the first run is logged, further ones beside it."""
        self.autosave = autosave
        self.logs = RunLogs(log)

    def keep(self, made: Made | None) -> None:
        """What there is to be kept now."""
        if self.autosave is not None:
            self.autosave.keep(made)

    def log_the_end(self, pane: Pane) -> None:
        """What has been done in the last increment of a run whose thread has ended."""
        if pane.solver.snapshot.frame and not pane.session.busy:
            self.logs.keep(pane.session.log())

    def close(self, made: Made | None, clean: bool) -> None:
        """A ``clean`` end takes the autosave away. Raises InputError if the log cannot be written; the autosave stays then."""
        try:
            self.logs.close()
        except InputError as error:
            self._close_autosave(made, clean=False)
            if self.autosave is None:
                raise
            raise InputError(
                f"{error}; what was there is kept, the menu offers it next time"
            ) from error
        self._close_autosave(made, clean)

    def _close_autosave(self, made: Made | None, clean: bool) -> None:
        if self.autosave is not None:
            self.autosave.keep(made)
            self.autosave.close(clean)

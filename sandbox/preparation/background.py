"""While somebody looks at the window, another process compiles what no scene has needed yet."""

from __future__ import annotations

import subprocess

from sandbox.beside import LOWEST, start
from sandbox.preparation import parts
from scenes import registry


class Background:
    """At most one process, at the lowest priority, for as long as the window is open."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._begun = False

    def begin(self) -> None:
        """Start it, the first time; if nothing is missing there is none."""
        if not self._begun:
            self._begun = True
            self._process = start(parts.missing(parts.of_scenes(registry.names())), LOWEST)

    def close(self) -> None:
        """End it. What it had finished is kept."""
        if self._process is not None:
            with self._process:  # its pipe as well
                self._process.kill()

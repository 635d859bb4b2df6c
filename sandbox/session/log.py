"""What a session has been asked for, and where that led: enough to do it again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Command


@dataclass(frozen=True)
class Log:
    """A run: ``commands`` are (increments finished before, command), in order; it ended after ``end`` increments in ``hash``.

    A log that broke off has an empty hash. That of a run that began with a scene file holds that file, and needs
    no other.
    """

    scene: str
    packing: str
    seed: int
    settings: dict[str, Any]
    commands: tuple[tuple[int, Command], ...]
    end: int
    hash: str
    start: SceneFile | None = None  # what it began with, if not with the scene as it is built

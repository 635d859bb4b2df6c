"""What packings side by side have in common: which there are, what begins a new curve, how far back all can go."""

from __future__ import annotations

from collections.abc import Sequence

from core.errors import InputError
from sandbox.session.commands import Change, Command, Recall, Redo, Reset, Undo
from sandbox.session.frame import Frame
from scenes import registry

FROM_THE_LEFT = ("regular", "mixed", "auxetic")
NOT_ALL = "not all packings can go back there"


def comparable(scene: str) -> tuple[str, ...]:
    """The packings of a scene that can stand side by side, from the left."""
    known = registry.get(scene).packings if scene in registry.names() else ()
    return tuple(kind for kind in FROM_THE_LEFT if kind in known)


def begins_anew(scene: str, command: Command) -> bool:
    """Does the command end the curve and begin another? A live change does not."""
    if not isinstance(command, Change):
        return isinstance(command, Reset)
    if scene not in registry.names():
        return True
    return command.name not in registry.get(scene).live


def way_back(command: Undo | Redo | Recall, frames: Sequence[Frame]) -> Command:
    """A way back that all packings can go. Raises InputError if there is none."""
    if len(frames) < 2:
        return command
    if isinstance(command, Recall):
        first = max(frame.first_kept for frame in frames)
        last = min(frame.last_kept for frame in frames)
        return Recall(max(first, min(command.increment, last)))
    able = [f.can_undo if isinstance(command, Undo) else f.can_redo for f in frames]
    if not all(able):
        raise InputError(NOT_ALL)
    return command

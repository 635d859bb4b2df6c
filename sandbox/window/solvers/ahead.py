"""Working ahead: increments that nobody has seen yet, so that a long one among short ones does not make a body stutter.

While a body lags behind the hand, or a script drives, the way before it is known. The solvers then go on until ``DEPTH``
finished increments are ready, and the window shows one a picture, evenly. A long increment is made while those before it are
looked at.

What is seen is what is so: history, log, table, autosave, undo, sound and lessons know only what was shown. A command takes
effect after what was shown. All that is ready is dropped then, and so is the increment under way: every session goes back to
the mark that it made at the increment shown (``session/mark.py``), bit for bit, and goes on as if it had never worked ahead.
Where nothing is ready, the increment under way is what would be under way in any case: the command waits for its end.

One command may wait for longer. A hand in motion asks for another place in every picture, and mostly the body goes there by
way of what is ready. That ``Move`` takes effect after it, as if the hand had been there these few pictures later; it costs no
more than ``DEPTH`` pictures, a tenth of a second. Nobody has to guess whether the ways are the same to the last bit: the log
says after which increment it took effect. Where going through all that is ready is a ``DETOUR``, the hand has turned, and
all of it is dropped.

So that the picture never goes back, an increment that is shown while it is still being relaxed counts as shown. So does one
that any other command than a ``Move`` has begun. While held, at a set speed, and while a packing that came late catches up,
nobody works ahead.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sandbox.session.commands import Command, Move
from sandbox.session.log import Log
from sandbox.session.mark import Mark
from sandbox.window.solvers.snapshot import Snapshot

DEPTH = 6  # increments ready at most
DETOUR = 1.0  # steps of the hand: a way over what is ready that is longer by more is a turn


@dataclass(frozen=True, slots=True, weakref_slot=True)
class Ready:
    """What a turn has come to in one packing: what the window may know, the log up to there, and the way back."""

    turn: int
    snapshot: Snapshot
    log: Log | None
    mark: Mark | None  # None where nobody works ahead


class Pace:
    """How many increments a picture takes up: one, and more only where the solvers make more than that."""

    def __init__(self) -> None:
        self._latest = 1

    def count(self, ready: int, most: int) -> int:
        """Of those that are ready; ``most`` could be. Where all of these are, the solvers have waited for the picture."""
        self._latest = self._latest + 1 if ready >= most else max(self._latest - 1, 1)
        self._latest = min(self._latest, most)
        return min(self._latest, ready)


def may_wait(command: Command, shown: Ready | None, ready: Sequence[Ready]) -> bool:
    """May a command take effect after all that is ready?"""
    if not isinstance(command, Move) or shown is None or shown.mark is None:
        return False
    marks = [one.mark for one in ready if one.mark is not None]
    return shown.mark.detour(command, marks) <= DETOUR

"""What a run came to, as ``record`` and ``replay`` print it."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from scenes.text import counted

if TYPE_CHECKING:
    from sandbox.record.record import Outcome, Output
    from sandbox.session.session import Session


def report(sessions: Sequence[Session], outcome: Outcome, output: Output | None) -> bool:
    """What a finished run came to, a line for each packing, and the scene's own checks; False where one of them fails."""
    if outcome.interrupted:
        print(interrupted(outcome, output), file=sys.stderr)
        if not outcome.increments:
            return True
    all_hold = True
    if output and output.page and not outcome.interrupted:
        print(_page_line(outcome, output))
    for session in sessions:
        print(f"{session.packing}: " * (len(sessions) > 1) + _summary(session, outcome))
        if session.run.locked:
            print(f"  {session.run.how_locked}")
        for check in session.checks():
            verdict = {True: "holds", False: "FAILS", None: "open"}[check.holds]
            print(f"  {verdict:<5}  {check.name}: {check.measured}")
            all_hold &= check.holds is not False
    return all_hold


def _page_line(outcome: Outcome, output: Output) -> str:
    line = f"{counted(outcome.pictures, 'picture')} in {output.page}"
    if outcome.pictures < outcome.increments // output.every:
        line += (
            f", of {counted(outcome.increments, 'increment')}: a page keeps no more (see --every)"
        )
    return line


def interrupted(outcome: Outcome, output: Output | None) -> str:
    """How far a run came that was stopped, and what there is of it."""
    written = []
    if outcome.frames and output and output.film:
        one = output.film.suffix.lower() == ".png"
        written.append(
            f"{'the last frame' if one else counted(outcome.frames, 'frame')} to {output.film}"
        )
    if outcome.pictures and output and output.page:
        written.append(f"{counted(outcome.pictures, 'picture')} to {output.page}")
    if outcome.increments and output and output.table:
        written.append(f"{counted(outcome.rows, 'row')} to {output.table}")
    if outcome.increments and output and output.trajectory:
        written.append(f"the trajectory to {output.trajectory}")
    what = f"wrote {' and '.join(written)}" if written else "nothing was written"
    return f"stopped after {counted(outcome.increments, 'increment')}: {what}"


def _summary(session: Session, outcome: Outcome) -> str:
    # Row 0 is the state before the hand has moved.
    reasons = session.history.column("stop_reason")[1:]
    forces = session.history.column("resisting")[1:]
    unfinished = sum(str(reason) != "converged" for reason in reasons)
    mean = float(forces.mean()) if len(forces) else 0.0
    frames = f"{counted(outcome.frames, 'frame')}, " if outcome.frames else ""
    return (
        f"{frames}{counted(len(reasons), 'increment')} "
        f"({unfinished or 'none'} did not converge), "
        f"mean {session.frame().curve_label}: {mean:.4g}, state {session.state_hash()}"
    )

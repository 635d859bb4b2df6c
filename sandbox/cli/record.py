"""The commands ``record`` and ``replay``: runs without a window. Light at the top, as the command line is."""

from __future__ import annotations

import argparse
from contextlib import suppress

from core.errors import InputError
from sandbox.cli import arguments
from sandbox.cli.exit_codes import CHECK_FAILED, DIFFERENT, INTERRUPTED, OK
from sandbox.cli.output_words import DEFAULTS, output_of
from sandbox.cli.report import report
from sandbox.cli.scene_words import row_of, sessions_of
from sandbox.interrupts import deferred


def record(options: argparse.Namespace) -> int:
    """Make a film, a table or both, of one packing or of several side by side."""
    output = output_of(options, options.size, options.fps, options.every)
    if output is None:
        raise InputError(
            "nothing to write: give --out FILE.mp4, --data FILE.csv or --trajectory FILE.xyz"
        )
    if output.trajectory and options.compare:
        raise InputError(
            "--trajectory takes one packing: leave --compare out, or record each alone"
        )
    sessions = sessions_of(options)
    row = row_of(options.scene)
    steps: int = options.steps or sessions[0].scene.steps(sessions[0].settings)
    if row is not None and not options.steps:
        steps = row.increments
    from sandbox.record import record as films

    outcome = films.record(sessions, steps, output)
    with suppress(KeyboardInterrupt), deferred():  # all is written, and is told to the end
        all_hold = report(sessions, outcome, output)
        if outcome.interrupted:
            return INTERRUPTED
        if row is not None and row.state and steps == row.increments:
            same = sessions[0].state_hash() == row.state
            print(
                "the same state as in the table"
                if same
                else f"NOT the state of the table, {row.state}"
            )
            return OK if same else DIFFERENT
        return OK if all_hold else CHECK_FAILED
    return INTERRUPTED


def replay(options: argparse.Namespace) -> int:
    """Repeat what a log says, and compare where it leads."""
    from sandbox.files.log_file import read_log

    output = output_of(options, DEFAULTS["size"], DEFAULTS["fps"])
    log = read_log(options.log)
    from sandbox.session.replay import session_of

    session_of(log)  # finds mistakes before any work
    from sandbox.record.record import repeat

    session, outcome = repeat(log, output)
    with suppress(KeyboardInterrupt), deferred():
        report([session], outcome, output)
        if outcome.interrupted:
            return INTERRUPTED
        same = log.hash in ("", session.state_hash())
        said = "the same state as in the log" if same else f"NOT the state of the log, {log.hash}"
        print(said if log.hash else "the log does not say in which state the run ended")
        refused, why = session.refusals
        if refused:
            noun = "command" if refused == 1 else "commands"
            print(
                f"{refused} {noun} of the log could not be carried out: {arguments.one_line(why)}"
            )
        return OK if same and not refused else DIFFERENT
    return INTERRUPTED

"""A log run again: command by command, so that Ctrl-C is heard; and the same bits."""

from __future__ import annotations

import signal
import sys
from pathlib import Path

import pytest

from core.errors import InputError
from sandbox.cli.report import interrupted
from sandbox.record import record
from sandbox.record.record import Outcome, Output
from sandbox.session.commands import Command, Protocol, Reset, Undo
from sandbox.session.log import Log
from sandbox.session.session import Session

RESETS = 40


def log(*commands: tuple[int, Command], end: int = 2) -> Log:
    return Log("single_grain", "regular", 1, {}, commands, end, "")


def test_commands_between_increments_lead_to_the_same_state() -> None:
    """As given to a session at once: also where they lead to another time, or come after the last increment."""
    commands: list[tuple[int, Command]] = [
        (0, Protocol(True)),
        (2, Reset()),
        (2, Undo()),
        (2, Protocol(True)),
        (3, Reset()),
        (3, Protocol(True)),
        (4, Undo()),
    ]
    session = Session("single_grain", "regular")
    session.build()
    for at in range(5):
        for stamp, command in commands:
            if stamp == at:
                session.submit(command)
        while at < 4 and not session.advance(400):
            pass
    session.settle()
    repeated, outcome = record.repeat(log(*commands, end=4), None)
    assert repeated.state_hash() == session.state_hash()
    assert [command for _, command in repeated.log().commands] == [c for _, c in commands]
    assert (outcome.increments, outcome.interrupted) == (4, False)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("after", [1, 2])
def test_ctrl_c_is_heard_between_two_commands(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, after: int
) -> None:
    """Among many after an increment, be it the last one."""
    done = 0
    reset = Session._reset

    def press(session: Session) -> None:
        nonlocal done
        done += 1
        reset(session)
        if done == 3:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Session, "_reset", press)
    many = [(after, Reset()) for _ in range(RESETS)]
    run = log((0, Protocol(True)), *many, end=2)
    _, outcome = record.repeat(run, Output(None, tmp_path / "run.csv"))
    assert done == 3
    assert outcome.interrupted
    assert outcome.increments == after
    assert (tmp_path / "run.csv").exists()


def test_a_log_that_leads_nowhere_is_told() -> None:
    with pytest.raises(InputError, match="nothing moves after increment 0 of 2"):
        record.repeat(log((0, Reset())), None)


@pytest.mark.parametrize(
    ("outcome", "film", "table", "words"),
    [
        (Outcome(0, 0, 1, True), "film.mp4", "run.csv", "nothing was written"),
        (Outcome(7, 7, 8, True), "film.mp4", None, "wrote 7 frames to film.mp4"),
        (
            Outcome(7, 7, 8, True),
            "last.png",
            "run.csv",
            "wrote the last frame to last.png and 8 rows to run.csv",
        ),
        (Outcome(7, 0, 8, True), "film.mp4", None, "nothing was written"),  # --every 10
    ],
)
def test_what_is_said_to_be_written_was(
    outcome: Outcome, film: str, table: str | None, words: str
) -> None:
    said = interrupted(outcome, Output(Path(film), Path(table) if table else None))
    assert said == f"stopped after {outcome.increments} increments: {words}"

"""The estimated error of the force on the handle: in rows, frames, tables and the status line, and whether it is true."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sandbox.draw.status import ROUGH, lamp
from sandbox.draw.theme import DARK
from sandbox.session.commands import Protocol
from sandbox.session.history import History, Row
from sandbox.session.session import Session
from sandbox.studies.accuracy.protocols import PROTOCOLS
from sandbox.words import words
from scenes import registry
from scenes.accuracy import TABLE, UNKNOWN, accuracies, accuracy_of
from tests.draw.frames import intruder_frame


def pressed(tolerance: float, increments: int = 10) -> Session:
    """A row of grains under the piston."""
    session = Session("grain_row", "regular", 1, {"tolerance": tolerance, "friction": 0.0})
    session.build()
    session.submit(Protocol(True))
    while len(session.history) <= increments:
        session.advance()
    return session


def row(number: int, fx: float, fy: float, resisting: float, error: float = 0.0) -> Row:
    return Row(number, 0.0, fx, fy, 0, 0.0, 0.0, 1, "converged", resisting, error)


def test_rows_frames_and_tables_carry_the_estimate() -> None:
    session = pressed(1e-2)
    newest = session.history[-1]
    assert 0.0 < newest.force_error < abs(newest.fy)
    frame = session.frame()
    mean = float(np.mean([abs(session.history[k].fy) for k in range(len(session.history))]))
    assert frame.force_error == pytest.approx(newest.force_error / mean)
    assert session.history.header()[-3] == "estimated error of the force on the handle [k R]"
    assert list(session.history.rows())[-1][-3] == newest.force_error


def test_estimate_is_above_most_errors() -> None:
    loose, tight = pressed(1e-2), pressed(1e-8)
    error = np.abs(loose.history.column("fy") - tight.history.column("fy"))
    estimate = loose.history.column("force_error")
    assert np.mean(error <= estimate) >= 0.8


def test_estimate_falls_with_the_tolerance() -> None:
    assert pressed(1e-5).history[-1].force_error < 1e-2 * pressed(1e-2).history[-1].force_error


def test_mean_magnitude_of_a_history_and_of_its_beginning() -> None:
    history = History()
    assert history.mean_magnitude == 0.0
    for number in range(600):
        history.append(row(number, 3.0, 4.0, -1.0) if number < 300 else row(number, 0.0, 0.0, -2.0))
    assert history.mean_magnitude == pytest.approx(3.5)
    assert history.upto(300).mean_magnitude == pytest.approx(5.0)
    assert history.curve.shape == (2, 600)


def test_lamp_says_the_estimate_and_turns_amber_where_it_is_rough() -> None:
    frame = replace(intruder_frame(6), residual=0.01, tolerance=0.01, stop_reason="converged")
    fine = lamp(replace(frame, busy=False, force_error=0.004), DARK)
    assert fine.error == words.HANDLE_FORCE_ERROR.format(error="0.5 %")
    assert fine.colour == DARK.good
    rough = lamp(replace(frame, busy=False, force_error=1.5 * ROUGH), DARK)
    assert rough.colour == DARK.working
    for unknown in (math.nan, 3.0):
        assert lamp(replace(frame, busy=False, force_error=unknown), DARK).error.startswith(
            words.FORCE_ERROR.split("{", maxsplit=1)[0]
        )


def test_scenes_that_the_study_has_seen_say_how_accurate_they_are() -> None:
    assert set(accuracies()) == set(PROTOCOLS)
    for name, found in accuracies().items():
        assert registry.get(name).accuracy is found
        assert "within" in found.statement
        assert found.error_factor >= 0.0
    assert accuracy_of("no such scene") is UNKNOWN


def test_statements_are_those_of_the_published_study() -> None:
    folder = Path(__file__).parents[2] / "assets" / "studies" / "accuracy"
    assert (folder / "accuracy.toml").read_bytes() == TABLE.read_bytes()
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert results["statements"] == {n: found.statement for n, found in accuracies().items()}
    assert not results["quick"]

"""The estimated error of the force on the handle: in rows, frames, tables and the status line, and whether it is true."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.relaxation import StopReason
from sandbox.draw.lamp import ROUGH, lamp, worst
from sandbox.draw.theme import DARK
from sandbox.session.commands import Erase, Protocol
from sandbox.session.history import History, Row
from sandbox.session.session import Session
from sandbox.studies.accuracy.estimate import MOVED_POWER, POWER
from sandbox.studies.accuracy.protocols import PROTOCOLS
from sandbox.words import words
from scenes import registry
from scenes.accuracy import TABLE, UNKNOWN, Bound, Estimate, accuracies, accuracy_of, left_over
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
    return Row(number, 0.0, fx, fy, 0, 0.0, 0.0, 1, "converged", resisting, error, error)


def test_rows_frames_and_tables_carry_the_estimate() -> None:
    session = pressed(1e-2)
    newest = session.history[-1]
    assert 0.0 < newest.usual_error <= newest.force_error < abs(newest.fy)
    frame = session.frame()
    mean = float(np.mean([abs(session.history[k].fy) for k in range(len(session.history))]))
    assert frame.usual_error == pytest.approx(newest.usual_error / mean)
    assert frame.force_error == pytest.approx(newest.force_error / mean)
    usual, most = session.table.header()[3:5]
    assert usual == "usual error, estimated: force on the piston [k R]"
    assert "nine of ten" in most
    assert list(session.table.rows())[-1][3:5] == (newest.usual_error, newest.force_error)


def test_estimate_is_above_most_errors() -> None:
    loose, tight = pressed(1e-2), pressed(1e-8)
    error = np.abs(loose.history.column("fy") - tight.history.column("fy"))
    assert np.mean(error <= loose.history.column("force_error")) >= 0.8


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
    fine = lamp(replace(frame, busy=False, usual_error=0.0065, force_error=0.026), DARK)
    assert fine.error == "force usually within 0.7 %, nine of ten within 3 %"
    assert fine.short.endswith("within 3 %")
    assert fine.colour == DARK.good
    alike = lamp(replace(frame, busy=False, usual_error=0.0, force_error=1e-9), DARK)
    assert alike.error == "force within 0.0001 %"
    rough = lamp(replace(frame, busy=False, usual_error=0.1, force_error=1.5 * ROUGH), DARK)
    assert rough.colour == DARK.working
    for unknown in (math.nan, 3.0):
        assert lamp(replace(frame, busy=False, force_error=unknown), DARK).error.startswith(
            words.FORCE_ERROR.split("{", maxsplit=1)[0]
        )


def test_of_several_that_are_settled_the_least_exact_is_named() -> None:
    frame = replace(intruder_frame(6), busy=False, tolerance=0.01, stop_reason="converged")
    exact, rough = (
        replace(frame, residual=residual, usual_error=0.1 * error, force_error=error)
        for residual, error in ((0.009, 0.2), (0.001, 0.4))
    )
    assert worst([exact, rough], DARK) is rough


def test_scenes_that_the_study_has_seen_say_how_accurate_they_are() -> None:
    assert set(accuracies()) == set(PROTOCOLS)
    for name, found in accuracies().items():
        assert registry.get(name).accuracy is found
        assert re.search("root mean square error of the force|within", found.statement)
        for kind, estimate in found.estimates.items():
            assert kind in registry.get(name).packings
            for bound in (estimate.usual, estimate.nine_of_ten):
                assert bound.factor > 0.0
                assert POWER[0] <= bound.power <= POWER[1]
                assert MOVED_POWER[0] <= bound.moved_power <= MOVED_POWER[1]
    for name in ("intruder", "hopper"):
        assert set(accuracy_of(name).estimates) == set(registry.get(name).packings)


def test_what_nobody_has_measured_has_the_estimate_of_the_worst() -> None:
    assert accuracy_of("no such scene").estimate("mixed") is UNKNOWN
    assert accuracy_of("intruder").estimate("no such packing") is UNKNOWN
    state = 1.0, 0.02, 1.0  # as a relaxation to the tolerance of most scenes ends
    unknown = UNKNOWN.errors(*state)
    for found in accuracies().values():
        for estimate in found.estimates.values():
            assert all(np.less_equal(estimate.errors(*state), unknown))


def test_an_edited_scene_is_one_that_nobody_has_measured() -> None:
    session = pressed(1e-2, 3)
    packing = session.run.setup.packing
    session.submit(Protocol(False))
    session.submit(Erase(float(packing.x[0]), float(packing.y[0]), 0.1))
    while not session.idle or not session.run.course.edited:
        session.advance()
    run = session.run
    report = run.last.report
    unbalanced = float(np.linalg.norm(run.last.unbalanced))
    left = left_over(unbalanced, report.residual, report.mean_contact_force)
    moved = max(run.engine.farthest_move() / run.setup.solver.step, 1.0)
    errors = UNKNOWN.errors(report.mean_contact_force, left, moved)
    newest = session.history[-1]
    assert (newest.usual_error, newest.force_error) == pytest.approx(errors)
    assert newest.force_error > 0.0


def test_nine_of_ten_is_never_less_than_usual_and_both_grow_with_what_is_left() -> None:
    estimate = Estimate(Bound(2.0, 0.5, 0.5), Bound(3.0, 1.0, 0.0))
    usual, most = estimate.errors(2.0, 0.02, 4.0)
    assert usual == pytest.approx(2.0 * 2.0 * 0.1 * 2.0)
    assert most == usual > Bound(3.0, 1.0, 0.0).error(2.0, 0.02, 4.0)
    assert estimate.errors(2.0, 20.0, 4.0) == pytest.approx((2.0 * 2.0 * 10**0.5 * 2.0, 60.0))
    assert estimate.errors(0.0, 0.0, 1.0) == (0.0, 0.0)


def test_what_is_left_on_a_shape_alone_counts() -> None:
    session = Session("single_grain", "regular", 1)
    session.build()
    session.submit(Protocol(True))
    while len(session.history) <= 5:
        session.advance()
    assert np.linalg.norm(session.run.last.unbalanced) < 1e-12
    assert session.history[-1].force_error > session.history[-1].usual_error > 0.0


def test_an_increment_that_is_taken_back_has_no_estimate() -> None:
    session = pressed(1e-2, 3)
    failed = replace(session.run.last.report, reason=StopReason.SUNK)
    increment = replace(session.run.last, report=failed)
    found = session.run.course.read_off(session.run.setup, increment, 4, 0.1, UNKNOWN)
    assert math.isnan(found.usual_error)
    assert math.isnan(found.force_error)


def test_statements_are_those_of_the_published_study() -> None:
    folder = Path(__file__).parents[2] / "assets" / "studies" / "accuracy"
    assert (folder / "accuracy.toml").read_bytes() == TABLE.read_bytes()
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert results["statements"] == {n: found.statement for n, found in accuracies().items()}
    assert not results["quick"]

"""How parts of a claim are judged, and the numbers in which that is said."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("scipy")

from sandbox.ensemble.estimates import Exact, Student
from sandbox.studies.common.verdicts import FAILS, HOLDS, OPEN, Demand
from sandbox.studies.paper import claims as parts_of
from sandbox.studies.paper.claims import (
    MORE,
    NOT_MEASURED,
    Claim,
    Measured,
    Part,
    Reading,
    Threshold,
    Unmeasurable,
    cross,
    number,
    settle,
)
from sandbox.studies.paper.runs import Request, Result
from tests.studies.paper_results import made_up, result


def test_a_failed_run_leaves_its_claim_unmeasured() -> None:
    part = Part("value", "says", "quantity", MORE, lambda _: Reading(Exact(2.0)))
    claim = Claim("c", "", "", lambda quick: (), (part, part))
    good = result(Request("hopper", "regular", 1))
    bad = Result(Request("hopper", "mixed", 5), failure="collapsed at increment 7 of 9")
    assert [f.verdict for f in settle(claim.find([good]))] == [HOLDS, HOLDS]
    for finding in settle(claim.find([good, bad])):
        assert finding.verdict == NOT_MEASURED
        for word in ("1 of 2", "hopper, mixed, seed 5", "collapsed at increment 7 of 9"):
            assert word in finding.decided_by
    short = replace(good, ended="squeezed flat")
    patient = replace(claim, bears_short_runs=True)
    assert settle(claim.find([short]))[0].verdict == NOT_MEASURED
    assert settle(patient.find([short]))[0].verdict == HOLDS
    assert settle(patient.find([bad]))[0].verdict == NOT_MEASURED


def test_a_part_that_cannot_be_measured_says_why() -> None:
    (finding,) = settle([made_up("no avalanche")])
    assert (finding.verdict, finding.decided_by) == (NOT_MEASURED, "no avalanche")


def test_what_a_variation_contradicts_is_not_established() -> None:
    sure, other = Student(2.0, 0.01, 15.0), Student(0.8, 0.05, 7.0)
    unsure = Student(0.8, 0.5, 7.0)
    assert settle([made_up(sure)])[0].verdict == HOLDS
    assert settle([made_up(sure, varied=[unsure, "not run"])])[0].verdict == HOLDS
    (contradicted,) = settle([made_up(sure, varied=[sure, other])])
    assert contradicted.verdict == OPEN
    assert "condition 1" in contradicted.decided_by
    (refuted,) = settle([made_up(other, Threshold(Demand(1.0), "reason"), [sure])])
    assert refuted.verdict == FAILS


def test_three_verdicts_in_words() -> None:
    findings = settle(
        [made_up(Student(v, e, 15.0)) for v, e in ((2.0, 0.01), (0.5, 0.01), (1.1, 0.2))]
    )
    assert [f.verdict for f in findings] == [HOLDS, FAILS, OPEN]
    assert all(f.p is not None for f in findings)
    assert "2 (1.98 to 2.02), must be above 1" in findings[0].decided_by


def test_means_and_spreads() -> None:
    measured = Measured.of("force", "k R", [1.0, 2.0, 3.0, 4.0])
    assert measured.mean == 2.5
    assert measured.spread == pytest.approx(math.sqrt(5.0 / 3.0))
    assert str(measured) == "force 2.5 ± 1.3 k R"
    alone = Measured.of("share", "", 0.25)
    assert (alone.spread, str(alone)) == (None, "share 0.25")


def test_a_ratio_of_nothing_is_told() -> None:
    some, none = Measured.of("a", "", [1.0, 1.0]), Measured.of("none", "", [0.0, 0.0])
    rows = ([(1, 1.0), (2, 1.0)], [(1, 0.0), (2, 0.0)])
    with pytest.raises(Unmeasurable, match="none is not above 0"):
        parts_of.ratio(some, none, rows)
    with pytest.raises(Unmeasurable, match="no seed"):
        parts_of.ratio(some, none, ([(1, 1.0)], [(2, 1.0)]))


def test_a_curve_is_read_between_its_points() -> None:
    x, y = np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 10.0])
    assert cross(x, y, 2.0) == 6.0
    assert cross(x, y, 0.0) == 0.0
    with pytest.raises(Unmeasurable, match="before 4"):
        cross(x, y, 4.0)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1234.0, "1234"),
        (-0.5, "−0.5"),
        (2e-7, "2e−7"),
        (math.inf, "no number"),
        (math.nan, "no number"),
    ],
)
def test_numbers_for_people(value: float, text: str) -> None:
    assert number(value).replace("e-", "e−") == text

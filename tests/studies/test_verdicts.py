"""Verdicts: by hand, against closed forms, and by simulation of how often they are right."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytest.importorskip("scipy")

from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from sandbox.ensemble.estimates import Exact, Student
from sandbox.studies.common.verdicts import FAILS, HOLDS, OPEN, Demand, holm, pair, verdicts


def test_holm_by_hand() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([]) == []
    assert holm([0.9, 0.8]) == [1.0, 1.0]


@given(st.lists(st.floats(0.0, 1.0), max_size=12))
def test_holm_never_helps_and_keeps_the_order(p: list[float]) -> None:
    adjusted = holm(p)
    assert all(before <= after <= 1.0 for before, after in zip(p, adjusted, strict=True))
    order = sorted(range(len(p)), key=p.__getitem__)
    assert [adjusted[k] for k in order] == sorted(adjusted)


def test_a_verdict_falls_either_way_or_not_at_all() -> None:
    clear, unclear = Student.mean([2.0, 2.1, 1.9, 2.05]), Student.mean([0.5, 3.0, 1.0, 2.0])
    demands = [Demand(1.0), Demand(3.0), Demand(high=1.0), Demand(1.5, 2.5), Demand(2.5, 3.0)]
    assert [verdicts([(clear, d)])[0][0] for d in demands] == [HOLDS, FAILS, FAILS, HOLDS, FAILS]
    assert all(verdicts([(unclear, d)])[0][0] == OPEN for d in demands)
    assert [v for v, _ in verdicts([(Exact(2.0), d) for d in demands])] == [
        HOLDS,
        FAILS,
        FAILS,
        HOLDS,
        FAILS,
    ]


def test_the_more_is_asked_the_more_evidence_it_takes() -> None:
    """p = 0.02 alone is enough, and is not beside four others that say nothing; exact numbers do not count."""
    estimate = Student(2.0, 2.0 / float(stats.t.ppf(0.99, 9)), 9.0)
    nothing = (Student(0.0, 1.0, 9.0), Demand(0.0))
    ((verdict, p),) = verdicts([(estimate, Demand(0.0))])
    assert (verdict, round(p, 9)) == (HOLDS, 0.02)
    verdict, p = verdicts([(estimate, Demand(0.0)), *[nothing] * 4])[0]
    assert (verdict, round(p, 9)) == (OPEN, 0.1)
    assert verdicts([(estimate, Demand(0.0)), *[(Exact(1.0), Demand(0.0))] * 4])[0][0] == HOLDS


def test_a_study_of_true_nothings_is_seldom_wrong() -> None:
    """Twenty statements whose truth lies on the bound: at most five studies of a hundred establish anything."""
    random = np.random.default_rng(6)
    tries, wrong = 400, 0
    for _ in range(tries):
        cases = [(Student.mean(row), Demand(0.0)) for row in random.normal(0.0, 1.0, (20, 4))]
        wrong += any(verdict != OPEN for verdict, _ in verdicts(cases))
    assert wrong / tries < 0.05 + 4.0 * math.sqrt(0.05 * 0.95 / tries)


def test_pairs_are_seeds_that_both_have() -> None:
    one, other = pair([(3, 0.3), (1, 0.1), (2, 0.2)], [(2, 2.0), (3, 3.0), (4, 4.0)])
    assert (one.tolist(), other.tolist()) == ([0.2, 0.3], [2.0, 3.0])

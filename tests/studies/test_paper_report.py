"""What is told of the paper's claims: a table of the runs, verdicts, the cost of the paper's conditions."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

pytest.importorskip("scipy")

from sandbox.ensemble.estimates import Exact
from sandbox.studies.paper import cost, hopper, report
from sandbox.studies.paper.claims import Claim, settle
from sandbox.studies.paper.conditions import AUXETIC, LAMBDAS, SYSTEMS, lam_of
from sandbox.studies.paper.shear import cell
from scenes.scene import HAND_STRENGTH
from tests.studies.paper_results import STIFFNESS, made_up, pushes, shears


def test_a_table_has_one_row_a_run_and_nothing_breaks_out_of_its_cells() -> None:
    runs = pushes(dict.fromkeys(hopper.KINDS, 1.0), dict.fromkeys(hopper.KINDS, 0.5))[:12]
    used = {run.request: ["hopper"] for run in runs}
    lines = report.as_table(runs, used).splitlines()
    assert len(lines) == 13
    header = lines[0].split(",")
    assert {
        "claims",
        "scene",
        "packing",
        "seed",
        HAND_STRENGTH,
        "force_mean",
        "locked_mean",
    } <= set(header)
    assert all(len(line.split(",")) == len(header) for line in lines)
    claim = Claim("c", "Fig. | 1", "a | b", lambda quick: (), (made_up(Exact(2.0)).part,))
    judged = [report.Judged(claim, tuple(settle(claim.find([]))))]
    text = report.as_markdown(judged, [], {})
    assert "“a \\| b”" in text
    assert "| direction: says | quantity: 2 | above 1 | no chance | **holds** |" in text
    assert "Must be above 1: a direction" in text


def test_the_cost_of_the_papers_conditions_is_extrapolated() -> None:
    """Steps five times as many that take twice as long: 25 times as many take four times as long."""
    plain = [replace(run, seconds=10.0) for run in shears(dict.fromkeys(LAMBDAS, 0.1), STIFFNESS)]
    fine = []
    for run in plain:
        settings = dict(run.request.settings)
        if settings["packing_fraction"] == cell.COMMON[-1] and settings["grains"] == cell.GRAINS:
            asked = replace(run.request, settings=tuple({**settings, "step": 0.01}.items()))
            fine.append(replace(run, request=asked, seconds=20.0))
    assert cost.growth(plain) == 1.0
    assert cost.growth(plain + fine) == pytest.approx(math.log(2.0) / math.log(5.0))
    (steady,) = cost.estimate(plain + fine)
    assert steady.protocol.startswith("Fig. 4")
    points = max(len(fractions) for fractions in cell.FRACTIONS.values())
    assert steady.runs == SYSTEMS * points * len(LAMBDAS)
    assert steady.hours == pytest.approx(steady.runs * 10.0 * 4.0 / 3600.0)
    assert cost.estimate([run for run in plain if lam_of(run.request) != AUXETIC]) == []

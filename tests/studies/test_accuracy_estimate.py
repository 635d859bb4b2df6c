"""The live estimate: drives that are solved twice, bounds fitted to some seeds and judged by others, and what is written."""

from __future__ import annotations

import csv
import io
import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from sandbox.studies.accuracy import study as accuracy
from sandbox.studies.accuracy.estimate import (
    SHARES,
    bound,
    bounds,
    calibrate,
    cases,
    judge,
    quantile_regression,
)
from sandbox.studies.accuracy.estimate_report import RUNS, as_runs, estimate_rows
from sandbox.studies.accuracy.live import FIT, JUDGE, Drive, drives, measure
from sandbox.studies.accuracy.report import as_table

KIND, SEED = "mixed", 1
LEFT = {1.0: 0.02, 10.0: 0.2, 0.1: 0.002}  # of the mean contact force, by level


@pytest.fixture(scope="module")
def row_drive() -> dict[str, Any]:
    """A row of grains, as it stands in a file."""
    data: dict[str, Any] = json.loads(json.dumps(measure(Drive("grain_row", KIND, SEED, 6))))
    return data


def made_up(seed: int, count: int = 60, power: float = 0.7, moved_power: float = 0.0) -> Any:
    """A drive whose errors are known: log-normal about 2 f (u/f)^p m^q."""
    rng = np.random.default_rng(seed)
    rows = []
    for _ in range(count):
        moved, force = 1.0 + rng.exponential(3.0), rng.uniform(0.5, 2.0)
        luck = float(np.exp(rng.normal()))
        readings = [
            {
                "level": level,
                "residual": 0.01 * level,
                "evaluations": 100,
                "contact_force": force,
                "unbalanced": left * force,
                "error": 2.0 * force * left**power * moved**moved_power * luck,
            }
            for level, left in LEFT.items()
        ]
        rows.append({"force": 3.0, "mean": 2.0, "moved": moved, "readings": readings})
    return {"increments": count, "unconverged": 1, "untold": 2, "rows": rows}


def test_a_drive_is_what_a_session_does(row_drive: dict[str, Any]) -> None:
    session = Session("grain_row", KIND, SEED)
    session.build()
    session.submit(Protocol(True))
    while session.history[-1].increment < 60:
        session.advance()
    assert row_drive["increments"] == 60
    assert [row["increment"] for row in row_drive["rows"]] == [10, 20, 30, 40, 50, 60]
    for row in row_drive["rows"]:
        found = session.history[row["increment"]]
        assert row["force"] == pytest.approx(found.magnitude, rel=1e-4)
        assert row["readings"][0]["residual"] <= session.run.setup.solver.tolerance


def test_less_is_left_and_less_is_wrong_on_the_way_down(row_drive: dict[str, Any]) -> None:
    for row in row_drive["rows"]:
        ended, loose, tight = row["readings"]
        assert (ended["level"], loose["level"], tight["level"]) == (1.0, 10.0, 0.1)
        assert loose["residual"] > ended["residual"] > tight["residual"]
        assert loose["unbalanced"] > ended["unbalanced"] > tight["unbalanced"] > 0.0
        assert loose["evaluations"] < ended["evaluations"] < tight["evaluations"]
        assert tight["error"] < ended["error"] < 1e-4 * row["force"]


def test_solving_again_leaves_no_trace_in_the_drive() -> None:
    few, many = (measure(Drive("grain_row", KIND, SEED, n))["rows"] for n in (3, 6))
    by_place = {row["increment"]: row for row in many}
    assert [by_place[row["increment"]] for row in few] == few


def test_there_are_other_seeds_to_judge_than_to_fit() -> None:
    assert not set(FIT) & set(JUDGE)
    assert {drive.seed for drive in drives("intruder", quick=False)} == {*FIT, *JUDGE}
    assert len(drives("intruder", quick=True)) == 6
    assert not drives("two_ellipses", quick=False)
    keys = {drive.key() for drive in drives("intruder", quick=False)}
    assert len(keys) == 24


@pytest.mark.parametrize("share", [0.25, 0.5, 0.9])
def test_quantile_regression_has_that_share_below_it(share: float) -> None:
    rng = np.random.default_rng(5)
    x = rng.uniform(0.0, 3.0, (400, 2))
    y = 1.0 + x @ [0.5, 1.5] + rng.normal(size=400) * 0.3
    plane = quantile_regression(x, y, share, [(0.0, 2.0)] * 2)
    assert plane[1:] == pytest.approx([0.5, 1.5], abs=0.1)
    assert np.mean(y <= plane[0] + x @ plane[1:]) == pytest.approx(share, abs=0.01)


def test_slopes_keep_to_their_limits() -> None:
    x = np.linspace(0.0, 1.0, 50)[:, None]
    assert quantile_regression(x, -3.0 * x[:, 0], 0.5, [(0.2, 2.0)])[1] == pytest.approx(0.2)


def test_bounds_find_the_powers_and_cover_other_seeds() -> None:
    fitted = bounds(cases({seed: made_up(seed, power=0.7, moved_power=0.5) for seed in FIT}))
    assert fitted is not None
    assert fitted["usual"].power == pytest.approx(0.7, abs=0.05)
    assert fitted["usual"].moved_power == pytest.approx(0.5, abs=0.3)
    verdict = judge(cases({seed: made_up(seed, 400, 0.7, 0.5) for seed in JUDGE}), fitted)
    for name, share in SHARES.items():
        assert verdict[name]["coverage"] == pytest.approx(share, abs=0.08)
        assert (
            verdict[name]["interval"][0] < verdict[name]["coverage"] < verdict[name]["interval"][1]
        )
        assert set(verdict[name]["elsewhere"]) == {"0.1", "10"}
    assert verdict["increments"] == 1600


def test_a_feature_that_tells_nothing_is_left_out() -> None:
    found = cases({seed: made_up(seed, count=150) for seed in FIT})
    assert abs(bound(found, 0.5).moved_power) < 0.1


def test_where_the_handle_feels_nothing_there_is_nothing_to_fit() -> None:
    drive = made_up(1)
    for row in drive["rows"]:
        row["force"] = 0.0
    assert calibrate({1: drive, 5: drive}) is None


def test_table_report_and_runs() -> None:
    found = calibrate({seed: made_up(seed) for seed in (1, 2, 5)})
    assert found is not None
    assert found["untold"] == 6
    table = tomllib.loads(as_table({"intruder": "well"}, {"intruder": {"mixed": found}}))
    assert table["intruder"]["statement"] == "well"
    assert table["intruder"]["mixed"]["usual"] == pytest.approx(found["bounds"]["usual"], rel=0.01)
    _, row = estimate_rows({"intruder": {"mixed": found}})
    assert row[:2] == ("`intruder`", "mixed")
    header, *runs = csv.reader(io.StringIO(as_runs({"intruder": {"mixed": found}})))
    assert tuple(header) == RUNS
    assert [(run[2], run[3]) for run in runs] == [
        ("1", "fitted"),
        ("2", "fitted"),
        ("5", "judging"),
    ]


def test_a_miss_of_the_aim_has_a_star() -> None:
    found = calibrate({1: made_up(1), 5: made_up(5)})
    assert found is not None
    found["judged"]["usual"] |= {"coverage": 0.45, "aim": True}
    found["judged"]["nine_of_ten"] |= {"coverage": 0.7, "aim": False}
    _, row = estimate_rows({"intruder": {"mixed": found}})
    assert row[6].endswith("*")
    assert not row[4].endswith("*")


def test_study_of_the_estimate_alone(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    for drive in drives("intruder", quick=True):
        (tmp_path / "runs" / f"{drive.key()}.json").write_text(json.dumps(made_up(drive.seed)))
    outcome = accuracy.study(tmp_path, scenes=["intruder"], quick=True, only_estimate=True)
    assert outcome.jobs == 6
    table = tomllib.loads((tmp_path / "accuracy.toml").read_text())["intruder"]
    assert set(table) == {"statement", "regular", "mixed", "auxetic"}
    assert outcome.statements == {"intruder": table["statement"]}
    assert "## The live estimate" in (tmp_path / "accuracy.md").read_text()
    assert len((tmp_path / "estimate.csv").read_text().splitlines()) == 7
    assert not list(tmp_path.glob("*.png"))

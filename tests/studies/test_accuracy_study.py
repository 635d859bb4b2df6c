"""The study of accuracy as a whole: a walk, a job, the command, and what it writes."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError
from sandbox.cli import main as cli
from sandbox.ensemble.machine import machine
from sandbox.session.commands import Protocol as Drive
from sandbox.session.session import Session
from sandbox.studies.accuracy import study as accuracy
from sandbox.studies.accuracy.estimate_report import percent
from sandbox.studies.accuracy.job import Job, measure
from sandbox.studies.accuracy.peers import df_sane
from sandbox.studies.accuracy.protocols import PROTOCOLS, QUICK
from sandbox.studies.accuracy.report import as_markdown, as_table, statement
from sandbox.studies.accuracy.summary import (
    along_path,
    bifurcation,
    own_end,
    own_increments,
    stiffness,
    summarise,
)
from sandbox.studies.accuracy.walk import Knobs, begin, walk
from scenes import registry

COMMAND = [sys.executable, "-m", "sandbox", "study", "accuracy"]


@pytest.fixture(scope="module")
def row_job() -> dict[str, Any]:
    """What is measured of a row of grains, as it stands in a file."""
    data: dict[str, Any] = json.loads(json.dumps(measure(Job("grain_row", 1, quick=True))))
    return data


def test_every_scene_of_the_menu_has_a_protocol() -> None:
    assert set(PROTOCOLS) <= set(registry.names())
    assert len(PROTOCOLS) == 10


def test_a_walk_is_what_a_session_does() -> None:
    session = Session("grain_row", "mixed", 1)
    session.build()
    session.submit(Drive(True))
    while len(session.history) < 6:
        session.advance()
    start = begin("grain_row", "mixed", 1, {}, 0)
    path = walk(start, Knobs(tolerance=start.setup.solver.tolerance), 5)
    force = [look.force[1] for look in path.looks]
    assert force == pytest.approx([session.history[k].fy for k in range(1, 6)], rel=1e-4)


def test_walks_of_all_increments_meet_at_common_places() -> None:
    start = begin("single_grain", "mixed", 1, {}, 2)
    coarse = walk(start, Knobs(tolerance=1e-8), 2)
    fine = walk(start, Knobs(tolerance=1e-8, step=0.25), 2)
    assert len(fine.looks) == 4 * len(coarse.looks) == 8
    both = coarse.at(2), fine.at(2)
    assert both[0] is not None
    assert both[1] is not None
    assert both[0].force == pytest.approx(both[1].force, rel=1e-6)
    assert coarse.at(0.25) is None
    assert fine.at(9) is None


def test_other_contact_stiffness_starts_from_the_same_places() -> None:
    start = begin("grain_row", "mixed", 1, {}, 3)
    hard = walk(start, Knobs(tolerance=1e-8, contact_stiffness=500.0), 1).looks[0]
    usual = walk(start, Knobs(tolerance=1e-8), 1).looks[0]
    assert np.hypot(*hard.force) > np.hypot(*usual.force)
    assert np.all(start.packing.contact_stiffness == 50.0)


def test_errors_fall_with_the_tolerance(row_job: dict[str, Any]) -> None:
    own = [walked for walked in row_job["walks"] if walked["step"] == 1.0]
    worst = [max(place["force"] for place in walked["errors"]) for walked in own]
    assert len(worst) == len(QUICK.tolerances)
    assert worst[0] > worst[2] > worst[-1]
    assert worst[-1] < 1e-4
    assert {walked["step"] for walked in row_job["tight"]} == {0.125, 0.25, 0.5, 1.0}
    assert row_job["sliced"] is True


def test_reference_is_confirmed_by_other_means(row_job: dict[str, Any]) -> None:
    check = row_job["check"]
    assert check["force"] < 1e-8
    assert check["position"] < 1e-8
    assert check["twin_residual"] < 1e-8


def test_summary_and_report(row_job: dict[str, Any]) -> None:
    summary = summarise([row_job, row_job])
    assert summary["default"]["step"] == 1.0
    costs = [dot["solving"] for dot in summary["shown"]["front"]]
    errors = [dot["force"] for dot in summary["shown"]["front"]]
    assert costs == sorted(costs)
    assert errors == sorted(errors, reverse=True)
    assert summary["stiffness"]["error_power"] == pytest.approx(-1.0, abs=0.3)
    assert set(summary["lead"]) == {"SciPy L-BFGS-B", "paper's chart"}
    assert statement(summary).startswith("root mean square error of the force ")
    about = {"machine": machine()["machine"], "quick": True, "jobs": 1}
    text = as_markdown({"grain_row": summary}, {}, about, 0.01)
    assert "| `grain_row` | 7 |" in text
    assert "Quick run." in text
    assert "## Length of the increment" in text
    assert "friction cone" not in text
    table = tomllib.loads(as_table({"grain_row": statement(summary)}, {}))["grain_row"]
    assert table["statement"] == statement(summary)


def test_with_friction_contacts_beyond_the_cone_are_reported_and_minimisers_are_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plan = replace(PROTOCOLS["grain_row"], length=2, settings=(("friction", 0.3),))
    monkeypatch.setitem(PROTOCOLS, "grain_row", plan)
    job = json.loads(json.dumps(measure(Job("grain_row", 1, quick=True))))
    assert job["friction"] is job["memory"] is True
    assert set(job["peers"]) == {"SciPy DF-SANE", "paper's chart"}
    assert job["overlap"] is job["check"] is None
    for walked in job["walks"]:
        walked["beyond_cone"] = 0.25
    summary = summarise([job])
    about = {"machine": machine()["machine"], "quick": True, "jobs": 1}
    text = as_markdown({"grain_row": summary}, {}, about, 0.01)
    section = text.split("## Contacts beyond the friction cone")[1].split("##")[0]
    assert "| `grain_row` | " + " | ".join(["25 %"] * len(QUICK.tolerances)) + " |" in section
    assert "L-BFGS-B: mean" not in text.split("## The reference")[0].split("| scene |")[2]


def test_root_finder_needs_no_energy() -> None:
    start = begin("grain_row", "mixed", 1, {"friction": 0.3}, 4)
    found = walk(start, Knobs(tolerance=1e-3, solve=df_sane), 1).looks[0]
    usual = walk(start, Knobs(tolerance=1e-8), 1).looks[0]
    assert found.residual <= 1e-3
    assert found.force[1] == pytest.approx(usual.force[1], rel=1e-2)


def test_a_tight_walk_that_leaves_the_reference_ends_the_errors(row_job: dict[str, Any]) -> None:
    assert bifurcation(row_job) is None
    job = json.loads(json.dumps(row_job))
    job["tight"][0]["apart"] = [(0.5, 0.001), (1.5, 0.5), (2.0, 0.001)]
    assert bifurcation(job) == 1.5
    cut = along_path(job, 1.5)
    for walked in (*cut["walks"], *cut["budgets"], *cut["peers"]["paper's chart"]):
        assert all(place["place"] < 1.5 for place in walked["errors"])
    assert len(cut["stiffness"][0]["force"]) == 1


def test_so_does_a_tight_walk_of_the_sweeps_unless_the_path_has_a_memory(
    row_job: dict[str, Any],
) -> None:
    job = json.loads(json.dumps(row_job))
    tight = next(walked for walked in job["walks"] if walked["tolerance"] <= 1e-6)
    tight["errors"][1]["position"] = 0.5
    assert bifurcation(job) == tight["errors"][1]["place"]
    job["memory"] = True
    assert bifurcation(job) is None


def test_where_the_path_bifurcates_at_once_errors_are_those_of_the_increment(
    row_job: dict[str, Any],
) -> None:
    job = json.loads(json.dumps(row_job))
    assert summarise([job])["against"] == "path"
    job["tight"][0]["apart"] = [(0.5, 0.5)]
    summary = summarise([job])
    assert summary["against"] == "increment"
    assert 0.0 < summary["default"]["force"] < 1e-2
    tight = next(walked for walked in job["walks"] if walked["tolerance"] <= 1e-6)
    tight["own"][1]["position"] = 0.5
    end = tight["own"][1]["place"]
    assert own_end(job, 1.0) == end
    for walked in own_increments(job)["walks"]:
        if walked["step"] == 1.0:
            assert [place["place"] < end for place in walked["errors"]] == [True]


def test_model_error_is_against_the_extrapolated_limit() -> None:
    rows = [
        {"stiffness": c, "force": [1.0 + 2.0 / c], "pressure": [0.0], "solving": c**0.5}
        for c in (25.0, 50.0, 100.0, 200.0)
    ]
    found = stiffness([rows])
    assert found["force"][1] == pytest.approx(0.04, rel=0.02)
    assert found["error_power"] == pytest.approx(-1.0, abs=0.01)
    assert found["cost_power"] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0123, "1.2 %"), (2.0, "200 %"), (0.0, "0"), (math.nan, "—"), (1e-9, "1e-07 %")],
)
def test_shares_in_words(value: float, text: str) -> None:
    assert percent(value) == text


def test_two_ellipses_are_held_against_the_exact_contact() -> None:
    summary = summarise([measure(Job("two_ellipses", 1, quick=True))])
    halvings = summary["halvings"]
    assert halvings[0]["error"] > 10.0 * halvings[-1]["error"]
    assert halvings[-1]["error"] < 1e-9
    assert [row["mean"] for row in summary["contact"]] == sorted(
        row["mean"] for row in summary["contact"]
    )
    assert "ns a contact" in statement(summary)


def test_what_was_finished_is_not_measured_again(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    job = Job("two_ellipses", 1, quick=True)
    (tmp_path / "runs" / f"{job.key()}.json").write_text(json.dumps(measure(job)))
    outcome = accuracy.study(tmp_path, scenes=["two_ellipses"], quick=True, jobs=1, measure=_never)
    assert list(outcome.statements) == ["two_ellipses"]
    assert (tmp_path / "two_ellipses.png").stat().st_size > 10_000
    assert (
        json.loads((tmp_path / "results.json").read_text())["format"] == "auxetic-sandbox accuracy"
    )


def _never(job: accuracy.Task) -> dict[str, Any]:
    raise AssertionError(f"{job} was measured again")


def test_key_follows_what_a_job_depends_on() -> None:
    keys = {Job("grain_row", 1, q).key() for q in (True, False)} | {Job("grain_row", 2, True).key()}
    assert len(keys) == 3


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["study", "accuracy", "--out", "x", "--scene", "intrudr"], "did you mean intruder?"),
        (["study", "accuracy", "--out", "x", "--only", "press"], "belongs to study paper"),
        (["study", "paper", "--out", "x", "--scene", "intruder"], "belongs to study accuracy"),
        (["study", "hand", "--out", "x", "--estimate"], "belongs to study accuracy"),
    ],
)
def test_mistakes(words: list[str], reason: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(words) == 2
    assert reason in capsys.readouterr().err


def test_unknown_scene_is_an_input_error() -> None:
    with pytest.raises(InputError, match="no scene"):
        accuracy.choose(["zzz"])


@pytest.mark.slow
@pytest.mark.end_to_end
def test_quick_study_of_one_scene(tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = [*COMMAND, "--quick", "--scene", "single_grain", "--jobs", "1", "--out", str(out)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("single_grain      root mean square error of the force ")
    assert {"accuracy.md", "results.json", "single_grain.png", "stiffness.png"} <= {
        path.name for path in out.iterdir()
    }
    results = json.loads((out / "results.json").read_text())
    assert results["scenes"]["single_grain"]["lead"]["SciPy L-BFGS-B"]["least"] > 1.0

"""The classics: the cheap cases as they are, the arithmetic of the others, and the study as a command."""

from __future__ import annotations

import csv
import json
import math
import operator
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("scipy")

from sandbox.cli import main as cli
from sandbox.studies.classics import apparatus, clogging, discs, grains, heaps, packings, study
from sandbox.studies.classics.case import FIRST, Case, Job, Row, judged
from sandbox.studies.common.verdicts import FAILS, HOLDS, OPEN

REPOSITORY = Path(__file__).parents[2]
CHEAP = ("pile", "block", "rolling", "arch", "plates", "minimum")


def go(case: Case, jobs: list[Job]) -> list[Row]:
    return [Row(job, case.run(job, lambda: None)) for job in jobs]


def case(name: str) -> Case:
    return next(case for case in study.CASES if case.name == name)


@pytest.mark.parametrize("name", CHEAP)
def test_cheap_cases_come_out_as_they_should(name: str) -> None:
    chosen = case(name)
    checks = chosen.judge(go(chosen, chosen.jobs(True)))
    for check, (verdict, _) in zip(checks, judged(checks), strict=True):
        assert verdict == HOLDS, f"{check.quantity}: {check.estimate.value}, not {check.expected}"


def test_every_case_has_a_source_and_seeds_that_judge() -> None:
    names = [each.name for each in study.CASES]
    assert len(set(names)) == len(names)
    for each in study.CASES:
        assert "closed form" in each.source or "doi:" in each.source or each.name == "minimum"
        for quick in (True, False):
            jobs = each.jobs(quick)
            assert len({job.key() for job in jobs}) == len(jobs) > 0
            assert all(job.case == each.name for job in jobs)
            assert all(job.seed == 0 or job.seed >= FIRST for job in jobs)
        assert len(each.jobs(True)) <= len(each.jobs(False))


# Closed forms, from balance written out once more.


@pytest.mark.parametrize("slope", [10.0, 20.0, 30.0, 45.0])
def test_least_friction_of_an_arch_balances_forces_and_torques(slope: float) -> None:
    """Unknowns N, T at the middle disc, M, S at the wall; weights 1."""
    beta = math.radians(slope)
    sine, cosine = math.sin(beta), math.cos(beta)
    equations = np.array(
        [
            [2.0 * sine, 2.0 * cosine, 0.0, 0.0],  # the middle disc, upwards
            [-cosine, sine, 1.0, 0.0],  # the outer one, across
            [-sine, -cosine, 0.0, 1.0],  # and upwards
            [0.0, 1.0, 0.0, 1.0],  # and its turning
        ]
    )
    normal, along, wall, up = np.linalg.solve(equations, [1.0, 0.0, 1.0, 0.0])
    assert abs(along) / normal == pytest.approx(discs.least_friction(slope))
    assert abs(up) / wall < discs.least_friction(slope)


def test_bisection_finds_where_it_stands() -> None:
    assert apparatus.least(lambda x: x > 0.3, 0.0, 1.0, 1e-6) == pytest.approx(0.3, abs=1e-6)
    for always in (-1.0, 2.0):
        with pytest.raises(ValueError, match="does not fall at 0 and stand at 1"):
            apparatus.least(partial(operator.lt, always), 0.0, 1.0, 0.1)


def test_janssens_saturation_is_found_again() -> None:
    weights = np.array([0.5, 1.0, 2.0, 4.0, 8.0])
    forces = np.array([heaps.janssen(w, 1.7) for w in weights])
    assert heaps.saturation(weights, forces) == pytest.approx(1.7, rel=1e-4)
    assert heaps.janssen(1e-6, 1.7) == pytest.approx(
        1e-6, rel=1e-5
    )  # nothing is borne by walls yet


def test_a_hessian_is_that_of_springs() -> None:
    """Two grains in contact: along the line of centres C/2 in series with nothing, across −f/r."""
    from core.packing import Packing

    packing = Packing([0.0, 1.9], [0.0, 0.0], 1.0, 0.0, 50.0)
    matrix = packings.hessian(packing)
    assert matrix.shape == (10, 10)
    assert matrix[0, 0] == pytest.approx(50.0, rel=1e-6)
    assert matrix[0, 1] == pytest.approx(-50.0, rel=1e-6)
    assert matrix[2, 2] == pytest.approx(-50.0 * 0.1 / 1.9, rel=1e-5)
    np.testing.assert_allclose(matrix, matrix.T)


def test_rattlers_are_taken_out_until_none_is_left() -> None:
    from core.packing import Packing

    angle = np.arange(6) * math.pi / 3.0
    ring_x, ring_y = 1.9 * np.cos(angle), 1.9 * np.sin(angle)
    packing = Packing([0.0, *ring_x, 3.79, 9.0], [0.0, *ring_y, 0.0, 9.0], 1.0, 0.0, 50.0)
    assert len(packings.backbone(packing)) == 7


def test_four_plates_tend_to_the_hard_limit() -> None:
    """C K/(2(2C + K)) → 1/(1 − ν) for hard contacts; λ = 100 has C = 1022 and ν = 0.98."""
    assert grains.from_all_sides(1.0) == pytest.approx(1.0)
    assert grains.from_all_sides(100.0) == pytest.approx(46.05, rel=1e-3)


def test_jamming_is_judged_by_shares() -> None:
    def shares(*hits: int) -> list[str]:
        rows = []
        for width, jams in zip(clogging.WIDTHS, hits, strict=True):
            for k in range(24):
                job = Job("jamming", (("width", width),), FIRST + k)
                rows.append(Row(job, {"jammed": float(k < jams), "out": float(k)}))
        return [verdict for verdict, _ in judged(case("jamming").judge(rows))]

    assert shares(24, 20, 4, 0)[:2] == [HOLDS, HOLDS]
    assert shares(24, 20, 4, 0)[-1] == HOLDS
    assert shares(12, 12, 12, 12) == [OPEN] * 6
    assert shares(0, 4, 20, 24)[:2] == [FAILS, FAILS]


# The study.


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> tuple[Case, ...]:
    """Two cases of a second, and one that fails."""
    return (case("rolling"), case("plates"))


def test_the_study_writes_tables_that_agree(tmp_path: Path, small: tuple[Case, ...]) -> None:
    done = study.study(tmp_path, quick=True, jobs=1, cases=small)
    assert not done.failures
    assert not done.interrupted
    assert {verdict for _, _, verdict, _ in done.verdicts} == {HOLDS}
    text = (tmp_path / "classics.md").read_text(encoding="utf-8")
    assert "## Rolling between plates" in text
    assert "| 1/2 | 0.4994 to 0.5006 | **holds** |" in text
    with (tmp_path / "runs.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["case"] for row in rows] == ["rolling"] * 3 + ["plates"] * 10
    assert float(rows[0]["measured_way"]) == pytest.approx(0.5)
    data = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    assert len(data["checks"]) == len(done.verdicts)
    assert not (tmp_path / study.KEPT).exists()


def test_what_is_finished_is_not_done_again(tmp_path: Path, small: tuple[Case, ...]) -> None:
    from sandbox.studies.common.kept import keep

    first = small[0].jobs(True)[0]
    keep(
        tmp_path / study.KEPT, first.key(), {"numbers": {"way": 0.25, "turn": 0.5}, "seconds": 1.0}
    )
    with (tmp_path / study.KEPT).open("a", encoding="utf-8") as file:
        file.write("{ damaged\n")
    done = study.study(tmp_path, quick=True, jobs=1, cases=small[:1])
    assert done.rows[0]["way"] == 0.25
    assert [verdict for _, _, verdict, _ in done.verdicts].count(FAILS) == 1
    assert json.loads((tmp_path / "results.json").read_text())["runs_from_before"] == 1


def test_a_run_that_fails_leaves_its_case_unjudged(tmp_path: Path) -> None:
    from dataclasses import replace

    # A process of its own carries it out: it has to be a job that really fails, a silo with no grains at all.
    bad = Job("silo", (("grains", -1.0),), FIRST)
    broken = replace(case("silo"), jobs=lambda quick: [bad])
    done = study.study(tmp_path, quick=True, jobs=1, cases=(broken,))
    assert len(done.failures) == 2
    assert "not judged" in done.failures[1]
    assert done.verdicts == ()
    assert "not judged" in (tmp_path / "classics.md").read_text(encoding="utf-8")


def test_without_scipy_nothing_is_begun(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert cli.main(["study", "classics", "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "auxetic-sandbox[study]" in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["study", "classics", "--out", "x", "--only", "piles"], "did you mean pile?"),
        (["study", "classics", "--out", "x", "--only", "zzz"], "there are pile"),
        (["study", "hand", "--out", "x", "--only", "pile"], "belongs to study paper and classics"),
        (["study", "classics", "--out", "x", "--scene", "hopper"], "belongs to study accuracy"),
    ],
)
def test_mistakes_are_one_line(
    words: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(words) == 2
    said = capsys.readouterr()
    assert message in said.err
    assert said.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.end_to_end
def test_quick_study_of_one_case(tmp_path: Path) -> None:
    words = ["study", "classics", "--quick", "--jobs", "1", "--only", "plates", "--out"]
    command = [sys.executable, "-m", "sandbox", *words, str(tmp_path / "out")]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("plates  holds ") == 15
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert written == ["classics.md", "results.json", "runs.csv"]

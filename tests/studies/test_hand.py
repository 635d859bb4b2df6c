"""The study of the hand: tours keep their word, random hands break nothing, and what is told of it is told right."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sandbox.lessons import tours
from sandbox.studies.hand import report, study
from sandbox.studies.hand.jobs import Job, carry_out
from sandbox.studies.hand.tour_claims import CLAIMS, TENDENCIES, play
from scenes import registry
from scenes.scene import STRONGEST

CI_SEEDS = (1, 2)


@pytest.mark.slow
@pytest.mark.parametrize("seed", CI_SEEDS)
@pytest.mark.parametrize("scene", tours.scenes())
def test_every_step_can_be_done_and_what_it_says_is_so(scene: str, seed: int) -> None:
    for step in play(scene, seed):
        assert step["done"], step
        assert not step["broken"], step
        if (scene, step["step"]) not in TENDENCIES:
            assert all(step["claims"].values()), step


def test_claims_are_about_steps_that_there_are() -> None:
    steps = {(scene, step.key) for scene in tours.scenes() for step in tours.steps(scene)}
    assert set(CLAIMS) <= steps
    assert set(TENDENCIES) <= set(CLAIMS)


def test_jobs_cover_every_scene_with_a_hand() -> None:
    jobs = study.all_jobs()
    scenes = study.scenes_with_a_hand()
    assert set(scenes) == set(registry.names()) - {"two_ellipses"}  # its grains are put, not pushed
    for part, count in (("push", None), ("random", study.RANDOM), ("tour", None)):
        some = [job for job in jobs if job.part == part]
        assert {job.scene for job in some} == set(tours.scenes() if part == "tour" else scenes)
        assert count is None or len(some) == count
    assert len({job.key() for job in jobs}) == len(jobs)
    assert len(study.all_jobs(quick=True)) < len(jobs) / 10


def test_a_push_tells_how_it_ended() -> None:
    row = carry_out(Job("push", "grain_row", "regular", 1, 0.5))
    assert row["ended"] == "locked"
    assert 0.45 < row["peak_force"] <= 0.5 * 1.02
    free = carry_out(Job("push", "grain_row", "regular", 1, STRONGEST))
    assert free["ended"] == "went through"
    assert free["peak_force"] > 1.0
    assert free["way"] > row["way"]
    assert free["failing"] == []


def test_a_weaker_hand_that_was_never_needed_comes_to_the_same() -> None:
    strong, weak = (Job("push", "grain_row", "auxetic", 1, strength) for strength in (50.0, 20.0))
    row = carry_out(strong)
    assert row["peak_force"] < 20.0
    assert study.implied(weak, [row]) == carry_out(weak)
    too_weak = Job("push", "grain_row", "auxetic", 1, 0.5 * row["peak_force"])
    assert study.implied(too_weak, [row]) is None
    assert study.implied(strong, [carry_out(weak)]) is None


def test_a_random_hand_is_the_same_again() -> None:
    job = Job("random", "biaxial_press", "mixed", 3)
    first, second = carry_out(job), carry_out(job)
    assert first == second
    assert first["broken"] == 0
    assert first["increments"] > 10


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("hand")
    chosen = [
        Job("push", "grain_row", "regular", 1, 0.5),
        Job("push", "grain_row", "auxetic", 1, STRONGEST),
        Job("tour", "grain_row", "", 1),
        Job("random", "grain_row", "mixed", 1),
    ]
    done = study.study(out, jobs=1, chosen=chosen)
    assert not done.failures
    assert not done.interrupted
    assert len(done.rows) == 4
    return out


def test_the_study_writes_tables_that_agree(folder: Path) -> None:
    text = (folder / "hand.md").read_text(encoding="utf-8")
    assert "| `grain_row` | 0.5 | regular | 1 of 1" in text
    assert "nothing pushes sideways | 1 of 1 |" in text
    assert "Steps that could not be done in time: none." in text
    rows = (folder / "runs.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("part,scene,packing,seed,strength,ended")
    assert len(rows) == 4  # tours have no row of their own
    data = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert [run["part"] for run in data["runs"]] == ["push", "push", "tour", "random"]
    assert report.wrong(data["runs"]) == []
    assert not (folder / study.KEPT).exists()


def test_what_is_wrong_is_named() -> None:
    step = {"step": "push", "done": False, "claims": {"it locks": False}, "broken": ["sunk"]}
    rows = [
        {"part": "tour", "scene": "hopper", "packing": "", "seed": 7, "steps": [step]},
        {
            "part": "random",
            "scene": "hopper",
            "packing": "mixed",
            "seed": 7,
            "ended": "sunk",
            "broken": 1,
        },
    ]
    found = report.wrong(rows)
    assert len(found) == 4
    assert all("hopper, seed 7" in line for line in found)

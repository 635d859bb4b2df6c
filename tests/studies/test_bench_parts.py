"""The parts of the bench: what they look at and how they judge. No test asks how long anything took."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from core.generate import Recipe, pack
from core.threads import most_threads
from sandbox.session.session import Session
from sandbox.studies.bench import drawing as bench_drawing
from sandbox.studies.bench import frames as bench_frames
from sandbox.studies.bench import peers as bench_peers
from sandbox.studies.bench import pictures as bench_pictures
from sandbox.studies.bench import report as bench_report
from sandbox.studies.bench import scaling as bench_scaling
from sandbox.studies.bench import smoothness as bench_smoothness
from sandbox.studies.bench import soft_discs
from sandbox.studies.bench import startup as bench_startup
from sandbox.studies.bench import threads as bench_threads
from sandbox.studies.bench import times as bench_times
from sandbox.studies.bench.disc_forces import DiscForces


def test_exponent_of_a_power_law() -> None:
    sizes = [500, 1000, 100_000]
    assert bench_times.exponent(sizes, [3.0 * n**1.07 for n in sizes]) == pytest.approx(1.07)
    assert bench_times.exponent(sizes, [2.0, 2.0, 2.0]) == pytest.approx(0.0, abs=1e-12)


def test_jobs_are_timed_in_turn() -> None:
    calls: list[str] = []
    times = bench_times.in_turn(
        {"a": lambda n: calls.append("a"), "b": lambda n: calls.append("b")}, seconds=0.0
    )
    assert calls[:4] == ["a", "a", "b", "b"]  # to choose how often
    assert calls[4:] == ["a", "b"] * 3
    assert {len(t.seconds) for t in times.values()} == {3}


def test_least_and_median() -> None:
    times = bench_times.Times((3e-6, 1e-6, 2e-6))
    assert times.data(1e-6) == pytest.approx({"min": 1.0, "median": 2.0})


def test_verdicts_say_by_how_much() -> None:
    assert bench_report.at_most(0.4, 0.45, "0.45") == ("≤ 0.45", True)
    assert bench_report.at_most(0.9, 0.6, "0.6") == ("≤ 0.6, 50% over", False)
    assert bench_report.at_least(0.9, 0.9) == ("≥ 90%", True)
    assert bench_report.at_least(0.8, 0.9) == ("≥ 90%, 10.0 points short", False)


def test_report_in_three_forms() -> None:
    rows = (
        bench_report.Row("max |F|", "1 µs", "≤ 2 µs", True),
        bench_report.Row("other", "3 µs", "≤ 2 µs, 50% over", False),
        bench_report.Row("plain", "4"),
    )
    section = bench_report.Section("part", "A part", rows, {"numbers": [1.0]})
    machine = {"processor": "P", "cores": 2, "python": "3", "numba": "0"}
    report = bench_report.Report(machine, True, [section])
    assert [row.what for row in report.missed()] == ["other"]
    text = bench_report.as_text(section)
    assert "met: ≤ 2 µs" in text
    assert "MISSED: ≤ 2 µs, 50% over" in text
    data = json.loads(bench_report.as_json(report))
    assert (data["format"], data["version"], data["quick"]) == ("auxetic-sandbox bench", 1, True)
    assert data["sections"]["part"]["numbers"] == [1.0]
    assert data["sections"]["part"]["rows"][1] == {
        "what": "other",
        "measured": "3 µs",
        "target": "≤ 2 µs, 50% over",
        "met": False,
    }
    table = bench_report.as_markdown(report).splitlines()[2:]
    assert all(line.replace(r"\|", "").count("|") == 4 for line in table)
    assert bench_report.finite([1.0, math.nan, math.inf]) == [1.0, None, None]


# Soft discs.


def test_discs_file_comes_back(tmp_path: Path) -> None:
    discs = soft_discs.random_discs(40, 2)
    path = tmp_path / "discs.npz"
    soft_discs.write(path, discs)
    again = soft_discs.read(path)
    np.testing.assert_array_equal(again.x, discs.x)
    np.testing.assert_array_equal(again.radius, discs.radius)
    assert again.side == discs.side
    area = math.pi * float(np.sum(discs.radius**2))
    assert area / discs.side**2 == pytest.approx(soft_discs.PACKING_FRACTION)


def test_another_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "discs.npz"
    np.savez(path, x=np.zeros(3))
    with pytest.raises(InputError, match="not a file of soft discs"):
        soft_discs.read(path)


def test_soft_discs_are_relaxed_as_discs() -> None:
    discs = soft_discs.random_discs(60, 1)
    found = soft_discs.relax(discs)
    assert found.largest_force <= soft_discs.TOLERANCE
    assert found.energy < found.start_energy
    # The energy at the start by another program text, and no grain has changed its shape.
    energy, _, _ = DiscForces(discs)(discs.x, discs.y)
    assert found.start_energy == pytest.approx(energy / 60, rel=1e-12)


def test_forces_for_peers_are_the_slope_of_their_energy() -> None:
    discs = soft_discs.random_discs(30, 4)
    forces = DiscForces(discs)
    _, fx, fy = forces(discs.x, discs.y)
    step = 1e-6
    shift = np.zeros(30)
    shift[7] = step
    along = forces(discs.x + shift, discs.y)[0] - forces(discs.x - shift, discs.y)[0]
    up = forces(discs.x, discs.y + shift)[0] - forces(discs.x, discs.y - shift)[0]
    assert fx[7] == pytest.approx(-along / (2.0 * step), rel=1e-6, abs=1e-7)
    assert fy[7] == pytest.approx(-up / (2.0 * step), rel=1e-6, abs=1e-7)
    assert forces.evaluations == 5


RUN = {"who": "x", "start_energy": 0.5, "largest_force": 1e-9, "iterations": 10}


def test_missing_peers_are_named_and_others_compared() -> None:
    own = [{**RUN, "seconds": s} for s in (1.0, 2.0)]
    other = [{**RUN, "seconds": s, "iterations": 5} for s in (2.0, 1.0)]
    section = bench_peers.judged(
        own, {"lammps": other, "ase": [{"missing": "ase is not installed"}]}
    )
    rows = {row.what: row for row in section.rows}
    assert rows["ASE FIRE"].measured == "not run: ase is not installed"
    assert section.data["missing"] == {"ase": "ase is not installed"}
    assert rows["this program / LAMMPS, an iteration"].met is True
    assert rows["this program / LAMMPS, the whole"].met is False
    assert "67% over" in rows["this program / LAMMPS, the whole"].target


def test_peers_that_solve_another_problem_are_found_out() -> None:
    own = [{**RUN, "seconds": 1.0} for _ in range(2)]
    other = [own[0], {**RUN, "start_energy": 0.6, "seconds": 1.0}]
    section = bench_peers.judged(own, {"scipy": other})
    assert any("differs" in row.measured and row.met is False for row in section.rows)


@pytest.mark.parametrize("name", list(bench_peers.NAMES))
def test_each_peer_solves_the_file_or_says_what_is_missing(name: str, tmp_path: Path) -> None:
    discs = soft_discs.random_discs(60, 1)
    path = tmp_path / "discs.npz"
    soft_discs.write(path, discs)
    runs = bench_peers.ask(name, path, 1)
    assert len(runs) == 1
    if "missing" in runs[0]:
        assert name in runs[0]["missing"] or "mpich" in runs[0]["missing"]
        assert "\n" not in runs[0]["missing"]
    else:
        assert runs[0]["start_energy"] == pytest.approx(soft_discs.relax(discs).start_energy)
        assert runs[0]["largest_force"] <= 1e-6


# Growth.


def test_copies_lie_side_by_side() -> None:
    seed = pack(Recipe("mixed"), seed=1, count=60, packing_fraction=0.8)
    assert seed.box is not None
    whole = bench_scaling.tiled(seed, 3, 2, np.random.default_rng(1))
    assert len(whole) == 360
    assert whole.box is not None
    assert (whole.box.width, whole.box.height) == (3 * seed.box.width, 2 * seed.box.height)
    for name in ("rest_radius", "poisson_ratio", "contact_stiffness"):
        np.testing.assert_array_equal(
            getattr(whole, name).reshape(6, 60), np.tile(getattr(seed, name), (6, 1))
        )
    last = whole.state[:2, 300:] - seed.state[:2]
    assert last[0] == pytest.approx(2 * seed.box.width, abs=bench_scaling.NOISE)
    assert last[1] == pytest.approx(seed.box.height, abs=bench_scaling.NOISE)


def test_an_increment_that_is_cut_short_says_so() -> None:
    seed = pack(Recipe("mixed"), seed=1, count=100, packing_fraction=0.9)
    found = bench_scaling.increment(seed.copy(), 60.0)
    assert found["ended"] == "converged"
    assert found["residual"] <= 1e-2
    assert bench_scaling.increment(seed.copy(), -1.0)["ended"] == "out of time"


def test_tiles_make_the_numbers_they_stand_for() -> None:
    for count, (columns, rows) in bench_scaling.TILES.items():
        assert count == bench_scaling.SEED_GRAINS * columns * rows
    assert set(bench_scaling.QUICK) < set(bench_scaling.TILES)


def test_an_increment_keeps_to_its_room() -> None:
    """A kilobyte a grain at its peak: forces, lists and what is measured at the end are not all there at once."""
    seed = pack(Recipe("mixed"), seed=1, count=500, packing_fraction=0.9)
    used = bench_scaling.memory(2_000, seed)
    assert used["arrays_bytes"] < used["peak_bytes"] < bench_scaling.BYTES


def test_bytes_of_nested_arrays() -> None:
    assert bench_scaling._bytes([np.zeros(3), (np.zeros(2), (1.0, np.zeros(1, np.uint32)))]) == 44


# Threads.


@pytest.mark.slow
@pytest.mark.skipif(most_threads() < 2, reason="this machine has one core")
def test_two_threads_are_timed_beside_one() -> None:
    section = bench_threads.section(seconds=0.3, sizes=(2_000,))
    (one,) = section.data["sizes"]
    assert one["same_bits"]
    assert one["ratio"] == pytest.approx(one["several_us"]["min"] / one["one_us"]["min"])
    (row,) = section.rows
    assert "N = 2000" in row.what
    assert (row.target, row.met) == ("the same bits", True)


def test_a_machine_with_one_core_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_threads, "most_threads", lambda: 1)
    section = bench_threads.section(seconds=1.0)
    assert [row.measured for row in section.rows] == ["this machine has one core"]


def test_other_bits_are_a_miss() -> None:
    assert bench_threads._same(bits=False)[1] is False


# Frames.


def test_drag_runs_to_the_end_of_the_script() -> None:
    settings = {"grains": 120, "stroke": 0.5, "intruder_radius": 2.0, "step": bench_frames.STEP}
    session = Session("intruder", "mixed", 1, settings)
    session.build()
    found = bench_frames.drag(session, 1000, budget=1000.0)
    assert len(found.residuals) == len(found.iterations) == len(found.seconds) == 10
    assert found.late == 0
    assert found.share == 1.0
    assert found.middle <= session.settings["tolerance"]


def test_a_drag_without_time_still_finishes_its_increments() -> None:
    settings = {"grains": 120, "stroke": 0.5, "intruder_radius": 2.0}
    hashes = []
    for budget in (0.0, 1000.0):
        session = Session("intruder", "mixed", 1, settings)
        session.build()
        found = bench_frames.drag(session, 5, budget=budget)
        assert len(found.residuals) == 5
        hashes.append(session.state_hash())
    assert hashes[0] == hashes[1]


@pytest.mark.parametrize(
    ("left", "seconds", "iterations", "expected"),
    [
        (10e-3, 0.0, 0, bench_frames.LEAST_SLICE),  # nothing is known of the pace yet
        (10e-3, 1e-3, 1000, bench_frames.SLICE),  # plenty of time: no more than a slice
        (1e-3, 1e-3, 100, 100),
        (1e-6, 1e-3, 100, bench_frames.LEAST_SLICE),
    ],
)
def test_slices_get_shorter_as_the_budget_runs_out(
    left: float, seconds: float, iterations: int, expected: int
) -> None:
    assert bench_frames.slice_that_fits(left, seconds, iterations) == expected


def test_shares_count_nan_as_worst() -> None:
    found = bench_frames.Drag(1, (1e-3, math.nan, 2e-2, 5e-2), (1,) * 4, (0.0,) * 4, 1)
    assert found.share == 0.5
    assert found.middle == pytest.approx(0.035)


def test_targets_of_the_intruder() -> None:
    small, large, *others = bench_frames.cases()
    assert (small.settings["grains"], small.share, small.middle) == (300, 0.90, 1e-2)
    assert (large.settings["grains"], large.share) == (600, 0.75)
    assert "hopper" in [case.scene for case in others]


def test_scenes_of_few_grains_are_left_out() -> None:
    case = bench_frames.Case("intruder", {"grains": 50, "intruder_radius": 0.5}, 0.9, 1e-2)
    section = bench_frames.section(frames=2, selected=[case])
    for drag in section.data["drags"]:
        assert drag["grains"] >= bench_frames.LEAST
        assert drag["frames"] == len(drag["residuals"]) == 2
    assert len(section.rows) == len(section.data["drags"])


# Pictures and start-up.


def test_drawing_looks_at_a_frame_with_forces() -> None:
    section = bench_drawing.section(seconds=0.01, grains=250)
    assert all(section.data[name]["contacts"] > 50 for name in ("draw", "side by side"))
    assert [row.met is not None for row in section.rows] == [True, True]


@pytest.mark.end_to_end
def test_first_frame_tells_its_milestones_in_order() -> None:
    run = bench_startup.first_frame("intruder")
    marks = list(run["marks"].values())
    assert list(run["marks"]) == [
        "imported",
        "solver kernels",
        "built",
        "drawing kernels",
        "first frame",
    ]
    assert marks == sorted(marks)
    assert marks[-1] <= run["seconds"]


def seen_at(speed: float, moved: int, turn: float | None = 0.03) -> bench_smoothness.Seen:
    drags = [
        {"depth": 0, "due": 100, "moved": 50, "rate": 60.0, "turn": None},
        {"depth": 6, "due": 100, "moved": moved, "rate": 58.0, "turn": turn},
    ]
    return bench_smoothness.Seen(speed, (*drags, *drags))


def test_slower_hands_are_tried_where_nothing_is_aimed_at(monkeypatch: pytest.MonkeyPatch) -> None:
    shares = dict(zip(bench_smoothness.SPEEDS, (80, 96, 99), strict=True))

    def watch(_: object, speed: float, **__: float) -> bench_smoothness.Seen:
        return seen_at(speed, shares[speed])

    monkeypatch.setattr(bench_smoothness, "watch", watch)
    free = bench_smoothness.Case("hopper", "mixed", 300, aimed=False)
    aimed = bench_smoothness.Case("intruder", "regular", 300)
    assert [s.speed for s in bench_smoothness.measure(free, seconds=1.0, rounds=2)] == [3.0, 2.0]
    assert [s.speed for s in bench_smoothness.measure(aimed, seconds=1.0, rounds=2)] == [3.0]
    section = bench_smoothness.section(seconds=1.0, rounds=2, selected=[aimed, free])
    assert [row.met for row in section.rows] == [False, None, None]
    assert section.rows[0].target == "≥ 95%, 15.0 points short"
    assert section.rows[0].measured == (
        "80% (50% without working ahead), 58 to 60 pictures/s, a turn seen within 30 ms"
    )
    json.dumps(section.data, allow_nan=False)


def test_a_turn_that_was_not_seen_is_no_good_one() -> None:
    assert seen_at(3.0, 99).turn == pytest.approx(30.0)
    assert seen_at(3.0, 99, None).turn == math.inf


def test_pictures_a_second_are_judged_by_the_middle_of_the_drags(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[dict[str, object]] = []

    def dragged(**case: object) -> list[dict[str, object]]:
        asked.append(case)
        return [{"rate": rate} for rate in (61.0, 38.0, 58.0)]

    monkeypatch.setattr(bench_pictures, "dragged", dragged)
    section = bench_pictures.section(seconds=1.0, rounds=2)
    assert [row.met for row in section.rows] == [False, False, False, True]
    assert section.rows[-1].what == "intruder, 600 grains, auxetic, 2560×1440"
    assert section.rows[-1].measured == "58 (38 to 61)"
    assert [case["size"] for case in asked] == [case.size for case in bench_pictures.CASES]
    json.dumps(section.data, allow_nan=False)

"""The study of stability: cases judged, invariants that do find what is wrong, reports, and the command."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from core.packing import Packing, PeriodicBox
from core.relaxation import StopReason
from core.rigid import RigidBody, RigidWorld
from sandbox.cli import main as cli
from sandbox.ensemble.pool import Stopped
from sandbox.studies.stability import report as stability_report
from sandbox.studies.stability import rigs as stability_rigs
from sandbox.studies.stability import study as stability
from sandbox.studies.stability.case import (
    CRASHED,
    FAILS,
    HOLDS,
    NOT_SOLVED,
    REFUSED,
    SOLVED,
    TIME_LIMIT,
    Act,
    Case,
    Outcome,
    carry_out,
)
from sandbox.studies.stability.watch import Watch, balance, reported, soundness

LIGHT = ("one grain between two plates", "packings that make no sense", "tolerance")


def case(act: Act, **changes: object) -> Case:
    return replace(Case("group", "name", "expectation", act), **changes)  # type: ignore[arg-type]


def quiet(watch: Watch) -> None:
    stability_rigs.Rig(stability_rigs.engine(Packing([0.0], [0.0]))).rest(watch)


def raises(error: Exception) -> Act:
    def act(watch: Watch) -> None:
        raise error

    return act


def starved(watch: Watch) -> None:
    packing = Packing([0.0, 1.0], [0.0, 0.0])
    solver = stability_rigs.settings(max_iterations=2, tolerance=1e-9)
    stability_rigs.Rig(stability_rigs.engine(packing, solver=solver)).rest(watch)


@pytest.mark.parametrize(
    ("act", "ended", "verdict"),
    [
        (quiet, SOLVED, HOLDS),
        (starved, StopReason.ITERATION_LIMIT, NOT_SOLVED),
        (raises(InputError("no")), REFUSED, FAILS),
        (raises(ZeroDivisionError("no")), CRASHED, FAILS),
        (lambda watch: watch.expect("too much", 2.0, 1.0), SOLVED, FAILS),
        (lambda watch: watch.expect("nan", math.nan, 1.0), SOLVED, FAILS),
    ],
)
def test_verdicts(act: Act, ended: str, verdict: str) -> None:
    outcome = carry_out(case(act))
    assert (outcome.ended, outcome.verdict) == (ended, verdict)


def test_what_is_allowed_holds_and_two_lines_never_do() -> None:
    refused = case(raises(InputError("no")), allowed=(REFUSED,), named=())
    assert carry_out(refused).verdict == HOLDS
    assert carry_out(replace(refused, act=quiet)).verdict == FAILS
    assert carry_out(replace(refused, act=raises(InputError("no\nno")))).verdict == FAILS
    assert carry_out(case(starved, named=())).verdict == FAILS


def test_a_case_that_takes_too_long_is_stopped_and_the_study_can_be() -> None:
    def forever(watch: Watch) -> None:
        while True:
            watch.check_time()

    assert carry_out(case(forever, seconds=0.05)).ended == TIME_LIMIT
    with pytest.raises(Stopped):
        carry_out(case(forever), stopping=lambda: True)


def broken(looks: list, name: str) -> bool:  # type: ignore[type-arg]
    return any(not look.holds and name in look.name for look in looks)


@pytest.mark.parametrize(
    ("change", "name"),
    [
        (lambda p: p.state.__setitem__((0, 0), math.nan), "not finite"),
        (lambda p: p.state.__setitem__((3, 0), 1.5), "without width"),
        (lambda p: p.state.__setitem__((1, 0), -5.0), "outside"),
        (lambda p: p.state.__setitem__((1, 0), -0.3), "in a body"),
        (lambda p: p.state.__setitem__((1, 0), 3.2), "in a body"),
    ],
)
def test_unsound_states_are_seen(change: Callable[[Packing], None], name: str) -> None:
    packing = Packing([2.0], [1.0])
    world, outline = stability_rigs.walls(4.0, 3.0)
    assert all(look.holds for look in soundness(packing, world, outline))
    change(packing)
    assert broken(soundness(packing, world, outline), name)


def test_energy_gained_and_forces_out_of_balance_are_seen() -> None:
    world = RigidWorld([RigidBody("floor", segments=[(-9.0, -0.5, 9.0, -0.5, 0.5)])])
    packing = Packing([0.0, 1.9], [0.99, 0.99])
    packing.set_axes([1.1, 1.0], [0.9, 1.0], 0.3)
    engine = stability_rigs.engine(packing, world, gravity=(0.0, -0.05))
    watch = Watch(10.0)
    done = watch.step(engine)
    assert not watch.broken
    assert all(look.holds for look in [*reported(done), *balance(engine, done)])
    gained = replace(done, report=replace(done.report, energy=done.report.start_energy + 1e-6))
    assert broken(reported(gained), "energy")
    unfelt = replace(done, reactions=done.reactions * 0.99)
    assert broken(balance(engine, unfelt), "out of balance")
    bodies = done.body_contacts
    pushed = replace(bodies, fx=bodies.fx + 0.01)
    assert broken(balance(engine, replace(done, body_contacts=pushed)), "asymmetry")


def test_there_are_enough_cases_and_every_one_has_its_name_and_expectation() -> None:
    cases = stability.all_cases()
    quick = stability.all_cases(quick=True)
    assert len(quick) >= 200
    assert set(quick) < set(cases)
    generated = sum(1 for part in stability.PARTS for _ in part.cases())
    assert generated == len(cases), "two cases have the same name"
    assert all(case.expectation and case.seconds <= 900.0 for case in cases.values())


def test_light_cases_hold() -> None:
    chosen = [c for c in stability.all_cases().values() if c.group in LIGHT]
    for one in chosen[::7]:
        outcome = carry_out(one, quick=True)
        assert outcome.verdict in (HOLDS, NOT_SOLVED), outcome


def test_a_small_study_is_written_resumed_and_drawn(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    cases = [c for c in stability.all_cases().values() if c.group == LIGHT[1]][:3]
    done = stability.study(tmp_path, quick=True, jobs=1, warm=False, cases=cases[:2])
    assert not done.interrupted
    assert [o.verdict for o in done.outcomes] == [HOLDS] * 2
    assert sorted(p.name for p in tmp_path.iterdir()) == ["results.json", "stability.md"]
    data = json.loads((tmp_path / "results.json").read_text())
    assert data["verdicts"] == {HOLDS: 2}
    assert Outcome.from_data(data["cases"][0]) == done.outcomes[0]
    # What an interrupted study leaves is not done again, damaged lines are.
    kept = tmp_path / stability.UNFINISHED
    stability._keep(kept, replace(done.outcomes[0], message="kept"), True)
    kept.write_text(kept.read_text() + '{"version": 1}\n[1]\n{"half": ')
    again = stability.study(tmp_path, quick=True, jobs=1, warm=False, cases=cases)
    assert [o.message == "kept" for o in again.outcomes] == [True, False, False]
    assert not kept.exists()


def test_the_report_lists_what_is_not_solved_by_name_and_the_figures_are_pictures(
    tmp_path: Path,
) -> None:
    pytest.importorskip("matplotlib")
    import imageio.v2

    one = Outcome("group", "a | b", "all well", SOLVED, "", HOLDS, 4, 400, 0.1, 0)
    outcomes = [
        replace(one, place=("regular", 0.8, c), name=f"C = {c}", iterations=int(40 * c**0.5))
        for c in (3.0, 50.0, 1e3)
    ]
    outcomes += [replace(o, place=("auxetic", -0.8, o.place[2])) for o in outcomes if o.place]
    outcomes += [replace(o, place=("mixed", 0.8, o.place[2])) for o in outcomes[:3] if o.place]
    unsolved = replace(one, ended="iteration limit", message="2 of 4", verdict=NOT_SOLVED)
    failed = replace(one, name="bad", verdict=FAILS, broken=("x: 2, allowed 1",), share=math.inf)
    outcomes += [unsolved, failed]
    text = stability_report.as_markdown(outcomes, {})
    assert "- group: a \\| b: iteration limit (2 of 4)" in text
    assert "- group: bad: solved; x: 2, allowed 1" in text
    heads = 2  # names of the columns, and the line below them
    assert sum(line.startswith("| ") for line in text.splitlines()) == heads + len(outcomes)
    stability_report.draw(outcomes, tmp_path)
    for name in ("fig-map.png", "fig-stiffness.png"):
        assert np.asarray(imageio.v2.imread(tmp_path / name)).std() > 5.0
    json.loads(stability_report.as_json(outcomes, {}))


def test_mistakes_are_told_before_any_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("mine")
    assert cli.main(["study", "stability", "--out", str(tmp_path / "file")]) == 2
    assert cli.main(["study", "stability", "--out", str(tmp_path), "--only", "x"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 2
    assert "belongs to study paper" in said


def test_periodic_cells_are_no_walls() -> None:
    packing = Packing([20.0], [-7.0], box=PeriodicBox(9.0, 9.0))
    square = [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)]
    assert all(look.holds for look in soundness(packing, RigidWorld(), square))

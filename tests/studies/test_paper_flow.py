"""Hopper and intruder of the paper, judged on runs made by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("scipy")

from sandbox.studies.common.verdicts import FAILS, HOLDS, OPEN
from sandbox.studies.paper import hopper, intruder
from sandbox.studies.paper.claims import Unmeasurable
from sandbox.studies.paper.runs import Request, Result
from tests.studies.paper_results import SEEDS, noise, pushes, result, value, verdicts


def test_hopper_counts_what_locks() -> None:
    runs = pushes(
        {"regular": 5.0, "auxetic": 0.8, "mixed": 1.2},
        {"regular": 1.0, "auxetic": 0.0, "mixed": 0.1},
    )
    assert set(verdicts("hopper", runs).values()) == {HOLDS}
    reading = hopper.locks("regular", hopper.DEFAULT)(runs)
    assert reading.remark == "40 of 40 locked"
    assert reading.estimate.interval()[0] == pytest.approx(0.912, abs=1e-3)


def test_hopper_does_not_say_more_than_it_shows() -> None:
    """All alike: nothing locks more often than anything, and half of all is no verdict on most of them."""
    same = dict.fromkeys(hopper.KINDS, 0.5)
    found = verdicts("hopper", pushes(dict.fromkeys(hopper.KINDS, 2.0), same))
    assert found["the rings clog"] == OPEN
    assert found["metagrains flow"] == OPEN
    assert found["rings clog more often than auxetic, hand of 8 k R"] == OPEN
    assert found["more force for rings than for auxetic"] == OPEN
    assert found["a large build up of force: much more than for mixed"] == FAILS


def test_hopper_leaves_out_runs_that_ended_early_unless_they_are_many() -> None:
    forces = {"regular": 5.0, "auxetic": 0.8, "mixed": 1.2}
    runs = pushes(forces, dict.fromkeys(hopper.KINDS, 0.0))
    mixed = [k for k, r in enumerate(runs) if r.request.packing == "mixed" and not r.lists]
    runs[mixed[0]] = replace(runs[mixed[0]], ended="a grain was squeezed flat")
    reading = hopper.force_over(hopper.peak, "regular", "mixed")(runs)
    assert "1 mixed of 120 runs" in reading.remark
    for k in mixed[:30]:
        runs[k] = replace(runs[k], ended="the same")
    with pytest.raises(Unmeasurable, match="only 10 of 40 mixed runs"):
        hopper.force_over(hopper.peak, "regular", "auxetic")(runs)


def test_a_run_that_ended_early_leaves_the_figure_whole() -> None:
    runs = pushes({"regular": 5.0, "auxetic": 0.8, "mixed": 1.2}, dict.fromkeys(hopper.KINDS, 0.0))
    k = next(k for k, r in enumerate(runs) if r.request.packing == "mixed")
    short = {name: values[:40] for name, values in runs[k].columns.items()}
    runs[k] = replace(runs[k], columns=short, ended="a grain was squeezed flat")
    one, mean, locked = hopper.hopper_panels(runs)
    assert [len(line.x) for line in one.lines] == [101, 101, 40]
    assert [len(line.x) for line in mean.lines] == [101, 101, 101]
    assert all(len(line.x) == len(line.y) for p in (one, mean, locked) for line in p.lines)


def test_hopper_avalanches_and_no_friction() -> None:
    runs = pushes({"regular": 5.0, "auxetic": 0.8, "mixed": 1.2}, dict.fromkeys(hopper.KINDS, 0.0))
    machine = [r for r in runs if not r.lists]
    assert set(verdicts("hopper_mixture", machine).values()) == {HOLDS}
    weak = pushes(dict.fromkeys(hopper.KINDS, 0.004), dict.fromkeys(hopper.KINDS, 0.0))
    assert set(verdicts("hopper_no_friction", [r for r in weak if not r.lists]).values()) == {HOLDS}
    assert set(verdicts("hopper_no_friction", machine).values()) == {FAILS}


def drags(regular: float, auxetic: float, mixed: float) -> list[Result]:
    """Intruder runs with a sawtooth between 0.5 and 1.5 of a mean force."""
    made = []
    for kind, force in (("regular", regular), ("auxetic", auxetic), ("mixed", mixed)):
        for seed in SEEDS:
            saw = 0.5 + (np.arange(400) % 5) / 4.0
            forces = noise(seed) * force * saw
            made.append(
                result(Request("intruder", kind, seed), stroke=np.arange(400) * 0.05, force=forces)
            )
    return made


def test_drag_and_drops_of_the_intruder() -> None:
    runs = drags(0.8, 0.2, 0.3)
    assert value(intruder.over(intruder.drag, "regular", "auxetic"), runs) == pytest.approx(4.0)
    assert value(intruder.over(intruder.mean_drop, "regular", "mixed"), runs) == pytest.approx(
        0.8 / 0.3
    )
    assert value(intruder.mixture_on_the_way, runs) == pytest.approx(1.0 / 6.0)
    assert set(verdicts("intruder_drag", runs).values()) == {HOLDS}
    assert set(verdicts("intruder_drops", runs).values()) == {HOLDS}
    assert verdicts("intruder_mixture", runs) == {
        "nearer to the metagrains than to the rings": HOLDS,
        "almost the same drag": FAILS,  # half as much again
        "larger fluctuations than metagrains": HOLDS,
    }
    assert set(verdicts("intruder_drag", drags(0.2, 0.3, 0.3)).values()) == {FAILS}
    far = verdicts("intruder_mixture", drags(0.8, 0.2, 0.7))
    assert far["nearer to the metagrains than to the rings"] == FAILS

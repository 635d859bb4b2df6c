"""Curves of earlier runs: kept once, named, bounded, exported to the last bit."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np

from sandbox.files.table import write_csv
from sandbox.session.frame import Frame
from sandbox.window.solvers.kept_curves import MOST, Curves, CurveTable, automatic_name
from sandbox.words import language
from tests.draw.frames import curve, intruder_frame


def frame(packing: str = "mixed", seed: int = 1, points: int = 30, **changes: object) -> Frame:
    stroke, force = curve(points, seed)
    settings = {"auxetic_poisson_ratio": -0.8, **changes}
    return replace(
        intruder_frame(6, packing, seed),
        curve_stroke=stroke,
        curve_force=force,
        settings=settings,  # type: ignore[arg-type]
    )


def test_a_name_says_what_is_otherwise() -> None:
    curves = Curves()
    curves.keep(frame())
    curves.keep(frame("auxetic", auxetic_poisson_ratio=-0.5))
    names = [kept.name for kept in curves.entries]
    assert names[0] == "mixed · seed 1"
    assert names[1].startswith("auxetic · seed 1 · ")
    assert names[1].endswith("−0.5")


def test_a_name_has_the_numbers_of_its_language() -> None:
    with language.speaking("de"):
        name = automatic_name(frame(auxetic_poisson_ratio=-0.5))
    assert name.endswith("−0,5")


def test_what_is_no_curve_is_not_kept() -> None:
    curves = Curves()
    still = replace(frame(), curve_stroke=np.zeros(1), curve_force=np.ones(1))
    assert curves.keep(None) is None
    assert curves.keep(still) is None
    assert curves.keep(replace(still, curve_stroke=np.zeros(5), curve_force=np.ones(5))) is None
    assert curves.entries == ()


def test_the_same_run_again_is_kept_once() -> None:
    curves = Curves()
    whole = frame(points=30)
    part = replace(whole, curve_stroke=whole.curve_stroke[:9], curve_force=whole.curve_force[:9])
    first = curves.keep(part)
    assert first is not None
    assert curves.keep(whole) is first
    assert first.stroke.shape == (30,)
    assert curves.keep(part) is None
    assert len(curves.entries) == 1
    other = replace(whole, curve_force=whole.curve_force + 1.0)
    assert curves.keep(other) is not None
    assert [kept.name for kept in curves.entries] == ["mixed · seed 1", "mixed · seed 1 (2)"]


def test_the_oldest_of_a_scene_go() -> None:
    curves = Curves()
    curves.keep(replace(frame(), scene="hopper"))
    for seed in range(1, MOST + 4):
        curves.keep(frame(seed=seed))
    assert [kept.seed for kept in curves.of("intruder")] == list(range(4, MOST + 4))
    assert len(curves.of("hopper")) == 1


def test_hidden_foreign_and_deleted_ones_are_not_drawn() -> None:
    curves = Curves()
    keys = [curves.keep(frame(seed=seed)).key for seed in (1, 2, 3)]  # type: ignore[union-attr]
    curves.keep(replace(frame(), curve_label="something else"))
    curves.toggle(keys[0])
    curves.delete(keys[1])
    assert [kept.key for kept in curves.shown(frame())] == [keys[2]]
    curves.toggle(keys[0])
    assert len(curves.shown(frame())) == 2
    curves.clear("hopper")
    assert len(curves.entries) == 3
    curves.clear()
    assert not curves.entries


def test_names_stay_different_and_never_empty() -> None:
    curves = Curves()
    first, second = (curves.keep(frame(seed=seed)) for seed in (1, 2))
    assert first is not None
    assert second is not None
    curves.rename(first.key, "  hard   floor ")
    curves.rename(second.key, "hard floor")
    curves.rename(first.key, "   ")
    assert (first.name, second.name) == ("hard floor", "hard floor (2)")
    curves.rename(first.key, "x" * 500)
    assert len(first.name) < 100


def test_the_table_reads_back_to_the_same_bits(tmp_path: Path) -> None:
    curves = Curves()
    kept = curves.keep(frame("auxetic", seed=2))
    assert kept is not None
    kept.name = 'a "name", with signs'
    now = [frame("regular"), frame("mixed")]
    write_csv(tmp_path / "x.csv", CurveTable(now, curves.entries))
    rows = list(csv.reader((tmp_path / "x.csv").read_text().splitlines()))
    assert rows[0][-2:] == ["stroke [R]", "force on the intruder [k R]"]
    assert [row[1] for row in rows[1:]] == ["present"] * 60 + ["earlier"] * 30
    assert rows[-1][:5] == [kept.name, "earlier", "intruder", "auxetic", "2"]
    assert [float(row[-1]) for row in rows[1:31]] == now[0].curve_force.tolist()
    assert [int(row[-3]) for row in rows[61:]] == list(range(30))

"""What was predicted goes into a table, whole lines, without names, times of day, or anything that a spreadsheet would run."""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from sandbox.cli.main import main
from sandbox.lessons import answers as answers_of
from sandbox.lessons.answers import COLUMNS, Answers, at_columns, mean_distance
from sandbox.lessons.lesson import Lesson, Predict, Said, Step
from tests.draw.frames import intruder_frame

ASK = Said({"en": "?"})
CHOICE = Step("pick", ASK, predict=Predict("choice", ASK, (ASK, ASK), right=1.0))
NUMBER = Step("guess", ASK, predict=Predict("number", ASK, right=3.0, within=0.5, unit="k R"))
SKETCH = Step("draw", ASK, predict=Predict("sketch", ASK, axes=(0.0, 2.0, 0.0, 1.0)))
LESSON = Lesson("=cmd|' /C calc'!A1", "intruder", (CHOICE, NUMBER, SKETCH))


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_a_row_for_each_prediction(tmp_path: Path) -> None:
    answers = Answers(tmp_path / "all.csv")
    answers.predicted(LESSON, CHOICE, 0.0)
    answers.predicted(LESSON, NUMBER, 3.25)
    along, up = np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.25, 0.5])
    answers.predicted(LESSON, SKETCH, (along, up))
    frame = replace(
        intruder_frame(6), curve_stroke=np.array([0.0, 0.75]), curve_force=np.array([0.0, 1.5])
    )
    answers.measured(LESSON, SKETCH, (along, up), [frame])
    answers.measured(LESSON, NUMBER, 3.25, [frame])  # nothing: it says itself what is right
    for step in (CHOICE, NUMBER, SKETCH):
        answers.predicted(LESSON, step, None)
    found = rows(tmp_path / "all.csv")
    assert [(row["step"], row["what"], row["given"], row["right"]) for row in found] == [
        ("pick", "predicted", "1", "no"),
        ("guess", "predicted", "3.25", "yes"),
        ("draw", "predicted", "0:0 0.5:0.25 1:0.5", ""),
        ("draw", "measured", "0:0 0.5:1", ""),
        ("pick", "no guess", "", ""),
        ("guess", "no guess", "", ""),
        ("draw", "no guess", "", ""),
    ]
    assert {tuple(row) for row in found} == {COLUMNS}
    for row in found:
        assert re.fullmatch(r"\d{4}-\d\d-\d\d", row["date"])
        assert not any(cell.startswith(("=", "+", "-", "@")) for cell in row.values())


def test_a_row_says_whether_the_answer_had_been_shown(tmp_path: Path) -> None:
    """Of this step, in this sitting: another one has not seen it."""
    answers, others = Answers(tmp_path / "all.csv"), Answers(tmp_path / "all.csv")
    answers.predicted(LESSON, CHOICE, None)
    answers.shown(LESSON, CHOICE)
    answers.predicted(LESSON, CHOICE, 1.0)
    answers.predicted(LESSON, CHOICE, None)
    answers.predicted(LESSON, NUMBER, 3.0)
    others.predicted(LESSON, CHOICE, 1.0)
    found = [(row["step"], row["what"], row["when"]) for row in rows(tmp_path / "all.csv")]
    assert found == [
        ("pick", "no guess", "before"),
        ("pick", "predicted", "after"),
        ("pick", "no guess", "after"),
        ("guess", "predicted", "before"),
        ("pick", "predicted", "before"),
    ]


def test_columns_are_described() -> None:
    """In the room's README, and what can stand in them."""
    text = (Path(answers_of.__file__).parent / "README.md").read_text(encoding="utf-8")
    table = [line for line in text.splitlines() if line.startswith("| `")]
    named = [name for line in table for name in re.findall(r"`([a-z]+)`", line.split("|")[1])]
    at = named.index(COLUMNS[0])
    assert tuple(named[at : at + len(COLUMNS)]) == COLUMNS
    for value in ("predicted", "no guess", "measured", "before", "after", "yes", "no"):
        assert f"`{value}`" in text


def test_sittings_are_told_apart_and_files_go_on(tmp_path: Path) -> None:
    path = tmp_path / "all.csv"
    for _ in range(2):
        Answers(path).predicted(LESSON, CHOICE, 1.0)
    path.write_bytes(path.read_bytes() + b"2026-01-01,half a li")  # a program that was killed
    Answers(path).predicted(LESSON, CHOICE, 1.0)
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines.count(",".join(COLUMNS)) == 1
    assert len(lines) == 5
    assert len({lines[k].split(",")[1] for k in (1, 2, 4)}) == 3


def test_another_table_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "marks.csv"
    path.write_text("name,mark\n", encoding="utf-8")
    with pytest.raises(InputError, match="no table of answers"):
        Answers(path)
    assert main(["play", "hopper", "--answers", str(path)]) == 2
    assert re.fullmatch(r"error: .*marks\.csv: this is no table.*\n", capsys.readouterr().err)
    assert path.read_text(encoding="utf-8") == "name,mark\n"


def test_what_cannot_be_written_waits(tmp_path: Path) -> None:
    path = tmp_path / "gone" / "all.csv"
    answers = Answers(path)
    answers.predicted(LESSON, CHOICE, 1.0)
    assert "all.csv" in answers.trouble
    path.parent.mkdir()
    answers.predicted(LESSON, NUMBER, 1.0)
    assert answers.trouble == ""
    assert [row["step"] for row in rows(path)] == ["pick", "guess"]


def test_without_a_file_nothing_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Answers().predicted(LESSON, CHOICE, 1.0)
    assert list(tmp_path.iterdir()) == []


def test_a_curve_that_goes_back_counts_where_it_was_first() -> None:
    stroke = np.array([0.0, 1.0, 0.5, 1.0, 2.0])
    force = np.array([0.0, 1.0, 9.0, 5.0, 4.0])
    found = at_columns(stroke, force, np.array([-1.0, 0.5, 1.0, 2.0, 3.0]))
    assert np.array_equal(found, [np.nan, 0.5, 1.0, 4.0, np.nan], equal_nan=True)
    assert np.isnan(at_columns(np.zeros(1), np.zeros(1), np.zeros(2))).all()


def test_the_mean_distance_is_that_where_both_are() -> None:
    stroke, force = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 2.0])
    along = np.array([-1.0, 0.0, 1.0, 2.0, 3.0])
    assert mean_distance(stroke, force, along, np.array([9.0, 0.0, 1.5, np.nan, 9.0])) == 0.25
    assert mean_distance(stroke, force, along, np.array([9.0, 1.0, 0.0, 3.0, 9.0])) == 1.0
    nothing = mean_distance(stroke, force, along, np.array([9.0, np.nan, np.nan, np.nan, 9.0]))
    assert np.isnan(nothing)
    assert np.isnan(mean_distance(stroke[:1], force[:1], along, np.ones(5)))


@pytest.mark.parametrize("right", [0.1, 1.1, 7.3, -0.7, 120.1])
def test_a_number_at_the_edge_of_what_is_right_is_right(right: float) -> None:
    """As somebody reckons with decimals, not as a machine does."""
    for within in (0.1, 0.2, 0.3):
        predict = Predict("number", Said({"en": "How much?"}), right=right, within=within)
        for given in (round(right - within, 1), round(right + within, 1)):
            assert predict.is_right(given)
            beyond = given + (0.001 if given > right else -0.001)
            assert not predict.is_right(beyond)

"""What the page about notebooks shows is run, line by line, and what it shows is what the command line would make."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError
from sandbox.notebook import Result, run
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from tests.test_layering import loaded_after

REPOSITORY = Path(__file__).parents[2]
PAGE = (REPOSITORY / "sandbox" / "notebook" / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.+?)```", PAGE, re.DOTALL)


def test_the_page_is_true(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    cell: dict[str, object] = {}
    for block in BLOCKS:
        if "pandas" not in block:
            exec(block, cell)
    result = cell["result"]
    assert isinstance(result, Result)
    assert len(result.table["increment"]) == len(result.frames) == 61
    film = cell["film"]
    assert isinstance(film, list)
    assert {image.shape for image in film} == {(360, 640, 3)}
    shown = result._repr_html_()
    assert shown.startswith("<iframe srcdoc=")
    assert shown.count("<") == 2  # all of the page is in quotes
    assert Path("run.html").read_text(encoding="utf-8").startswith("<!doctype html>")


def test_pandas_has_the_same_columns() -> None:
    pandas = pytest.importorskip("pandas")
    result = run("single_grain", steps=3)
    frame = result.table.to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == result.session.table.header()
    assert len(frame) == 4


def test_a_run_is_that_of_a_session(capsys: pytest.CaptureFixture[str]) -> None:
    result = run("grain_row", "auxetic", 2, steps=7, every=3, progress=True, gap=0.1)
    session = Session("grain_row", "auxetic", 2, {"gap": 0.1})
    session.build()
    session.submit(Protocol(True))
    while session.finished < 7:
        session.advance(1_000)
    assert result.session.state_hash() == session.state_hash()
    assert [frame.increment for frame in result.frames] == [0, 3, 6, 7]
    np.testing.assert_array_equal(
        result.table[session.frame().curve_label], session.frame().curve_force
    )
    assert "7/7" in capsys.readouterr().err


@pytest.mark.parametrize("wrong", [{"steps": -3}, {"steps": 2.5}, {"every": 0}, {"every": "x"}])
def test_counts_are_whole_numbers(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="must be a whole number from"):
        run("single_grain", **wrong)


def test_the_package_is_light() -> None:
    assert not loaded_after("import sandbox") & {"numpy", "numba", "pygame", "tqdm"}
    assert "pandas" not in loaded_after("import sandbox.notebook")

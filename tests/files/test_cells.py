"""What a person types goes into tables as text, whatever a spreadsheet might make of it."""

from __future__ import annotations

import ast
import csv
import io
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.files import cells
from sandbox.files.table import PLAIN, Spelling, for_excel

SANDBOX = Path(__file__).parents[2] / "sandbox"
FORMULAS = ("=1+1", "+1+1", "-2+3", "@SUM(A1)", "\t=1", "\r=1", "'=1+1", "''-", "-0.5:1 0:2")


@pytest.mark.parametrize("text", FORMULAS)
@pytest.mark.parametrize("separator", [",", ";"])
def test_no_cell_begins_as_a_formula_does(text: str, separator: str) -> None:
    lines = cells.lines([[text, "b"]], separator)
    ((cell, _),) = csv.reader(io.StringIO(lines, newline=""), delimiter=separator)
    assert cell == "'" + text
    assert cells.read(lines, separator) == [[text, "b"]]


@pytest.mark.parametrize("value", ["-1", "+2.5", "-1,5", "-.5e-07", "-inf", -1.5, -3, "'s", "a=b"])
def test_numbers_and_plain_texts_stay_as_they_are(value: object) -> None:
    assert cells.lines([[value]], "\t") == f"{value}\n"


@given(st.lists(st.text("'=+-@\t\r\n\"; a1,.e"), min_size=2))
def test_what_is_read_is_what_was_written(row: list[str]) -> None:
    assert cells.read(cells.lines([row])) == [row]


@pytest.mark.parametrize("spelling", [PLAIN, for_excel(",", str)])
def test_tables_for_programs_and_for_excel_alike(spelling: Spelling) -> None:
    written = spelling.lines([["=1+1", -1.5]]).decode()
    assert written.startswith("'=1+1")
    assert written.rstrip()[6:] in ("-1.5", "-1,5")


OTHER_WRITERS = ("writer", "DictWriter", "to_csv", "savetxt")


def test_nobody_else_writes_tables() -> None:
    for path in sorted(SANDBOX.rglob("*.py")):
        tree = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        found = {node.attr for node in tree if isinstance(node, ast.Attribute)} & {*OTHER_WRITERS}
        assert not found or path == SANDBOX / "files/cells.py", path

"""Columns of a run's table that not every run has."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sandbox.session.commands import DrawWall, Grab, Move
from sandbox.session.history import History
from sandbox.session.session import Session
from sandbox.session.table import RunTable


def test_drawn_walls_have_columns_once_they_are_pushed_and_bear_their_part() -> None:
    session = Session("workshop", "regular", 1, {"grains": 30, "width": 12.0, "height": 10.0})
    session.build()
    before = session.table.header()
    # In front of the disc; then it is dragged against the grains between.
    session.submit(DrawWall(((8.0, 0.0), (8.0, 9.5))))
    session.submit(Grab("intruder"))
    session.submit(Move("intruder", 11.0, 5.0))
    while not session.history.drawn_upon:
        assert session.advance(10_000) or not session.idle
    table = session.table
    assert table.header() == [
        *before,
        "force of the grains on drawn walls, x [k R]",
        "force of the grains on drawn walls, y [k R]",
    ]
    forces = np.array(list(table.rows())[-1][len(before) - 4 :], float).reshape(-1, 2)
    assert len(forces) == 3  # walls, disc, drawn walls
    assert np.any(forces[-1])
    left = session.run.last.unbalanced.sum()
    assert np.hypot(*forces.sum(axis=0)) <= left * (1.0 + 1e-9) + 1e-12


def test_rows_of_an_older_program_do_not_know_the_forces_on_walls() -> None:
    session = Session("single_grain", "regular", 1)
    session.build()
    old = replace(session.history[0], on_solids=())
    history = History.of([old, session.history[0]], ())
    first, second = RunTable(session.run.setup, history).rows()
    assert [math.isnan(value) for value in first[-4:]] == [True] * 4  # type: ignore[arg-type]
    assert not any(map(math.isnan, second[-4:]))  # type: ignore[arg-type]
    column = history.column("on_solids")
    assert column.shape == (2, 4)
    assert np.all(np.isnan(column[0]))

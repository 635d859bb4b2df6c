"""One grain and a few of the paper, judged on runs made by hand."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("scipy")

from sandbox.studies.common.verdicts import FAILS, HOLDS
from sandbox.studies.paper import grains
from sandbox.studies.paper.runs import Request, Result
from tests.studies.paper_results import result, value, verdicts


def test_row_of_grains() -> None:
    def row(kind: str, sideways: float) -> Result:
        down = np.array([0.0, 1.0, 2.0])
        return result(Request("grain_row", kind), force=sideways * down, down=down)

    assert set(verdicts("grain_row", [row("regular", 0.7), row("auxetic", 0.0)]).values()) == {
        HOLDS
    }
    pushed = verdicts("grain_row", [row("regular", 0.7), row("auxetic", 0.1)])
    assert pushed["auxetic grains never do"] == FAILS


def test_overlap_factor_knows_the_true_expansion() -> None:
    """Fed with the paper's own factor of 5 the claim holds; with the true −3 it does not."""

    def ellipses(exact: float) -> list[Result]:
        made = []
        for aspect in grains.ASPECTS:
            stretch, tilt = aspect - 1.0, np.array([0.0, 45.0])
            bend = stretch**2 * (1.0 - np.cos(np.deg2rad(4.0 * tilt))) / 16.0
            first = 2.0 + 2.0 * stretch * np.cos(np.deg2rad(tilt)) ** 2
            made.append(
                result(
                    Request("two_ellipses", "regular", settings=(("aspect", aspect),)),
                    stroke=tilt,
                    a=[aspect, aspect],
                    b=[1.0, 1.0],
                    exact_distance=first + exact * bend,
                    model_distance=first + 2.0 * bend,
                )
            )
        return made

    says = "a difference by a factor of 5"
    assert verdicts("overlap_factor", ellipses(10.0))[says] == HOLDS
    assert verdicts("overlap_factor", ellipses(-6.0))[says] == FAILS
    assert value(grains.overlap_factor, ellipses(-6.0)) == pytest.approx(-3.0)

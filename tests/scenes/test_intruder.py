"""The paper's claim for the intruder, on a box a third as large and a drag a third as long as the scene's own."""

from __future__ import annotations

import numpy as np
import pytest

from core.observables import force_drops
from sandbox.session.commands import Protocol
from sandbox.session.session import Session
from scenes.scene import STRONGEST

STROKE = 7.0  # [R]: three and a half diameters, some ten force drops


@pytest.fixture(scope="module")
def drags() -> dict[str, np.ndarray]:
    """Drag force [k R] along the stroke for each packing, same seed and geometry."""
    curves = {}
    for packing in ("regular", "mixed", "auxetic"):
        settings = {"grains": 300, "stroke": STROKE, "hand_strength": STRONGEST}
        session = Session("intruder", packing, 1, settings)
        session.build()
        session.submit(Protocol(True))
        while not session.idle:
            session.advance(2_000)
        curves[packing] = session.history.column("resisting")
        assert session.history[-1].stroke == pytest.approx(STROKE, abs=1e-6)
        assert all(check.holds for check in session.checks())
    return curves


def test_auxetic_grains_are_easier_to_drag_through(drags: dict[str, np.ndarray]) -> None:
    mean = {packing: force.mean() for packing, force in drags.items()}
    assert mean["regular"] > mean["mixed"] >= mean["auxetic"]
    # Measured over seeds 1 to 4: 6.2, 6.2, 5.7, 5.1.
    assert mean["regular"] >= 2.0 * mean["auxetic"]


def test_auxetic_grains_let_force_chains_break_gently(drags: dict[str, np.ndarray]) -> None:
    drop = {packing: force_drops(force).mean() for packing, force in drags.items()}
    assert drop["regular"] > drop["mixed"] > drop["auxetic"]

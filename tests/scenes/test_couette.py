"""The shear cell: its geometry, its protocols, and the stresses of regular and auxetic packings (Figs. 3 and 4 of the paper)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core.shear import shear_modulus
from sandbox.session.commands import Grab, Move, Protocol
from sandbox.session.session import Session
from scenes import registry
from scenes.couette import plate_stresses

SMALLEST = 160


def cell(kind: str = "mixed", **settings: object) -> Session:
    session = Session("couette", kind, 1, {"grains": SMALLEST, **settings})
    session.build()
    return session


def sheared(kind: str, **settings: object) -> np.ndarray:
    """Rows of (shear strain, shear stress [k], normal stress [k]) along the scripted drive."""
    session = cell(kind, **settings)
    session.submit(Protocol(True))
    rows = []
    while True:
        run = session.run
        box = run.setup.packing.box
        assert box is not None
        stresses = plate_stresses(run.setup.world, box.width, run.last)
        rows.append((session.history[-1].stroke, *stresses))
        while not session.advance(20_000):
            if session.idle:
                assert not [check for check in session.checks() if check.holds is False]
                return np.array(rows)


def test_plates_have_notches_in_which_one_large_grain_fits() -> None:
    session = cell()
    setup = session.run.setup
    assert setup.packing.box is not None
    assert len(setup.packing) == SMALLEST
    assert setup.packing.box.width == SMALLEST / 8.0  # 800 grains: 100 R
    lower = np.array(setup.world["lower plate"].discs)
    assert np.all(lower[:, 2] == 1.0 / 3.5)
    assert len(lower) == 4 * SMALLEST // 16
    # A large grain in the first notch touches all of its discs, from tip to tip.
    seat = 1.0 + 1.0 / 3.5
    height = math.sqrt(seat**2 - 1.0)
    distance = np.hypot(lower[:5, 0] - 1.0, lower[:5, 1] - height)
    assert distance == pytest.approx(seat)
    # Neighbouring discs touch, so nothing slips between them.
    gap = np.hypot(*np.diff(lower[:, :2], axis=0).T) - 2.0 / 3.5
    assert np.all(np.abs(gap) < 0.01)


def test_protocols_go_as_far_as_they_say() -> None:
    scene = registry.get("couette")
    for protocol, amplitude in ((1, 0.002), (2, 0.04), (3, 2.0)):
        settings: dict[str, object] = {"protocol": protocol, "cycles": 1, "grains": SMALLEST}
        values = scene.settings(settings)
        session = Session("couette", "mixed", 1, settings)
        if protocol == 1:
            session.build()
            setup = session.run.setup
            top = setup.world["upper plate"]
        path = []
        for k in range(scene.steps(values) + 1):
            goal = scene.drive(setup, values, k)
            if goal is None:
                break
            path.append((goal["upper plate"][0] - top.home[0]) / top.home[1])
        assert len(path) == scene.steps(values)
        assert max(path) == pytest.approx(amplitude)
        assert min(path) == pytest.approx(-amplitude)
        assert path[-1] == pytest.approx(0.0, abs=1e-12)
        assert np.abs(np.diff(path)).max() * top.home[1] <= setup.solver.step * (1.0 + 1e-9)


def test_auxetic_packings_are_easier_to_shear_at_equal_volume() -> None:
    """Measured with 400 grains, seeds 1–3, packing fraction 0.88: G = 0.17 / 0.087 k; yield stress 0.0061 / 0.0012 k."""
    small: dict[str, object] = {"protocol": 1, "cycles": 1, "tolerance": 1e-4}
    regular, auxetic = sheared("regular", **small), sheared("auxetic", **small)
    assert shear_modulus(*regular[1:, :2].T) > 1.3 * shear_modulus(*auxetic[1:, :2].T) > 0.0
    assert regular[:, 2].mean() > 3.0 * auxetic[:, 2].mean()


@pytest.mark.slow
def test_friction_of_the_flow_does_not_depend_on_the_kind_of_grains() -> None:
    """Measured with 400 grains, strain 0.3 to 1, seeds 1 and 2: τ/P = 0.084, 0.081 regular, 0.074, 0.081 auxetic."""
    ratios = {}
    for kind in ("regular", "auxetic"):
        rows = sheared(kind, strain=0.8, grains=240, step=0.08)
        flow = rows[rows[:, 0] > 0.2]
        ratios[kind] = flow[:, 1].mean() / flow[:, 2].mean()
        assert 0.04 < ratios[kind] < 0.14
    assert ratios["regular"] == pytest.approx(ratios["auxetic"], abs=0.04)


def test_a_plate_goes_round_under_the_hand() -> None:
    session = cell(step=0.15, tolerance=0.1)
    box = session.run.setup.packing.box
    assert box is not None
    top = session.run.setup.world["upper plate"]
    session.submit(Grab("upper plate"))
    for _ in range(3):
        shown = session.frame().handles[0]
        session.submit(Move("upper plate", shown.x + 0.3 * box.width, shown.y))
        while not session.idle:
            session.advance(20_000)
            shown = session.frame().handles[0]
            assert 0.0 <= shown.x < box.width
    assert top.position[0] - top.home[0] == pytest.approx(0.9 * box.width, abs=1e-6)
    frame = session.frame()
    assert frame.bodies[1].discs[:, 0].min() >= 0.0
    assert frame.bodies[1].discs[:, 0].max() < box.width
    assert frame.x.min() >= 0.0
    assert frame.x.max() < box.width

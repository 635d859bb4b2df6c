"""What the columns of a table say, held against what they must be: as plot and export have it, and as found by other ways."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from numpy.typing import NDArray

from sandbox.session.frame import Frame
from sandbox.session.session import Session
from sandbox.window.solvers.kept_curves import CurveTable

Columns = Mapping[str, NDArray[np.float64]]
Expected = Callable[[Session, Columns], float]  # of the newest row


def check_table(session: Session) -> None:
    """The table of a run agrees with plot and export, with the third law, and with what can be measured otherwise."""
    table, frame = session.table, session.frame()
    named = zip(table.header(), zip(*table.rows(), strict=True), strict=True)
    columns = {name: np.array(values, float) for name, values in named if name != "stop reason"}
    assert len(columns) == len(table.header()) - 1
    assert columns[frame.stroke_label].tolist() == frame.curve_stroke.tolist()
    assert columns[frame.curve_label].tolist() == frame.curve_force.tolist()
    export = CurveTable([frame], [])
    assert export.header()[-2:] == table.header()[1:3] == [frame.stroke_label, frame.curve_label]
    assert list(export.rows())[-1][-2:] == list(table.rows())[-1][1:3]
    bodies = [body.name for body in session.run.setup.solids]
    on_bodies = np.sum([[on(session, columns, body, axis) for axis in "xy"] for body in bodies], 0)
    if session.run.setup.gravity is not None:
        assert on_bodies[1] < 0.0  # they bear weight
    else:  # nothing but what the grains do not hold among themselves
        left = float(session.run.last.unbalanced.sum())
        assert np.hypot(*np.broadcast_to(on_bodies, 2)) <= left * (1.0 + 1e-9) + 1e-12
    told = {name or frame.curve_label: what for name, what in TOLD.get(frame.scene, FELT).items()}
    where = f"{frame.scene} in TOLD of tests/scenes/told.py"
    missing = sorted(set(told) - set(columns))
    assert not missing or frame.scene in TOLD, f"no entry for {where}"
    assert not missing, f"no columns {missing} for {where}"
    for name, expected in told.items():
        found = expected(session, columns)
        assert columns[name][-1] == pytest.approx(found, rel=1e-9, abs=1e-12), name


def on(session: Session, columns: Columns, body: str, axis: str) -> float:
    """Force of the grains on a body in the newest row [k R]."""
    labels = {handle.body: handle.label for handle in session.run.setup.handles}
    return float(columns[f"force of the grains on {labels.get(body, body)}, {axis} [k R]"][-1])


def way(session: Session, body: str) -> tuple[float, float]:
    """From where it first stood [R]."""
    moved = session.run.setup.world[body]
    return moved.position[0] - moved.home[0], moved.position[1] - moved.home[1]


def stroke(session: Session, _: Columns) -> float:
    """The script of these goes straight on."""
    return math.hypot(*way(session, session.run.setup.handles[0].body))


def felt(session: Session, columns: Columns) -> float:
    """By the columns of the handle, against the drive."""
    handle, along = session.run.setup.handles[0].body, session.run.course.direction
    return -sum(along[k] * on(session, columns, handle, axis) for k, axis in enumerate("xy"))


def side(session: Session) -> tuple[float, float]:
    """Of the square under the lid, whose faces stand at 45° to its way: at the start and now [R]."""
    whole = math.sqrt(2.0) * float(session.run.setup.outline[1][0])
    return whole, whole + way(session, "lid")[1] / math.sqrt(2.0)


def cell(frame: Frame) -> tuple[float, float, float]:
    """Width, height and shift of the periodic cell [R]."""
    assert frame.box is not None
    return frame.box


def across(session: Session, *, shear: bool) -> float:
    """Shear stress or pressure [k] of all contacts, from force and branch."""
    pairs, (width, height, _) = session.run.last.grain_contacts, cell(session.frame())
    if shear:
        return 0.5 * float(pairs.fx @ pairs.dy + pairs.fy @ pairs.dx) / (width * height)
    return -0.5 * float(pairs.fx @ pairs.dx + pairs.fy @ pairs.dy) / (width * height)


def tilt(session: Session, _: Columns) -> float:
    """Of the long axis of the left grain from the line to the right one [deg]."""
    frame = session.frame()
    line = math.atan2(frame.y[1] - frame.y[0], frame.x[1] - frame.x[0])
    return math.degrees(0.5 * math.atan2(frame.q2[0], frame.q1[0]) - line) % 180.0


FELT: Mapping[str, Expected] = {"stroke [R]": stroke, "": felt}  # "": whatever is plotted
TOLD: Mapping[str, Mapping[str, Expected]] = {
    "grain_row": {
        "compression [% of a diameter]": lambda s, _: -50.0 * way(s, "piston")[1],
        "sideways force on the walls [k R]": lambda s, c: (
            0.5 * (on(s, c, "right wall", "x") - on(s, c, "left wall", "x"))
        ),
    },
    "biaxial_press": {
        "less area [%]": lambda s, _: 100.0 * (1.0 - (side(s)[1] / side(s)[0]) ** 2),
        "pressure [k]": lambda s, c: on(s, c, "lid", "y") / (math.sqrt(2.0) * side(s)[1]),
    },
    "biaxial_periodic": {
        "volumetric strain −ε_v": lambda s, _: (
            1.0 - math.prod(cell(s.frame())[:2]) / (s.frame().bounds[2] - 1.0) ** 2
        ),
        "pressure [k]": lambda s, _: across(s, shear=False),
    },
    "couette": {
        "shear strain": lambda s, _: (
            way(s, "upper plate")[0] / s.run.setup.world["upper plate"].home[1]
        ),
        "shear stress [k]": lambda s, c: -on(s, c, "upper plate", "x") / cell(s.frame())[0],
    },
    "avalanches": {
        "shear strain": lambda s, _: cell(s.frame())[2] / cell(s.frame())[1],
        "shear stress [k]": lambda s, _: across(s, shear=True),
    },
    "two_ellipses": {"tilt of the left grain [deg]": tilt},
    "gravity_hopper": {
        "increments": lambda s, _: len(s.history) - 1.0,
        "grains that have left": lambda s, c: float(s.frame().grains_out),
    },
}

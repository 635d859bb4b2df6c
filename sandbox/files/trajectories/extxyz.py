"""Grains as extended XYZ, which OVITO, ASE and many a script read: a block of lines a frame.

Of grains: species (Re: regular, Au: auxetic, signs of elements since readers want such), pos [R], id (stays with one for life),
radius (at rest [R]), aspherical_shape (semi-axes [R]) and orientation (quaternion x, y, z, w) as OVITO names them, kind (0
regular, 1 auxetic), poisson_ratio, pressure [k], stress_difference [k], displacement (in the latest increment [R]), spin [rad].

In the comment line: the cell, the increment, what the scene plots with its unit, energy [k R²], and where the frame is from. The
plane is z = 0. Where a cell is open it is as wide as the view.
https://docs.ovito.org/reference/file_formats/input/xyz.html
"""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path
from typing import BinaryIO

import numpy as np

from core.files import atomic_write
from sandbox.files.trajectories.state import State

_PROPERTIES = (
    "species:S:1:pos:R:3:id:I:1:radius:R:1:aspherical_shape:R:3:orientation:R:4:kind:I:1:poisson_ratio:R:1:"
    "pressure:R:1:stress_difference:R:1:displacement:R:3:spin:R:1"
)
_SPECIES = ("Re", "Au")


class ExtendedXYZ:
    """Writes blocks one after another, aside until the end."""

    def __init__(self, path: Path, aside: BinaryIO) -> None:
        self._path, self._aside = path, aside

    def write(self, state: State) -> None:
        """One frame."""
        frame, (long, short), half = state.frame, state.axes, 0.5 * state.angle
        zero = np.zeros(frame.grains)
        columns = [
            np.take(_SPECIES, frame.auxetic.astype(int)),
            *(frame.x, frame.y, zero, frame.label, frame.rest_radius),
            *(long, short, frame.p),
            *(zero, zero, np.sin(half), np.cos(half)),
            *(frame.auxetic.astype(int), frame.poisson_ratio),
            *(frame.pressure, frame.stress_difference),
            *(*frame.motion, zero, state.spin),
        ]
        rows = zip(*(column.tolist() for column in columns), strict=True)
        lines = [str(frame.grains), _comment(state), *(" ".join(map(str, row)) for row in rows)]
        self._aside.write("\n".join([*lines, ""]).encode())

    def finish(self) -> None:
        """All frames into the file."""
        self._aside.seek(0)
        with atomic_write(self._path) as file:
            shutil.copyfileobj(self._aside, file)


def _comment(state: State) -> str:
    frame = state.frame
    cell, origin, periodic = _cell(state)
    said = {
        "Lattice": " ".join(map(str, cell)),
        "Origin": " ".join(map(str, origin)),
        "Properties": _PROPERTIES,
        "pbc": " ".join("T" if p else "F" for p in periodic),
        "increment": frame.increment,
        "plotted_along": frame.stroke_label,
        "along": state.row.stroke,
        "plotted": frame.curve_label,
        "value": state.row.resisting,
        "energy_kR2": state.row.energy,
        "grains_out": state.row.grains_out,
        "scene": frame.scene,
        "packing": frame.packing,
        "seed": frame.seed,
    }
    words = (f"{key}={_word(value)}" for key, value in said.items())
    return " ".join(words)


def _word(value: object) -> str:
    """In quotes where there is a blank."""
    text = str(value)
    return json.dumps(text, ensure_ascii=False) if " " in text else text


def _cell(state: State) -> tuple[list[float], list[float], tuple[bool, bool, bool]]:
    """Three vectors, where they start, and along which of them the cell repeats itself."""
    x0, y0, x1, y1 = state.frame.bounds
    width, height, shift = (math.inf, math.inf, 0.0) if state.frame.box is None else state.frame.box
    periodic = math.isfinite(width), math.isfinite(height), False
    if periodic[0]:
        x0, x1 = 0.0, width
    if periodic[1]:
        y0, y1 = 0.0, height
    else:
        shift = 0.0
    thick = 2.0 * float(state.frame.p.max(initial=0.5))
    cell = [x1 - x0, 0.0, 0.0, shift, y1 - y0, 0.0, 0.0, 0.0, thick]
    return [float(v) for v in cell], [float(x0), float(y0), -0.5 * thick], periodic

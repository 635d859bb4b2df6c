"""Frames as VTK PolyData for ParaView: three VTP files a frame, and a PVD file that names them all with their increments.

- grains: the outline of each, a polygon. Of cells: id (stays with one for life), kind (0 regular, 1 auxetic), poisson_ratio,
  rest_radius [R], pressure [k], stress_difference [k], displacement (in the latest increment [R]), spin [rad].
- contacts: a line each, from centre to centre or to where a body is touched. Of cells: force on the first grain, friction
  included [k R], normal_force and tangential_force [k R], first and second (ids of the grains, -1: a body), body (place among
  the frame's bodies, -1: a grain). Of points: normal_force once more, for tubes as wide as the force.
- bodies: their shapes, a polygon each. Of cells: body.

Numbers are of double precision, in base64. https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

from __future__ import annotations

import base64
import hashlib
import os
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.files import atomic_write
from sandbox.files.trajectories.state import State

CORNERS = 32  # of a grain's outline, and of a disc's
_TYPES = {"f": "Float64", "i": "Int64"}
LONGEST = 60  # letters of a folder's name that are those of the PVD file
_ODD = re.compile(r"[^\w. -]")  # what XML spells otherwise, or not at all
_PART = re.compile(r'file="([^"/]+-[0-9a-f]{8})/((?:grains|contacts|bodies)-\d{6}\.vtp)"')


@dataclass(frozen=True)
class _Part:
    increment: int
    number: int  # of grains, contacts, bodies
    name: str  # of the file
    size: int  # [bytes]


class ParaView:
    """Keeps the files of all frames aside until the end; then they go into a folder, and the PVD file beside it."""

    def __init__(self, path: Path, aside: BinaryIO) -> None:
        """``path``: where the PVD file goes; ``aside`` is for what is not finished yet."""
        self._path, self._aside = path, aside
        self._digest = hashlib.sha256()
        self._parts: list[_Part] = []

    def write(self, state: State) -> None:
        """One frame."""
        number = len(self._parts) // 3
        files = {"grains": _grains(state), "contacts": _contacts(state), "bodies": _bodies(state)}
        for part, (name, content) in enumerate(files.items()):
            file = f"{name}-{number:06d}.vtp"
            self._aside.write(content)
            self._digest.update(content)
            self._parts.append(_Part(state.frame.increment, part, file, len(content)))

    def finish(self) -> None:
        """All files, and last the one that names them: until then the earlier one is there, and what it names."""
        name = _ODD.sub("_", self._path.stem)[:LONGEST]
        if name != self._path.stem:  # others may be called the same now
            self._digest.update(os.fsencode(self._path.stem))
        folder = self._path.with_name(f"{name}-{self._digest.hexdigest()[:8]}")
        folder.mkdir(exist_ok=True)
        self._aside.seek(0)
        for part in self._parts:
            (folder / part.name).write_bytes(self._aside.read(part.size))
        earlier = _named_in(self._path)
        named = "\n".join(
            f"<DataSet timestep={quoteattr(str(part.increment))} part={quoteattr(str(part.number))} "
            f"file={quoteattr(f'{folder.name}/{part.name}')}/>"
            for part in self._parts
        )
        with atomic_write(self._path) as file:
            file.write(_document("Collection", f"<Collection>\n{named}\n</Collection>"))
        for path in sorted(earlier - {folder / part.name for part in self._parts}):
            with suppress(OSError):
                path.unlink()
                path.parent.rmdir()  # after the last one


def _named_in(path: Path) -> set[Path]:
    """The files that an earlier run has left, as its PVD file names them."""
    try:
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
    except (OSError, ValueError):
        return set()
    return {path.with_name(folder) / name for folder, name in _PART.findall(text)}


def _grains(state: State) -> bytes:
    frame = state.frame
    data = {
        "id": frame.label,
        "kind": frame.auxetic.astype(np.int64),
        "poisson_ratio": frame.poisson_ratio,
        "rest_radius": frame.rest_radius,
        "pressure": frame.pressure,
        "stress_difference": frame.stress_difference,
        "displacement": _in_space(frame.motion.T),
        "spin": state.spin,
    }
    (long, short), angle = state.axes[:, :, None], state.angle[:, None]
    around = np.linspace(0.0, 2.0 * np.pi, CORNERS, endpoint=False)
    along, across = long * np.cos(around), short * np.sin(around)
    x = frame.x[:, None] + along * np.cos(angle) - across * np.sin(angle)
    y = frame.y[:, None] + along * np.sin(angle) + across * np.cos(angle)
    outlines = np.stack([x, y], axis=2)
    return _poly_data(polygons=list(outlines), cells=data)


def _contacts(state: State) -> bytes:
    lines, forces, label = state.frame.contacts, state.forces, state.frame.label
    ends = np.stack([lines.x0, lines.y0, lines.x1, lines.y1], axis=1).reshape(-1, 2, 2)
    data = {
        "force": _in_space(np.column_stack([forces.fx, forces.fy])),
        "normal_force": forces.normal,
        "tangential_force": forces.tangential,
        "first": label[lines.i],
        "second": np.where(lines.j < 0, -1, np.append(label, -1)[lines.j]),
        "body": forces.body,
    }
    points = {"normal_force": np.repeat(forces.normal, 2)}
    return _poly_data(lines=list(ends), cells=data, points=points)


def _bodies(state: State) -> bytes:
    outlines, numbers = [], []
    for number, body in enumerate(state.frame.bodies):
        own = [
            *body.polygons,
            *(_capsule(x, y, x, y, radius) for x, y, radius in body.discs),
            *(_capsule(*row) for row in body.segments),
        ]
        outlines += own
        numbers += [number] * len(own)
    return _poly_data(polygons=outlines, cells={"body": np.array(numbers, dtype=np.int64)})


def _capsule(x0: float, y0: float, x1: float, y1: float, radius: float) -> Floats:
    """The outline of all that is as near to a line as ``radius``: half a circle around each end, (n, 2) [R]."""
    half = np.linspace(-0.5 * np.pi, 0.5 * np.pi, CORNERS // 2 + 1)
    turn = np.arctan2(y1 - y0, x1 - x0) + np.concatenate([half, np.pi + half])
    ends = np.repeat([[x1, y1], [x0, y0]], len(half), axis=0)
    return ends + radius * np.column_stack([np.cos(turn), np.sin(turn)])


def _in_space(plane: Floats) -> Floats:
    """(n, 2) → (n, 3)."""
    return np.column_stack([plane, np.zeros(len(plane))])


def _poly_data(
    *,
    cells: Mapping[str, NDArray[Any]],
    points: Mapping[str, NDArray[Any]] | None = None,
    lines: Sequence[Floats] = (),
    polygons: Sequence[Floats] = (),
) -> bytes:
    """A VTP file. ``lines`` and ``polygons`` are corners (n, 2) [R] each; arrays go by cells, lines first, or by points."""
    corners = [*lines, *polygons]
    places = np.concatenate(corners) if corners else np.zeros((0, 2))
    parts, first = [], 0
    for name, kind in (("Lines", lines), ("Polys", polygons)):
        ends = np.cumsum([len(one) for one in kind], dtype=np.int64)
        count = int(ends[-1]) if len(ends) else 0
        parts.append(
            f"<{name}>{_array('connectivity', first + np.arange(count))}{_array('offsets', ends)}</{name}>"
        )
        first += count
    by_cell = "".join(_array(name, values) for name, values in cells.items())
    by_point = "".join(_array(name, values) for name, values in (points or {}).items())
    content = (
        f'<Piece NumberOfPoints="{len(places)}" NumberOfVerts="0" NumberOfLines="{len(lines)}" '
        f'NumberOfStrips="0" NumberOfPolys="{len(polygons)}">'
        f"<PointData>{by_point}</PointData><CellData>{by_cell}</CellData>"
        f"<Points>{_array('Points', _in_space(places))}</Points>{''.join(parts)}</Piece>"
    )
    return _document("PolyData", f"<PolyData>{content}</PolyData>")


def _document(kind: str, content: str) -> bytes:
    head = f'type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64"'
    return f'<?xml version="1.0"?>\n<VTKFile {head}>\n{content}\n</VTKFile>\n'.encode()


def _array(name: str, values: NDArray[Any]) -> str:
    content = np.ascontiguousarray(values, dtype=f"<{values.dtype.kind}8").tobytes()
    coded = base64.b64encode(len(content).to_bytes(8, "little") + content).decode()
    several = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    kind = _TYPES[values.dtype.kind]
    return f'<DataArray type="{kind}" Name="{name}"{several} format="binary">{coded}</DataArray>\n'

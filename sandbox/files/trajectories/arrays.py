"""All frames as NumPy arrays in one NPZ file: plain numbers and texts, which ``np.load(FILE)`` reads without any pickle.

The F frames have N grains and C contacts each, as many as there are: their arrays follow one another, and those of frame k are
``x[grain_start[k] : grain_start[k + 1]]``, and so for contacts.

- Of the run: ``scene``, ``packing``, ``seed``, ``settings`` (JSON), ``stroke_label`` and ``force_label`` (what the scene plots,
  with units), ``bodies`` (B, names).
- Of frames, (F,): ``increment``, ``stroke`` and ``force`` (as the labels say), ``energy`` [k R²], ``residual``, ``grains_out``,
  ``converged``; ``box`` (F, 3) width, height and shift of a periodic cell [R], inf where it is open; ``grain_start`` and
  ``contact_start`` (F + 1,).
- Of grains: ``label`` (stays with one for life), ``x``, ``y`` [R], ``p``, ``q1``, ``q2`` (semi-axes p ± |q| [R], the long one
  at atan2(q2, q1) / 2), ``rest_radius`` [R], ``poisson_ratio``, ``pressure``, ``stress_difference`` [k], ``spin`` [rad].
- Of contacts: ``contact_i``, ``contact_j`` (places in the frame, -1: a body), ``contact_body`` (place in ``bodies``, -1: a
  grain), ``contact_line`` (C, 4) x0, y0, x1, y1 from centre to centre or to where a body is touched [R], ``contact_force``
  (C, 2) on grain i, on the other the opposite, friction included [k R], ``contact_normal`` and ``contact_tangential``, the
  sizes of normal force and friction [k R].
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.files import atomic_write
from sandbox.files.trajectories.state import State

_OF_GRAINS = (
    *("label", "x", "y", "p", "q1", "q2"),
    *("rest_radius", "poisson_ratio", "pressure", "stress_difference"),
)
_STARTS = ("grain_start", "contact_start")  # put aside as numbers of grains and contacts


class Arrays:
    """Puts what it is given aside piece by piece, as nobody knows how long the arrays get."""

    def __init__(self, path: Path, aside: BinaryIO) -> None:
        self._path, self._aside = path, aside
        self._growing: dict[str, _Growing] = {}
        self._bodies: list[str] = []
        self._latest: State | None = None

    def write(self, state: State) -> None:
        """One frame."""
        frame, row, forces, lines = state.frame, state.row, state.forces, state.frame.contacts
        self._latest = state
        names = [body.name for body in frame.bodies]
        self._bodies += [name for name in names if name not in self._bodies]
        place = np.array([*(self._bodies.index(name) for name in names), -1])
        of_frame: dict[str, ArrayLike] = {
            "increment": frame.increment,
            "stroke": float(row.stroke),
            "force": float(row.resisting),
            "energy": row.energy,
            "residual": row.residual,
            "grains_out": row.grains_out,
            "converged": frame.converged,
            "box": (np.inf, np.inf, 0.0) if frame.box is None else frame.box,
            "grain_start": frame.grains,
            "contact_start": len(lines),
        }
        for name, value in of_frame.items():
            self._put(name, np.array([value]))
        for name in _OF_GRAINS:
            self._put(name, getattr(frame, name))
        self._put("spin", state.spin)
        self._put("contact_i", lines.i)
        self._put("contact_j", lines.j)
        self._put("contact_body", place[forces.body])
        self._put("contact_line", np.column_stack([lines.x0, lines.y0, lines.x1, lines.y1]))
        self._put("contact_force", np.column_stack([forces.fx, forces.fy]))
        self._put("contact_normal", forces.normal)
        self._put("contact_tangential", forces.tangential)

    def _put(self, name: str, values: ArrayLike) -> None:
        part = np.ascontiguousarray(values)
        growing = self._growing.setdefault(name, _Growing(part.dtype, part.shape[1:]))
        content = part.astype(growing.kind, casting="safe").tobytes()
        growing.pieces.append((self._aside.tell(), len(content)))
        growing.length += len(part)
        self._aside.write(content)

    def finish(self) -> None:
        """All arrays into one file."""
        state = self._latest
        assert state is not None
        frame = state.frame
        about = {
            "scene": frame.scene,
            "packing": frame.packing,
            "seed": frame.seed,
            "settings": json.dumps(dict(frame.settings)),
            "stroke_label": frame.stroke_label,
            "force_label": frame.curve_label,
            "bodies": np.array(self._bodies, dtype=np.str_),
        }
        with (
            atomic_write(self._path) as file,
            zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive,
        ):
            for name, value in about.items():
                _entry(archive, name, np.asarray(value))
            for name, growing in self._growing.items():
                if name in _STARTS:
                    counts = np.frombuffer(b"".join(growing.read(self._aside)), growing.kind)
                    _entry(archive, name, np.concatenate([[0], np.cumsum(counts)]))
                else:
                    with archive.open(_info(name), "w", force_zip64=True) as entry:
                        entry.write(growing.head())
                        entry.writelines(growing.read(self._aside))


class _Growing:
    """An array that grows along its first axis, in pieces that lie in a file."""

    def __init__(self, kind: np.dtype[Any], rest: tuple[int, ...]) -> None:
        self.kind, self.rest, self.length = kind, rest, 0
        self.pieces: list[tuple[int, int]] = []  # where in the file, and how long [bytes]

    def head(self) -> bytes:
        """As of the whole in NumPy's format."""
        head = io.BytesIO()
        about = {
            "descr": np.lib.format.dtype_to_descr(self.kind),
            "fortran_order": False,
            "shape": (self.length, *self.rest),
        }
        np.lib.format.write_array_header_1_0(head, about)
        return head.getvalue()

    def read(self, aside: BinaryIO) -> Iterator[bytes]:
        """Its pieces, one after another."""
        for at, size in self.pieces:
            aside.seek(at)
            yield aside.read(size)


def _entry(archive: zipfile.ZipFile, name: str, array: NDArray[Any]) -> None:
    content = io.BytesIO()
    np.lib.format.write_array(content, array, allow_pickle=False)
    archive.writestr(_info(name), content.getvalue())


def _info(name: str) -> zipfile.ZipInfo:
    """An entry that has not the time of day."""
    info = zipfile.ZipInfo(f"{name}.npy")
    info.compress_type = zipfile.ZIP_DEFLATED
    return info

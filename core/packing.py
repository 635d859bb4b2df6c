"""The state of a packing: five degrees of freedom and three material numbers a grain.

A grain is an ellipse with semi-axes a ≥ b at an angle θ. Those are a bad chart: where a = b, and that is every grain at
rest, θ has no meaning. Stored instead are the mean semi-axis p = (a + b)/2 and the deviatoric stretch
(q1, q2) = (a − b)/2 · (cos 2θ, sin 2θ), which are smooth at the circle. See MODEL.md.
"""

from __future__ import annotations

import hashlib
import os
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Floats, twin
from core.errors import InputError
from core.files import atomic_write
from core.material import DEFAULT_CONTACT_STIFFNESS, check_material

FORMAT = "auxetic-sandbox packing"
FORMAT_VERSION = 1
MAX_GRAINS = 2_000_000
MAX_LENGTH = 1e9
MAX_LABEL = 2**30  # contacts are remembered by a number made of two labels
# What zipfile, zlib and numpy raise for damaged and for hostile files.
UNREADABLE = (
    ArithmeticError,
    EOFError,
    KeyError,
    MemoryError,
    OSError,
    RuntimeError,
    SyntaxError,
    TypeError,
    ValueError,
    struct.error,
    tokenize.TokenError,
    zipfile.BadZipFile,
    zlib.error,
)


@dataclass(frozen=True)
class PeriodicBox:
    """A periodic cell. A length of ``inf`` leaves that direction open.

    ``shift`` is the x offset between the cell and its image one ``height`` above (Lees and Edwards), for simple shear. [R]
    """

    width: float
    height: float = float("inf")
    shift: float = 0.0

    def __post_init__(self) -> None:
        if not (self.width > 0.0 and self.height > 0.0 and np.isfinite(self.shift)):
            raise InputError(
                "a periodic box needs a width and a height greater than 0 and a finite shift"
            )

    def kernel_form(self) -> tuple[float, float, float, float, float]:
        """(width, 1/width, height, 1/height, shift) with (0, 0) for an open direction, as the kernels want it."""
        width, inverse_width = (
            (self.width, 1.0 / self.width) if np.isfinite(self.width) else (0.0, 0.0)
        )
        height, inverse_height = (
            (self.height, 1.0 / self.height) if np.isfinite(self.height) else (0.0, 0.0)
        )
        return width, inverse_width, height, inverse_height, self.shift

    @property
    def area(self) -> float:
        """Area of the cell [R²]."""
        return self.width * self.height


class Packing:
    """N grains: ``state`` float64 (5, N) with rows x, y, p, q1, q2 [R], and per grain ``rest_radius`` [R],
    ``poisson_ratio``, ``contact_stiffness`` [k], float64 (N,), and ``label`` int64 (N,), which stays with a grain for life.
    """

    def __init__(
        self,
        x: ArrayLike,
        y: ArrayLike,
        rest_radius: ArrayLike = 1.0,
        poisson_ratio: ArrayLike = 0.0,
        contact_stiffness: ArrayLike = DEFAULT_CONTACT_STIFFNESS,
        *,
        box: PeriodicBox | None = None,
        label: ArrayLike | None = None,
    ) -> None:
        """Grains at rest (circles) at x, y [R]. Scalars are shared by all grains. Raises InputError on bad shapes or ranges."""
        x = np.atleast_1d(np.asarray(x, dtype=np.float64))
        if x.ndim != 1:
            raise InputError("grain positions must be one-dimensional arrays")
        count = x.size

        def per_grain(value: ArrayLike, name: str) -> Floats:
            array = np.asarray(value, dtype=np.float64)
            if array.ndim == 0:
                array = np.full(count, array)
            if array.shape != (count,):
                raise InputError(
                    f"{name} must be one number or {count} numbers, one a grain; got shape {array.shape}"
                )
            return np.array(array)

        self.rest_radius = per_grain(rest_radius, "rest_radius")
        self.poisson_ratio = per_grain(poisson_ratio, "poisson_ratio")
        self.contact_stiffness = per_grain(contact_stiffness, "contact_stiffness")
        self.state: Floats = np.zeros((5, count))
        self.state[0] = x
        self.state[1] = per_grain(y, "y")
        self.state[2] = self.rest_radius
        self.label: NDArray[np.int64] = (
            np.arange(count) if label is None else np.array(label, dtype=np.int64)
        )
        self.box = box
        self.validate()

    def validate(self) -> None:
        """Raise InputError unless all shapes and ranges are right and everything is finite."""
        count = self.state.shape[-1]
        if count > MAX_GRAINS:
            raise InputError(f"{count} grains are more than this program holds ({MAX_GRAINS})")
        if self.state.shape != (5, count) or self.label.shape != (count,):
            raise InputError("a packing's arrays disagree about the number of grains")
        if not np.all((self.rest_radius > 1e-6) & (self.rest_radius < MAX_LENGTH)):
            raise InputError("rest radii must be greater than 1e-6 R and finite")
        if not np.all(np.isfinite(self.state)) or np.any(np.abs(self.state) > MAX_LENGTH):
            raise InputError(
                f"grain positions and shapes must be finite and within ±{MAX_LENGTH:g} R"
            )
        if np.unique(self.label).size != count:
            raise InputError("grain labels must differ from one another")
        if np.any((self.label < 0) | (self.label >= MAX_LABEL)):
            raise InputError(f"grain labels must be from 0 to {MAX_LABEL - 1}")
        check_material(self.poisson_ratio, self.contact_stiffness)

    def __len__(self) -> int:
        return int(self.state.shape[1])

    def __repr__(self) -> str:
        return f"Packing({len(self)} grains, {int(self.auxetic.sum())} auxetic)"

    x = property(lambda self: self.state[0], doc="Centres, x [R], (N,), a view.")
    y = property(lambda self: self.state[1], doc="Centres, y [R], (N,), a view.")
    p = property(lambda self: self.state[2], doc="Mean semi-axes (a + b)/2 [R], (N,), a view.")
    q1 = property(lambda self: self.state[3], doc="(a − b)/2 · cos 2θ [R], (N,), a view.")
    q2 = property(lambda self: self.state[4], doc="(a − b)/2 · sin 2θ [R], (N,), a view.")

    @property
    def semi_axes(self) -> tuple[Floats, Floats]:
        """(a, b) with a ≥ b [R], each (N,). b ≤ 0 means a collapsed grain."""
        deviation = np.hypot(self.state[3], self.state[4])
        return self.state[2] + deviation, self.state[2] - deviation

    @property
    def angle(self) -> Floats:
        """Angle θ of the longer axis in [−π/2, π/2] [rad], (N,); 0 for a circle."""
        q1, q2 = self.state[3:] + 0.0  # of −0, too, the angle is 0
        angle: Floats = 0.5 * np.arctan2(q2, q1)
        return angle

    @property
    def auxetic(self) -> NDArray[np.bool_]:
        """True where Poisson's ratio is negative, (N,)."""
        auxetic: NDArray[np.bool_] = self.poisson_ratio < 0.0
        return auxetic

    @property
    def rest_area(self) -> float:
        """Sum of π R0² [R²]; the packing fraction is this over the area open to the grains."""
        return float(np.pi * np.sum(self.rest_radius**2))

    def folded(self) -> tuple[Floats, Floats]:
        """Centres (x, y) folded into the periodic cell [0, width) × [0, height) [R], each (N,); as they are where it is open."""
        x, y = self.state[0].copy(), self.state[1].copy()
        if self.box is not None:
            width, inverse_width, height, inverse_height, shift = self.box.kernel_form()
            turns = np.floor(y * inverse_height)
            x -= turns * shift
            y -= turns * height
            x -= width * np.floor(x * inverse_width)
        return x, y

    def set_axes(self, a: ArrayLike, b: ArrayLike, angle: ArrayLike) -> None:
        """Set the shapes from semi-axes [R] and the angle of ``a`` [rad] (the paper's chart)."""
        a, b, angle = (np.asarray(v, dtype=np.float64) for v in (a, b, angle))
        self.state[2] = 0.5 * (a + b)
        self.state[3] = 0.5 * (a - b) * np.cos(2.0 * angle)
        self.state[4] = 0.5 * (a - b) * np.sin(2.0 * angle)

    def copy(self) -> Packing:
        """An independent copy, equal to the last bit."""
        return twin(self)

    def select(self, keep: NDArray[np.bool_]) -> Packing:
        """A new packing of the grains where ``keep`` (N,) is True; their labels stay."""
        twin = Packing.__new__(Packing)
        twin.state = np.ascontiguousarray(self.state[:, keep])
        twin.rest_radius = self.rest_radius[keep]
        twin.poisson_ratio = self.poisson_ratio[keep]
        twin.contact_stiffness = self.contact_stiffness[keep]
        twin.label = self.label[keep]
        twin.box = self.box
        return twin

    def hash(self) -> str:
        """SHA-256 of every bit of the packing, as 64 hexadecimal digits."""
        digest = hashlib.sha256()
        for array in (
            self.state,
            self.rest_radius,
            self.poisson_ratio,
            self.contact_stiffness,
            self.label,
        ):
            digest.update(str(array.shape).encode())
            digest.update(np.ascontiguousarray(array).tobytes())
        digest.update(repr(self.box).encode())
        return digest.hexdigest()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write an NPZ (plain arrays, no pickle) under a temporary name, then rename. Raises OSError as the system does."""
        with atomic_write(path) as file:
            np.savez_compressed(file, allow_pickle=False, **self.arrays())

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All there is to be written."""
        box = self.box
        return {
            "format": np.array(FORMAT),
            "version": np.array(FORMAT_VERSION),
            "state": self.state,
            "rest_radius": self.rest_radius,
            "poisson_ratio": self.poisson_ratio,
            "contact_stiffness": self.contact_stiffness,
            "label": self.label,
            "box": np.array(
                [] if box is None else [box.width, box.height, box.shift], dtype=np.float64
            ),
        }

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Packing:
        """Read what ``save`` wrote. Raises InputError for a missing, malformed, hostile or newer file; runs no code from it."""
        path = Path(path)
        try:
            with zipfile.ZipFile(path) as archive:
                methods = {info.compress_type for info in archive.infolist()}
                if not methods <= {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}:
                    raise InputError(f"{path}: not a packing file of this program")
                unpacked = sum(info.file_size for info in archive.infolist())
                if unpacked > 16 * 8 * MAX_GRAINS:
                    raise InputError(
                        f"{path}: would unpack to {unpacked} bytes, more than any packing needs; not opened"
                    )
            with np.load(path, allow_pickle=False) as data:
                return cls.of_arrays(data, str(path))
        except InputError:
            raise
        except FileNotFoundError:
            raise InputError(f"{path}: no such file") from None
        except UNREADABLE as error:
            reason = " ".join(str(error).split())
            raise InputError(f"{path}: not a readable packing file ({reason})") from None

    @classmethod
    def of_arrays(cls, data: Mapping[str, NDArray[Any]], path: str) -> Packing:
        """The packing of ``arrays``; ``path`` is what messages call it. Raises InputError as ``load`` does."""
        try:
            if str(data["format"]) != FORMAT:
                raise InputError(f"{path}: not a packing file of this program")
            version = int(data["version"])
            if version != FORMAT_VERSION:
                raise InputError(
                    f"{path}: format version {version}, this program reads {FORMAT_VERSION}; update the program"
                )
            packing = cls.__new__(cls)
            packing.state = _floats(data["state"], path)
            packing.rest_radius = _floats(data["rest_radius"], path)
            packing.poisson_ratio = _floats(data["poisson_ratio"], path)
            packing.contact_stiffness = _floats(data["contact_stiffness"], path)
            packing.label = _whole_numbers(data["label"], path)
            box = _floats(data["box"], path)
        except InputError:
            raise
        except UNREADABLE as error:
            reason = " ".join(str(error).split())
            raise InputError(f"{path}: not a readable packing file ({reason})") from None
        if box.shape not in ((0,), (3,)) or packing.state.ndim != 2:
            raise InputError(f"{path}: malformed packing file (wrong array shapes)")
        packing.box = PeriodicBox(*map(float, box)) if box.size else None
        count = packing.state.shape[1]
        if any(
            a.shape != (count,)
            for a in (packing.rest_radius, packing.poisson_ratio, packing.contact_stiffness)
        ):
            raise InputError(
                f"{path}: malformed packing file (arrays disagree about the number of grains)"
            )
        packing.validate()
        return packing


def _whole_numbers(array: NDArray[Any], path: str) -> NDArray[np.int64]:
    if array.dtype.kind not in "iu":
        raise InputError(
            f"{path}: malformed packing file (labels are {array.dtype}, not whole numbers)"
        )
    return np.array(array, dtype=np.int64)


def _floats(array: NDArray[Any], path: str) -> Floats:
    if array.dtype != np.float64:
        raise InputError(f"{path}: malformed packing file (an array is {array.dtype}, not float64)")
    return np.ascontiguousarray(array)

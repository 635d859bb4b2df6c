"""Packings as data: checked, copied, hashed, and written to files that nobody needs to trust."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import InputError
from core.packing import Packing, PeriodicBox
from tests.core import examples

Arrays = dict[str, np.ndarray]
ARRAYS = ("state", "rest_radius", "poisson_ratio", "contact_stiffness", "label")


def saved(tmp_path: Path, box: PeriodicBox | None = None) -> Path:
    path = tmp_path / "grains.npz"
    examples.random_grains(12, 9.0, 1, box).save(path)
    return path


def rewrite(path: Path, change: Callable[[Arrays], object]) -> None:
    with np.load(path) as data:
        arrays = dict(data)
    change(arrays)
    np.savez(path, **arrays)


def assert_refused(path: Path, message: str = "npz") -> None:
    with pytest.raises(InputError, match=message) as caught:
        Packing.load(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("box", examples.BOXES.values(), ids=examples.BOXES.keys())
def test_round_trip_is_bitwise(tmp_path: Path, box: PeriodicBox | None) -> None:
    packing = examples.random_grains(12, 9.0, 1, box)
    packing.label[:] = np.arange(12)[::-1] * 10
    packing.state[0, 0] = -0.0
    packing.state[1, 0] = 5e-324
    packing.save(tmp_path / "grains.npz")
    loaded = Packing.load(tmp_path / "grains.npz")
    assert loaded.hash() == packing.hash()
    assert loaded.box == packing.box
    for name in ARRAYS:
        assert getattr(loaded, name).tobytes() == getattr(packing, name).tobytes()
        assert getattr(loaded, name).flags.writeable


def test_no_grains(tmp_path: Path) -> None:
    Packing([], []).save(tmp_path / "none.npz")
    assert len(Packing.load(tmp_path / "none.npz")) == 0


def test_saving_replaces_whole_files_only(tmp_path: Path) -> None:
    path = saved(tmp_path)
    before = path.read_bytes()
    with pytest.raises(OSError, match="grains"):
        Packing([0.0], [0.0]).save(tmp_path / "nowhere" / "grains.npz")
    broken = Packing([0.0], [0.0])
    broken.state = None  # type: ignore[assignment]
    broken.box = "no box"  # type: ignore[assignment]
    with pytest.raises(AttributeError):
        broken.save(path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from([*ARRAYS, "box"]),
    st.integers(0, 10_000),
    st.integers(0, 63),
)
def test_hash_sees_every_bit(name: str, place: int, bit: int) -> None:
    packing = examples.random_grains(12, 9.0, 1, PeriodicBox(20.0, 30.0, 1.0))
    before = packing.hash()
    if name == "box":
        sides = np.array([20.0, 30.0, 1.0])
        sides.view(np.int64)[place % 3] ^= np.int64(1) << np.int64(bit % 60)
        assume_box = [float(v) for v in sides]
        if not (assume_box[0] > 0.0 and assume_box[1] > 0.0 and math.isfinite(assume_box[2])):
            return
        packing.box = PeriodicBox(*assume_box)
    else:
        array = getattr(packing, name).reshape(-1)
        array.view(np.int64)[place % array.size] ^= np.int64(1) << np.int64(bit)
    assert packing.hash() != before


def test_hash_sees_order_and_box() -> None:
    packing = examples.random_grains(12, 9.0, 1)
    others = [packing.copy() for _ in range(4)]
    others[0].box = PeriodicBox(20.0)
    others[1].state[[0, 1]] = others[1].state[[1, 0]]
    others[2] = packing.select(np.arange(12) != 11)
    others[3].rest_radius, others[3].poisson_ratio = packing.poisson_ratio, packing.rest_radius
    hashes = {packing.hash(), *(other.hash() for other in others)}
    assert len(hashes) == 5
    assert packing.copy().hash() == packing.hash()


def test_copies_are_independent() -> None:
    packing = examples.random_grains(12, 9.0, 1)
    before = packing.hash()
    twin = packing.copy()
    for name in ARRAYS:
        getattr(twin, name)[...] = 7
    part = packing.select(np.ones(12, dtype=bool))
    part.state[:] = 0.0
    part.label[:] = 0
    assert packing.hash() == before


def test_arguments_are_copied() -> None:
    x, radius, label = np.zeros(2), np.ones(2), np.array([4, 5])
    packing = Packing(x, x, radius, label=label)
    packing.state[:] = 5.0
    packing.rest_radius[:] = 5.0
    packing.label[:] = 9
    assert (x.tolist(), radius.tolist(), label.tolist()) == ([0.0, 0.0], [1.0, 1.0], [4, 5])


def test_select_keeps_labels() -> None:
    packing = Packing(np.arange(5.0), np.zeros(5))
    part = packing.select(packing.x > 2.5)
    assert part.label.tolist() == [3, 4]
    assert part.select(part.label == 4).label.tolist() == [4]


def test_a_circle_is_not_tilted_whatever_the_signs_of_its_zeros() -> None:
    packing = Packing(np.arange(4.0), np.zeros(4))
    packing.state[3], packing.state[4] = [0.0, 0.0, -0.0, -0.0], [0.0, -0.0, 0.0, -0.0]
    assert np.array_equal(packing.angle, np.zeros(4))


@given(
    st.lists(st.tuples(st.floats(0.1, 2.0), st.floats(0.1, 2.0), st.floats(-9.0, 9.0)), max_size=5)
)
def test_axes_round_trip(shapes: list[tuple[float, float, float]]) -> None:
    """(a, b, θ) → (p, q1, q2) → the same ellipse: axes in order, angle modulo half a turn where it means something."""
    packing = Packing(np.zeros(len(shapes)), np.zeros(len(shapes)))
    if shapes:
        packing.set_axes(*np.transpose(shapes))
    longer, shorter = packing.semi_axes
    for i, (a, b, theta) in enumerate(shapes):
        assert longer[i] == pytest.approx(max(a, b), abs=1e-14)
        assert shorter[i] == pytest.approx(min(a, b), abs=1e-14)
        if abs(a - b) > 1e-3:
            turn = packing.angle[i] - theta - (0.5 * math.pi if b > a else 0.0)
            assert abs(math.sin(turn)) < 1e-11
    assert np.all((packing.angle > -0.5 * math.pi - 1e-12) & (packing.angle <= 0.5 * math.pi))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"y": [0.0, 1.0, 2.0]}, "y must be one number or 2 numbers"),
        ({"rest_radius": [1.0]}, "rest_radius must be one number or 2"),
        ({"rest_radius": 0.0}, "rest radii"),
        ({"rest_radius": -1.0}, "rest radii"),
        ({"rest_radius": math.nan}, "rest radii"),
        ({"rest_radius": math.inf}, "rest radii"),
        ({"x": [0.0, math.nan]}, "finite"),
        ({"x": [0.0, 1e300]}, "within"),
        ({"poisson_ratio": 1.0}, "Poisson"),
        ({"poisson_ratio": [0.0, math.nan]}, "Poisson"),
        ({"contact_stiffness": 2.0}, "contact stiffness"),
        ({"label": [3, 3]}, "labels must differ"),
        ({"label": [3]}, "disagree"),
    ],
)
def test_impossible_packings(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Packing(**{"x": [0.0, 3.0], "y": [0.0, 0.0], **arguments})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "sides", [(0.0, 1.0), (1.0, -1.0), (math.nan, 1.0), (1.0, math.nan), (1.0, 1.0, math.inf)]
)
def test_impossible_boxes(sides: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="periodic box"):
        PeriodicBox(*sides)


def test_missing_file(tmp_path: Path) -> None:
    assert_refused(tmp_path / "none.npz", "no such file")
    assert_refused(tmp_path, "not a readable")


@pytest.mark.parametrize(
    "content", [b"", b"PK\x03\x04", b"not a packing", b"\x93NUMPY\x01\x00v\x00"]
)
def test_other_files(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "grains.npz"
    path.write_bytes(content)
    assert_refused(path)


def set_array(name: str, value: object) -> Callable[[Arrays], object]:
    return lambda arrays: arrays.update({name: np.asarray(value)})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        *((lambda arrays, name=name: arrays.pop(name), "not a readable") for name in ARRAYS),
        (lambda arrays: arrays.pop("format"), "not a readable"),
        (lambda arrays: arrays.pop("version"), "not a readable"),
        (lambda arrays: arrays.pop("box"), "not a readable"),
        (set_array("format", "something else"), "not a packing file"),
        (set_array("version", 99), "format version 99"),
        (set_array("version", [1, 2]), "not a readable"),
        (set_array("version", "one"), "not a readable"),
        (set_array("state", np.zeros((5, 12), dtype=np.float32)), "float32, not float64"),
        (set_array("state", np.zeros((5, 12), dtype=">f8")), "not float64"),
        (set_array("state", np.zeros((5, 12), dtype=complex)), "not float64"),
        (set_array("state", np.zeros((4, 12))), "disagree|malformed"),
        (set_array("state", np.zeros(12)), "wrong array shapes"),
        (set_array("state", 1.0), "wrong array shapes"),
        (set_array("state", np.zeros((5, 11))), "disagree"),
        (set_array("state", np.full((5, 12), np.nan)), "finite"),
        (set_array("state", np.full((5, 12), 1e200)), "within"),
        (set_array("rest_radius", np.zeros(12)), "rest radii"),
        (set_array("rest_radius", np.ones((12, 1))), "disagree"),
        (set_array("poisson_ratio", np.full(12, 1.0)), "Poisson"),
        (set_array("contact_stiffness", np.full(12, 1.0)), "contact stiffness"),
        (set_array("label", np.zeros(12, dtype=np.int64)), "labels"),
        (set_array("label", np.arange(11)), "disagree"),
        (set_array("label", np.arange(12) + 0.5), "not whole numbers"),
        (set_array("label", np.array(["a"] * 12)), "not whole numbers"),
        (set_array("box", [1.0]), "malformed"),
        (set_array("box", [1.0, -1.0, 0.0]), "periodic box"),
        (set_array("box", [np.nan, 1.0, 0.0]), "periodic box"),
        (set_array("box", np.array([None])), "not a readable"),
    ],
)  # fmt: skip
def test_malformed_files(tmp_path: Path, change: Callable[[Arrays], object], message: str) -> None:
    path = saved(tmp_path)
    rewrite(path, change)
    assert_refused(path, message)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.99])
def test_truncated_files(tmp_path: Path, share: float) -> None:
    path = saved(tmp_path)
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    assert_refused(path)


@settings(max_examples=300, deadline=None)
@given(st.integers(0, 10**9), st.integers(1, 255))
def test_damaged_files(tmp_path_factory: pytest.TempPathFactory, place: int, change: int) -> None:
    """One wrong byte anywhere: refused in one line, or harmless. Never another exception, never another packing."""
    path = tmp_path_factory.getbasetemp() / "damaged.npz"
    packing = examples.random_grains(12, 9.0, 1)
    packing.save(path)
    content = bytearray(path.read_bytes())
    content[place % len(content)] ^= change
    path.write_bytes(content)
    with suppress(InputError):
        assert Packing.load(path).hash() == packing.hash()
        return
    assert_refused(path)


def with_member(path: Path, name: str, content: bytes) -> None:
    """Replace one member of a zip archive."""
    with zipfile.ZipFile(path) as archive:
        members = {info.filename: archive.read(info) for info in archive.infolist()}
    members[name] = content
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for member, data in members.items():
            archive.writestr(member, data)


@pytest.mark.parametrize("length", [10**9, 10**13, 10**18, 10**30, -5])
def test_header_that_promises_too_much(tmp_path: Path, length: int) -> None:
    """A small file whose array header asks for terabytes."""
    path = saved(tmp_path)
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": "<f8", "fortran_order": False, "shape": (5, length)}
    )
    with_member(path, "state.npy", header.getvalue() + bytes(80))
    assert_refused(path)


def test_archive_that_unpacks_to_too_much(tmp_path: Path) -> None:
    path = saved(tmp_path)
    with (
        zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive,
        archive.open("more.npy", "w") as bomb,
    ):
        for _ in range(300):
            bomb.write(bytes(1_000_000))
    assert path.stat().st_size < 1_000_000
    assert_refused(path, "would unpack to")


def test_pickles_are_not_opened(tmp_path: Path) -> None:
    path = saved(tmp_path)
    header = io.BytesIO()
    np.save(header, np.array([print], dtype=object), allow_pickle=True)
    with_member(path, "state.npy", header.getvalue())
    assert_refused(path, "not a readable")


def test_its_arrays_are_the_whole_of_it() -> None:
    packing = examples.random_grains(12, 9.0, 1)
    others = {"spin": np.arange(12.0)}
    assert Packing.of_arrays({**others, **packing.arrays()}, "it").hash() == packing.hash()
    for name in packing.arrays():
        fewer = {key: array for key, array in packing.arrays().items() if key != name}
        with pytest.raises(InputError, match="elsewhere"):
            Packing.of_arrays(fewer, "elsewhere")

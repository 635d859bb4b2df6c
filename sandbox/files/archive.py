"""A file of readable texts and plain arrays: a zip of NAME.json and NAME.npy, in which nothing is ever run.

What is read may come from anyone. Sizes are looked at before anything is unpacked, every array's size against what its header
promises, every text for keys that stand twice and for numbers that are none.
"""

from __future__ import annotations

import io
import json
import math
import zipfile
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.packing import UNREADABLE

LARGEST = 1 << 28  # bytes, of a file and of all that it unpacks to
LARGEST_TEXT = 1 << 25  # bytes
MOST_PARTS = 500
_DIGITS = (
    "Exceeds the limit"  # how Python begins where a whole number has more digits than it reads
)
ZIP = b"PK\x03\x04"  # how such a file begins
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_READ_HEADER = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def pack(
    texts: Mapping[str, object], arrays: Mapping[str, NDArray[Any]], *, compressed: bool
) -> bytes:
    """The file's bytes, which depend on nothing but what is in it. ``texts`` are plain data."""
    method = zipfile.ZIP_DEFLATED if compressed else zipfile.ZIP_STORED
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", method) as archive:
        for name, data in texts.items():
            text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
            archive.writestr(_entry(f"{name}.json", method), text.encode())
        for name, array in arrays.items():
            content = io.BytesIO()
            np.lib.format.write_array(content, array, version=(1, 0), allow_pickle=False)
            archive.writestr(_entry(f"{name}.npy", method), content.getvalue())
    return packed.getvalue()


def _entry(name: str, method: int) -> zipfile.ZipInfo:
    """Without it an entry has the time of day."""
    entry = zipfile.ZipInfo(name)
    entry.compress_type = method
    return entry


def unpack(content: bytes) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """The texts' data and the arrays, by name. Raises InputError for what ``pack`` has not written."""
    texts: dict[str, Any] = {}
    arrays: dict[str, NDArray[Any]] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = archive.infolist()
            _check(entries)
            for entry in entries:
                name, _, kind = entry.filename.rpartition(".")
                if kind == "json":
                    texts[name] = data_of(archive.read(entry))
                elif kind == "npy":
                    arrays[name] = _array(archive.read(entry), name)
                else:
                    raise InputError(f"it has a part {entry.filename[:80]!r}, which nobody knows")
    except UNREADABLE as error:
        raise _damaged(error) from None
    return texts, arrays


def first_text(content: io.BufferedReader, name: str) -> Any:
    """The data of one text, for a look at a file that is not opened. Raises InputError."""
    try:
        with zipfile.ZipFile(content) as archive:
            entry = archive.getinfo(f"{name}.json")
            _check([entry])
            return data_of(archive.read(entry))
    except UNREADABLE as error:
        raise _damaged(error) from None


def _damaged(error: BaseException) -> InputError:
    if isinstance(error, zipfile.BadZipFile):
        return InputError("cut off, damaged, or no file of this program")
    return InputError(f"damaged, or no file of this program ({why_unread(error)})")


def data_of(text: bytes) -> Any:
    """What a JSON text says; a byte order mark is no error. Raises InputError."""
    try:
        return json.loads(
            text.decode("utf-8-sig"), parse_constant=_no_number, object_pairs_hook=_each_once
        )
    except (ValueError, RecursionError) as error:
        raise InputError(f"its text cannot be read ({why_unread(error)})") from None


def _each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key stands there twice")
    return found


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number")


def _check(entries: Iterable[zipfile.ZipInfo]) -> None:
    """Before anything is unpacked."""
    entries = list(entries)
    if len(entries) > MOST_PARTS or len({entry.filename for entry in entries}) < len(entries):
        raise InputError("it has more parts than any file of this program, or one of them twice")
    for entry in entries:
        if entry.compress_type not in _METHODS or entry.flag_bits & 1:
            raise InputError("its parts are packed in a way that this program does not use")
        if entry.filename.endswith(".json") and entry.file_size > LARGEST_TEXT:
            raise InputError("its text is longer than any text of this program; not opened")
    if sum(entry.file_size for entry in entries) > LARGEST:
        raise InputError("it would unpack to more than any scene needs; not opened")


def _array(content: bytes, name: str) -> NDArray[Any]:
    stream = io.BytesIO(content)
    read_header = _READ_HEADER.get(np.lib.format.read_magic(stream))
    if read_header is None:
        raise InputError(f"array {name[:80]!r} has a format of another kind")
    shape, fortran, kind = read_header(stream)
    if kind.hasobject or kind.kind not in "biufU":
        raise InputError(f"array {name[:80]!r} holds no plain numbers")
    if (
        min(shape, default=0) < 0
        or math.prod(shape) * kind.itemsize != len(content) - stream.tell()
    ):
        raise InputError(f"array {name[:80]!r} has not the size that it says")
    if not kind.itemsize:
        raise InputError(f"array {name[:80]!r} holds nothing")
    flat = np.frombuffer(content, kind, offset=stream.tell())
    return flat.reshape(shape, order="F" if fortran else "C").copy()


def why_unread(error: BaseException) -> str:
    """In one line, why somebody's text or archive cannot be read; what Python says about itself in words of ours."""
    if str(error).startswith(_DIGITS):
        return "a whole number in it has thousands of digits"
    if isinstance(error, UnicodeDecodeError):
        return "it is no text"
    return " ".join(str(error).split())[:200] or type(error).__name__

"""Everything that a person can do to a running scene, as data. A log of them is a replay file.

A command takes effect between two increments, never inside one, and is stamped with the number of increments finished by then.
"""

from __future__ import annotations

import sys
from dataclasses import asdict, dataclass, fields
from typing import Any, TypeGuard, get_args

from core.errors import InputError

Scalar = float | int | bool | str
KINDS = ("regular", "auxetic")  # of grains
WIDEST = 100.0  # [R] radius of a brush
MOST_POINTS = 4000  # of a drawn line


@dataclass(frozen=True)
class Grab:
    """Take hold of a handle."""

    handle: str


@dataclass(frozen=True)
class Move:
    """Ask a held handle to go to (x, y) [R]. The body follows in increments."""

    handle: str
    x: float
    y: float


@dataclass(frozen=True)
class Release:
    """Let go. The body stays where it is."""

    handle: str


@dataclass(frozen=True)
class Reset:
    """Back to the state at the start, to the last bit."""


@dataclass(frozen=True)
class Change:
    """Set a parameter, or "packing", "seed" or "scene".

    A parameter that is ``live`` acts on the grains where they stand; for anything else the scene is built anew.
    """

    name: str
    value: Scalar


@dataclass(frozen=True)
class Protocol:
    """Switch the scripted drive on (from its beginning) or off."""

    on: bool


@dataclass(frozen=True)
class Recall:
    """Go to the state after that increment, or after the nearest one before it that is kept.

    What came later is kept too, until something moves.
    """

    increment: int


@dataclass(frozen=True)
class Undo:
    """Back to the state before the last gesture, change, recall, reset or new start."""


@dataclass(frozen=True)
class Redo:
    """Take the last undo back."""


@dataclass(frozen=True)
class Place:
    """Put a grain of ``kind``, "regular" or "auxetic", at (x, y) [R], or near it where there is more room.

    ``goes_on``, here and below: part of the same stroke of a brush as the edit before, and undone with it.
    """

    x: float
    y: float
    kind: str
    goes_on: bool = False


@dataclass(frozen=True)
class Erase:
    """Take away the grains whose centres are within ``radius`` of (x, y) [R], and the one that lies there."""

    x: float
    y: float
    radius: float
    goes_on: bool = False


@dataclass(frozen=True)
class Retype:
    """Make those grains the kind "regular" or "auxetic"."""

    x: float
    y: float
    radius: float
    kind: str
    goes_on: bool = False


@dataclass(frozen=True)
class DrawWall:
    """Draw a wall along a line through ``points`` [R]; one that is as good as a point is a peg."""

    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class EraseWall:
    """Take away the drawn wall nearest to (x, y) [R]."""

    x: float
    y: float


Edit = Place | Erase | Retype | DrawWall | EraseWall
Command = Grab | Move | Release | Reset | Change | Protocol | Recall | Undo | Redo | Edit
_BY_NAME: dict[str, type] = {kind.__name__.lower(): kind for kind in get_args(Command)}


def to_data(command: Command) -> dict[str, Any]:
    """A command as plain data for a log."""
    return {"command": type(command).__name__.lower(), **asdict(command)}


def from_data(data: dict[str, Any]) -> Command:
    """The command that ``to_data`` wrote. Raises InputError if it is none."""
    kind = _BY_NAME.get(str(data.get("command")))
    if kind is None:
        raise InputError(f"unknown command {data.get('command')!r}")
    names = {f.name for f in fields(kind)}
    given = {key: value for key, value in data.items() if key != "command"}
    if set(given) != names:
        raise InputError(
            f"command {data['command']!r} needs {', '.join(sorted(names)) or 'nothing'}"
        )
    for name, value in given.items():
        if name in ("x", "y"):
            if not _finite(value):
                raise InputError(f"command {data['command']!r}: {name} must be a finite number")
            given[name] = float(value)
        elif name == "radius":
            if not (_finite(value) and 0.0 <= value <= WIDEST):
                raise InputError(
                    f"command {data['command']!r}: radius must be a number from 0 to {WIDEST:g}"
                )
            given[name] = float(value)
        elif name == "kind":
            if value not in KINDS:
                raise InputError(
                    f"command {data['command']!r}: kind must be one of {', '.join(KINDS)}"
                )
        elif name == "points":
            given[name] = _line(value)
        elif name == "increment":
            if isinstance(value, bool) or not isinstance(value, int) or value < 0:
                raise InputError("command 'recall': increment must be a whole number from 0 on")
        elif name in ("on", "goes_on"):
            if not isinstance(value, bool):
                raise InputError(f"command {data['command']!r}: {name} must be true or false")
        elif name == "value":
            if not (isinstance(value, (bool, str)) or _finite(value)):
                raise InputError(
                    "command 'change': value must be a finite number, a word or a switch"
                )
        elif not isinstance(value, str):
            raise InputError(f"command {data['command']!r}: {name} must be a word")
    command: Command = kind(**given)
    return command


def check(command: Command) -> None:
    """Raises InputError for a command that a log could not carry, such as one with numbers that are not finite."""
    from_data(to_data(command))


def _line(value: object) -> tuple[tuple[float, float], ...]:
    """The points of a drawn line. Raises InputError unless they are some, not too many, and finite."""
    if not isinstance(value, (list, tuple)) or not 1 <= len(value) <= MOST_POINTS:
        raise InputError(f"command 'drawwall': points must be 1 to {MOST_POINTS} pairs of numbers")
    points = []
    for point in value:
        if not (isinstance(point, (list, tuple)) and len(point) == 2 and all(map(_finite, point))):
            raise InputError("command 'drawwall': each point must be two finite numbers")
        points.append((float(point[0]), float(point[1])))
    return tuple(points)


def _finite(value: object) -> TypeGuard[float]:
    """Is it a number that a float holds, and not inf or nan?"""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return abs(value) <= sys.float_info.max

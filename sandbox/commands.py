"""Everything that a person can do to a running scene, as data. A log of them is a replay file.

A command takes effect between two increments, never inside one, and is stamped with the number of increments finished by then.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, fields
from typing import Any

from core.errors import InputError

Scalar = float | int | bool | str


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


Command = Grab | Move | Release | Reset | Change | Protocol | Recall | Undo | Redo
_BY_NAME: dict[str, type] = {
    c.__name__.lower(): c
    for c in (Grab, Move, Release, Reset, Change, Protocol, Recall, Undo, Redo)
}


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
            if (
                isinstance(value, bool)
                or not isinstance(value, (int, float))
                or not math.isfinite(value)
            ):
                raise InputError(f"command {data['command']!r}: {name} must be a finite number")
            given[name] = float(value)
        elif name == "increment":
            if isinstance(value, bool) or not isinstance(value, int) or value < 0:
                raise InputError("command 'recall': increment must be a whole number from 0 on")
        elif name == "on":
            if not isinstance(value, bool):
                raise InputError("command 'protocol': on must be true or false")
        elif name == "value":
            if not isinstance(value, (bool, int, float, str)):
                raise InputError("command 'change': value must be a number, a word or a switch")
        elif not isinstance(value, str):
            raise InputError(f"command {data['command']!r}: {name} must be a word")
    command: Command = kind(**given)
    return command

"""What a sweep is asked: a scene, parameters along axes, packings, seeds, and what ends a run early.

Rows are numbered seed by seed, all cells of one seed first, so that more seeds leave every number as it was.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import Any

from core.errors import InputError, did_you_mean
from sandbox import __version__
from scenes import registry
from scenes.parameter import Value, check_seed, shown
from scenes.scene import Scene

DATA_VERSION = 2  # of what a run writes down
MOST_RUNS = 1_000_000
MOST_CELLS = 10_000
LOCKED, CLOG, EMPTY = "locked", "clog", "empty"
ENDINGS = (LOCKED, CLOG, EMPTY)
# How far a free grain sinks in the longest run under gravity [R]: ten times the height of the usual hopper.
DEEPEST = 400.0


@dataclass(frozen=True)
class Axis:
    """A parameter and the values that it takes."""

    name: str
    values: tuple[Value, ...]


@dataclass(frozen=True)
class Job:
    """One run. ``row``: its number in the table, from 1."""

    row: int
    scene: str
    packing: str
    seed: int
    settings: Mapping[str, Value]  # all of them
    until: tuple[str, ...]
    steps: int  # increments at most


@dataclass(frozen=True)
class Request:
    """A whole sweep. Every combination of the axes' values is a cell."""

    scene: str
    axes: tuple[Axis, ...]
    packings: tuple[str, ...]
    seeds: tuple[int, int]  # the first and the last
    settings: tuple[tuple[str, Value], ...] = ()  # of all cells
    until: tuple[str, ...] | None = None  # None: see ``endings``
    steps: int | None = None  # None: see ``longest``

    @property
    def cells(self) -> list[dict[str, Value]]:
        """The values along the axes, the last axis changing fastest."""
        names = [axis.name for axis in self.axes]
        return [
            dict(zip(names, values, strict=True))
            for values in product(*(axis.values for axis in self.axes))
        ]

    @property
    def runs(self) -> int:
        """How many there are."""
        return self._a_seed * (self.seeds[1] - self.seeds[0] + 1)

    @property
    def _a_seed(self) -> int:
        return len(self.packings) * math.prod(len(axis.values) for axis in self.axes)

    def jobs(self) -> Iterator[Job]:
        """All runs, in the order of their rows."""
        scene = registry.get(self.scene)
        given = [scene.settings({**dict(self.settings), **cell}) for cell in self.cells]
        one = [(packing, settings) for packing in self.packings for settings in given]
        for row in range(1, self.runs + 1):
            seed, place = divmod(row - 1, len(one))
            yield self._job(row, self.seeds[0] + seed, *one[place])

    def place(self, row: int) -> tuple[int, int]:
        """Which packing and which cell a row is of, counted from 0."""
        return divmod((row - 1) % self._a_seed, self._a_seed // len(self.packings))

    def job(self, row: int) -> Job:
        """The run of one row. Raises InputError if there is none."""
        if not 1 <= row <= self.runs:
            raise InputError(f"there is no row {row}: use 1 to {self.runs}")
        seed, (packing, cell) = (row - 1) // self._a_seed, self.place(row)
        settings = registry.get(self.scene).settings({**dict(self.settings), **self.cells[cell]})
        return self._job(row, self.seeds[0] + seed, self.packings[packing], settings)

    def _job(self, row: int, seed: int, packing: str, settings: Mapping[str, Value]) -> Job:
        scene = registry.get(self.scene)
        until = endings(scene, settings) if self.until is None else self.until
        steps = self.steps or longest(scene, settings)
        return Job(row, self.scene, packing, seed, settings, until, steps)

    def with_more_seeds(self, count: int) -> Request:
        """The same with so many more. Raises InputError if that is too much."""
        more = replace(self, seeds=(self.seeds[0], self.seeds[1] + count))
        _check_size(more)
        return more

    def key(self) -> str:
        """Changes with all that its runs depend on, the defaults of its scene too, but not with how many seeds there are."""
        scene = registry.get(self.scene)
        asked = {**asdict(self), "seeds": self.seeds[0]}
        asked["settings"] = sorted(scene.settings(dict(self.settings)).items())
        words = json.dumps([asked, DATA_VERSION, __version__], sort_keys=True)
        return hashlib.sha256(words.encode()).hexdigest()[:16]

    def data(self) -> dict[str, Any]:
        """As JSON has it."""
        return {
            **asdict(self),
            "axes": [{"name": axis.name, "values": list(axis.values)} for axis in self.axes],
            "settings": dict(self.settings),
        }

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Request:
        """What ``data`` wrote. Raises InputError if it is none."""
        try:
            until, scene = data["until"], registry.get(str(data["scene"]))
            request = cls(
                scene.name,
                tuple(axis_of(scene, axis["name"], axis["values"]) for axis in data["axes"]),
                tuple(map(str, data["packings"])),
                (check_seed(data["seeds"][0]), check_seed(data["seeds"][1])),
                tuple((name, parsed(scene, name, v)) for name, v in data["settings"].items()),
                None if until is None else tuple(map(str, until)),
                data["steps"],
            )
        except (KeyError, TypeError, AttributeError, IndexError) as error:
            raise InputError(f"not the request of a sweep ({error!r})") from None
        check(request)
        return request


def endings(scene: Scene, settings: Mapping[str, Value]) -> tuple[str, ...]:
    """What ends a run unless something else is asked for: under gravity a clog as well, which nothing breaks by itself."""
    return ENDINGS if scene.ingredients(settings).gravity else (LOCKED, EMPTY)


def longest(scene: Scene, settings: Mapping[str, Value]) -> int:
    """Increments of a run at most: the scripted drive, or under gravity until a free grain has sunk by ``DEEPEST``."""
    if scene.ingredients(settings).gravity and "fall" in settings:
        return math.ceil(DEEPEST / float(settings["fall"]))
    return scene.steps(settings)


def check(request: Request) -> None:
    """Raises InputError for a request that cannot be carried out, of no or too many runs, or whose scene refuses a cell."""
    scene = registry.get(request.scene)
    names = [axis.name for axis in request.axes]
    for several in (names, request.packings, *(axis.values for axis in request.axes)):
        if len(set(several)) < len(several):
            raise InputError("an axis, a packing or a value comes twice")
    if request.steps is not None and not _is_count(request.steps):
        raise InputError(f"steps must be a whole number from 1, not {shown(request.steps)}")
    if unknown := set(request.until or ()) - set(ENDINGS):
        raise InputError(f"nothing ends by {shown(min(unknown))}: use {', '.join(ENDINGS)}")
    _check_size(request)
    for packing in request.packings:
        scene.check_packing(packing)
    fixed = dict(request.settings)
    for axis in request.axes:
        if axis.name in fixed:
            raise InputError(f"{axis.name} is both varied and set: leave one of them out")
    for cell in request.cells:
        try:
            scene.settings({**fixed, **cell})
        except InputError as error:
            if not cell:
                raise
            where = ", ".join(f"{name}={value:g}" for name, value in cell.items())
            raise InputError(f"at {where}: {error}") from None


def parsed(scene: Scene, name: str, value: object) -> Value:
    """A value, or what was typed for it, as the parameter has it. Raises InputError."""
    for parameter in scene.parameters:
        if parameter.name == name:
            return parameter.parse(value) if isinstance(value, str) else parameter.check(value)
    names = [p.name for p in scene.parameters]
    hint = did_you_mean(name, names) or f"; there are: {', '.join(names)}"
    raise InputError(f"scene {scene.name} has no parameter {name!r}{hint}")


def axis_of(scene: Scene, name: str, values: Sequence[object]) -> Axis:
    """An axis of such values. Raises InputError."""
    return Axis(name, tuple(parsed(scene, name, value) for value in values))


def _is_count(value: object) -> bool:
    return type(value) is int and value > 0


def _check_size(request: Request) -> None:
    cells = math.prod(len(axis.values) for axis in request.axes)
    if request.runs < 1:
        raise InputError(
            "no runs: an axis without values, no packing, or a range of seeds without any"
        )
    if cells > MOST_CELLS:
        raise InputError(f"{cells:,} cells are too many: use {MOST_CELLS:,} at most")
    if request.runs > MOST_RUNS:
        raise InputError(f"{request.runs:,} runs are too many: use {MOST_RUNS:,} at most")

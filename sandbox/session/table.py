"""The table of a run: a row an increment, and columns that say what its scene writes, in the words of its plot."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from operator import attrgetter

from sandbox.session.history import History, Row
from scenes.scene import Setup
from scenes.text import Text

Column = tuple[str, Callable[[Row], float | int | str]]  # quantity with its unit, and its value


class RunTable:
    """The rows of a history, under the names of what they are in the scene that is set up."""

    def __init__(self, setup: Setup, history: History) -> None:
        self._columns = _columns(setup) + (_DRAWN if history.drawn_upon else [])
        self._history = history

    def __len__(self) -> int:
        return len(self._history)

    def __getitem__(self, index: int) -> Row:
        """What the row is made from, always the same object."""
        return self._history[index]

    def header(self) -> list[str]:
        """Names of the columns: quantities with their units, in English, and to be said in any language."""
        return [name for name, _ in self._columns]

    def rows(self, begin: int = 0) -> Iterator[tuple[float | int | str, ...]]:
        """One tuple an increment, in the order of the header, from that increment on."""
        for row in self._history.rows(begin):
            yield tuple(value(row) for _, value in self._columns)


def _columns(setup: Setup) -> list[Column]:
    felt = setup.felt_label
    usual = Text("usual error, estimated: {quantity}", quantity=felt)
    most = Text("error that nine of ten stay within, estimated: {quantity}", quantity=felt)
    counts = setup.curve is not None and setup.curve.force is None
    columns: list[Column] = [
        ("increment", attrgetter("increment")),
        (setup.stroke_label, attrgetter("stroke")),
        (setup.force_label, attrgetter("grains_out" if counts else "resisting")),
        (usual, attrgetter("usual_error")),
        (most, attrgetter("force_error")),
        ("grains out", attrgetter("grains_out")),
        ("energy [k R^2]", attrgetter("energy")),
        ("relative residual", attrgetter("residual")),
        ("FIRE iterations", attrgetter("iterations")),
        ("stop reason", attrgetter("stop_reason")),
        ("hand strength [k R] (1000: a testing machine)", attrgetter("hand_strength")),
        ("share of contacts beyond the friction cone", attrgetter("beyond_cone")),
    ]
    labels = {handle.body: handle.label for handle in setup.handles}
    for index, body in enumerate(setup.solids):
        label = labels.get(body.name, body.name)
        x = Text("force of the grains on {label}, x [k R]", label=label)
        y = Text("force of the grains on {label}, y [k R]", label=label)
        columns += [(x, _on_solid(2 * index)), (y, _on_solid(2 * index + 1))]
    return columns


def _on_solid(place: int) -> Callable[[Row], float]:
    """A row of an older program does not know."""
    return lambda row: row.on_solids[place] if row.on_solids else math.nan


_DRAWN: list[Column] = [
    ("force of the grains on drawn walls, x [k R]", attrgetter("on_drawn_x")),
    ("force of the grains on drawn walls, y [k R]", attrgetter("on_drawn_y")),
]

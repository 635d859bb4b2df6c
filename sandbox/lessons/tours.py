"""Guided tours: what each step sets up, and what has to happen for it to be done. The words are in the language tables.

A tour is data, ``sandbox/lessons/tours.toml``: for every scene a list of steps. A step may begin the scene anew, in one
packing or several and with other settings, and choose a view; then it waits for what a person does.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from sandbox.session.frame import Frame

FILE = Path(__file__).with_name("tours.toml")


@dataclass(frozen=True, slots=True)
class Condition:
    """What a person is asked to do; exactly one of these is set, ``by``, ``or_event`` and ``below`` apart."""

    moved: str = ""  # a handle, from where it was
    by: float = 0.0  # at least so far [R]
    event: str = ""  # a kind of event since then
    or_event: str = ""  # or another kind
    view: str = ""  # another way to look at the grains
    setting: str = ""  # a parameter has another value than before
    below: float = math.inf  # or one that is at most so large
    out: int = 0  # so many more grains have left
    force: float = 0.0  # what is plotted has come to so much
    grains: int = 0  # so many grains have been placed or erased
    walls: int = 0  # so many walls have been drawn


@dataclass(frozen=True, slots=True)
class Step:
    """One step. Without packings the scene goes on as it is."""

    key: str  # of its words
    packings: tuple[str, ...] = ()  # begins the scene anew, side by side if there are several
    settings: Mapping[str, float | int | bool] = field(default_factory=dict)
    view: str = ""
    until: Condition | None = None


@dataclass(frozen=True, slots=True)
class Moment:
    """What conditions look at, of all panes together."""

    handles: tuple[
        Mapping[str, tuple[float, float]], ...
    ]  # of every pane: one of them may be locked
    settings: Mapping[str, object]
    events: tuple[tuple[str, int, int], ...]  # kind, increment, pane
    view: str
    out: int
    force: float  # the largest that is plotted now
    grains: int
    bodies: int

    @classmethod
    def of(cls, frames: Sequence[Frame], view: str) -> Moment:
        """Settings are those of the first pane: the same ones hold for all."""
        first = frames[0]
        return cls(
            handles=tuple(
                {handle.name: (handle.x, handle.y) for handle in frame.handles} for frame in frames
            ),
            settings=dict(first.settings),
            events=tuple(
                (event.kind, event.increment, pane)
                for pane, frame in enumerate(frames)
                for event in frame.events
            ),
            view=view,
            out=max(frame.grains_out for frame in frames),
            force=max(frame.curve_force[-1] for frame in frames),
            grains=first.grains + first.grains_out,
            bodies=len(first.bodies),
        )


def met(condition: Condition, then: Moment, now: Moment) -> bool:
    """Has it happened between two moments?"""
    c = condition
    if c.moved:
        return any(
            c.moved in before and c.moved in after and _apart(before[c.moved], after[c.moved], c.by)
            for before, after in zip(then.handles, now.handles, strict=False)
        )
    if c.event:
        return any(
            event[0] in (c.event, c.or_event) for event in set(now.events) - set(then.events)
        )
    if c.view:
        return now.view == c.view
    if c.setting:
        before, after = then.settings.get(c.setting), now.settings.get(c.setting)
        if math.isfinite(c.below):
            return isinstance(after, (int, float)) and after <= c.below
        return before != after
    if c.out:
        return now.out - then.out >= c.out
    if c.force:
        return now.force >= c.force
    if c.grains:
        return abs(now.grains - then.grains) >= c.grains
    return now.bodies - then.bodies >= c.walls


def _apart(a: tuple[float, float], b: tuple[float, float], least: float) -> bool:
    return math.dist(a, b) >= least


def scenes() -> tuple[str, ...]:
    """Names of the scenes that have a tour."""
    return tuple(_read())


def steps(scene: str) -> tuple[Step, ...]:
    """The tour of a scene; nothing if it has none."""
    return tuple(_step(data) for data in _read().get(scene, ()))


@cache
def _read() -> dict[str, list[dict[str, Any]]]:
    with FILE.open("rb") as file:
        return tomllib.load(file)


def _step(data: Mapping[str, Any]) -> Step:
    """Raises TypeError for a key that means nothing."""
    given = dict(data)
    until = given.pop("until", None)
    return Step(
        **{**given, "packings": tuple(given.get("packings", ()))},
        until=None if until is None else Condition(**until),
    )

"""What conditions of a lesson look at, and whether they are met."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sandbox.lessons.lesson import Condition
from sandbox.session.frame import Frame

# What reads as the number that is wanted counts as that: nobody sees what is behind the last digit.
PLACE_DECIMALS, FIGURES = 3, 4  # of a place [R] that is told or given, of any other number
NEAR = 10.0**-PLACE_DECIMALS  # of a way: either end may be off by half a digit [R]
ON_SCREEN = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "up": (0.0, 1.0), "down": (0.0, -1.0)}

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Moment:
    """What conditions look at, of all panes together."""

    handles: tuple[Mapping[str, Point], ...]  # of every pane: one of them may be locked
    middles: tuple[Point, ...]  # of what there is in every pane
    settings: Mapping[str, object]
    events: tuple[tuple[str, int, int], ...]  # kind, increment, pane
    view: str
    out: int
    force: float  # the largest that is plotted now
    grains: int
    bodies: int
    increment: int  # of the pane that has come furthest

    @classmethod
    def of(cls, frames: Sequence[Frame], view: str) -> Moment:
        """Settings are those of the first pane: the same ones hold for all."""
        first = frames[0]
        return cls(
            handles=tuple(
                {handle.name: (handle.x, handle.y) for handle in frame.handles} for frame in frames
            ),
            middles=tuple(_middle(frame.bounds) for frame in frames),
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
            increment=max(frame.increment for frame in frames),
        )


def met(condition: Condition, then: Moment, now: Moment) -> bool:
    """Has it happened between two moments?"""
    c = condition
    if c.moved:
        return any(
            c.moved in before
            and c.moved in after
            and _gone(before[c.moved], after[c.moved], c.way, middle) >= c.by - NEAR
            for before, after, middle in zip(then.handles, now.handles, then.middles, strict=False)
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
            return isinstance(after, (int, float)) and after <= c.below + _half_digit(c.below)
        return before != after
    if c.out:
        return now.out - then.out >= c.out
    if c.force:
        return now.force >= c.force - _half_digit(c.force)
    if c.grains:
        return abs(now.grains - then.grains) >= c.grains
    if c.walls:
        return now.bodies - then.bodies >= c.walls
    return now.increment - then.increment >= c.increments


def _half_digit(value: float) -> float:
    """Half of the last digit of a number as it is shown."""
    power = math.floor(math.log10(abs(value))) if value else 0
    return 0.5 * 10.0 ** (power + 1 - FIGURES)


def _gone(start: Point, end: Point, way: str, middle: Point) -> float:
    """How far from start to end, as the way is said; whichever way where none is [R]."""
    across, up = end[0] - start[0], end[1] - start[1]
    if not way:
        return math.hypot(across, up)
    x, y = ON_SCREEN.get(way) or (middle[0] - start[0], middle[1] - start[1])
    along = (across * x + up * y) / (math.hypot(x, y) or 1.0)
    return -along if way == "outwards" else along


def _middle(bounds: tuple[float, float, float, float]) -> Point:
    left, bottom, right, top = bounds
    return 0.5 * (left + right), 0.5 * (bottom + top)

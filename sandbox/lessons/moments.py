"""What conditions of a lesson look at, and whether they are met."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sandbox.lessons.lesson import Condition
from sandbox.session.frame import Frame


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
    increment: int  # of the pane that has come furthest

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
            increment=max(frame.increment for frame in frames),
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
    if c.walls:
        return now.bodies - then.bodies >= c.walls
    return now.increment - then.increment >= c.increments


def _apart(a: tuple[float, float], b: tuple[float, float], least: float) -> bool:
    return math.dist(a, b) >= least

"""Curves of earlier runs, kept to be compared with the present ones: named, hidden, deleted, exported."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from core.arrays import Floats
from sandbox.session.frame import Frame
from sandbox.session.history import Event
from sandbox.words import words
from sandbox.words.language import decimal_sign
from scenes import registry

MOST = 12  # of a scene; then the oldest goes
LONGEST = 80  # characters of a name
PRESENT, EARLIER = "present", "earlier"


@dataclass(eq=False)
class Kept:
    """The curve of a run that has ended. Name and visibility may be changed."""

    key: int  # stays with it
    name: str
    scene: str
    packing: str
    seed: int
    settings: Mapping[str, object]
    stroke: Floats  # (M,) [R], or what the scene plots instead
    force: Floats  # (M,) [k R], or what the scene plots instead
    labels: tuple[str, str]  # of stroke and force, as the scene says them
    events: tuple[Event, ...] = ()
    visible: bool = True


@dataclass
class Curves:
    """All kept curves, of all scenes, the oldest first."""

    _all: list[Kept] = field(default_factory=list)
    _made: int = 0

    def keep(self, frame: Frame | None) -> Kept | None:
        """Keep the curve of a run that ends; None if it is none, or is there already."""
        if frame is None or not _is_curve(frame.curve_stroke):
            return None
        same = [kept for kept in self._all if _same_run(kept, frame)]
        for kept in same:
            if _begins_with(kept, frame.curve_stroke, frame.curve_force):
                return None
        for kept in same:
            if _begins_with(frame, kept.stroke, kept.force):
                kept.stroke, kept.force = frame.curve_stroke.copy(), frame.curve_force.copy()
                kept.events = frame.events
                return kept
        self._made += 1
        kept = Kept(
            self._made,
            self._free(automatic_name(frame)),
            frame.scene,
            frame.packing,
            frame.seed,
            dict(frame.settings),
            frame.curve_stroke.copy(),
            frame.curve_force.copy(),
            (frame.stroke_label, frame.curve_label),
            frame.events,
        )
        self._all.append(kept)
        for old in self.of(frame.scene)[:-MOST]:
            self._all.remove(old)
        return kept

    def of(self, scene: str) -> tuple[Kept, ...]:
        """Those of a scene, hidden ones too, the oldest first."""
        return tuple(kept for kept in self._all if kept.scene == scene)

    def shown(self, frame: Frame) -> tuple[Kept, ...]:
        """Those to be drawn behind a frame's curve: visible, of its scene and on its axes."""
        axes = frame.stroke_label, frame.curve_label
        return tuple(kept for kept in self.of(frame.scene) if kept.visible and kept.labels == axes)

    @property
    def entries(self) -> tuple[Kept, ...]:
        """All, the oldest first."""
        return tuple(self._all)

    def rename(self, key: int, name: str) -> None:
        """Give another name; one that is taken gets a number, an empty one changes nothing."""
        name = " ".join(name.split())[:LONGEST]
        for kept in self._all:
            if kept.key == key and name and name != kept.name:
                kept.name = self._free(name)

    def toggle(self, key: int) -> None:
        """Hide, or show again."""
        for kept in self._all:
            if kept.key == key:
                kept.visible = not kept.visible

    def delete(self, key: int) -> None:
        """Forget one."""
        self._all = [kept for kept in self._all if kept.key != key]

    def clear(self, scene: str | None = None) -> None:
        """Forget all, or all of a scene."""
        self._all = [kept for kept in self._all if scene not in (None, kept.scene)]

    def _free(self, name: str) -> str:
        taken = {kept.name for kept in self._all}
        number, free = 1, name
        while free in taken:
            number += 1
            free = f"{name} ({number})"
        return free


def automatic_name(frame: Frame) -> str:
    """Packing, seed and what is set otherwise than by default."""
    parts = [
        words.PACKINGS.get(frame.packing, frame.packing),
        words.SEED.format(seed=frame.seed),
    ]
    defaults = {}
    if frame.scene in registry.names():
        defaults = registry.get(frame.scene).settings()
    for name, value in frame.settings.items():
        if name in defaults and value != defaults[name]:
            shown = f"{value:g}" if isinstance(value, float) else str(value)
            shown = shown.replace("-", "−").replace(".", decimal_sign())
            parts.append(f"{words.parameter_name(name)} {shown}")
    return " · ".join(parts)[:LONGEST]


class CurveTable:
    """Present curves and kept ones in one long table: a row a point, with who it belongs to."""

    def __init__(self, frames: Sequence[Frame], kept: Sequence[Kept]) -> None:
        self._frames, self._kept = frames, kept

    def header(self) -> list[str]:
        """Names of the columns; stroke and force with their units."""
        frame = self._frames[0]
        who = ["curve", "run", "scene", "packing", "seed", "settings", "increment"]
        return [*who, frame.stroke_label, frame.curve_label]

    def rows(self) -> Iterator[tuple[object, ...]]:
        """Curve after curve, the present ones first."""
        for frame in self._frames:
            who = (automatic_name(frame), PRESENT, frame.scene, frame.packing, frame.seed)
            yield from _points(who, frame.settings, frame.curve_stroke, frame.curve_force)
        for kept in self._kept:
            who = (kept.name, EARLIER, kept.scene, kept.packing, kept.seed)
            yield from _points(who, kept.settings, kept.stroke, kept.force)


def _points(
    who: tuple[object, ...], settings: Mapping[str, object], stroke: Floats, force: Floats
) -> Iterator[tuple[object, ...]]:
    setting = "; ".join(f"{name}={value}" for name, value in settings.items())
    for increment, (x, y) in enumerate(zip(stroke.tolist(), force.tolist(), strict=True)):
        yield (*who, setting, increment, x, y)


def _is_curve(stroke: Floats) -> bool:
    sound = stroke[np.isfinite(stroke)]
    return bool(sound.size >= 2 and np.ptp(sound) > 0.0)


def _same_run(kept: Kept, frame: Frame) -> bool:
    return (kept.scene, kept.packing, kept.seed, dict(kept.settings), kept.labels) == (
        frame.scene,
        frame.packing,
        frame.seed,
        dict(frame.settings),
        (frame.stroke_label, frame.curve_label),
    )


def _begins_with(longer: Kept | Frame, stroke: Floats, force: Floats) -> bool:
    """Is the curve a beginning of the longer one, to the last bit?"""
    if isinstance(longer, Kept):
        whole = longer.stroke, longer.force
    else:
        whole = longer.curve_stroke, longer.curve_force
    count = stroke.shape[0]
    return all(
        part.shape[0] >= count and np.array_equal(part[:count], beginning)
        for part, beginning in zip(whole, (stroke, force), strict=True)
    )

"""A tape written down: one deflated piece that holds all numbers, and all texts in every language."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Floats
from core.errors import InputError
from sandbox.draw.marks import marks
from sandbox.draw.numbers import FINER, nice_ceiling, typical_largest
from sandbox.draw.views import VIEWS, View
from sandbox.player import series
from sandbox.player.coding import Writer, carried
from sandbox.player.kept import QUANTITIES, Kept, Said
from sandbox.player.series import Tops
from sandbox.player.tape import Tape
from sandbox.session.frame import Frame
from sandbox.session.history import Event
from sandbox.words import words
from sandbox.words.language import available, in_each

LEAST_FORCE, LEAST_PUSH = 0.01, 0.01  # [k R] tops of scales are never below these
USUAL = 95.0  # percentile, over the moments of a run, that a scale reaches up to
CURVE_STEPS = 4000  # from the lowest to the highest value of a curve


class Texts:
    """Texts that are said again and again, each kept once and known by its number."""

    def __init__(self) -> None:
        self._numbers: dict[Said, int] = {}

    def number(self, said: Said) -> int:
        """Of a text."""
        return self._numbers.setdefault(said, len(self._numbers))

    @property
    def all(self) -> list[Said]:
        """In the order of their numbers."""
        return list(self._numbers)


def recording(tape: Tape) -> bytes:
    """All that a page draws and tells, deflated. Raises InputError for a tape with nothing on it."""
    moments = tape.moments
    if not moments:
        raise InputError("there is nothing to show yet: add the state at the start")
    panes = list(zip(*moments, strict=True))
    tops = _tops(panes)
    # What follows from shapes gets its scale where shapes are known.
    scales = {"pressure": tops.pressure, "fringes": tops.stress, "motion": tops.motion}
    writer, texts = Writer(), Texts()
    first = tape.last[0]
    head = {
        "languages": available(),
        "increments": [max(kept.increment for kept in moment) for moment in moments],
        "every": tape.every,
        "scene": first.scene,
        "seed": first.seed,
        "labels": {
            "force": in_each(lambda: words.say(first.curve_label)),
            "stroke": in_each(lambda: words.say(first.stroke_label)),
        },
        "limit": first.hand_limit,
        "views": [view_of(view, scales) for view in VIEWS.values()],
        "tops": {"chains": tops.force, "hand": tops.hand},
        "panes": [
            _pane(writer, texts, kept, tape.last, place, tops) for place, kept in enumerate(panes)
        ],
        "texts": texts.all,
    }
    return writer.packed(head)


def _pane(
    writer: Writer,
    texts: Texts,
    moments: Sequence[Kept],
    frames: Sequence[Frame],
    place: int,
    tops: Tops,
) -> dict[str, Any]:
    last = frames[place]
    written = series.grains(writer, moments, tops)
    labels = written["labels"]
    stroke, force = _finite(last.curve_stroke), _finite(last.curve_force)
    increments = [kept.increment for kept in moments]
    return {
        "packing": last.packing,
        "title": in_each(lambda: marks(frames)[place].name),
        "dash": marks(frames)[place].dash,
        "grains": written,
        "contacts": series.contacts(writer, moments, labels, tops.force),
        "bodies": series.bodies(writer, moments),
        "handles": series.handles(writer, moments, tops.hand),
        "box": series.box(writer, moments),
        "bounds": _bounds(moments),
        "at": increments,  # of each moment in the curve
        "out": [kept.out for kept in moments],
        "level": [kept.level for kept in moments],
        "state": [texts.number(kept.state) for kept in moments],
        "notices": [[texts.number(said) for said in kept.notices] for kept in moments],
        "stroke": writer.block(stroke[:, None], _step(stroke)),
        "force": writer.block(force[:, None], _step(force)),
        "counts": _counts(force),
        "events": [_event(event, increments) for event in last.events],
    }


def _event(event: Event, increments: Sequence[int]) -> dict[str, Any]:
    """An event, and the first moment that shows it."""
    moment = int(np.searchsorted(increments, event.increment))
    return {
        "kind": event.kind,
        "moment": min(moment, len(increments) - 1),
        "increment": event.increment,
        "stroke": _number(event.stroke),
        "force": _number(event.force),
        "text": in_each(lambda: words.say(event.text)),
    }


def view_of(view: View, tops: Mapping[str, float]) -> dict[str, Any]:
    """A view as the script knows it, with the top of its scale if there is one in ``tops``."""
    return {
        "name": view.name,
        "title": in_each(lambda: view.title),
        "unit": view.unit,
        "top": tops.get(view.name),
        "least": view.least,
        "valued": view.measure is not None,
        "ramp": "fringes" if view.name == "fringes" else "fill",
        "made": view.made,
        "chains": view.chains,
        "onlyChains": view.only_chains,
    }


def _tops(panes: Sequence[Sequence[Kept]]) -> Tops:
    """One scale for all moments and all packings."""
    all_kept = [kept for moments in panes for kept in moments]
    row = {name: k for k, name in enumerate(QUANTITIES)}

    def top(least: float, values: Callable[[Kept], NDArray[np.float32]]) -> float:
        each = [typical_largest(values(kept).astype(np.float64)) for kept in all_kept]
        return nice_ceiling(max(float(np.percentile(each, USUAL)), least), FINER)

    pushes = [math.hypot(h.fx, h.fy) for kept in all_kept for h in kept.handles]
    return Tops(
        pressure=top(VIEWS["pressure"].least, lambda kept: kept.grains[row["pressure"]]),
        stress=top(VIEWS["fringes"].least, lambda kept: kept.grains[row["stress"]]),
        motion=top(VIEWS["motion"].least, lambda kept: kept.grains[row["motion"]]),
        force=top(LEAST_FORCE, lambda kept: kept.force),
        hand=nice_ceiling(max(_largest(pushes), LEAST_PUSH), FINER),
    )


def _bounds(moments: Sequence[Kept]) -> list[float]:
    """What the camera shows, the whole time."""
    bounds = np.array([kept.bounds for kept in moments])
    return [float(v) for v in (*bounds[:, :2].min(axis=0), *bounds[:, 2:].max(axis=0))]


def _finite(values: Floats) -> Floats:
    """A curve without gaps, and never empty."""
    return carried(values[:, None])[:, 0] if values.size else np.zeros(1)


def _step(values: Floats) -> float:
    if _counts(values):
        return 1.0
    return max(float(np.ptp(values)), 1e-6) / CURVE_STEPS


def _counts(values: Floats) -> bool:
    """Do they count something? A curve of nothing but zeros is a force that was none."""
    return bool((values == np.rint(values)).all() and values.any())


def _number(value: float) -> float:
    return float(f"{value:.6g}") if math.isfinite(value) else 0.0


def _largest(values: Iterable[float]) -> float:
    return max(filter(math.isfinite, values), default=0.0)

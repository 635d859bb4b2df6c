"""A sketched prediction in words: where the pen is, what has been drawn, and how far what is measured lies from it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.draw.marks import marks
from sandbox.draw.plot import unit_of
from sandbox.draw.sketch import Beside, Sketch
from sandbox.draw.widgets.scale import shown
from sandbox.lessons.answers import mean_distance
from sandbox.session.frame import Frame
from sandbox.words import words

FIGURES = 3  # of a number that a hand has drawn


def told(sketch: Sketch, frame: Frame) -> str:
    """What is predicted: of what, by how many points, from where to where."""
    drawn = np.isfinite(sketch.up)
    what = words.SKETCH_OF.format(
        up=words.say(frame.curve_label), along=words.say(frame.stroke_label)
    )
    if not drawn.any():
        return f"{what}. {words.SKETCH_NOTHING}"
    along, up = sketch.along[drawn], sketch.up[drawn]
    most, least = int(np.argmax(up)), int(np.argmin(up))
    points = words.SKETCH_POINTS.format(
        count=int(drawn.sum()),
        begin=_figures(along[0]),
        first=_figures(up[0]),
        end=_figures(along[-1]),
        last=_figures(up[-1]),
        most=_figures(up[most]),
        most_at=_figures(along[most]),
        least=_figures(up[least]),
        least_at=_figures(along[least]),
    )
    return f"{what}. {points}"


def pen(sketch: Sketch) -> str:
    """Where the keyboard draws; nothing while it does not."""
    if sketch.cursor is None:
        return ""
    along, up = sketch.cursor
    return words.SKETCH_PEN.format(along=_figures(along), up=_figures(up))


def beside(sketch: Sketch, frames: Sequence[Frame]) -> list[Beside]:
    """The curves that were measured, each with how far it lies from the sketch; none where they have nothing in common."""
    found = []
    for frame, mark in zip(frames, marks(frames), strict=True):
        away = mean_distance(frame.curve_stroke, frame.curve_force, sketch.along, sketch.up)
        if math.isfinite(away):
            distance = f"{_figures(away)} {words.unit(unit_of(frame.curve_label))}".rstrip()
            text = words.SKETCH_AWAY.format(name=mark.name, distance=distance)
            found.append(Beside(text, mark.colour, mark.dash))
    return found


def _figures(value: float) -> str:
    return shown(float(f"{value:.{FIGURES}g}"))

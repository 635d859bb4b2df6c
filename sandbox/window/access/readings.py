"""What is read off what runs: the line under the canvases, force and way of every packing, what is said there, and a sketch."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sandbox.draw.lamp import lamp
from sandbox.draw.marks import marks
from sandbox.draw.pane import said_of
from sandbox.draw.plot import unit_of
from sandbox.draw.status import items
from sandbox.draw.widgets.scale import shown
from sandbox.session.frame import Frame
from sandbox.window import sketched
from sandbox.window.access.node import Node, label
from sandbox.window.asking import Asking
from sandbox.window.stage import Stage
from sandbox.words import words


def frames_of(stage: Stage) -> list[Frame]:
    """What runs, from the left."""
    return [pane[0] for pane in stage.picture.panes()]


def nodes_of_readings(stage: Stage) -> Iterator[Node]:
    """All of it, a node each: it may be read at any time."""
    frames = frames_of(stage)
    line = " · ".join(item.text for item in items(frames, stage.panes.paused))
    yield label("line", line, stage.renderer.layout.status)
    for k, (frame, name) in enumerate(zip(frames, names_of(frames), strict=True)):
        yield label(f"status/{k}", f"{name}{lamp(frame, stage.renderer.theme).words}")
        if name and frame.grains_out:  # one that is alone has it in the line
            yield label(f"out/{k}", f"{name}{words.GRAINS_OUT.format(count=frame.grains_out)}")
        for what, text in zip(("force", "stroke"), _measured(frame), strict=False):
            yield label(f"{what}/{k}", f"{name}{text}", stage.renderer.layout.plot)
        for place, text in enumerate(said_of(frame)):
            yield label(f"said/{k}/{place}", f"{name}{text}")


def nodes_of_sketch(asking: Asking, frames: Sequence[Frame]) -> Iterator[Node]:
    """A prediction that lies over the plot, and how far from it what has been measured is."""
    if asking.sketch is not None and not asking.on:
        rect = asking.stage.renderer.layout.plot
        yield label("sketch", sketched.told(asking.sketch, frames[0]), rect)
        for k, each in enumerate(asking.measured):
            yield label(f"sketch/{k}", each.text, rect)


def names_of(frames: Sequence[Frame]) -> list[str]:
    """What tells them apart, before what is said of one; nothing where there is one alone."""
    return [f"{mark.name}: " for mark in marks(frames)] if len(frames) > 1 else [""] * len(frames)


def reading(stage: Stage, frame: Frame) -> str:
    """Force, way, grains out, and how sure that is, in a breath."""
    out = [words.GRAINS_OUT.format(count=frame.grains_out)] if frame.grains_out else []
    return ", ".join([*_measured(frame), *out, lamp(frame, stage.renderer.theme).words])


def _measured(frame: Frame) -> list[str]:
    """Force and way now; nothing before there is a curve."""
    if not len(frame.curve_force):
        return []
    both = (frame.curve_label, frame.curve_force), (frame.stroke_label, frame.curve_stroke)
    return [_with_unit(words.say(label), float(values[-1])) for label, values in both]


def _with_unit(label: str, value: float) -> str:
    """What stands on an axis, and a value of it: the unit where it is heard with the number."""
    unit = unit_of(label)
    name = label.removesuffix(f"[{unit}]").strip() if unit else label
    return f"{name} {shown(value)} {unit}".rstrip()

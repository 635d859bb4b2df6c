"""Handles as sliders: one along the line that a handle can slide on, or one to the right and one upwards."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from sandbox.draw.numbers import number
from sandbox.draw.widgets.scale import shown
from sandbox.lessons.moments import PLACE_DECIMALS
from sandbox.session.frame import Frame, HandleState
from sandbox.window.access.node import Do, Node, Number, changes
from sandbox.window.canvas.arrows import FINE_STEP, STEP, Arrows
from sandbox.window.focus import CANVAS
from sandbox.words import words

Take = Callable[[str], bool]  # a handle by the name of its stop; False: not now, which is said


def hand_keys() -> str:
    """What pulls a handle, and how far."""
    return words.HAND_KEYS.format(step=number(STEP, 2), fine=number(FINE_STEP, 2))


def nodes_of_handle(
    handle: HandleState, frame: Frame, arrows: Arrows, take: Take
) -> Iterator[Node]:
    """They tell where the body is [R], and lead it as the arrow keys do, or to a place, once it is taken."""
    x0, y0, x1, y1 = frame.bounds
    name, title = f"{CANVAS}/{handle.name}", words.say(handle.label)
    if handle.axis is None:
        yield _along((1.0, 0.0), (x0, x1), f"{name}/x", f"{title}, x", handle, arrows, take)
        yield _along((0.0, 1.0), (y0, y1), f"{name}/y", f"{title}, y", handle, arrows, take)
    else:
        x, y = handle.axis
        axis = (-x, -y) if (y if abs(y) > abs(x) else x) < 0.0 else (x, y)  # more: right, or up
        place, far = _place(handle, axis), max(x1 - x0, y1 - y0)
        yield _along(axis, (place - far, place + far), name, title, handle, arrows, take)


def _place(handle: HandleState, axis: tuple[float, float]) -> float:
    return handle.x * axis[0] + handle.y * axis[1]


def _along(
    axis: tuple[float, float],
    ends: tuple[float, float],
    name: str,
    title: str,
    handle: HandleState,
    arrows: Arrows,
    take: Take,
) -> Node:
    place, focus = _place(handle, axis), f"{CANVAS}/{handle.name}"

    def lead_to(to: float) -> None:
        if take(focus):
            by = to - place
            arrows.lead_to(handle, handle.x + by * axis[0], handle.y + by * axis[1])

    def lead(by: float) -> None:
        if take(focus):
            arrows.lead(handle, by * axis[0], by * axis[1])

    told, low, high = (round(value, PLACE_DECIMALS) for value in (place, *ends))
    number = Number(told, low, high, STEP)
    does: dict[str, Do] = {"FOCUS": lambda _: arrows.stage.focus.go(focus, True)}
    does |= changes(number, lead_to)
    does |= {"INCREMENT": lambda _: lead(STEP), "DECREMENT": lambda _: lead(-STEP)}
    about = f"[R] {hand_keys()}"
    return Node(name, "SLIDER", title, f"{shown(place)} R", about, number, does=does)

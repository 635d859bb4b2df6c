"""What a screen reader can be told of one thing in the window, and what it can ask of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import pygame

Do = Callable[[Any], None]  # with the value that was given, if the action has one
Edges = tuple[int, int, int, int] | None  # left, top, right, bottom in the window [px]
ROOT = "window"


@dataclass(frozen=True, slots=True)
class Number:
    """A value on a scale."""

    value: float
    low: float
    high: float
    step: float


@dataclass(frozen=True, slots=True)
class Node:
    """One thing. Roles and actions are called as AccessKit calls them."""

    name: str  # tells it from all others
    role: str
    label: str = ""
    text: str = ""  # its value in words
    about: str = ""
    number: Number | None = None
    on: bool | None = None  # of what can be switched
    open: bool | None = None  # of what can be folded
    enabled: bool = True
    live: bool = False  # it is read out when it appears
    rect: Edges = None
    children: tuple[str, ...] = ()
    does: Mapping[str, Do] = field(default_factory=dict, compare=False)


def edges(rect: pygame.Rect | None) -> Edges:
    """A place in the window as a node has it."""
    return None if rect is None else (rect.left, rect.top, rect.right, rect.bottom)


def label(name: str, text: str, rect: pygame.Rect | None = None) -> Node:
    """Something to read."""
    return Node(name, "LABEL", text=text, rect=edges(rect))


def button(name: str, title: str, press: Callable[[], object], **more: Any) -> Node:
    """Something to press."""
    does = {"CLICK": lambda _: press(), **more.pop("does", {})}
    return Node(name, "BUTTON", title, does=does, **more)


def changes(number: Number, give: Callable[[float], object]) -> dict[str, Do]:
    """To a value within the range, and by a step."""

    def to(value: float) -> None:
        give(min(max(float(value), number.low), number.high))

    return {
        "SET_VALUE": to,
        "INCREMENT": lambda _: to(number.value + number.step),
        "DECREMENT": lambda _: to(number.value - number.step),
    }

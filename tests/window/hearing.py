"""What tests of the window for screen readers share: a desk, what is there to be read, and a reader's asking."""

from __future__ import annotations

from sandbox.window.access.tree import Tree
from tests.window.desk import Desk


def open_desk() -> Desk:
    """The intruder, and all of the panel unfolded."""
    desk = Desk((1024, 720))
    desk.start()
    desk.app.panel.folded.clear()
    desk.app.tick()
    return desk


def seen(desk: Desk) -> Tree:
    """What is there to be read."""
    return Tree(desk.app.reader.parts)


def do(desk: Desk, name: str, action: str = "CLICK", value: object = None) -> None:
    """As a screen reader asks for it."""
    seen(desk).nodes[name].does[action](value)
    desk.app.tick()

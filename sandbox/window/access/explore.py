"""Explore as nodes: what is asked, line by line with less and more, how it stands, and every cell of the map."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from sandbox.draw.pages.explore_page import Line, MapCell
from sandbox.window.access.node import Do, Node, button, edges, label
from sandbox.window.explore.page import ExplorePage
from sandbox.words import words

NAME = "explore"


def nodes_of_explore(page: ExplorePage) -> Iterator[Node]:
    """Everything on the page."""
    yield label(f"{NAME}/status", page.status)
    for line in page.lines():
        yield from _line(page, line)
    for cell in page.explorer.progress.cells:
        name, rect = f"{NAME}/cell/{cell.row}", edges(page.place_of(cell))
        yield button(name, page.about(cell), _take(page, cell), rect=rect)


def chosen(page: ExplorePage) -> str:
    """The node of what has the keyboard."""
    return f"{NAME}/{page.chosen}" if page.pointed is None else f"{NAME}/cell/{page.pointed.row}"


def _take(page: ExplorePage, cell: MapCell) -> Callable[[], None]:
    return lambda: page.take(cell, beside=False)


def _line(page: ExplorePage, line: Line) -> Iterator[Node]:
    name, own = f"{NAME}/{line.name}", line.name
    focus: dict[str, Do] = {"FOCUS": lambda _: page.choose(own)}
    if page.is_button(own):
        title = f"{line.title}: {line.value}" if line.value else line.title
        yield button(name, title, lambda: page.press(own), does=focus)
        return

    def by(way: int) -> None:
        page.choose(own)
        page.change(own, way)

    does = focus | {"INCREMENT": lambda _: by(1), "DECREMENT": lambda _: by(-1)}
    side = {"0": words.EXPLORE_ACROSS, "1": words.EXPLORE_UP}.get(own[0], line.title)
    said = line.title if side == line.title else f"{side}, {line.title}"
    yield Node(name, "SPIN_BUTTON", said, line.value, does=does)
    yield button(f"{name}/less", f"{said} {line.value}, {words.LESS}", lambda: by(-1))
    yield button(f"{name}/more", f"{said} {line.value}, {words.MORE}", lambda: by(1))

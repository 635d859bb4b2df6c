"""The way to AccessKit: what is sent to a reader and when, and what it asks for."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pygame
import pytest

from sandbox.session.commands import Change
from sandbox.window.access import reader as reader_module
from sandbox.window.access.node import ROOT, Node
from sandbox.window.access.reader import Reader
from tests.window.desk import Desk
from tests.window.fake_session import FakeSession
from tests.window.hearing import open_desk, seen

NU = "grains/regular_poisson_ratio"


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = open_desk()
    yield place
    place.app.close()


class FakeAdapter:
    """Keeps what is sent. AccessKit's would wait for its lock, and the window with it, until a reader has been let in."""

    def __init__(self, let_in: Callable[[], Any], ask: Callable[[Any], None], leave: Any) -> None:
        self.let_in, self.ask, self._leave = let_in, ask, leave
        self.there = False
        self.updates: list[Any] = []
        self.focused: list[bool] = []

    def come(self) -> Any:
        first = self.let_in()
        self.there = True
        return first

    def leave(self) -> None:
        self.there = False
        self._leave()

    def update_if_active(self, update: Callable[[], Any]) -> None:
        assert self.there
        self.updates.append(update())

    def update_window_focus_state(self, has_it: bool) -> None:
        assert self.there
        self.focused.append(has_it)

    def set_root_window_bounds(self, outer: object, inner: object) -> None:
        assert self.there


class FakeNode:
    """Takes everything."""

    def __init__(self, role: str) -> None:
        self.role = role
        self.told: dict[str, object] = {}

    def __getattr__(self, name: str) -> Callable[..., None]:
        return lambda *values: self.told.update({name: values[0] if values else True})


class Names:
    """Role.SLIDER is "SLIDER"."""

    def __getattr__(self, name: str) -> str:
        return name


@pytest.fixture
def accesskit(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """The library, as far as it is used."""
    fake = SimpleNamespace(
        unix=SimpleNamespace(Adapter=FakeAdapter),
        Node=FakeNode,
        TreeUpdate=lambda focus: SimpleNamespace(focus=focus, nodes=[], tree=None),
        Tree=lambda root: SimpleNamespace(root=root, toolkit_name=""),
        Rect=lambda *edges: edges,
        Role=Names(),
        Action=Names(),
        Live=Names(),
        Toggled=Names(),
    )
    monkeypatch.setattr(reader_module, "accesskit", fake)
    monkeypatch.setattr(reader_module.sys, "platform", "linux")  # type: ignore[attr-defined]
    return fake


def test_who_comes_is_told_all_and_then_only_what_has_changed(
    desk: Desk, accesskit: SimpleNamespace
) -> None:
    reader = Reader(desk.app.reader.parts)
    adapter = reader._adapter
    reader.tick(0.0)
    assert adapter.updates == []  # nobody listens
    first = adapter.come()
    assert [number for number, _ in first.nodes] == [first.focus]
    reader.tick(1.0)
    (whole,) = adapter.updates
    assert len(whole.nodes) == len(seen(desk).nodes)
    by_name = {node.told["set_author_id"]: node.told for _, node in whole.nodes}
    assert by_name[NU]["set_numeric_value"] == 0.8
    assert by_name["general/drive"]["set_toggled"] == "FALSE"
    reader.tick(1.01)  # too soon to look again
    reader.tick(2.0)  # nothing new
    assert len(adapter.updates) == 1
    desk.app.stage.renderer.set_view("pressure")
    desk.app.tick()
    reader.tick(3.0)
    changed = {node.told["set_author_id"] for _, node in adapter.updates[1].nodes}
    assert {"general/view#kind", "general/view#pressure"} <= changed
    assert len(changed) < 5
    desk.app.stage.toast("something")
    reader.tick(4.0)
    (live,) = [n.told for _, n in adapter.updates[2].nodes if "set_live" in n.told]
    assert live["set_value"] == "something"
    adapter.leave()
    desk.app.stage.renderer.set_view("kind")
    reader.tick(5.0)
    assert len(adapter.updates) == 3
    adapter.come()
    adapter.leave()
    adapter.come()  # all of it within one picture, however long that takes
    reader.tick(60.0)
    assert len(adapter.updates[3].nodes) >= len(whole.nodes)  # all of it, for another one


def test_while_a_reader_is_let_in_nothing_is_sent(
    desk: Desk, accesskit: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The window would wait for a lock that is held by who waits for the window's thread: for ever."""
    reader = Reader(desk.app.reader.parts)
    events = [
        pygame.event.Event(kind)
        for kind in (pygame.WINDOWSHOWN, pygame.WINDOWMOVED, pygame.WINDOWFOCUSGAINED)
    ]

    def pictures() -> None:
        for now in (0.0, 60.0):
            for event in events:
                reader.watch(event)
            reader.tick(now)

    monkeypatch.setattr(pygame.key, "get_focused", lambda: True)
    pictures()
    made = accesskit.TreeUpdate

    def interrupted(focus: int) -> Any:
        pictures()
        return made(focus)

    accesskit.TreeUpdate = interrupted
    adapter = reader._adapter
    adapter.come()
    accesskit.TreeUpdate = made
    assert adapter.updates == []
    reader.tick(61.0)
    assert adapter.focused == [True]  # what came before the reader is told now
    assert len(adapter.updates) == 1
    reader.watch(pygame.event.Event(pygame.WINDOWFOCUSLOST))
    assert adapter.focused == [True, False]


def test_requests_are_done_and_those_that_come_too_late_are_not(
    desk: Desk, accesskit: SimpleNamespace
) -> None:
    reader = Reader(desk.app.reader.parts)
    reader._adapter.come()
    reader.tick(0.0)
    ids = dict(reader._ids)

    def ask(name: str, action: str, data: object = None) -> None:
        reader._adapter.ask(SimpleNamespace(target=ids[name], action=action, data=data))

    ask(NU, "SET_VALUE", ("NUMERIC_VALUE", 0.3))
    ask("general/redo", "CLICK")  # not enabled
    ask("general/reset", "EXPAND")  # no such thing
    reader._adapter.ask(SimpleNamespace(target=10**6, action="CLICK", data=None))
    reader.tick(0.2)
    desk.until(lambda: bool(desk.session.commands))
    assert desk.session.commands == [Change("regular_poisson_ratio", 0.3)]


def test_another_scene_can_begin_by_request(
    desk: Desk, accesskit: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between two pictures, as by a key: nothing is drawn of what is no more, nor of what is not there yet."""
    built, build = threading.Event(), FakeSession.build

    def slowly(self: FakeSession, progress: Any = None) -> None:
        built.wait(20.0)
        build(self, progress)

    monkeypatch.setattr(FakeSession, "build", slowly)
    desk.app.pages.open_menu()
    reader = desk.app.reader = Reader(desk.app.reader.parts)
    reader._adapter.come()
    desk.until(lambda: bool(reader._sent))
    request = SimpleNamespace(target=reader._ids["scene/couette"], action="CLICK", data=None)
    reader._adapter.ask(request)
    desk.until(lambda: desk.session.scene == "couette")
    for _ in range(5):
        desk.app.tick()
    assert seen(desk).nodes["cancel"].does  # a way out while it is built
    built.set()
    desk.until(lambda: "canvas" in reader._sent)


def test_while_nobody_listens_nothing_is_looked_at(
    desk: Desk, accesskit: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(reader_module, "Tree", never)
    reader = Reader(desk.app.reader.parts)
    for now in range(100):
        reader.tick(float(now))
    assert reader._adapter.updates == []


def test_without_the_extra_there_is_nothing(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reader_module, "accesskit", None)
    reader = Reader(desk.app.reader.parts)
    reader.watch(pygame.event.Event(pygame.WINDOWFOCUSLOST))
    reader.tick(1.0)
    assert reader._adapter is None
    assert isinstance(seen(desk).nodes[ROOT], Node)

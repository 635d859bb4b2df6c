"""The window as a screen reader has it: a tree of what is shown, what can be done with it, and what is said."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pygame
import pytest

from sandbox.draw.pages.explore_page import MapCell
from sandbox.draw.painter import Painter
from sandbox.draw.widgets.scale import shown
from sandbox.lessons.answers import mean_distance
from sandbox.lessons.reading import parse_lesson
from sandbox.session.commands import Change, Grab, Move, Protocol
from sandbox.session.history import Event
from sandbox.window.access import reader as reader_module
from sandbox.window.access.handles import hand_keys
from sandbox.window.access.node import ROOT, Node
from sandbox.window.access.reader import Reader
from sandbox.window.access.speech import Speech
from sandbox.window.access.tree import Tree
from sandbox.window.asking import SKETCH
from sandbox.window.canvas.arrows import FINE_STEP, STEP
from sandbox.window.focus import CANVAS
from sandbox.window.solvers.snapshot import Snapshot
from sandbox.words import language, words
from tests.window.desk import Desk
from tests.window.fake_session import FakeSession

NU = "grains/regular_poisson_ratio"


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = Desk((1024, 720))
    place.start()
    place.app.panel.folded.clear()
    place.app.tick()
    yield place
    place.app.close()


def seen(desk: Desk) -> Tree:
    return Tree(desk.app.reader.parts)


def do(desk: Desk, name: str, action: str = "CLICK", value: object = None) -> None:
    """As a screen reader asks for it."""
    seen(desk).nodes[name].does[action](value)
    desk.app.tick()


def pages(desk: Desk) -> Iterator[tuple[str, Tree]]:
    """All that can be shown."""
    app = desk.app
    yield "run", seen(desk)
    app.panel.fold()
    app.tick()
    yield "folded", seen(desk)
    app.panel.fold()
    app.tick()
    app.brush.take(True)
    app.inspector.look(3)
    app.guide.start("intruder")
    desk.until(lambda: bool(app.stage.picture.panes()))
    app.tick()
    yield "tour", seen(desk)
    app.guide.close()
    desk.key(pygame.K_e)
    yield "question", seen(desk)
    desk.key(pygame.K_ESCAPE)
    desk.key(pygame.K_h)
    yield "help", seen(desk)
    desk.key(pygame.K_h)
    desk.key(pygame.K_x)
    yield "explore", seen(desk)
    desk.key(pygame.K_ESCAPE)
    app.pages.open_menu()
    app.tick()
    yield "menu", seen(desk)


def test_everything_that_is_shown_has_a_name_and_a_place_in_the_tree(desk: Desk) -> None:
    for code in language.available():
        language.use(code)
        for page, tree in pages(desk):
            told = {ROOT}
            for node in tree.nodes.values():
                assert node.label or node.text, (code, page, node)
                assert (node.label or node.text)[0] not in "▶⏸⏭◉○×›", (code, page, node)
                said = node.label.removesuffix(".").lower()
                assert not said or said not in node.about.lower().split("."), (code, page, node)
                assert len(set(node.children)) == len(node.children), (page, node)
                told |= set(node.children)
            assert told == set(tree.nodes), page
            assert tree.focus in tree.nodes, page
        desk.app.stage.start("intruder")
        desk.until(lambda: not desk.app._splash and bool(desk.app.stage.picture.panes()))


def test_while_packings_side_by_side_are_built_each_is_told_of_by_itself(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A child that is named twice ends AccessKit, and the program with it."""
    built = threading.Event()

    def slowly(session: FakeSession, progress: Any) -> None:
        progress("packing the grains", 0.5)
        built.wait(20.0)
        session.built += 1

    monkeypatch.setattr(FakeSession, "build", slowly)
    panes = desk.app.stage.panes
    desk.app.stage.start("intruder", packings=("regular", "mixed", "auxetic"))
    desk.until(lambda: all(one.phase == "building" and one.text for one in panes.snapshots))
    tree = seen(desk)
    built.set()
    named = [name for node in tree.nodes.values() for name in node.children]
    assert len(named) == len(set(named)) == len(tree.nodes) - 1
    told = [node.text for name, node in tree.nodes.items() if name.startswith("told/")]
    assert len(told) == 3
    for packing, text in zip(panes.packings, told, strict=True):
        assert text.startswith(f"{words.PACKINGS[packing]}: "), text


def test_every_stop_of_the_keyboard_is_in_the_tree(desk: Desk) -> None:
    tree = seen(desk)
    for stop in desk.app.stage.focus.stops():
        found = [name for name in tree.nodes if name == stop or name.startswith(f"{stop}/")]
        assert found, stop
        tree.nodes[found[0]].does["FOCUS"](None)
        assert desk.app.stage.focus.name == stop
        focus = seen(desk).focus
        assert focus.startswith(stop), (focus, stop)


def test_controls_tell_what_they_are(desk: Desk) -> None:
    nodes = seen(desk).nodes
    slider = nodes[NU]
    assert (slider.role, slider.label) == ("SLIDER", words.parameter_name("regular_poisson_ratio"))
    assert slider.number is not None
    assert (slider.number.value, slider.number.low, slider.number.high) == (0.8, 0.0, 0.99)
    assert nodes["general/seed"].role == "SPIN_BUTTON"
    assert nodes["looks/chains"].role == "SWITCH"
    assert nodes["general/drive"].on is False
    assert nodes["general/reset"].on is None
    assert nodes["general/redo"].enabled is False
    assert nodes["general/redo"].does == {}
    assert [nodes[name].on for name in nodes["general/packing"].children] == [False, False, True]
    assert nodes["time/play"].label in (words.PAUSE, words.PLAY)
    strength = nodes["hand/hand_strength"]
    assert strength.about.startswith("[k R] ")
    desk.app.stage.focus.go("general/packing", True)
    assert seen(desk).focus == "general/packing#mixed"


def test_what_is_asked_of_a_control_is_done(desk: Desk) -> None:
    do(desk, NU, "SET_VALUE", 0.5)
    desk.until(lambda: Change("regular_poisson_ratio", 0.5) in desk.session.commands)
    do(desk, NU, "INCREMENT")
    desk.until(lambda: Change("regular_poisson_ratio", 0.51) in desk.session.commands)
    do(desk, "general/seed", "SET_VALUE", 7.0)
    desk.until(lambda: Change("seed", 7) in desk.session.commands)
    do(desk, "general/drive")
    desk.until(lambda: Protocol(True) in desk.session.commands)
    desk.until(lambda: seen(desk).nodes["general/drive"].on is True)
    do(desk, "general/view#pressure")
    assert desk.app.stage.renderer.view.name == "pressure"
    do(desk, "looks/chains")
    assert seen(desk).nodes["looks/chains"].on is desk.app.stage.renderer.chains
    do(desk, "grains", "COLLAPSE")
    desk.app.tick()
    assert NU not in seen(desk).nodes
    do(desk, "grains", "EXPAND")
    desk.app.tick()
    assert NU in seen(desk).nodes
    do(desk, "files/name", "SET_VALUE", "mine")
    desk.app.tick()
    assert seen(desk).nodes["files/name"].text == "mine"


def test_a_handle_is_led_and_goes_where_it_is_told(desk: Desk) -> None:
    """One that goes anywhere is a slider to the right and one upwards."""
    x = "canvas/intruder/x"
    before = seen(desk).nodes[x].number
    assert before is not None
    for name in (x, CANVAS):  # and it says how far keys lead it, with Shift too
        assert hand_keys() in seen(desk).nodes[name].about
        assert f"{STEP:g} R" in hand_keys()
        assert f"Shift by {FINE_STEP:g} R" in hand_keys()
    do(desk, x, "INCREMENT")
    moved = [done for done in desk.session.commands if isinstance(done, Move)]
    desk.until(lambda: any(isinstance(done, Move) for done in desk.session.commands))
    moved = [done for done in desk.session.commands if isinstance(done, Move)]
    assert moved[0].x == pytest.approx(before.value + 0.25, abs=1e-3)
    assert Grab("intruder") in desk.session.commands
    assert seen(desk).focus == x
    do(desk, x, "SET_VALUE", before.value + 5.0)
    desk.until(
        lambda: (
            (desk.session.commands[-1].x if isinstance(desk.session.commands[-1], Move) else 0.0)
            == pytest.approx(before.value + 5.0, abs=0.3)
        )
    )


def test_the_menu_leads_to_a_scene_and_the_help_closes(desk: Desk) -> None:
    desk.app.pages.open_menu()
    desk.app.tick()
    do(desk, "keys")
    assert seen(desk).focus == "help/close"
    do(desk, "help/close")
    assert seen(desk).focus.startswith("scene/")
    do(desk, "packing/regular")
    assert seen(desk).nodes["packing/regular"].on is True
    do(desk, "scene/couette", "FOCUS")
    assert seen(desk).focus == "scene/couette"
    do(desk, "scene/couette")
    desk.until(lambda: desk.page() == "run" and bool(desk.app.stage.picture.panes()))
    assert desk.session.scene == "couette"


def test_the_export_question_is_answered(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[int] = []
    monkeypatch.setattr(desk.app.question, "answer", given.append)
    desk.key(pygame.K_e)
    do(desk, "question/1")
    assert given == [1]


def test_a_map_is_asked_for_and_a_cell_of_it_opened(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    desk.key(pygame.K_x)
    page = desk.app.pages.explore
    before = seen(desk).nodes["explore/0high"].text
    do(desk, "explore/0high/less")
    assert seen(desk).nodes["explore/0high"].text != before
    assert seen(desk).focus == "explore/0high"
    went: list[bool] = []
    monkeypatch.setattr(page, "go_or_stop", lambda: went.append(True))
    do(desk, "explore/go")
    assert went == [True]
    first, second = (side.values() for side in page._sides)
    cell = MapCell((first[0], second[0]), 0.5, (0.2, 0.8), 10, 10, 1, "clog")
    progress = replace(page.explorer.progress, cells=(cell,))
    monkeypatch.setattr(page.explorer, "progress", progress)
    taken: list[MapCell | None] = []
    monkeypatch.setattr(page, "take", lambda cell, beside: taken.append(cell))
    assert seen(desk).nodes["explore/cell/1"].label == page.about(cell)
    do(desk, "explore/cell/1")
    assert taken == [cell]


# -- what is said --


def test_notices_and_events_are_said_once(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    stage = desk.app.stage
    speech = Speech(stage, desk.app.guide)
    stage.toast("before anybody listened")
    speech.begin()
    assert list(speech.new()) == []
    for text in ("one", "two", "two"):
        stage.toast(text)
    assert list(speech.new()) == ["one", "two", "two"]
    ((frame, camera, rect),) = stage.picture.panes()
    event = Event("clog", 3, 0.1, 1.0, "the grains have locked up")
    pane = replace(frame, events=(*frame.events, event)), camera, rect
    monkeypatch.setattr(stage.picture, "panes", lambda: (pane,))
    assert list(speech.new()) == [event.text]
    assert list(speech.new()) == []


@pytest.mark.parametrize("packings", [(), ("regular", "auxetic")])
def test_every_reading_under_the_canvases_is_in_the_tree(
    desk: Desk, monkeypatch: pytest.MonkeyPatch, packings: tuple[str, ...]
) -> None:
    """All words that are drawn there, but for the pictures a second."""
    stage = desk.app.stage
    stage.start("intruder", packings=packings)
    desk.until(lambda: len(stage.picture.panes()) == max(len(packings), 1))
    stage.send(Protocol(True))
    desk.until(lambda: all(pane[0].increment > 2 for pane in stage.picture.panes()))
    desk.key(pygame.K_SPACE)
    frames = [pane[0] for pane in stage.picture.panes()]
    told = replace(frames[0], notices=("cancelled: everything is as it was before",), grains_out=3)
    panes = [
        (frame, *pane[1:])
        for frame, pane in zip([told, *frames[1:]], stage.picture.panes(), strict=True)
    ]
    monkeypatch.setattr(stage.picture, "panes", lambda: panes)
    renderer, drawn = stage.renderer, []
    text = Painter.text

    def noted(painter: Painter, said: str, x: float, y: float, **more: Any) -> pygame.Rect:
        under = y > renderer.layout.canvas.bottom - renderer.layout.canvas.height // 3
        if under and not renderer.layout.timeline.collidepoint(x, y):
            drawn.append(said)
        return text(painter, said, x, y, **more)

    monkeypatch.setattr(Painter, "text", noted)
    renderer.draw([frame for frame, *_ in panes], paused=stage.panes.paused)
    nodes = seen(desk).nodes.values()
    there = " ".join(f"{node.label} {node.text}" for node in nodes)
    status = " ".join(node.text for node in nodes if node.name.startswith(("line", "status/")))
    assert len(drawn) > 5
    for one in drawn:
        if one in status or one.endswith("…"):
            continue
        for word in re.findall(r"[^\W\d_]+", one):  # the plot has fewer digits
            assert word in there, one
    assert words.GRAINS_OUT.format(count=3) in there
    for frame in frames:
        for values in (frame.curve_force, frame.curve_stroke):
            assert shown(float(values[-1])) in there


def test_readings_are_said_where_a_run_has_come_to_rest(desk: Desk) -> None:
    speech = Speech(desk.app.stage, desk.app.guide)
    frame = desk.app.stage.picture.panes()[0][0]
    speech.begin()

    def at(increment: int, now: float, busy: bool = False, missing: int = 0) -> list[str]:
        note = f"height {increment} R"
        curve = np.array([0.0, 0.25 * increment])
        moved = replace(frame, increment=increment, busy=busy, curve_force=curve, notices=(note,))
        snapshots = [Snapshot("running", frame=moved), *[Snapshot("building")] * missing]
        pane = moved, *desk.app.stage.picture.panes()[0][1:]
        speech.stage = SimpleNamespace(  # type: ignore[assignment]
            picture=SimpleNamespace(panes=lambda: [pane]),
            panes=SimpleNamespace(snapshots=snapshots),
            renderer=desk.app.stage.renderer,
        )
        return list(speech._from_the_readings(now))

    for step in range(1, 9):
        assert at(step, 100.0 + 0.1 * step) == []
    said, note = at(8, 103.0)
    assert note == "height 8 R"
    assert "force on the intruder 2 k R" in said
    assert at(8, 104.0) == []
    for now in (105.0, 109.0):  # an increment that takes long has not come to rest
        assert at(9, now, busy=True) == []
    for now in (110.0, 114.0):  # nor have packings side by side of which one is still built
        assert at(10, now, missing=1) == []
    assert at(10, 115.0) == []
    assert at(10, 116.0)


def test_what_was_said_when_it_happened_is_not_said_again_at_rest(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = desk.app.stage
    speech = Speech(stage, desk.app.guide)
    speech.begin()
    ((frame, camera, rect),) = stage.picture.panes()
    text = "an arch of 4 grains holds what is above"
    event = Event("arch", 3, 0.1, 1.0, text)
    later = replace(frame, increment=3, events=(*frame.events, event), notices=(text, "leaning"))
    monkeypatch.setattr(stage.picture, "panes", lambda: ((later, camera, rect),))
    assert list(speech._from_the_runs()) == [text]
    heard = [*speech._from_the_readings(100.0), *speech._from_the_readings(110.0)]
    assert heard[-1] == "leaning"
    assert text not in heard


SKETCHED = """
format = "auxetic-sandbox lesson"
version = 1
scene = "intruder"
[[step]]
key = "draw"
packings = ["mixed"]
say = "Look."
do = "Drag."
until = { increments = 2 }
[step.predict]
kind = "sketch"
ask = "How does it go on?"
along = [0, 30]
up = [0, 4]
"""


def test_a_sketch_is_told_while_it_is_drawn_and_compared_after(desk: Desk) -> None:
    app = desk.app
    speech = Speech(app.stage, app.guide)
    app.guide.begin(parse_lesson("mine", SKETCHED.encode(), ""))
    desk.until(lambda: bool(app.stage.picture.panes()) and not app._splash)
    app.tick()

    def heard(seconds: float = 0.0) -> list[str]:
        return [*speech._from_the_sketch(seconds), *speech._from_the_sketch(seconds + 10.0)]

    node = seen(desk).nodes[SKETCH]
    assert words.SKETCH_NOTHING in node.about
    assert app.stage.picture.panes()[0][0].curve_label in node.about
    assert any(one in node.about for one in heard())
    desk.key(pygame.K_SPACE, " ")
    for key in (*[pygame.K_RIGHT] * 8, *[pygame.K_UP] * 20):
        desk.key(key)
    desk.key(pygame.K_SPACE, " ")
    drawn = seen(desk).nodes[SKETCH].about
    assert "17 points, from 0 at 0 to 2 at 7.5" in drawn
    assert words.SKETCH_PEN.format(along="7.5", up="2") in drawn
    said = heard(20.0)
    assert any("17 points" in one for one in said)
    assert any("7.5" in one for one in said)
    assert heard(40.0) == []
    desk.key(pygame.K_RETURN, "\r")
    assert SKETCH not in seen(desk).nodes
    assert "17 points" in seen(desk).nodes["sketch"].text
    app.stage.send(Protocol(True))
    desk.until(lambda: app.guide.done)
    app.stage.panes.pause_or_go_on()
    desk.until(lambda: not app.stage.picture.panes()[0][0].busy)
    app.tick()
    frame = app.stage.picture.panes()[0][0]
    sketch = app.guide.asking.sketch
    assert sketch is not None
    away = mean_distance(frame.curve_stroke, frame.curve_force, sketch.along, sketch.up)
    (line,) = [each.text for each in app.guide.asking.measured]
    assert f"{shown(float(f'{away:.3g}'))} k R" in line
    assert seen(desk).nodes["sketch/0"].text == line
    assert heard(60.0) == [line]  # once


def test_a_lesson_says_what_comes_next(desk: Desk) -> None:
    speech = Speech(desk.app.stage, desk.app.guide)
    speech.begin()
    desk.app.guide.start("intruder")
    page = desk.app.guide.page
    said = list(speech.new())
    assert page.say in said
    assert page.do in said or not page.do
    desk.app.guide.next()
    later = list(speech.new())
    assert desk.app.guide.page.why in later or desk.app.guide.page.say in later
    assert page.say not in later


def test_a_long_wait_is_told_and_its_end(desk: Desk) -> None:
    speech = Speech(desk.app.stage, desk.app.guide)
    ready = desk.app.stage.panes.snapshot
    assert ready.frame is not None
    building = replace(ready, phase="building", text="compiling", frame=None)
    for snapshot, now, said in (
        (ready, 0.0, []),
        (building, 1.0, []),
        (building, 1.5, []),
        (building, 2.5, ["compiling"]),
        (building, 3.5, []),
        (ready, 4.0, [words.title("intruder", ready.frame.title)]),
        (ready, 5.0, []),
    ):
        speech.stage = SimpleNamespace(panes=SimpleNamespace(snapshot=snapshot))  # type: ignore[assignment]
        assert list(speech._from_the_build(now)) == said


# -- the way to AccessKit --


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

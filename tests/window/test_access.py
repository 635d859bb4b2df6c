"""The window as a screen reader has it: a tree of what is shown, and what can be done with it."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pygame
import pytest

from sandbox.draw.pages.explore_page import MapCell
from sandbox.draw.painter import Painter
from sandbox.draw.widgets.scale import shown
from sandbox.session.commands import Change, Grab, Move, Protocol
from sandbox.session.frame import Frame
from sandbox.window.access.handles import hand_keys
from sandbox.window.access.node import ROOT
from sandbox.window.access.tree import Tree
from sandbox.window.canvas.arrows import FINE_STEP, STEP
from sandbox.window.focus import CANVAS
from sandbox.window.measure.measuring import SPREADS
from sandbox.words import language, words
from tests.window.desk import Desk
from tests.window.fake_session import FakeSession
from tests.window.hearing import do, open_desk, seen

NU = "grains/regular_poisson_ratio"
X = "canvas/intruder/x"


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = open_desk()
    yield place
    place.app.close()


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


@pytest.mark.parametrize("held", [True, False])
def test_a_body_that_is_locked_holds_back_none_beside_it(
    desk: Desk, monkeypatch: pytest.MonkeyPatch, held: bool
) -> None:
    """The hand by keys, and the slider, go on from the body that has followed best."""
    stage, arrows = desk.app.stage, desk.app.reader.parts.arrows
    stage.start("intruder", packings=("regular", "mixed", "auxetic"))
    desk.until(lambda: not desk.app._splash and len(stage.picture.panes()) == 3)
    target = (9.0, 0.0) if held else None

    def at(frame: Frame, x: float, stroke: float) -> Frame:
        handle = replace(frame.handles[0], x=x, y=0.0, target=target)
        return replace(frame, handles=(handle,), stroke=stroke)

    places = {"regular": (1.0, 1.0), "mixed": (2.0, 2.0), "auxetic": (8.0, 8.0)}
    for pane in stage.panes._row.panes:
        pane.solver.stop()
        kept = pane.solver.snapshot
        assert kept.frame is not None
        moved = replace(kept, frame=at(kept.frame, *places[pane.packing]))
        pane.solver._snapshot = moved
    monkeypatch.setattr(stage, "send", lambda command: sent.append(command))
    sent: list[object] = []
    number = seen(desk).nodes[X].number
    assert number is not None
    assert number.value == 8.0
    stage.focus.go("canvas/intruder", True)
    handle = arrows.handle_state()
    assert handle is not None
    arrows.lead(handle, 0.25, 0.0)
    assert sent[-1] == Move("intruder", 9.25 if held else 8.25, 0.0)


def test_histograms_are_told_in_words_and_no_line_is_empty(desk: Desk) -> None:
    stage = desk.app.stage
    stage.start("intruder", packings=("regular", "auxetic"))
    desk.until(lambda: not desk.app._splash and len(stage.picture.panes()) == 2)
    desk.app.measuring.take(SPREADS)
    desk.app.tick()
    tree = seen(desk)
    read = [node for node in tree.nodes.values() if node.role == "LABEL"]
    assert all(node.text.strip(" :") == node.text for node in read), read
    told = [node.text for node in read if node.text.startswith(words.MEASURE_FORCES)]
    assert len(told) == 2
    for text in told:
        shares = text.rpartition(": ")[2].removesuffix(" %").split(words.LIST_SIGN)
        assert len(shares) > 8
        assert abs(sum(map(float, shares)) - 100.0) <= len(shares) / 2

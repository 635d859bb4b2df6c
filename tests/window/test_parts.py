"""Looking at a grain, arrow keys, scene files and earlier curves, at a window without a screen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pygame
import pytest

from sandbox.draw.camera import ALL
from sandbox.draw.widgets.controls import Fact, TextField
from sandbox.session.commands import (
    Change,
    Grab,
    Move,
    Release,
)
from sandbox.session.frame import Contacts
from sandbox.window.canvas.arrows import Arrows
from sandbox.words import words
from tests.window.at_panel import go_to, grain_place, sent, some_increments
from tests.window.desk import Desk

AT_WORK = (1024, 720)  # size of a window in which a scene runs already


# -- looking at a grain --


def test_click_looks_at_a_grain_and_escape_ends_it(desk: Desk) -> None:
    desk.click(grain_place(desk, 0))
    frame = desk.app.stage.picture.panes()[0][0]
    assert desk.app.inspector.inspection is not None
    assert desk.app.inspector.inspection.label == int(frame.label[0])
    desk.app.tick()
    facts = [
        place.control for place in desk.app.panel._places.all if isinstance(place.control, Fact)
    ]
    assert any(fact.title == words.GRAIN_PRESSURE for fact in facts)
    desk.key(pygame.K_ESCAPE)
    assert desk.app.inspector.label is None
    assert desk.page() == "run"
    assert sent(desk) == []


def test_click_between_the_grains_looks_at_none(desk: Desk) -> None:
    desk.click(grain_place(desk, 0))
    rect = desk.app.stage.renderer.layout.canvas
    desk.click((rect.left + 2, rect.top + 2))
    assert desk.app.inspector.label is None


def test_drag_and_handle_are_no_click(desk: Desk) -> None:
    x, y = grain_place(desk, 0)
    desk.press((x, y))
    desk.point((x + 40, y), pressed=True)
    desk.release((x + 40, y))
    assert desk.app.inspector.label is None
    desk.click(desk.handle_place())
    assert desk.app.inspector.label is None


def test_next_grain_in_contact_goes_along_the_strongest(desk: Desk) -> None:
    still = desk.session._still
    none = np.zeros(3)
    contacts = Contacts(
        none,
        none,
        none,
        none,
        np.array([0.1, 0.3, 0.2]),
        np.zeros(3, dtype=bool),
        np.array([0, 0, 1]),
        np.array([1, 2, 2]),
    )
    desk.session._still = replace(still, contacts=contacts)
    some_increments(desk, 1)
    desk.key(pygame.K_i)
    desk.app.inspector.look(0)
    seen = []
    for _ in range(5):
        desk.key(pygame.K_i)
        seen.append(desk.app.inspector.label)
    assert seen[:2] == [2, 1]  # the strongest, then one not seen yet
    assert set(seen) == {0, 1, 2}  # and round again
    go_to(desk, "general/menu")
    go_to(desk, f"grain/{desk.app.inspector.inspection.touches[0].label}")  # type: ignore[union-attr]
    before = desk.app.inspector.label
    desk.key(pygame.K_RETURN)
    assert desk.app.inspector.label != before


def test_from_a_grain_that_touches_nothing_to_the_nearest(desk: Desk) -> None:
    frame = desk.app.stage.picture.panes()[0][
        0
    ]  # nobody knows its contacts' grains: there are none
    desk.key(pygame.K_i)
    seen = []
    for _ in range(4):
        assert desk.app.inspector.inspection is not None
        seen.append(desk.app.inspector.inspection)
        desk.key(pygame.K_i)
    assert len({found.label for found in seen}) == 4
    away = np.hypot(frame.x - seen[0].x, frame.y - seen[0].y)
    assert int(frame.label[np.argsort(away)[1]]) == seen[1].label


def test_grain_that_has_left_is_looked_at_no_more(desk: Desk) -> None:
    desk.click(grain_place(desk, 0))
    still = desk.session._still
    names = ["x", "y", "p", "q1", "q2", "rest_radius", "poisson_ratio", "label", "pressure"]
    names.append("stress_difference")
    fewer = {name: getattr(still, name)[1:] for name in names}
    desk.session._still = replace(
        still, motion=still.motion[:, 1:], contacts=Contacts.none(), **fewer
    )
    some_increments(desk, 1)
    desk.until(lambda: desk.app.inspector.label is None, seconds=10)


# -- the hand by keyboard --


def test_arrow_keys_pull_the_handle(desk: Desk) -> None:
    frame = desk.app.stage.picture.panes()[0][0]
    x, y = frame.handles[0].x, frame.handles[0].y
    for key in (pygame.K_RIGHT, pygame.K_RIGHT, pygame.K_UP):
        desk.key(key)
    desk.until(lambda: desk.session._place[0] >= x + 0.5 - 1e-9)
    commands = [command for command in sent(desk) if not isinstance(command, Move)]
    assert commands == [Grab("intruder")]
    move = [command for command in sent(desk) if isinstance(command, Move)][-1]
    assert (move.x, move.y) == pytest.approx((x + 0.5, y + 0.25))
    desk.key(pygame.K_TAB)  # shows where the keyboard is
    desk.key(pygame.K_TAB)  # and leaves
    desk.until(lambda: sent(desk)[-1] == Release("intruder"))


def test_small_steps_with_shift(desk: Desk) -> None:
    """What a lesson asks for, such as 0.15 R, can be hit: at once, and added up after pauses."""
    x = desk.app.stage.picture.panes()[0][0].handles[0].x
    for _ in range(15):
        desk.key(pygame.K_RIGHT, mod=pygame.KMOD_LSHIFT)
    desk.until(lambda: desk.session._place[0] == pytest.approx(x + 0.15, abs=1e-9))
    desk.key(pygame.K_LEFT)
    desk.until(lambda: desk.session._place[0] == pytest.approx(x - 0.1, abs=1e-9))
    assert desk.app.stage.renderer.sight == ALL  # that looks nowhere else


def test_a_handle_that_went_with_its_scene_is_not_let_go(desk: Desk) -> None:
    """Else the next scene says that it has nothing of that name."""
    desk.key(pygame.K_RIGHT)
    (arrows,) = (part for part in desk.app.stage.parts if isinstance(part, Arrows))
    arrows._held = "plate"  # of the scene before, that a lesson has left
    desk.key(pygame.K_RIGHT)
    desk.until(lambda: sent(desk).count(Grab("intruder")) == 2)
    assert not any(isinstance(command, Release) for command in sent(desk))


def test_hand_by_keyboard_is_never_far_ahead(desk: Desk) -> None:
    desk.key(pygame.K_SPACE)  # the body cannot follow
    frame = desk.app.stage.picture.panes()[0][0]
    for _ in range(30):
        desk.key(pygame.K_RIGHT)
    desk.key(pygame.K_SPACE)
    desk.until(lambda: any(isinstance(command, Move) for command in sent(desk)))
    moves = [command for command in sent(desk) if isinstance(command, Move)]
    assert moves[-1].x - frame.handles[0].x <= 2.0 + 1e-9


def test_handle_on_a_rail_moves_along_it(desk: Desk) -> None:
    still = desk.session._still
    rail = replace(still.handles[0], axis=(0.0, -1.0))
    desk.session._still = replace(still, handles=(rail,))
    some_increments(desk, 1)
    before = len(sent(desk))
    desk.key(pygame.K_LEFT)  # across the rail
    assert len(sent(desk)) == before
    desk.key(pygame.K_SPACE)
    desk.key(pygame.K_DOWN)
    desk.until(lambda: isinstance(sent(desk)[-1], Move))
    move = sent(desk)[-1]
    assert isinstance(move, Move)
    assert move.y < rail.y
    assert move.x == pytest.approx(desk.session._home[0])


# -- files and curves --


def test_scene_file_is_named_saved_and_opened(
    desk: Desk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    saved: list[str] = []
    opened: list[Path] = []
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(desk.app.stage.panes, "save", saved.append)
    monkeypatch.setattr(desk.app.stage, "open", opened.append)
    text = 'format = "auxetic-sandbox scene"\nscene = "intruder"\n'
    (tmp_path / "made before.toml").write_text(text, encoding="utf-8")
    (tmp_path / "something else.toml").write_text("x = 1\n", encoding="utf-8")
    desk.app.panel.folded.discard("files")
    desk.app.tick()
    go_to(desk, "files/name")
    desk.key(pygame.K_RETURN)
    desk.type("my trap")
    desk.key(pygame.K_RETURN)
    go_to(desk, "files/save")
    desk.key(pygame.K_RETURN)
    (tmp_path / "my trap.scene").touch()
    desk.key(pygame.K_RETURN)  # nothing is written over
    assert saved == ["my trap.scene", "my trap-1.scene"]
    go_to(desk, "files/open/made before.toml")
    assert "files/open/something else.toml" not in desk.app.stage.focus.stops()
    desk.key(pygame.K_RETURN)
    assert opened == [Path("made before.toml")]


def test_name_of_a_file_cannot_leave_the_folder(desk: Desk) -> None:
    files = next(section for section in desk.app.panel.sections if section.name == "files")
    files.use("files/name", "../../elsewhere.scene", True)
    assert files.stem == "elsewhere"  # type: ignore[attr-defined]


def test_earlier_curves_are_named_hidden_and_forgotten(desk: Desk) -> None:
    desk.app.stage.panes.curves.keep(desk.app.stage.panes.snapshot.frame)
    (kept,) = desk.app.stage.panes.curves.entries
    desk.app.tick()
    field = desk.app.panel._places.named(f"curves/name/{kept.key}")
    assert field is not None
    assert isinstance(field.control, TextField)
    go_to(desk, field.control.name)
    desk.key(pygame.K_RETURN)
    desk.type("first try")
    desk.key(pygame.K_RETURN)
    assert kept.name == "first try"
    go_to(desk, f"curves/show/{kept.key}")
    desk.key(pygame.K_SPACE)
    assert not kept.visible
    go_to(desk, f"curves/delete/{kept.key}")
    desk.key(pygame.K_RETURN)
    assert desk.app.stage.panes.curves.entries == ()
    desk.app.tick()
    assert "curves" not in desk.app.stage.focus.stops()


def test_refusal_is_said_once(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    monkeypatch.setattr(desk.app.stage, "toast", said.append)
    still = desk.session._still
    desk.session._still = replace(still, refusals=1, refusal="no room here")
    some_increments(desk, 2)
    desk.app.stage.send(Change("friction", 0.1))
    desk.until(lambda: bool(desk.session.changed))
    assert said.count("no room here") == 1

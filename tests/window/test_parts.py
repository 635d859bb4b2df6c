"""Time line, looking at a grain, brush, arrow keys, scene files and earlier curves, at a window without a screen."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pygame
import pytest

from sandbox.draw.camera import ALL
from sandbox.draw.timeline import Bar
from sandbox.draw.widgets.controls import Fact, TextField
from sandbox.session.commands import (
    Change,
    Command,
    DrawWall,
    Erase,
    EraseWall,
    Grab,
    Move,
    Place,
    Recall,
    Redo,
    Release,
    Retype,
    Undo,
)
from sandbox.session.frame import Contacts
from sandbox.session.history import Event
from sandbox.window import timeline
from sandbox.window.canvas.arrows import Arrows
from sandbox.words import words
from tests.window.desk import Desk


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = Desk((1024, 720))
    place.start()
    place.app.tick()
    yield place
    place.app.close()


def sent(desk: Desk) -> list[Command]:
    return desk.session.commands


def increment(desk: Desk) -> int:
    frame = desk.app.stage.panes.snapshot.frame
    assert frame is not None
    return frame.increment


def some_increments(desk: Desk, count: int) -> None:
    """So many increments, then a pause."""
    desk.key(pygame.K_a)
    desk.until(lambda: increment(desk) >= count)
    desk.key(pygame.K_a)
    desk.key(pygame.K_SPACE)
    desk.until(lambda: not desk.session.busy and not desk.session.frame().protocol)
    desk.app.tick()


def tab_to(desk: Desk, name: str) -> None:
    for _ in range(60):
        if desk.app.stage.focus.ring == name:
            return
        desk.key(pygame.K_TAB)
    raise AssertionError(f"Tab never came to {name}")


# -- time --


def test_brackets_go_back_and_on(desk: Desk) -> None:
    some_increments(desk, 4)
    last = increment(desk)
    desk.key(pygame.K_LEFTBRACKET, "[")
    desk.until(lambda: increment(desk) == last - 1)
    desk.key(pygame.K_RIGHTBRACKET, "]")
    desk.until(lambda: increment(desk) == last)
    assert sent(desk)[-2:] == [Recall(last - 1), Recall(last)]
    desk.key(pygame.K_a)
    desk.key(pygame.K_RIGHTBRACKET, "]")  # beyond what is kept: one more increment
    desk.until(lambda: increment(desk) == last + 1)
    assert desk.paused()


def test_bar_is_dragged_and_only_the_latest_place_is_asked_for(desk: Desk) -> None:
    some_increments(desk, 12)
    bar = desk.app.timeline.bar()
    assert bar is not None
    assert (bar.first, bar.last) == (0, increment(desk))
    desk.press((bar.rect.right, bar.rect.centery))
    for step in range(21):
        x = bar.rect.right - step * bar.rect.width // 40
        event = pygame.event.Event(
            pygame.MOUSEMOTION, pos=(x, bar.rect.centery), rel=(1, 0), buttons=(1, 0, 0)
        )
        pygame.event.post(event)
    desk.app.tick()
    desk.release((bar.rect.centerx, bar.rect.centery))
    middle = bar.increment_at(bar.rect.centerx)
    desk.until(lambda: increment(desk) == middle)
    recalls = [command for command in sent(desk) if isinstance(command, Recall)]
    assert recalls[-1] == Recall(middle)
    assert len(recalls) <= 3


def test_bar_by_keyboard(desk: Desk) -> None:
    some_increments(desk, 6)
    last = increment(desk)
    tab_to(desk, "time/bar")
    desk.key(pygame.K_HOME)
    desk.until(lambda: increment(desk) == 0)
    desk.key(pygame.K_RIGHT)
    desk.until(lambda: increment(desk) == 1)
    desk.key(pygame.K_END)
    desk.until(lambda: increment(desk) == last)


def test_nothing_kept_says_so(desk: Desk) -> None:
    desk.key(pygame.K_LEFTBRACKET, "[")
    assert desk.app.stage.notices.latest == words.NOTHING_KEPT
    assert sent(desk) == []


def test_undo_and_redo_by_all_their_keys(desk: Desk) -> None:
    desk.key(pygame.K_z)
    desk.key(pygame.K_z, "Z", pygame.KMOD_SHIFT)
    desk.key(pygame.K_z, "\x1a", pygame.KMOD_LCTRL)
    desk.key(pygame.K_z, "\x1a", pygame.KMOD_LCTRL | pygame.KMOD_LSHIFT)
    desk.key(pygame.K_y, "\x19", pygame.KMOD_LCTRL)
    desk.until(lambda: len(sent(desk)) == 5)
    assert sent(desk) == [Undo(), Redo(), Undo(), Redo(), Redo()]


def test_speed_has_its_keys_and_limits(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    limits: list[float] = []
    monkeypatch.setattr(desk.app.stage.panes, "set_speed", limits.append)
    for _ in range(9):
        desk.key(pygame.K_COMMA)
    for _ in range(9):
        desk.key(pygame.K_PERIOD)
    assert min(limits) == 60 / 8
    assert limits[-1] == math.inf
    assert limits[:6] == [240.0, 120.0, 60.0, 30.0, 15.0, 7.5]


def test_held_step_waits_for_the_solver(desk: Desk) -> None:
    desk.session.slice_time = 0.08
    desk.key(pygame.K_a)
    desk.post(pygame.KEYDOWN, key=pygame.K_s, unicode="s", mod=0)
    desk.until(lambda: increment(desk) >= 4)
    desk.post(pygame.KEYUP, key=pygame.K_s, mod=0)
    done = increment(desk)
    for _ in range(60):
        desk.app.tick()
    assert increment(desk) <= done + 4  # not the twenty a second of the key


def test_play_and_step_by_mouse(desk: Desk) -> None:
    play, step, faster = (place.rect for place in desk.app.timeline.places().all)
    desk.click(play.center)
    assert desk.paused()
    desk.click(step.center)
    desk.click(play.center)
    assert not desk.paused()
    desk.click((faster.left + 10, faster.centery))
    assert timeline.SPEED_NAMES[desk.app.timeline.speed] == "4"


def test_events_are_found_on_the_bar() -> None:
    events = [Event("clog", 40, 1.0, 2.0, "clogged"), Event("arch", 900, 1.0, 2.0, "later")]
    bar = Bar(pygame.Rect(100, 0, 200, 30), 0, 100, 50, events)
    assert bar.increment_at(0) == 0
    assert bar.increment_at(1e6) == 100
    assert bar.increment_at(bar.x(37)) == 37
    assert bar.event_at(bar.x(41), 6.0) == events[0]
    assert bar.event_at(bar.x(60), 6.0) is None


def test_bar_of_one_increment_has_both_ends() -> None:
    bar = Bar(pygame.Rect(0, 0, 100, 30), 3, 3, 3, ())
    assert (bar.x(3), bar.increment_at(90)) == (0.0, 3)


# -- looking at a grain --


def grain_place(desk: Desk, index: int) -> tuple[float, float]:
    frame, camera, _ = desk.app.stage.picture.panes()[0]
    return camera.to_screen(float(frame.x[index]), float(frame.y[index]))


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
    tab_to(desk, "general/menu")
    tab_to(desk, f"grain/{desk.app.inspector.inspection.touches[0].label}")  # type: ignore[union-attr]
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


# -- brush --


def in_world(desk: Desk, place: tuple[float, float]) -> tuple[float, float]:
    return desk.app.stage.picture.panes()[0][1].to_world(round(place[0]), round(place[1]))


def use_tool(desk: Desk, tool: str) -> None:
    desk.app.tick()
    tab_to(desk, f"brush/{tool}")
    desk.key(pygame.K_RETURN)
    desk.key(pygame.K_ESCAPE)


def test_brush_places_and_drags(desk: Desk) -> None:
    desk.key(pygame.K_b)
    start = grain_place(desk, 0)
    scale = desk.app.stage.picture.panes()[0][1].scale
    desk.press(start)
    for step in range(1, 9):
        desk.point((start[0] + 0.55 * step * scale, start[1]), pressed=True)
    desk.release((start[0] + 4.4 * scale, start[1]))
    desk.until(lambda: len(sent(desk)) >= 3)
    places = [command for command in sent(desk) if isinstance(command, Place)]
    assert len(places) == 3  # 2 R apart
    assert (places[0].x, places[0].y) == pytest.approx(in_world(desk, start))
    assert {place.kind for place in places} == {"regular"}
    desk.key(pygame.K_ESCAPE)
    assert not desk.app.brush.on


def test_brush_tools_send_their_commands(desk: Desk) -> None:
    desk.key(pygame.K_b)
    spot = grain_place(desk, 0)
    x, y = in_world(desk, spot)
    use_tool(desk, "retype")
    tab_to(desk, "brush/kind")
    desk.key(pygame.K_RIGHT)
    tab_to(desk, "brush/radius")
    desk.type("3")
    desk.key(pygame.K_RETURN)
    desk.click(spot)
    use_tool(desk, "erase")
    desk.click(spot)
    use_tool(desk, "erase_wall")
    desk.click(spot)
    wanted = [Retype(x, y, 3.0, "auxetic"), Erase(x, y, 3.0), EraseWall(x, y)]
    desk.until(lambda: len(sent(desk)) == 3)
    assert sent(desk) == wanted


def test_wall_is_drawn_by_a_drag(desk: Desk) -> None:
    desk.key(pygame.K_b)
    use_tool(desk, "draw_wall")
    start = grain_place(desk, 0)
    desk.press(start)
    for step in range(1, 6):
        desk.point((start[0] + 20 * step, start[1] + 5 * step), pressed=True)
    desk.release((start[0] + 100, start[1] + 25))
    desk.until(lambda: len(sent(desk)) == 1)
    (wall,) = sent(desk)
    assert isinstance(wall, DrawWall)
    assert len(wall.points) == 6
    assert wall.points[0] == pytest.approx(in_world(desk, start))


def test_brush_by_keyboard(desk: Desk) -> None:
    desk.key(pygame.K_b)
    x0, y0, x1, y1 = desk.app.stage.picture.panes()[0][0].bounds
    desk.key(pygame.K_RIGHT)
    desk.key(pygame.K_UP)
    desk.key(pygame.K_RETURN)
    middle = 0.5 * (x0 + x1) + 0.5, 0.5 * (y0 + y1) + 0.5
    desk.until(lambda: sent(desk) == [Place(*middle, "regular")])
    use_tool(desk, "draw_wall")
    desk.key(pygame.K_RETURN)
    for _ in range(4):
        desk.key(pygame.K_DOWN)
    desk.key(pygame.K_RETURN)
    desk.until(lambda: len(sent(desk)) == 2)
    assert sent(desk)[1] == DrawWall((middle, (middle[0], middle[1] - 2.0)))


def test_hand_comes_before_the_brush(desk: Desk) -> None:
    desk.key(pygame.K_b)
    desk.press(desk.handle_place())
    assert desk.app.stage.mouse.holding
    x, y = desk.handle_place()
    desk.point((x + 40, y), pressed=True)
    desk.release((x + 40, y))
    desk.until(lambda: Release("intruder") in sent(desk))
    assert not any(isinstance(command, Place) for command in sent(desk))


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
    tab_to(desk, "files/name")
    desk.key(pygame.K_RETURN)
    desk.type("my trap")
    desk.key(pygame.K_RETURN)
    tab_to(desk, "files/save")
    desk.key(pygame.K_RETURN)
    (tmp_path / "my trap.scene").touch()
    desk.key(pygame.K_RETURN)  # nothing is written over
    assert saved == ["my trap.scene", "my trap-1.scene"]
    tab_to(desk, "files/open/made before.toml")
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
    tab_to(desk, field.control.name)
    desk.key(pygame.K_RETURN)
    desk.type("first try")
    desk.key(pygame.K_RETURN)
    assert kept.name == "first try"
    tab_to(desk, f"curves/show/{kept.key}")
    desk.key(pygame.K_SPACE)
    assert not kept.visible
    tab_to(desk, f"curves/delete/{kept.key}")
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

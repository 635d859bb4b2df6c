"""The window under a driver that shows nothing, driven by posted events."""

from __future__ import annotations

import os
from pathlib import Path

import pygame
import pytest

from sandbox.session.commands import Change, Grab, Move, Protocol, Recall, Release, Reset
from sandbox.window import display
from sandbox.words import words
from tests.window.desk import Desk


def test_splash_is_drawn_while_building(desk: Desk) -> None:
    desk.app.stage.start("intruder")
    desk.app.tick()
    assert desk.app.stage.panes.snapshot.phase in ("building", "running")
    desk.until(lambda: desk.app.stage.panes.snapshot.phase == "running")


def test_drag_grabs_moves_and_releases(running: Desk) -> None:
    start = running.handle_place()
    running.press((start[0] + 5, start[1]))
    assert running.app.stage.mouse.holding
    for step in range(1, 9):
        running.point((start[0] + 5 + 10 * step, start[1]), pressed=True)
    scale = running.app.stage.renderer.camera.scale
    wanted = running.app.stage.renderer.camera.to_world(start[0], start[1])[0] + 80 / scale
    running.until(lambda: abs(running.session.frame().handles[0].x - wanted) < 0.6 / scale)
    running.release((start[0] + 85, start[1]))
    running.until(lambda: Release("intruder") in running.session.commands)
    commands = running.session.commands
    assert commands[0] == Grab("intruder")
    moves = [command for command in commands if isinstance(command, Move)]
    assert moves[-1].x == pytest.approx(wanted, abs=0.6 / scale)  # no jump by the grip's offset
    assert not running.app.stage.mouse.holding


def test_press_beside_the_handle_does_nothing(running: Desk) -> None:
    running.press((3, 300))
    running.release((3, 300))
    assert running.session.commands == []


def test_hover_changes_the_cursor(running: Desk) -> None:
    running.point(running.handle_place())
    assert running.app.stage.mouse.cursor() == pygame.SYSTEM_CURSOR_HAND
    running.press(running.handle_place())
    assert running.app.stage.mouse.cursor() == pygame.SYSTEM_CURSOR_SIZEALL
    running.point((3, 300), pressed=True)
    running.release((3, 300))
    running.point((3, 300))
    assert running.app.stage.mouse.cursor() == pygame.SYSTEM_CURSOR_ARROW


def test_dragging_out_of_the_window_stops_at_the_canvas_edge(running: Desk) -> None:
    running.press(running.handle_place())
    running.point((5000, 250), pressed=True)
    target = running.app.stage.mouse.hand.target
    assert target is not None
    edge = running.app.stage.renderer.camera.to_world(800, 0)[0]
    assert target[0] <= edge + 1.0


def test_leaving_the_window_lets_go(running: Desk) -> None:
    running.press(running.handle_place())
    running.post(pygame.WINDOWFOCUSLOST)
    running.until(lambda: Release("intruder") in running.session.commands)


def test_a_click_picks_up_and_a_click_puts_down(running: Desk) -> None:
    """The other way to move a handle, for whom holding a button is hard."""
    x, y = running.handle_place()
    running.click((x, y))
    mouse = running.app.stage.mouse
    assert mouse.carrying
    running.point((x + 40, y))  # with no button down
    running.until(lambda: any(isinstance(done, Move) for done in running.session.commands))
    assert Release("intruder") not in running.session.commands
    running.press((x + 60, y))  # wherever that is
    assert not mouse.holding
    running.release((x + 60, y))
    running.until(lambda: Release("intruder") in running.session.commands)
    assert running.app.inspector.label is None  # that click looked at no grain
    moves = [done for done in running.session.commands if isinstance(done, Move)]
    world = running.app.stage.renderer.camera.to_world
    assert moves[-1].x - moves[0].x == pytest.approx(world(60, y)[0] - world(0, y)[0])


def test_what_is_carried_is_put_down_over_panel_and_time_line_and_by_escape(running: Desk) -> None:
    mouse = running.app.stage.mouse
    bar = running.app.timeline.bar()
    assert bar is not None
    for place in (running.app.panel.rect.center, bar.rect.center):
        running.click(running.handle_place())
        assert mouse.carrying
        running.click(place)
        assert not mouse.holding
    running.click(running.handle_place())
    running.key(pygame.K_ESCAPE)
    assert not mouse.holding
    assert running.page() == "run"
    assert not any(isinstance(done, Recall) for done in running.session.commands)


def test_pause_step_and_drive(running: Desk) -> None:
    running.key(pygame.K_SPACE)
    assert running.paused()
    running.key(pygame.K_a)
    for count in (1, 2):
        running.key(pygame.K_s)
        running.until(lambda count=count: running.session.increments == count)  # type: ignore[misc]
    running.key(pygame.K_SPACE)
    running.until(lambda: running.session.increments > 4)
    running.key(pygame.K_a)
    running.until(lambda: Protocol(False) in running.session.commands)


def test_reset_packing_and_seed(running: Desk) -> None:
    running.key(pygame.K_r)
    running.key(pygame.K_2)
    running.key(pygame.K_2)  # already so: nothing is built anew
    running.key(pygame.K_p)
    running.key(pygame.K_n)
    expected = [
        Reset(),
        Change("packing", "auxetic"),
        Change("packing", "mixed"),
        Change("seed", 2),
    ]
    running.until(lambda: running.session.commands == expected)


def test_keys_by_what_is_printed_on_them(running: Desk) -> None:
    # On a French keyboard the digit 1 is Shift and the key of '&'.
    running.key(pygame.K_AMPERSAND, "1")
    running.until(lambda: running.session.commands == [Change("packing", "regular")])
    running.post(pygame.KEYDOWN, key=pygame.K_n, unicode="\x0e", mod=pygame.KMOD_LCTRL)
    assert len(running.session.commands) == 1


def test_views_in_turn(running: Desk) -> None:
    seen = []
    for _ in range(len(words.VIEWS)):
        running.key(pygame.K_v)
        renderer = running.app.stage.renderer
        seen.append(renderer.view.name)
        assert renderer.chains == renderer.view.chains
        running.key(pygame.K_f)  # where chains are all there is to see they stay
        assert renderer.chains == (renderer.view.chains == renderer.view.only_chains)
    assert sorted(seen) == sorted(words.VIEWS)
    assert seen[-1] == "kind"


def test_chains_theme_scale_and_help(running: Desk) -> None:
    running.key(pygame.K_f)
    assert not running.app.stage.renderer.chains
    running.key(pygame.K_t)
    assert running.app.stage.renderer.theme.name == "light"
    running.key(pygame.K_PLUS, "+", pygame.KMOD_LCTRL)
    assert running.app.stage.renderer.scale == 1.25
    running.key(pygame.K_MINUS, "-", pygame.KMOD_LCTRL)
    running.key(pygame.K_MINUS, "-", pygame.KMOD_LCTRL)
    assert running.app.stage.renderer.scale == 1.0
    running.key(pygame.K_F1)
    assert running.page() == "help"
    running.key(pygame.K_ESCAPE)
    assert running.page() == "run"


def test_screenshot_has_a_free_name(
    running: Desk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    running.key(pygame.K_F12)
    running.key(pygame.K_F12)
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["sandbox-intruder-1.png", "sandbox-intruder-2.png"]
    assert pygame.image.load(tmp_path / names[0]).get_size() == (800, 600)


@pytest.mark.skipif(os.name == "nt", reason="folders are not write-protected there")
def test_screenshot_that_cannot_be_saved_says_so(
    running: Desk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(display, "atomic_write", full)
    running.key(pygame.K_F12)
    assert "no space left" in running.app.stage.notices.latest
    assert list(tmp_path.iterdir()) == []


def test_resizing_redraws_at_the_new_size(running: Desk) -> None:
    running.app.stage.screen = pygame.display.set_mode((1000, 700), pygame.RESIZABLE)
    running.post(pygame.WINDOWSIZECHANGED, x=1000, y=700)
    assert running.app.stage.renderer.size == (1000, 700)


def test_events_of_an_unbuilt_scene_do_no_harm(desk: Desk) -> None:
    desk.app.stage.start("intruder")
    for key in (pygame.K_r, pygame.K_a, pygame.K_s, pygame.K_SPACE, pygame.K_f, pygame.K_h):
        desk.key(key)
    desk.press((400, 300))
    desk.release((400, 300))
    desk.until(lambda: desk.app.stage.panes.snapshot.phase == "running")


def test_hint_until_the_first_grab(running: Desk) -> None:
    assert running.app.stage.notices.lines("") == (words.HINT,)
    running.press(running.handle_place())
    assert running.app.stage.notices.lines("") == ()

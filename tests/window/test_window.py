"""The window under a driver that shows nothing, driven by posted events."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pygame
import pytest

from core.errors import InputError
from sandbox.draw.warmup import Warmup
from sandbox.files.log_file import read_log
from sandbox.files.scene_file import write_scene
from sandbox.session.commands import Change, Command, Grab, Move, Protocol, Recall, Release, Reset
from sandbox.window import app, display
from sandbox.window.display import Looks
from sandbox.window.picture import progress_of
from sandbox.words import language, words
from scenes import registry
from tests.session.edited import built
from tests.window import desk as desks
from tests.window.desk import Desk
from tests.window.fake_session import FakeSession


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = Desk()
    yield place
    place.app.close()


@pytest.fixture
def running(desk: Desk) -> Desk:
    desk.start()
    return desk


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


def test_menu_by_keyboard(desk: Desk) -> None:
    desk.app.pages.open_menu()
    desk.until(lambda: not desk.app._splash)
    desk.app.tick()
    assert desk.app.pages.menu.chosen == "start"
    desk.key(pygame.K_2)
    desk.key(pygame.K_DOWN)
    desk.key(pygame.K_TAB)
    desk.post(pygame.KEYDOWN, key=pygame.K_TAB, unicode="", mod=pygame.KMOD_LSHIFT)
    desk.key(pygame.K_RIGHT)
    names = registry.names()
    assert desk.app.pages.menu.chosen == f"scene/{names[1]}"
    desk.key(pygame.K_RETURN)
    desk.until(lambda: desk.app.stage.panes.snapshot.phase == "running")
    assert (desk.session.scene, desk.session.packing) == (names[1], "auxetic")
    assert desk.page() == "run"


def test_tab_goes_through_the_whole_menu_and_shows_it(running: Desk) -> None:
    running.key(pygame.K_m)
    first = running.app.pages.menu.chosen
    seen: list[str] = []
    while not seen or running.app.pages.menu.chosen != first:
        running.key(pygame.K_TAB)
        seen.append(running.app.pages.menu.chosen)
        place = running.app.pages.menu.place_of(seen[-1])
        assert place is not None
        assert running.app.stage.screen.get_rect().contains(place)
    assert {name.partition("/")[0] for name in seen} >= {"start", "scene", "packing", "language"}
    assert len(seen) == len(set(seen)) >= len(registry.names()) + 5


def test_chips_of_the_menu_switch_theme_language_and_open_the_keys(running: Desk) -> None:
    menu = running.app.pages.menu
    running.key(pygame.K_m)
    for chip, expected in (
        ("theme", "light"),
        ("language", language.available()[1]),
        ("keys", "help"),
    ):
        place = menu.place_of(chip)
        assert place is not None
        running.press(place.center)
        now = (running.app.stage.renderer.theme.name, language.present())
        assert expected in (*now, "help" if running.app.stage.show_help else "")
    running.key(pygame.K_ESCAPE)
    for _ in language.available()[1:]:
        running.key(pygame.K_l)
    assert (running.page(), running.app.stage.show_help) == ("menu", False)
    assert language.present() == "en"


def test_menu_by_mouse_and_back(running: Desk) -> None:
    running.key(pygame.K_a)
    running.key(pygame.K_m)
    assert running.page() == "menu"
    assert running.paused()
    running.key(pygame.K_m)
    assert running.page() == "run"
    assert not running.paused()
    running.key(pygame.K_ESCAPE)
    for _ in registry.names():
        running.key(pygame.K_UP)
    first = registry.names()[0]
    place = running.app.pages.menu.place_of(first)
    assert place is not None
    running.point(place.center)
    assert running.app.pages.menu.cursor() == pygame.SYSTEM_CURSOR_HAND
    running.press(place.center)
    running.until(lambda: running.app.stage.panes.snapshot.phase == "running")
    assert [session.scene for session in running.sessions] == ["intruder", first]


def test_scene_files_of_the_folder_are_in_the_menu(
    running: Desk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    head = 'format = "auxetic-sandbox scene"\nscene = "hopper"\n'
    (tmp_path / "my bridge.toml").write_text(head, encoding="utf-8")
    (tmp_path / "pyproject.toml").write_text('name = "no scene"\n', encoding="utf-8")
    (tmp_path / "broken.toml").write_bytes(b"\xff = [")
    (tmp_path / "broken.scene").write_bytes(b"PK\x03\x04")
    session = built(grains=0)
    write_scene(tmp_path / "my trap.scene", session.made())
    os.utime(tmp_path / "my trap.scene", (0, 0))
    monkeypatch.chdir(tmp_path)
    running.key(pygame.K_m)
    files = [
        card
        for card in running.app.pages.menu.contents("mixed", "dark").cards
        if "file/" in card.name
    ]
    assert [(card.title, card.picture) for card in files] == [
        ("my bridge", "hopper"),
        ("my trap", "workshop"),
    ]


def test_packing_looked_at_in_the_menu_only_is_forgotten(running: Desk) -> None:
    running.key(pygame.K_m)
    running.key(pygame.K_1)
    assert running.app.stage.panes.packing == "regular"
    running.key(pygame.K_m)
    assert running.app.stage.panes.packing == "mixed"


def test_escape_leads_to_the_menu_then_out(running: Desk) -> None:
    running.key(pygame.K_ESCAPE)
    assert running.page() == "menu"
    running.key(pygame.K_ESCAPE)
    assert running.page() == "closed"


def test_a_notice_goes_with_what_it_was_about(running: Desk) -> None:
    """What is carried is put down: by a click, by Escape, by a page that opens."""
    ways: list[Callable[[], None]] = [
        lambda: running.click(running.handle_place()),
        lambda: running.key(pygame.K_ESCAPE),
        lambda: running.key(pygame.K_m),
    ]
    for put_down in ways:
        running.point(running.handle_place())
        running.click(running.handle_place())
        assert running.app.stage.notices.latest == words.CARRYING
        put_down()
        running.app.tick()
        assert running.app.stage.notices.latest == ""
    assert running.page() == "menu"


def test_escape_in_the_menu_closes_what_is_said_first(running: Desk) -> None:
    running.key(pygame.K_m)
    running.app.stage.toast("something")
    running.key(pygame.K_ESCAPE)
    assert running.page() == "menu"
    assert running.app.stage.notices.latest == ""
    running.key(pygame.K_ESCAPE)
    assert running.page() == "closed"


@pytest.mark.parametrize("code", ["en", "de", "uk"])
def test_escape_is_answered_where_the_menu_cannot_be_drawn_yet(
    desk: Desk, monkeypatch: pytest.MonkeyPatch, code: str
) -> None:
    """At a first start what draws is compiled as well. It is said at once what is waited for; the next closes the window."""
    shown: list[str] = []
    monkeypatch.setattr(app, "draw_splash", lambda *_, text, **__: shown.append(text))
    monkeypatch.setattr(Warmup, "ready", property(lambda self: False))
    language.use(code)
    desk.app.stage.start("intruder")
    desk.app.tick()
    before = shown[-1]
    desk.key(pygame.K_ESCAPE)
    assert shown[-1] == words.SPLASH_MENU != before
    desk.key(pygame.K_ESCAPE)
    assert desk.page() == "closed"


class Compiling(FakeSession):
    """A change for which something is compiled: reported before and after, as a session does."""

    def build(self, progress: Callable[[str, float], None] | None = None) -> None:
        self.report = progress or (lambda text, share: None)
        super().build(progress)

    def _apply(self, command: Command) -> None:
        try:
            if isinstance(command, Change):
                self.report("compiling", 0.0)
                assert self.block_change is not None
                self.block_change.wait()
                self.report("compiling", 1.0)
            super()._apply(command)
        except InputError as error:
            self.refusal = str(error)


@pytest.mark.parametrize("focus", ["canvas/intruder", "grains/friction", "general/seed"])
def test_escape_during_a_change_says_when_it_ends(
    focus: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(desks, "FakeSession", Compiling)
    desk = Desk()
    desk.start()
    compiled = desk.session.block_change = threading.Event()
    desk.app.stage.send(Change("friction", 0.3))
    desk.until(lambda: desk.app.stage.panes.snapshot.phase == "building")
    desk.app.stage.focus.go(focus, True)
    desk.key(pygame.K_ESCAPE)
    assert desk.page() == "run"
    assert desk.app.stage.focus.name == focus  # another Escape leaves it
    said = progress_of(desk.app.stage.panes.snapshot)
    assert said == words.ENDING.format(text="Compiling")
    assert words.CANCELLED not in desk.app.stage.notices.said  # it is not yet
    compiled.set()
    desk.until(lambda: desk.app.stage.panes.snapshot.phase == "running")
    assert not any(isinstance(command, Change) for command in desk.session.commands)
    assert "as it was" in desk.session.refusal  # type: ignore[attr-defined]
    assert not desk.app.stage.panes.snapshot.ending
    desk.app.close()


def test_failure_is_shown_and_reset_builds_anew(running: Desk) -> None:
    running.session.fail = RuntimeError("a grain got lost")
    running.key(pygame.K_a)
    running.until(lambda: running.app.stage.panes.snapshot.phase == "failed")
    running.app.tick()
    running.key(pygame.K_SPACE)  # nothing but reset, menu and quit make sense now
    running.key(pygame.K_r)
    running.until(lambda: running.app.stage.panes.snapshot.phase == "running")
    assert len(running.sessions) == 2


def test_failed_build_is_shown(desk: Desk) -> None:
    desk.app.stage.start("intruder")
    desk.session.fail_build = InputError("too few grains to fill the funnel")
    desk.until(lambda: desk.app.stage.panes.snapshot.phase in ("failed", "running"))
    for _ in range(3):
        desk.app.tick()
    assert desk.app.stage.running


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


def test_close_writes_the_log_between_increments(tmp_path: Path) -> None:
    desk = Desk(log=tmp_path / "run.jsonl")
    desk.start()
    desk.key(pygame.K_a)
    desk.until(lambda: desk.seen > 1)
    desk.app.close()
    assert read_log(tmp_path / "run.jsonl").end == desk.session.increments
    assert not desk.session.busy


def test_closing_does_not_wait_for_a_change_that_compiles(tmp_path: Path) -> None:
    desk = Desk(log=tmp_path / "run.jsonl")
    desk.start()
    desk.key(pygame.K_a)
    desk.until(lambda: desk.seen > 1)
    compiled = desk.session.block_change = threading.Event()
    desk.app.stage.send(Change("packing", "auxetic"))
    desk.until(lambda: desk.session.waits)
    ended = desk.app.close()
    assert not compiled.is_set()
    compiled.set()
    assert not ended  # the process leaves without that thread
    log = read_log(tmp_path / "run.jsonl")
    assert log.end == desk.session.increments
    assert not any(isinstance(command, Change) for _, command in log.commands)


def test_quit_ends_the_loop(running: Desk) -> None:
    running.post(pygame.QUIT)
    assert running.page() == "closed"


def test_unknown_scene_is_an_input_error(desk: Desk) -> None:
    with pytest.raises(InputError, match="unknown"):
        desk.app.stage.start("unknown")


def test_no_display_is_one_plain_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(InputError, match="no display") as caught:
        display.open_display(Looks((800, 600)))
    assert "record" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_display_that_cannot_be_opened_is_an_input_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise pygame.error("x11 not available")

    monkeypatch.setattr(pygame.display, "set_mode", broken)
    with pytest.raises(InputError, match="x11 not available"):
        display.open_display(Looks((800, 600)))


def test_window_is_not_larger_than_the_screen() -> None:
    screen, _ = display.open_display(Looks((100_000, 100)))
    desktop = pygame.display.get_desktop_sizes()[0]
    assert screen.get_width() <= max(desktop[0], display.SMALLEST[0])
    assert screen.get_height() == display.SMALLEST[1]
    pygame.display.quit()


def test_rate_says_what_holds_it_up() -> None:
    rate = display.Rate()
    rate.renew(1.0, 60.0)
    assert rate.text.startswith("60 frames/s")
    rate.renew(2.0, 20.0)
    assert words.SLOW_MACHINE in rate.text
    for _ in range(100):
        rate.drew(0.05)
    rate.renew(3.0, 20.0)
    assert "drawing takes 50 ms" in rate.text


@pytest.mark.end_to_end
def test_quitting_while_compiling_is_no_crash(tmp_path: Path) -> None:
    # LLVM aborts when the interpreter ends under a thread that compiles.
    program = (
        "import threading, time, pygame\n"
        "from sandbox.window import app\n"
        "def quit():\n"
        "    time.sleep(1.5)\n"
        "    pygame.event.post(pygame.event.Event(pygame.QUIT))\n"
        "threading.Thread(target=quit, daemon=True).start()\n"
        "raise SystemExit(app.run('intruder'))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={
            **os.environ,
            "NUMBA_CACHE_DIR": str(tmp_path),
            "PYTHONPATH": str(Path(__file__).parents[2]),
        },
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""

"""The window at its ends: escape while it compiles, scenes that fail, logs and screens at closing."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pygame
import pytest

from core.errors import InputError
from sandbox.draw.warmup import Warmup
from sandbox.files.log_file import read_log
from sandbox.session.commands import Change, Command
from sandbox.window import app, display
from sandbox.window.display import Looks
from sandbox.window.picture import progress_of
from sandbox.words import language, words
from tests.window import desk as desks
from tests.window.desk import Desk
from tests.window.fake_session import FakeSession


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

"""Time: back and on, the bar that is dragged, undo and redo, speed, steps."""

from __future__ import annotations

import math

import pygame
import pytest

from sandbox.draw.timeline import Bar
from sandbox.session.commands import (
    Recall,
    Redo,
    Undo,
)
from sandbox.session.history import Event
from sandbox.window import timeline
from sandbox.words import words
from tests.window.at_panel import go_to, increment, sent, some_increments
from tests.window.desk import Desk

AT_WORK = (1024, 720)  # size of a window in which a scene runs already


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
    go_to(desk, "time/bar")
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

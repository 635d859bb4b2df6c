"""What the menu leads to: what was left unfinished, files, and what cannot be done."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pygame
import pytest

from sandbox.draw.pages.menu_layout import DISCARD, START, TAKE_UP
from sandbox.files import autosave
from sandbox.window.menu import Choice
from sandbox.window.pages import ago
from sandbox.words import language
from tests.window.desk import Desk


class LeftBehind:
    """As an autosave of a program that is gone."""

    scene, grains = "hopper", 150

    def __init__(self, minutes: float) -> None:
        self.saved = time.time() - 60.0 * minutes
        self.removed = False

    def remove(self) -> None:
        self.removed = True


@pytest.fixture
def left(monkeypatch: pytest.MonkeyPatch) -> list[LeftBehind]:
    found = [LeftBehind(12.0), LeftBehind(300.0)]
    monkeypatch.setattr(autosave, "find", lambda: autosave.Found(tuple(found)))  # type: ignore[arg-type]
    return found


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = Desk((1000, 700))
    yield place
    place.app.close()


def menu_open(desk: Desk) -> None:
    desk.app.pages.open_menu()
    desk.until(lambda: not desk.app._splash)
    desk.app.tick()


def test_what_was_left_is_offered_first_and_taken_up(
    desk: Desk, left: list[LeftBehind], monkeypatch: pytest.MonkeyPatch
) -> None:
    taken: list[Any] = []
    monkeypatch.setattr(desk.app.stage, "take_up", taken.append)
    menu_open(desk)
    menu = desk.app.pages.menu
    assert menu.chosen == TAKE_UP
    assert menu.resume is not None
    assert menu.resume() == "Left unfinished: Hopper, 150 grains, 12 minutes ago."
    language.use("de")
    assert menu.resume() == "Nicht zu Ende gebracht: Trichter, 150 Körner, vor 12 Minuten."
    desk.key(pygame.K_RETURN)
    assert taken == [left[0]]
    assert not left[0].removed


def test_what_was_left_can_be_discarded_one_by_one(desk: Desk, left: list[LeftBehind]) -> None:
    menu_open(desk)
    for one in left:
        desk.app.pages.take(Choice(what=DISCARD))
        assert one.removed
    assert desk.app.pages.menu.resume is None
    desk.app.pages.take(Choice(what=DISCARD))  # a second click too many
    menu_open(desk)  # it is not looked for again
    assert desk.app.pages.menu.resume is None


def test_without_anything_left_the_menu_begins_with_where_to_start(desk: Desk) -> None:
    menu_open(desk)
    assert (desk.app.pages.menu.resume, desk.app.pages.menu.chosen) == (None, START)


def test_what_was_set_aside_is_named(
    desk: Desk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    aside = autosave.SetAside(tmp_path / "autosave-1-0123abcd.scene", "of a newer program")
    monkeypatch.setattr(autosave, "find", lambda: autosave.Found((), (aside,)))
    menu_open(desk)
    assert str(aside.path) in desk.app.stage.notices.latest
    assert "newer program" in desk.app.stage.notices.latest


def test_a_file_that_cannot_be_read_is_said_and_the_menu_stays(desk: Desk, tmp_path: Path) -> None:
    menu_open(desk)
    desk.app.pages.take(Choice(file=tmp_path / "gone.scene"))
    assert desk.page() == "menu"
    assert "gone.scene" in desk.app.stage.notices.latest


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (5.0, "less than a minute ago"),
        (70.0, "1 minute ago"),
        (600.0, "10 minutes ago"),
        (4000.0, "1 hour ago"),
        (7200.0, "2 hours ago"),
        (300000.0, "3 days ago"),
    ],
)
def test_how_long_ago(seconds: float, said: str) -> None:
    assert ago(seconds) == said

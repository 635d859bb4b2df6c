"""The menu: by keyboard and by mouse, its chips, scenes that were made, and out of it again."""

from __future__ import annotations

import os
from pathlib import Path

import pygame
import pytest

from sandbox.files.scene_file import write_scene
from sandbox.words import language
from scenes import registry
from tests.session.edited import built
from tests.window.desk import Desk


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

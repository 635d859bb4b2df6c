"""The card of a tour: keys and mouse, what it waits for, and that it hides no handle."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import pygame
import pytest

from sandbox.draw.pages.tour_card import BACK, CLOSE, NEXT
from sandbox.lessons import tours
from sandbox.words import words
from tests.window.desk import Desk


@pytest.fixture
def desk() -> Iterator[Desk]:
    place = Desk((1000, 700))
    yield place
    place.app.close()


@pytest.fixture
def touring(desk: Desk) -> Desk:
    desk.app.guide.start("intruder")
    ready(desk)
    return desk


def ready(desk: Desk) -> None:
    run = desk.app.stage.panes
    desk.until(lambda: not desk.app._splash and all(s.phase == "running" for s in run.snapshots))
    desk.app.tick()


def press(desk: Desk, name: str) -> None:
    guide = desk.app.guide
    button = guide.card.layout(guide.page, guide.rect.width).buttons[name].move(guide.rect.topleft)
    desk.press(button.center)
    desk.release(button.center)


def test_start_here_leads_to_three_packings_and_their_tour(desk: Desk) -> None:
    desk.app.pages.open_menu()
    desk.until(lambda: not desk.app._splash)
    assert desk.app.pages.menu.chosen == "start"
    desk.key(pygame.K_RETURN)
    ready(desk)
    assert desk.app.guide.on
    assert [session.scene for session in desk.sessions] == ["hopper"] * 3
    assert desk.app.stage.panes.packings == ("regular", "mixed", "auxetic")


def test_tour_by_its_key_and_from_the_menu(desk: Desk) -> None:
    desk.start()
    seen = []
    for keys in ((pygame.K_y,), (pygame.K_y,), (pygame.K_m, pygame.K_y)):
        for key in keys:
            desk.key(key)
        ready(desk)
        seen.append((desk.page(), desk.app.guide.on))
    assert seen == [("run", True), ("run", False), ("run", True)]
    assert desk.app.guide.scene == "intruder"


def test_a_step_is_done_by_doing_it(touring: Desk) -> None:
    guide = touring.app.guide
    for _ in range(2):  # the first step waits for a locked hand; the second for a way
        touring.key(pygame.K_RETURN)
    assert (guide.index, guide.done) == (1, False)
    assert guide.page.onward == words.TOUR_WHY  # it explains before it goes on
    ready(touring)
    start = touring.handle_place()
    touring.press(start)
    assert touring.app.stage.mouse.holding
    scale = touring.app.stage.renderer.camera.scale
    touring.point((start[0] + 4.0 * scale, start[1]), pressed=True)
    touring.until(lambda: guide.done)
    assert guide.page.why == str(tours.steps("intruder")[1].why)
    touring.release((start[0] + 4.0 * scale, start[1]))
    touring.key(pygame.K_RETURN)
    assert (guide.index, guide.done) == (2, False)
    assert touring.app.stage.renderer.view.name == "chains"


def test_every_step_by_keyboard_alone(touring: Desk) -> None:
    guide = touring.app.guide
    steps = tours.steps("intruder")
    seen = []
    while guide.on:
        ready(touring)
        seen.append((guide.index, guide.done or guide.told))
        touring.key(pygame.K_RETURN)
    assert seen == [(k, done) for k in range(len(steps)) for done in (False, True)]


def test_what_has_not_happened_yet_is_not_said_as_if_it_had(touring: Desk) -> None:
    guide = touring.app.guide
    why = str(tours.steps("intruder")[0].why)
    assert guide.page.why == ""
    touring.key(pygame.K_RETURN)  # why?
    assert not guide.page.done
    assert guide.page.why == words.TOUR_AHEAD.format(why=why)
    guide.done = True
    assert guide.page.why == why


def test_back_and_close_by_keyboard(touring: Desk) -> None:
    guide = touring.app.guide
    touring.key(pygame.K_BACKSPACE)
    assert guide.index == 0
    for _ in range(2):
        touring.key(pygame.K_RETURN)
    assert guide.index == 1
    touring.key(pygame.K_BACKSPACE)
    assert guide.index == 0
    touring.key(pygame.K_ESCAPE)
    assert not guide.on
    assert touring.page() == "run"


def test_buttons_by_tab(touring: Desk) -> None:
    guide, focus = touring.app.guide, touring.app.stage.focus
    while focus.name != NEXT:
        touring.key(pygame.K_TAB)
    touring.key(pygame.K_SPACE, " ")
    assert guide.told
    while focus.name != CLOSE:
        touring.key(pygame.K_TAB)
    touring.key(pygame.K_RETURN)
    assert not guide.on
    assert focus.on_canvas


def test_buttons_by_mouse(touring: Desk) -> None:
    guide = touring.app.guide
    for name, expected in ((NEXT, (0, True)), (NEXT, (1, False)), (BACK, (0, False))):
        press(touring, name)
        ready(touring)
        assert (guide.index, guide.told) == expected
    touring.press(guide.rect.center)  # the card lets nothing through
    assert not touring.app.stage.mouse.holding
    press(touring, CLOSE)
    assert not guide.on


def test_another_scene_ends_the_tour(touring: Desk) -> None:
    touring.app.stage.start("hopper")
    touring.app.tick()
    assert not touring.app.guide.on


@pytest.mark.parametrize("folded", [False, True])
def test_the_card_hides_nothing_and_stays_in_the_window(touring: Desk, folded: bool) -> None:
    app, guide = touring.app, touring.app.guide
    if folded:
        app.panel.drawer.switch()
    for scale, _ in itertools.product((1.0, 1.5, 2.0, 3.0), range(2)):
        app.stage.renderer.resize(app.stage.renderer.size, scale)
        app.tick()
        assert app.stage.screen.get_rect().contains(guide.rect)
        places = app.stage.renderer.layout
        assert not any(guide.rect.colliderect(canvas) for canvas in places.canvases)
        assert not guide.rect.colliderect(app.panel.rect)
        assert (places.panel if places.panel.width else places.card).contains(guide.rect)
        assert (
            guide.rect.height == guide.card.layout(guide.page, guide.rect.width).height
        )  # nothing is cut off
        guide.next()
        ready(touring)


def test_a_panel_that_is_opened_over_the_card_covers_it(touring: Desk) -> None:
    app, guide = touring.app, touring.app.guide
    app.stage.renderer.resize(app.stage.renderer.size, 3.0)
    seen = []
    for _ in range(3):
        app.tick()
        seen.append((app.panel.drawer.over, guide.seen, bool(guide.stops())))
        app.panel.drawer.switch()
    assert seen == [(False, True, True), (True, False, False), (False, True, True)]
    assert guide.on

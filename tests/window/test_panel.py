"""The panel by mouse and by keyboard: what is shown, what is sent."""

from __future__ import annotations

import pygame
import pytest

from sandbox.draw.widgets.controls import (
    Button,
    Choice,
    Heading,
    Slider,
    Stepper,
    TextField,
)
from sandbox.session.commands import Change, Protocol, Reset
from sandbox.window.display import is_fullscreen
from sandbox.window.focus import FIRST_REPEAT, Focus
from sandbox.words import language, words
from scenes import registry
from tests.window.at_panel import box, control, go_to, number, sent, track, value
from tests.window.desk import Desk

AT_WORK = (1024, 720)  # size of a window in which a scene runs already


NU = "grains/regular_poisson_ratio"  # acts at once
SHARE = "grains/auxetic_fraction"  # packs anew
RATIO = "grains/stiffness_ratio"  # in place of Poisson's ratios
SAID_TWICE = {NU, "grains/auxetic_poisson_ratio", "grains/contact_stiffness"}


# -- keyboard --


def test_tab_goes_through_everything_and_comes_back(desk: Desk) -> None:
    desk.app.panel.folded.clear()
    desk.app.tick()
    wanted = desk.app.stage.focus.stops()
    assert {"canvas/intruder", "general/packing", NU, "solver/tolerance", "time/bar"} <= set(wanted)
    seen = []
    for _ in wanted:
        desk.key(pygame.K_TAB)
        seen.append(desk.app.stage.focus.ring)
        rect = desk.app.panel.place_of(seen[-1])
        if rect is not None:  # what has the ring can be seen
            view = desk.app.panel.rect.copy()
            view.height = desk.app.panel._view
            assert view.contains(rect), seen[-1]
    assert seen == wanted
    desk.key(pygame.K_TAB)
    assert desk.app.stage.focus.ring == wanted[0]
    desk.key(pygame.K_TAB, mod=pygame.KMOD_SHIFT)
    assert desk.app.stage.focus.ring == wanted[-1]


def test_every_control_answers_the_keyboard(desk: Desk) -> None:
    """Every control of the panel is changed by keys alone, and every change has its effect."""
    desk.app.panel.folded.clear()
    desk.app.tick()
    for name in desk.app.panel.stops():
        found = control(desk, name)
        if found is None or isinstance(found, (Button, Heading, TextField)):
            continue
        go_to(desk, name)
        before = effects(desk)
        if isinstance(found, Slider):
            desk.key(pygame.K_LEFT if found.value >= found.high else pygame.K_RIGHT)
            desk.key(pygame.K_RETURN)
            if desk.app.panel.edit is not None:  # it acted at once, and Enter began to type
                desk.key(pygame.K_ESCAPE)
        elif isinstance(found, (Choice, Stepper)):
            desk.key(pygame.K_RIGHT)
        elif name not in ("looks/sound", "looks/tone"):  # there may be no sound device
            desk.key(pygame.K_SPACE)
        else:
            continue
        desk.until(lambda before=before: effects(desk) != before, seconds=20)  # type: ignore[misc]
        if name in SAID_TWICE:  # set back, or what says the same in other words would be refused
            before = effects(desk)
            desk.key(pygame.K_DELETE)
            desk.until(lambda before=before: effects(desk) != before, seconds=20)  # type: ignore[misc]


def test_what_says_the_same_twice_is_refused_in_one_line(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Poisson's ratio and λ: a line says why, and the panel shows what is set. Once the one is set back, the other is taken."""
    said: list[str] = []
    monkeypatch.setattr(desk.app.stage, "toast", said.append)
    go_to(desk, NU)
    desk.key(pygame.K_LEFT)
    desk.until(lambda: len(sent(desk)) == 1)
    go_to(desk, RATIO)
    desk.key(pygame.K_RIGHT)
    desk.until(lambda: any("not both" in line for line in said))
    desk.until(lambda: value(desk, RATIO) == 0.0)
    go_to(desk, NU)
    desk.key(pygame.K_DELETE)
    desk.until(lambda: sent(desk)[-1] == Change("regular_poisson_ratio", 0.8))
    go_to(desk, RATIO)
    desk.key(pygame.K_RIGHT)
    desk.until(lambda: sent(desk)[-1] == Change("stiffness_ratio", 0.1))
    assert len(sent(desk)) == 3


def effects(desk: Desk) -> tuple[object, ...]:
    """All that the panel can change."""
    renderer = desk.app.stage.renderer
    looks = renderer.view.name, renderer.chains, renderer.theme.name, renderer.scale
    switched = desk.app.stage.still, is_fullscreen()
    return len(sent(desk)), *looks, language.present(), *switched


def test_buttons_by_enter_and_space(desk: Desk) -> None:
    go_to(desk, "general/drive")
    desk.key(pygame.K_SPACE)
    desk.until(lambda: Protocol(True) in sent(desk))
    assert not desk.paused()
    desk.until(lambda: desk.session.frame().protocol)
    go_to(desk, "general/reset")
    desk.key(pygame.K_RETURN)
    desk.until(lambda: Reset() in sent(desk))


def test_escape_leads_back_to_the_canvas_first(desk: Desk) -> None:
    go_to(desk, NU)
    desk.key(pygame.K_ESCAPE)
    assert desk.app.stage.focus.on_canvas
    assert desk.app.stage.focus.ring == ""
    assert desk.page() == "run"
    desk.key(pygame.K_ESCAPE)
    assert desk.page() == "menu"


def test_arrows_and_pages_on_a_live_slider_act_at_once(desk: Desk) -> None:
    go_to(desk, NU)
    desk.key(pygame.K_LEFT)
    assert value(desk, NU) == pytest.approx(0.79)
    desk.key(pygame.K_PAGEDOWN)
    assert value(desk, NU) == pytest.approx(0.69)
    desk.until(lambda: Change("regular_poisson_ratio", 0.69) in sent(desk))
    desk.key(pygame.K_DELETE)
    desk.until(lambda: sent(desk)[-1] == Change("regular_poisson_ratio", 0.8))
    desk.key(pygame.K_HOME)
    desk.until(lambda: sent(desk)[-1] == Change("regular_poisson_ratio", 0.0))


def test_keys_on_what_packs_anew_wait_for_enter(desk: Desk) -> None:
    go_to(desk, SHARE)
    for _ in range(3):
        desk.key(pygame.K_RIGHT)
    assert value(desk, SHARE) == pytest.approx(0.53)
    assert sent(desk) == []
    desk.key(pygame.K_RETURN)
    desk.until(lambda: sent(desk) == [Change("auxetic_fraction", 0.53)])
    desk.key(pygame.K_RIGHT)
    desk.key(pygame.K_ESCAPE)  # thinks better of it
    desk.app.tick()
    assert value(desk, SHARE) == pytest.approx(0.53)
    desk.key(pygame.K_RIGHT)
    desk.key(pygame.K_TAB)  # and going on is as good as Enter
    desk.until(lambda: sent(desk)[-1] == Change("auxetic_fraction", 0.54))
    assert len(sent(desk)) == 2


def test_a_number_is_typed(desk: Desk) -> None:
    go_to(desk, NU)
    desk.type("0,25")
    assert desk.app.panel.edit is not None
    assert sent(desk) == []
    desk.key(pygame.K_RETURN)
    desk.until(lambda: sent(desk) == [Change("regular_poisson_ratio", 0.25)])
    assert desk.app.stage.focus.ring == NU
    desk.type("7")
    desk.key(pygame.K_RETURN)
    assert "between" in desk.app.stage.notices.latest
    desk.type("-")
    desk.key(pygame.K_ESCAPE)
    assert len(sent(desk)) == 1
    assert desk.page() == "run"


def test_a_whole_number_is_typed_on_from_all_its_digits(desk: Desk) -> None:
    panel = desk.app.panel
    panel._begin_edit(
        Slider("solver/max_iterations", "", 1_000_000.0, 10, 1_000_000, 20_000, whole=True)
    )
    assert panel.edit is not None
    assert panel.edit.text == "1000000"


def test_letters_do_what_they_always_do_but_not_while_typing(desk: Desk) -> None:
    go_to(desk, NU)
    desk.key(pygame.K_t)
    assert desk.app.stage.renderer.theme.name == "light"
    desk.key(pygame.K_RETURN)
    desk.key(pygame.K_t)
    assert desk.app.stage.renderer.theme.name == "light"
    desk.key(pygame.K_ESCAPE)
    assert sent(desk) == []


def test_seed_is_stepped_and_typed(desk: Desk) -> None:
    go_to(desk, "general/seed")
    desk.key(pygame.K_RIGHT)
    desk.until(lambda: sent(desk) == [Change("seed", 2)])
    desk.type("77")
    desk.key(pygame.K_RETURN)
    desk.until(lambda: sent(desk)[-1] == Change("seed", 77))
    desk.type("7-")
    desk.key(pygame.K_RETURN)
    assert desk.app.stage.notices.latest == words.SEED_WRONG


def test_sections_fold_by_keyboard(desk: Desk) -> None:
    go_to(desk, "grains")
    desk.key(pygame.K_RETURN)
    desk.app.tick()
    assert control(desk, NU) is None
    desk.key(pygame.K_RIGHT)
    desk.app.tick()
    assert control(desk, NU) is not None


def test_one_press_counts_once_however_long_a_picture_takes() -> None:
    """A key is held from the picture that has seen it on."""
    again: list[pygame.event.Event] = []
    focus = Focus(again.append)
    key = pygame.event.Event(pygame.KEYDOWN, key=pygame.K_TAB, mod=0, unicode="")
    focus.tick(1.0)
    focus.watch(key)
    focus.tick(9.0)
    assert again == []
    focus.tick(9.0 + 1.1 * FIRST_REPEAT)
    assert again == [key]


def test_held_key_repeats(desk: Desk) -> None:
    go_to(desk, NU)
    desk.post(pygame.KEYDOWN, key=pygame.K_LEFT, unicode="", mod=0)
    desk.until(lambda: value(desk, NU) < 0.75, seconds=20)
    desk.post(pygame.KEYUP, key=pygame.K_LEFT, mod=0)
    desk.app.tick()
    still = value(desk, NU)
    for _ in range(40):
        desk.app.tick()
    assert value(desk, NU) == still


# -- mouse --


def test_dragging_a_live_slider_sends_no_more_than_a_change_a_picture(desk: Desk) -> None:
    rail = track(desk, NU)
    desk.press((rail.left + 0.5 * rail.width, rail.centery))
    for step in range(30):
        x = rail.left + (0.5 + 0.01 * step) * rail.width
        pygame.event.post(
            pygame.event.Event(
                pygame.MOUSEMOTION, pos=(round(x), rail.centery), rel=(1, 0), buttons=(1, 0, 0)
            )
        )
        if step % 10 == 9:
            desk.app.tick()
    desk.app.tick()
    desk.release((rail.left + 0.79 * rail.width, rail.centery))
    shown = value(desk, NU)
    assert shown == pytest.approx(0.99 * 0.79, abs=0.01)
    desk.until(lambda: sent(desk)[-1:] == [Change("regular_poisson_ratio", shown)])
    assert 1 <= len(sent(desk)) <= 6


def test_dragging_what_packs_anew_sends_once_at_the_end(desk: Desk) -> None:
    rail = track(desk, SHARE)
    desk.press((rail.centerx, rail.centery))
    for share in (0.6, 0.7, 0.75):
        desk.point((rail.left + share * rail.width, rail.centery), pressed=True)
        assert value(desk, SHARE) == pytest.approx(share, abs=0.01)
    assert sent(desk) == []
    desk.release((rail.left + 0.75 * rail.width, rail.centery))
    desk.until(lambda: sent(desk) != [])
    (change,) = sent(desk)
    assert isinstance(change, Change)
    assert change.name == "auxetic_fraction"
    assert change.value == pytest.approx(0.75, abs=0.01)


def test_double_click_brings_the_default_back(desk: Desk) -> None:
    rail = track(desk, NU)
    desk.click((rail.left + 0.2 * rail.width, rail.centery))
    desk.until(lambda: desk.session.changed != {})
    desk.app.panel._clicked = ("", 0.0)
    spot = (rail.left + 0.2 * rail.width, rail.centery)
    desk.click(spot)
    desk.click(spot)
    desk.until(lambda: desk.session.changed == {"regular_poisson_ratio": 0.8})


def test_click_on_the_number_begins_to_type(desk: Desk) -> None:
    desk.click(number(desk, NU))
    assert desk.app.panel.edit is not None
    desk.type("0.3")
    desk.click((200, 300))  # elsewhere: as good as Enter
    desk.until(lambda: desk.session.changed == {"regular_poisson_ratio": 0.3})


def test_packing_by_mouse(desk: Desk) -> None:
    rect = box(desk, "general/packing")
    desk.click((rect.left + 20, rect.bottom - 10))
    desk.until(lambda: sent(desk) == [Change("packing", "regular")])


def test_wheel_and_finger_scroll(desk: Desk) -> None:
    panel = desk.app.panel
    desk.point(panel.rect.center)
    desk.post(pygame.MOUSEWHEEL, precise_y=-2.0, y=-2, x=0)
    assert panel.scroll > 0
    before = panel.scroll
    heading = box(desk, "geometry")
    before = panel.scroll
    desk.press(heading.center)
    desk.point((heading.centerx, heading.centery - 60), pressed=True)
    desk.release((heading.centerx, heading.centery - 60))
    assert panel.scroll > before
    assert "geometry" not in panel.folded  # it was no click


def test_fold_gives_the_canvas_the_room(desk: Desk) -> None:
    width = desk.app.stage.renderer.layout.canvas.width
    desk.key(pygame.K_k)
    desk.app.tick()
    assert not desk.app.panel.drawer.shown
    assert desk.app.stage.renderer.layout.canvas.width > width
    assert not any(name.startswith("general") for name in desk.app.stage.focus.stops())
    desk.key(pygame.K_k)
    assert desk.app.stage.renderer.layout.canvas.width == width


def test_folded_panel_opens_by_mouse(desk: Desk) -> None:
    rect = box(desk, "general/fold")
    desk.click(rect.center)
    assert not desk.app.panel.drawer.shown
    desk.click(desk.app.panel.drawer.tab.center)
    assert desk.app.panel.drawer.shown


def test_where_there_is_no_room_the_panel_opens_over_the_canvas() -> None:
    desk = Desk((800, 600), 2.0)
    desk.start()
    panel = desk.app.panel
    assert panel.rect.width == 0
    desk.key(pygame.K_k)
    desk.app.tick()
    assert 600 <= panel.rect.width <= 800
    assert panel.rect.right == desk.app.stage.renderer.size[0]
    assert "general/reset" in panel.stops()
    assert desk.app.timeline.rect.height == 0
    rect = box(desk, "time/play")  # there is no room for the time line: its buttons are here
    desk.click(rect.center)
    assert desk.paused()
    desk.click((panel.rect.left - 20, 300))
    assert panel.rect.width == 0
    desk.app.close()


def test_press_on_the_panel_is_none_on_the_canvas(desk: Desk) -> None:
    desk.app.panel.drawer.over = True
    rect = desk.app.panel.rect
    desk.press((rect.centerx, rect.bottom - 5))
    assert not desk.app.stage.mouse.holding
    desk.release((rect.centerx, rect.bottom - 5))


def test_what_the_solver_refuses_is_shown_as_it_was(desk: Desk) -> None:
    """A change that never comes true is forgotten after a while."""
    desk.session.refused = {"auxetic_fraction"}
    go_to(desk, SHARE)
    desk.key(pygame.K_RIGHT)
    desk.key(pygame.K_RETURN)
    desk.until(lambda: value(desk, SHARE) == pytest.approx(0.51))
    desk.until(lambda: value(desk, SHARE) == pytest.approx(0.5), seconds=10)


SWITCHES = [
    (name, parameter.name, bool(parameter.default))
    for name in registry.names()
    for parameter in registry.get(name).parameters
    if parameter.kind == "switch"
]


@pytest.mark.parametrize(("scene", "parameter", "default"), SWITCHES)
def test_every_switch_of_every_scene_is_taken(scene: str, parameter: str, default: bool) -> None:
    """By mouse and by every key that means it. A bool is a whole number to Python, and not to a parameter."""
    desk = Desk((1024, 720))
    try:
        desk.start(scene)
        desk.app.tick()
        name = f"geometry/{parameter}"
        desk.click(box(desk, name).center)
        desk.until(lambda: sent(desk) == [Change(parameter, not default)])
        for key, on in (
            (pygame.K_SPACE, default),
            (pygame.K_RIGHT, True),
            (pygame.K_LEFT, False),
            (pygame.K_RETURN, True),
            (pygame.K_DELETE, default),
        ):
            go_to(desk, name)
            desk.key(key)
            desk.until(
                lambda on=on: desk.session.changed.get(parameter, default) is on  # type: ignore[misc]
            )
    finally:
        desk.app.close()

"""A line of text that is edited: keys, what is selected, the clipboard, clicks, input methods."""

from __future__ import annotations

import pygame
import pytest

from sandbox.draw.text import BODY
from sandbox.draw.widgets.controls import (
    TextField,
    parts_of,
)
from sandbox.window.panel.line_edit import Edit
from tests.window.at_panel import box, control, go_to
from tests.window.desk import Desk

AT_WORK = (1024, 720)  # size of a window in which a scene runs already


def edited(text: str, *keys: int | tuple[int, int] | str) -> Edit:
    """After keys, keys with modifiers, and texts."""
    edit = Edit.of("x", text)
    for key in keys:
        if isinstance(key, str):
            edit.write(key)
        else:
            code, mod = key if isinstance(key, tuple) else (key, 0)
            edit.key(pygame.event.Event(pygame.KEYDOWN, key=code, unicode="", mod=mod))
    return edit


SHIFT, CTRL, CMD = pygame.KMOD_LSHIFT, pygame.KMOD_LCTRL, pygame.KMOD_LMETA
HOME, END, LEFT, RIGHT = pygame.K_HOME, pygame.K_END, pygame.K_LEFT, pygame.K_RIGHT
BACK, DELETE = pygame.K_BACKSPACE, pygame.K_DELETE


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ((), "one two"),
        (("q",), "q"),  # all is selected at first
        ((END, "d", HOME, "z"), "zone twod"),
        ((HOME, DELETE, RIGHT, BACK), "e two"),
        ((BACK,), ""),
        ((LEFT, "z"), "zone two"),  # to the side of what was selected
        ((RIGHT, "z"), "one twoz"),
        ((END, (LEFT, SHIFT), (LEFT, SHIFT), "x"), "one tx"),
        ((HOME, (END, SHIFT), DELETE), ""),
        ((END, (LEFT, CTRL), "z"), "one ztwo"),
        ((HOME, (RIGHT, CTRL), "z"), "onez two"),
        ((END, (BACK, CTRL)), "one "),
        ((END, (LEFT, CTRL | SHIFT), (pygame.K_x, CTRL), HOME, (pygame.K_v, CTRL)), "twoone "),
        ((END, (pygame.K_a, CMD), (pygame.K_c, CMD), END, (pygame.K_v, CMD)), "one twoone two"),
        (("two\nlines\t",), "twolines"),
        (("x" * 100,), "x" * 80),
        ((pygame.K_F5, (pygame.K_q, CTRL)), "one two"),
    ],
)
def test_editing_a_line(keys: tuple[int | tuple[int, int] | str, ...], text: str) -> None:
    pygame.display.init()
    edit = edited("one two", *keys)
    assert edit.text == text
    assert edit.changed == (text != "one two")


def test_clipboard_by_place_where_letters_are_others() -> None:
    """On a Russian keyboard Ctrl and the key of V."""
    pygame.display.init()
    edit = edited("one", (pygame.K_c, CTRL), END)
    paste = {"key": ord("м"), "scancode": pygame.KSCAN_V, "unicode": "м", "mod": CTRL}
    edit.key(pygame.event.Event(pygame.KEYDOWN, paste))
    assert edit.text == "oneone"


def test_a_click_puts_the_caret_between_letters(desk: Desk) -> None:
    desk.app.panel.folded.clear()
    desk.app.tick()
    box(desk, "files/name")
    place = desk.app.panel._places.named("files/name")
    assert place is not None
    type_ = desk.app.stage.renderer.type
    inside = parts_of(place.control, place.rect, type_).box.move(
        desk.app.panel.rect.left, desk.app.panel.rect.top - desk.app.panel.scroll
    )
    desk.click(inside.center)
    desk.type("abcdef")
    desk.click((inside.left + 8 + type_.width("abc", BODY), inside.centery))
    desk.type("-")
    assert desk.app.panel.edit is not None
    assert desk.app.panel.edit.text == "abc-def"
    desk.click((inside.right - 2, inside.centery))
    desk.key(pygame.K_BACKSPACE)
    assert desk.app.panel.edit.text == "abc-de"


def test_an_input_method_has_the_keys_while_it_composes(desk: Desk) -> None:
    desk.app.panel.folded.clear()
    desk.app.tick()
    go_to(desk, "files/name")
    desk.key(pygame.K_RETURN)
    desk.post(pygame.TEXTEDITING, text="ni", start=2, length=0)
    assert desk.app.panel.edit is not None
    assert desk.app.panel.edit.composed == "ni"
    desk.key(pygame.K_RETURN)  # takes what is offered
    desk.key(pygame.K_BACKSPACE)
    desk.post(pygame.TEXTINPUT, text="日")
    assert desk.app.panel.edit.text == "日"
    desk.key(pygame.K_RETURN)
    found = control(desk, "files/name")
    assert isinstance(found, TextField)
    assert found.text == "日"

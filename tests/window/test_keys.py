"""Keys mean the same on keyboards of another script."""

from __future__ import annotations

import pygame
import pytest

from sandbox.window.keys import Action, action_of

CTRL = pygame.KMOD_LCTRL


@pytest.mark.parametrize(
    ("sign", "place", "mod", "action"),
    [
        ("д", pygame.KSCAN_L, 0, Action.LANGUAGE),
        ("я", pygame.KSCAN_Z, 0, Action.UNDO),
        ("Я", pygame.KSCAN_Z, pygame.KMOD_LSHIFT, Action.REDO),
        ("я", pygame.KSCAN_Z, CTRL, Action.UNDO),
        ("я", pygame.KSCAN_Z, CTRL | pygame.KMOD_LSHIFT, Action.REDO),
        ("х", pygame.KSCAN_LEFTBRACKET, 0, Action.BACKWARD),
        ("ю", pygame.KSCAN_PERIOD, 0, Action.FASTER),
        ("є", pygame.KSCAN_APOSTROPHE, 0, None),
        # Latin letters count by what is printed, wherever they are.
        ("z", pygame.KSCAN_Y, 0, Action.UNDO),
        ("ü", pygame.KSCAN_LEFTBRACKET, 0, None),
    ],
)
def test_letters_of_another_script_go_by_their_place(
    sign: str, place: int, mod: int, action: Action | None
) -> None:
    written = sign if not mod & CTRL else "\x1a"
    event = pygame.event.Event(
        pygame.KEYDOWN, key=ord(sign.lower()), unicode=written, scancode=place, mod=mod
    )
    assert action_of(event) is action

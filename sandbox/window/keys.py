"""Which key means what; ``keyboards`` says what a key writes."""

from __future__ import annotations

import enum
from collections.abc import Sequence

import pygame

from sandbox.window.keyboards import letter_of, sign_of


class Action(enum.Enum):
    """What a key asks for."""

    PAUSE = enum.auto()
    STEP = enum.auto()
    RESET = enum.auto()
    PACKING_1 = enum.auto()
    PACKING_2 = enum.auto()
    PACKING_3 = enum.auto()
    NEXT_PACKING = enum.auto()
    NEW_SEED = enum.auto()
    MENU = enum.auto()
    PROTOCOL = enum.auto()
    NEXT_VIEW = enum.auto()
    CHAINS = enum.auto()
    HELP = enum.auto()
    THEME = enum.auto()
    LANGUAGE = enum.auto()
    TOUR = enum.auto()
    LARGER = enum.auto()
    SMALLER = enum.auto()
    NEARER = enum.auto()
    FARTHER = enum.auto()
    WHOLE = enum.auto()
    LOOK_LEFT = enum.auto()
    LOOK_RIGHT = enum.auto()
    LOOK_UP = enum.auto()
    LOOK_DOWN = enum.auto()
    SCREENSHOT = enum.auto()
    BACK = enum.auto()
    ENTER = enum.auto()
    LEFT = enum.auto()
    RIGHT = enum.auto()
    UP = enum.auto()
    DOWN = enum.auto()
    FINE_LEFT = enum.auto()
    FINE_RIGHT = enum.auto()
    FINE_UP = enum.auto()
    FINE_DOWN = enum.auto()
    FOLD = enum.auto()
    BRUSH = enum.auto()
    NEXT_CONTACT = enum.auto()
    UNDO = enum.auto()
    REDO = enum.auto()
    BACKWARD = enum.auto()
    FORWARD = enum.auto()
    SLOWER = enum.auto()
    FASTER = enum.auto()
    COMPARE = enum.auto()
    RECORD = enum.auto()
    RECORD_GIF = enum.auto()
    SOUND = enum.auto()
    TONE = enum.auto()
    EXPORT = enum.auto()
    SAVE = enum.auto()
    EXPLORE = enum.auto()
    MEASURE = enum.auto()
    FULLSCREEN = enum.auto()


PACKING_ACTIONS = (Action.PACKING_1, Action.PACKING_2, Action.PACKING_3)

_SIGNS = {
    " ": Action.PAUSE,
    "s": Action.STEP,
    "r": Action.RESET,
    "1": Action.PACKING_1,
    "2": Action.PACKING_2,
    "3": Action.PACKING_3,
    "p": Action.NEXT_PACKING,
    "n": Action.NEW_SEED,
    "m": Action.MENU,
    "a": Action.PROTOCOL,
    "v": Action.NEXT_VIEW,
    "f": Action.CHAINS,
    "h": Action.HELP,
    "?": Action.HELP,
    "t": Action.THEME,
    "l": Action.LANGUAGE,
    "y": Action.TOUR,
    "+": Action.NEARER,
    "=": Action.NEARER,
    "-": Action.FARTHER,
    "0": Action.WHOLE,
    "k": Action.FOLD,
    "b": Action.BRUSH,
    "i": Action.NEXT_CONTACT,
    "z": Action.UNDO,
    "Z": Action.REDO,
    "[": Action.BACKWARD,
    "]": Action.FORWARD,
    ",": Action.SLOWER,
    ".": Action.FASTER,
    "c": Action.COMPARE,
    "g": Action.RECORD,
    "G": Action.RECORD_GIF,
    "o": Action.SOUND,
    "O": Action.TONE,
    "e": Action.EXPORT,
    "w": Action.SAVE,
    "x": Action.EXPLORE,
    "d": Action.MEASURE,
}

_KEYS = {
    pygame.K_F1: Action.HELP,
    pygame.K_F11: Action.FULLSCREEN,
    pygame.K_F12: Action.SCREENSHOT,
    pygame.K_ESCAPE: Action.BACK,
    pygame.K_RETURN: Action.ENTER,
    pygame.K_KP_ENTER: Action.ENTER,
    pygame.K_LEFT: Action.LEFT,
    pygame.K_RIGHT: Action.RIGHT,
    pygame.K_UP: Action.UP,
    pygame.K_DOWN: Action.DOWN,
    pygame.K_KP_PLUS: Action.NEARER,
    pygame.K_KP_MINUS: Action.FARTHER,
}

_WITH_SHIFT = {
    pygame.K_LEFT: Action.FINE_LEFT,
    pygame.K_RIGHT: Action.FINE_RIGHT,
    pygame.K_UP: Action.FINE_UP,
    pygame.K_DOWN: Action.FINE_DOWN,
}

# With Ctrl.
_LOOKS = {
    pygame.K_LEFT: Action.LOOK_LEFT,
    pygame.K_RIGHT: Action.LOOK_RIGHT,
    pygame.K_UP: Action.LOOK_UP,
    pygame.K_DOWN: Action.LOOK_DOWN,
}
_COMMANDS = {"z": Action.UNDO, "y": Action.REDO, "s": Action.SAVE}
_SIZES = {
    pygame.K_PLUS: Action.LARGER,
    pygame.K_EQUALS: Action.LARGER,
    pygame.K_KP_PLUS: Action.LARGER,
    pygame.K_MINUS: Action.SMALLER,
    pygame.K_KP_MINUS: Action.SMALLER,
}
_BRACKETS = ("[", "]")


def action_of(event: pygame.event.Event) -> Action | None:
    """What a KEYDOWN event asks for, if anything."""
    if _asks_for_the_screen(event):
        return Action.FULLSCREEN
    mod, letter = getattr(event, "mod", 0), letter_of(event)
    commands = {**_SIZES, **_LOOKS}
    if mod & (pygame.KMOD_CTRL | pygame.KMOD_META) and event.key in commands:
        return commands[event.key]
    if mod & pygame.KMOD_SHIFT and event.key in _WITH_SHIFT:
        return _WITH_SHIFT[event.key]
    if event.key in _KEYS:
        return _KEYS[event.key]
    if mod & (pygame.KMOD_CTRL | pygame.KMOD_META) and letter in _COMMANDS:
        again = letter == "z" and mod & pygame.KMOD_SHIFT
        return Action.REDO if again else _COMMANDS[letter]
    if mod & (pygame.KMOD_CTRL | pygame.KMOD_ALT | pygame.KMOD_META):
        # AltGr, with which many keyboards write brackets, may come as Ctrl and Alt.
        written = getattr(event, "unicode", "")
        return _SIGNS[written] if written in _BRACKETS else None
    sign = sign_of(event)
    return _SIGNS.get(sign) or _SIGNS.get(sign.lower())


def _asks_for_the_screen(event: pygame.event.Event) -> bool:
    """Alt and Enter, as in other programs; AltGr, which may come as Ctrl and Alt, is no Alt."""
    held = getattr(event, "mod", 0) & (pygame.KMOD_ALT | pygame.KMOD_CTRL)
    return (
        event.key == pygame.K_RETURN
        and bool(held & pygame.KMOD_LALT)
        and held & pygame.KMOD_CTRL == 0
    )


def packing_for(action: Action, packings: Sequence[str], current: str) -> str | None:
    """The packing that an action asks for: by its number, or the next one."""
    if action in PACKING_ACTIONS:
        index = PACKING_ACTIONS.index(action)
        return packings[index] if index < len(packings) else None
    if action is Action.NEXT_PACKING and packings:
        here = packings.index(current) if current in packings else -1
        return packings[(here + 1) % len(packings)]
    return None

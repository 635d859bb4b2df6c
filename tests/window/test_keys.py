"""Keys mean the same on every keyboard."""

from __future__ import annotations

import pygame
import pytest

from sandbox.window.focus import REPEATING_SIGNS
from sandbox.window.keyboards import SIGNS, letter_of, sign_of
from sandbox.window.keys import _SIGNS, Action, action_of

MODS = {
    "-": 0,
    "S": pygame.KMOD_LSHIFT,
    "C": pygame.KMOD_LCTRL,
    "L": pygame.KMOD_CAPS,
    "G": pygame.KMOD_RALT,
}

# What SDL tells of keys under X: the keyboard, what is held or locked (Shift, Ctrl, caps Lock, AltGr), key, scancode, what it
# writes (^Z: a control character, ·: nothing), and what that is to mean.
TOLD = """
us -    122  29 z  UNDO
us S    122  29 Z  REDO
us L    122  29 Z  UNDO
us SL   122  29 z  REDO
us C    122  29 ^Z UNDO
us SC   122  29 ^Z REDO
us CL   122  29 ^Z UNDO
us C    121  28 ^Y REDO
us C    115  22 ^S SAVE
us -    121  28 y  TOUR
us -     97   4 a  PROTOCOL
us -    109  16 m  MENU
us -     49  30 1  PACKING_1
us L     49  30 1  PACKING_1
us -     50  31 2  PACKING_2
us -     51  32 3  PACKING_3
us -     91  47 [  BACKWARD
us -     93  48 ]  FORWARD
us -     44  54 ,  SLOWER
us -     46  55 .  FASTER
us -     61  46 =  NEARER
us S     61  46 +  NEARER
us -     45  45 -  FARTHER
us S     49  30 !  -
us -     47  56 /  -
de -    122  28 z  UNDO
de S    122  28 Z  REDO
de L    122  28 Z  UNDO
de SL   122  28 z  REDO
de C    122  28 ^Z UNDO
de SC   122  28 ^Z REDO
de CL   122  28 ^Z UNDO
de C    121  29 ^Y REDO
de C    115  22 ^S SAVE
de -    121  29 y  TOUR
de -     97   4 a  PROTOCOL
de -    109  16 m  MENU
de -     49  30 1  PACKING_1
de L     49  30 1  PACKING_1
de -     50  31 2  PACKING_2
de -     51  32 3  PACKING_3
de G     56  37 [  BACKWARD
de G     57  38 ]  FORWARD
de -     44  54 ,  SLOWER
de -     46  55 .  FASTER
de -     43  48 +  NEARER
de -     45  56 -  FARTHER
de -    252  47 ü  -
de -    223  45 ß  -
de S     49  30 !  -
fr -    122  26 z  UNDO
fr S    122  26 Z  REDO
fr L    122  26 Z  UNDO
fr SL   122  26 z  REDO
fr C    122  26 ^Z UNDO
fr SC   122  26 ^Z REDO
fr CL   122  26 ^Z UNDO
fr C    121  28 ^Y REDO
fr C    115  22 ^S SAVE
fr -    121  28 y  TOUR
fr -     97  20 a  PROTOCOL
fr -    109  51 m  MENU
fr -     49  30 &  PACKING_1
fr L     49  30 &  PACKING_1
fr -     50  31 é  PACKING_2
fr -     51  32 "  PACKING_3
fr S     49  30 1  PACKING_1
fr G     53  34 [  BACKWARD
fr G     41  45 ]  FORWARD
fr -     44  16 ,  SLOWER
fr S     59  54 .  FASTER
fr -     61  46 =  NEARER
fr S     61  46 +  NEARER
fr -     54  35 -  FARTHER
fr S     44  16 ?  HELP
fr -     59  54 ;  -
fr -    249  52 ù  -
fr G     57  38 ^  -
ru -   1103  29 я  UNDO
ru S   1103  29 Я  REDO
ru L   1103  29 Я  UNDO
ru SL  1103  29 я  REDO
ru C   1103  29 я  UNDO
ru SC  1103  29 Я  REDO
ru CL  1103  29 Я  UNDO
ru C   1085  28 н  REDO
ru C   1099  22 ы  SAVE
ru -   1085  28 н  TOUR
ru -   1092   4 ф  PROTOCOL
ru -   1100  16 ь  MENU
ru -     49  30 1  PACKING_1
ru L     49  30 1  PACKING_1
ru -     50  31 2  PACKING_2
ru -     51  32 3  PACKING_3
ru -   1093  47 х  BACKWARD
ru -   1098  48 ъ  FORWARD
ru -   1073  54 б  SLOWER
ru -   1102  55 ю  FASTER
ru -     46  56 .  FASTER
ru S     46  56 ,  SLOWER
ru -     61  46 =  NEARER
ru -     45  45 -  FARTHER
ru -   1078  51 ж  -
ru -   1101  52 э  -
gr -    950  29 ζ  UNDO
gr S    950  29 Ζ  REDO
gr L    950  29 Ζ  UNDO
gr SL   950  29 ζ  REDO
gr C    950  29 ζ  UNDO
gr SC   950  29 Ζ  REDO
gr CL   950  29 Ζ  UNDO
gr C    965  28 υ  REDO
gr C    963  22 σ  SAVE
gr -    965  28 υ  TOUR
gr -    945   4 α  PROTOCOL
gr -    956  16 μ  MENU
gr -     49  30 1  PACKING_1
gr L     49  30 1  PACKING_1
gr -     50  31 2  PACKING_2
gr -     51  32 3  PACKING_3
gr -     91  47 [  BACKWARD
gr -     93  48 ]  FORWARD
gr -     44  54 ,  SLOWER
gr -     46  55 .  FASTER
gr -     61  46 =  NEARER
gr -     45  45 -  FARTHER
gr -     59  20 ;  -
gr -    962  26 ς  SAVE
il -   1494  29 ז  UNDO
il S   1494  29 Z  REDO
il L   1494  29 Z  UNDO
il SL  1494  29 ז  REDO
il C   1494  29 ז  UNDO
il SC  1494  29 ·  REDO
il CL  1494  29 ·  UNDO
il C   1496  28 ט  REDO
il C   1491  22 ד  SAVE
il -   1496  28 ט  TOUR
il -   1513   4 ש  PROTOCOL
il -   1510  16 צ  MENU
il -     49  30 1  PACKING_1
il L     49  30 1  PACKING_1
il -     50  31 2  PACKING_2
il -     51  32 3  PACKING_3
il -     91  48 [  BACKWARD
il -     93  47 ]  FORWARD
il -   1514  54 ת  SLOWER
il -   1509  55 ץ  FASTER
il -     46  56 .  FASTER
il -     44  52 ,  SLOWER
il S     46  56 ?  HELP
il S     39  26 W  SAVE
il -     61  46 =  NEARER
il -     45  45 -  FARTHER
il -   1507  51 ף  -
il -     47  20 /  -
"""


def told(line: str) -> tuple[pygame.event.Event, Action | None]:
    """The event of a line, and what it is to mean."""
    _, held, key, scancode, written, action = line.split()
    if written.startswith("^") and len(written) > 1:
        written = chr(ord(written[1]) - 64)
    event = pygame.event.Event(
        pygame.KEYDOWN,
        key=int(key),
        scancode=int(scancode),
        unicode=written.replace("·", ""),
        mod=sum(MODS[letter] for letter in held),
    )
    return event, None if action == "-" else Action[action]


@pytest.mark.parametrize("line", TOLD.split("\n")[1:-1])
def test_keys_of_every_keyboard(line: str) -> None:
    event, action = told(line)
    assert action_of(event) is action


def test_every_letter_is_on_every_keyboard() -> None:
    """By what is printed, else by place: a letter has a key wherever 26 keys have letters."""
    rows = {
        "us": "abcdefghijklmnopqrstuvwxyz",
        "de": "abcdefghijklmnopqrstuvwxzy",
        "ru": "фисвуапршолдьтщзйкыегмцчня",
        "uk": "фисвуапршолдьтщзйкіегмцчня",
    }
    for name, signs in rows.items():
        letters = {
            letter_of(
                pygame.event.Event(pygame.KEYDOWN, key=ord(sign), scancode=pygame.KSCAN_A + k)
            )
            for k, sign in enumerate(signs)
        }
        assert letters == set("abcdefghijklmnopqrstuvwxyz"), name


def test_every_sign_that_means_something_is_known() -> None:
    assert {sign for sign in {*_SIGNS, *REPEATING_SIGNS} if not sign.isalpha()} <= SIGNS


def test_numbers_without_shift_where_they_want_it() -> None:
    """Windows names a French key after what it writes, which is no digit."""
    event = pygame.event.Event(
        pygame.KEYDOWN, key=ord("é"), scancode=pygame.KSCAN_2, unicode="é", mod=0
    )
    assert sign_of(event) == "2"

"""What the scene menu leads to: a scene, a tour, a file, or what was left unfinished."""

from __future__ import annotations

import contextlib
import time
from typing import TYPE_CHECKING

from core.errors import InputError
from sandbox.draw.pages.menu_layout import DISCARD, KEYS, LANGUAGE, START, TAKE_UP, THEME
from sandbox.files import autosave
from sandbox.window.keys import Action
from sandbox.window.menu import Choice
from sandbox.words import words
from scenes.text import message

if TYPE_CHECKING:
    from sandbox.window.app import App

START_SCENE = "hopper"  # whose tour begins with three packings side by side
MINUTE, HOUR, DAY = 60.0, 3600.0, 86400.0  # [s]


class Beginnings:
    """Carries out choices. Autosaves of programs that are gone are looked for once."""

    def __init__(self, app: App) -> None:
        self.app = app
        self._left: list[autosave.Leftover] = []
        self._looked = False

    def look_for_leftovers(self) -> None:
        """Offer the latest autosave in the menu, if there is one."""
        if not self._looked:
            self._looked = True
            with contextlib.suppress(OSError):
                self._left = list(autosave.find())
        self._tell()

    def _tell(self) -> None:
        self.app.menu.resume = (lambda: left_words(self._left[0])) if self._left else None

    def take(self, choice: Choice) -> None:
        """Do what was chosen; what cannot be done is said."""
        try:
            self._take(choice)
        except InputError as error:
            self.app.toast(words.say(message(error)))

    def _take(self, choice: Choice) -> None:
        app = self.app
        if choice.packing is not None:
            app.run.packing = choice.packing
        elif choice.scene is not None:
            app.guide.close()
            app.start(choice.scene)
        elif choice.tour is not None:
            app.guide.start(choice.tour)
        elif choice.file is not None:
            app.guide.close()
            app.open(choice.file)
        elif choice.what == START:
            app.guide.start(START_SCENE)
        elif choice.what in (TAKE_UP, DISCARD) and self._left:
            self._end_of_leftover(choice.what == TAKE_UP)
        elif choice.what == KEYS:
            app.act(Action.HELP)
        elif choice.what in (LANGUAGE, THEME):
            app.act(Action.LANGUAGE if choice.what == LANGUAGE else Action.THEME)

    def _end_of_leftover(self, wanted: bool) -> None:
        leftover = self._left.pop(0)
        self._tell()
        if wanted:
            self.app.guide.close()
            self.app.take_up(leftover)
        else:
            leftover.remove()
            self.app.toast(words.DISCARDED)


def left_words(leftover: autosave.Leftover) -> str:
    """What was left unfinished, and when, in the present language."""
    scene = words.title(leftover.scene) or leftover.scene
    return words.LEFT_UNFINISHED.format(
        scene=scene, grains=leftover.grains, when=ago(time.time() - leftover.saved)
    )


def ago(seconds: float) -> str:
    """How long ago something was."""
    if seconds < MINUTE:
        return words.AGO_NOW
    if seconds < 1.5 * MINUTE:
        return words.AGO_MINUTE
    if seconds < HOUR:
        return words.AGO_MINUTES.format(count=round(seconds / MINUTE))
    if seconds < 1.5 * HOUR:
        return words.AGO_HOUR
    if seconds < 2 * DAY:
        return words.AGO_HOURS.format(count=round(seconds / HOUR))
    return words.AGO_DAYS.format(count=round(seconds / DAY))

"""Pages over the window: the scene menu with all that it leads to, and the page of keys."""

from __future__ import annotations

import contextlib
import time

import pygame

from core.errors import InputError
from sandbox.draw.pages.help_page import HelpLayout, draw_help
from sandbox.draw.pages.menu_layout import DISCARD, EXPLORE, KEYS, LANGUAGE, START, TAKE_UP, THEME
from sandbox.draw.painter import Painter
from sandbox.files import autosave
from sandbox.lessons import classroom
from sandbox.window.explore.page import ExplorePage
from sandbox.window.guide import Guide
from sandbox.window.keys import Action
from sandbox.window.menu import Choice, Menu
from sandbox.window.stage import Stage
from sandbox.words import words
from scenes import registry
from scenes.text import message

START_SCENE = "hopper"  # whose tour begins with three packings side by side
ACTIONS = {
    EXPLORE: Action.EXPLORE,
    KEYS: Action.HELP,
    LANGUAGE: Action.LANGUAGE,
    THEME: Action.THEME,
}
MINUTE, HOUR, DAY = 60.0, 3600.0, 86400.0  # [s]


class HelpPage:
    """All keys; arrows and wheel scroll where not all of them fit."""

    def __init__(self) -> None:
        self.scroll = 0
        self._places: HelpLayout | None = None

    def act(self, action: Action, step: int) -> bool:
        """Scroll by ``step`` pixels; True if that is what the key means."""
        ways = {Action.UP: 1.0, Action.DOWN: -1.0}
        if action in ways:
            self.wheel(ways[action], step)
        return action in ways

    def wheel(self, notches: float, step: int) -> None:
        """Scroll by notches of ``step`` pixels, up where they are positive."""
        most = 0 if self._places is None else self._places.most_scroll
        self.scroll = max(0, min(round(self.scroll - notches * step), most))

    def draw(self, painter: Painter) -> None:
        """Draw the page over the picture."""
        self._places = draw_help(painter, self.scroll)
        self.scroll = min(self.scroll, self._places.most_scroll)


class Pages:
    """The menu and the page of keys. Carries out choices; autosaves of programs that are gone are looked for once."""

    def __init__(self, stage: Stage, guide: Guide) -> None:
        self.stage, self.guide = stage, guide
        self.menu = Menu()
        self.help = HelpPage()
        self.explore = ExplorePage(stage)
        self._left: list[autosave.Leftover] = []
        self._looked = False
        stage.at_new_scene(lambda: self.menu.choose(stage.panes.scene))

    def open_menu(self) -> None:
        """Show the scenes; what runs is held meanwhile."""
        stage = self.stage
        stage.mouse.release(stage.send)
        stage.panes.hold()
        if stage.panes.exists:
            stage.notices.forget()  # of what is left behind
        stage.show_menu, stage.show_help, stage.show_explore = True, False, False
        self._look_for_leftovers()
        self.menu.open(stage.panes.scene if stage.panes.exists else "")
        stage.redraw(True)

    def mouse(self, event: pygame.event.Event) -> Action | None:
        """The mouse, while a page is shown. What it asks for, if that is an action."""
        if self.stage.show_help:
            self.stage.show_help = event.type != pygame.MOUSEBUTTONDOWN
        elif self.stage.show_explore:
            if event.type == pygame.MOUSEMOTION:
                self.explore.hover(event.pos)
            elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
                beside = bool(pygame.key.get_mods() & pygame.KMOD_SHIFT)
                self.explore.click(event.pos, beside=beside)
        elif self.stage.show_menu and event.type == pygame.MOUSEMOTION:
            self.menu.hover(event.pos)
        elif self.stage.show_menu and event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            return self.take(self.menu.click(event.pos))
        return None

    def handle(self, event: pygame.event.Event) -> bool:
        """Tab in the menu, and the wheel; True if the event was that."""
        stage = self.stage
        if stage.show_explore and not stage.show_help:
            if event.type == pygame.KEYDOWN and event.key == pygame.K_TAB:
                self.explore.tab()
                return True
            return False
        if stage.show_menu and not stage.show_help and self.menu.handle(event):
            return True
        if event.type != pygame.MOUSEWHEEL or not (stage.show_menu or stage.show_help):
            return False
        page = self.help if stage.show_help else self.menu
        page.wheel(event.precise_y, round(60 * stage.renderer.scale))
        return True

    def draw(self) -> None:
        """What is shown of them; nothing if neither is."""
        stage = self.stage
        if stage.show_explore:
            self.explore.draw(stage.renderer.painter())
        elif stage.show_menu:
            self.menu.draw(stage.renderer.painter(), stage.panes.packing, stage.notices.latest)
        if stage.show_help:
            self.help.draw(stage.renderer.painter())

    def open_explore(self) -> None:
        """The map, of what runs or of what is chosen in the menu."""
        panes, chosen = self.stage.panes, self.menu.scene_chosen
        frame = panes.snapshot.frame
        if self.stage.show_menu and chosen:
            scene = registry.get(chosen)
            packing = panes.packing if panes.packing in scene.packings else scene.packings[0]
            self.explore.open(chosen, packing, {})
        elif not self.stage.show_menu and frame is not None:
            self.explore.open(frame.scene, frame.packing, frame.settings)

    def _look_for_leftovers(self) -> None:
        """Offer the latest autosave in the menu, if there is one."""
        if not self._looked:
            self._looked = True
            with contextlib.suppress(OSError):
                found = autosave.find()
                self._left = list(found.leftovers)
                if found.set_aside:
                    named = (f"{one.path} ({one.why})" for one in found.set_aside)
                    self.stage.toast(words.SET_ASIDE.format(files=words.LIST_SIGN.join(named)))
        self._tell()

    def _tell(self) -> None:
        self.menu.resume = (lambda: left_words(self._left[0])) if self._left else None

    def take(self, choice: Choice) -> Action | None:
        """Do what was chosen; what cannot be done is said. An action is for ``Actions`` to carry out."""
        try:
            self._take(choice)
        except InputError as error:
            self.stage.toast(words.say(message(error)))
        return ACTIONS.get(choice.what)

    def _take(self, choice: Choice) -> None:
        if choice.packing is not None:
            self.stage.panes.packing = choice.packing
        elif choice.scene is not None:
            self.guide.leave()
            self.stage.start(choice.scene)
        elif choice.tour is not None:
            self.guide.start(choice.tour)
        elif choice.lesson is not None:
            self.guide.begin(classroom.named(choice.lesson))
        elif choice.file is not None:
            self.guide.leave()
            self.stage.open(choice.file)
        elif choice.what == START:
            self.guide.start(START_SCENE)
        elif choice.what in (TAKE_UP, DISCARD) and self._left:
            self._end_of_leftover(choice.what == TAKE_UP)

    def _end_of_leftover(self, wanted: bool) -> None:
        leftover = self._left.pop(0)
        self._tell()
        if wanted:
            self.guide.leave()
            self.stage.take_up(leftover)
        else:
            leftover.remove()
            self.stage.toast(words.DISCARDED)


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
    if seconds < HOUR:
        return words.AGO_MINUTES.format(count=round(seconds / MINUTE))
    if seconds < 2 * DAY:
        return words.AGO_HOURS.format(count=round(seconds / HOUR))
    return words.AGO_DAYS.format(count=round(seconds / DAY))

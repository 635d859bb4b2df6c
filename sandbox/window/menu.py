"""The scene menu's state: what is chosen, how far it is scrolled, and what a person picks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pygame

from sandbox.draw.pages import menu_layout
from sandbox.draw.pages.menu_layout import (
    DISCARD,
    EXPLORE,
    FILE,
    KEYS,
    LANGUAGE,
    LESSON,
    PACKING,
    SCENE,
    START,
    TAKE_UP,
    THEME,
    TOUR,
    Card,
    Chip,
    Contents,
    MenuLayout,
)
from sandbox.draw.pages.menu_page import draw_menu
from sandbox.draw.painter import Painter
from sandbox.files.scene_file import SceneHere, scenes_here
from sandbox.lessons import classroom, tours
from sandbox.lessons.classroom import LessonHere, lessons_here
from sandbox.lessons.lesson import Lesson
from sandbox.window.keys import Action
from sandbox.words import language, words
from scenes import registry

ARROWS = {
    Action.LEFT: (-1, 0),
    Action.RIGHT: (1, 0),
    Action.UP: (0, -1),
    Action.DOWN: (0, 1),
}


@dataclass(frozen=True, slots=True)
class Choice:
    """What a person picked: at most one of these. ``what`` is START, TAKE_UP, DISCARD, EXPLORE, LANGUAGE, THEME or KEYS."""

    scene: str | None = None
    packing: str | None = None
    tour: str | None = None  # of that scene
    lesson: str | None = None  # its name, or the path of a file
    file: Path | None = None
    what: str = ""


class Menu:
    """All there is to begin with; keyboard and mouse."""

    def __init__(self) -> None:
        self.scenes = [registry.get(name) for name in registry.names()]
        kinds = dict.fromkeys(packing for scene in self.scenes for packing in scene.packings)
        self.packings = tuple(kinds)
        self.chosen = START
        self.scroll = 0
        self.resume: Callable[[], str] | None = (
            None  # tells what was left unfinished, if anything was
        )
        self._files: tuple[SceneHere, ...] = ()
        self._lessons: tuple[LessonHere, ...] = ()
        self._places: MenuLayout | None = None
        self._scene = ""  # that the choice was on last
        self._pointed = ""  # what the mouse is over
        self._follow = False  # bring what is chosen into view with the next picture

    def open(self, scene: str, folder: Path | None = None) -> None:
        """The menu is shown: look for files, and put the choice on the scene that runs, if one does."""
        self._files = scenes_here(folder or Path.cwd())
        self._lessons = lessons_here(folder or Path.cwd())
        if scene:
            self.choose(scene)
        elif self.resume:
            self.go(TAKE_UP)

    def choose(self, scene: str) -> None:
        """Put the choice on a scene."""
        if scene in registry.names():
            self.go(SCENE + scene)

    @property
    def scene_chosen(self) -> str:
        """The scene that the choice was on last; the first before any."""
        return self._scene or self.scenes[0].name

    def contents(self, packing: str, theme: str) -> Contents:
        """What the menu offers, in the present language."""
        cards = [
            Card(
                SCENE + scene.name,
                words.title(scene.name, scene.title),
                words.question(scene.name, scene.question),
                words.first_sentence(words.about(scene.name, scene.about)),
                scene.name,
                scene.name in tours.scenes(),
            )
            for scene in self.scenes
        ]
        cards += [lesson_card(name, classroom.lesson(name)) for name in classroom.names()]
        cards += [lesson_card(str(here.path), here.lesson) for here in self._lessons]
        cards += [
            Card(
                FILE + str(file.path),
                file.path.stem,
                words.MENU_FILE.format(name=file.path.name),
                words.MENU_FILE_FROM.format(scene=words.title(file.scene) or file.scene),
                file.scene,
            )
            for file in self._files
        ]
        chips = [
            Chip(PACKING + name, words.PACKINGS.get(name, name), name == packing)
            for name in self.packings
        ]
        chips += [
            Chip(EXPLORE, words.EXPLORE),
            Chip(LANGUAGE, str(language.find("name"))),
            Chip(THEME, words.THEMES[theme]),
            Chip(KEYS, words.HELP_TITLE),
        ]
        return Contents(tuple(cards), tuple(chips), self.resume() if self.resume else "")

    # -- what a person does --

    def handle(self, event: pygame.event.Event) -> bool:
        """Tab goes on, with Shift back; True if the key was that."""
        if event.type != pygame.KEYDOWN or event.key != pygame.K_TAB:
            return False
        stops = self._places.stops() if self._places is not None else []
        if stops:
            way = -1 if getattr(event, "mod", 0) & pygame.KMOD_SHIFT else 1
            here = stops.index(self.chosen) if self.chosen in stops else -way
            self.go(stops[(here + way) % len(stops)])
        return True

    def key(self, action: Action) -> Choice:
        """Arrows move the choice, Enter takes it."""
        if action in ARROWS and self._places is not None:
            self.go(self._places.neighbour(self.chosen, ARROWS[action]))
        elif action in (Action.ENTER, Action.PAUSE):
            return self.taken(self.chosen)
        elif action is Action.TOUR:
            return Choice(tour=self.chosen.removeprefix(SCENE)) if self._tour_here() else Choice()
        return Choice()

    def hover(self, place: tuple[int, int]) -> None:
        """The mouse is there."""
        self._pointed = self._at(place)
        if self._pointed and not self._pointed.startswith(TOUR):
            self.chosen = self._pointed
            self._note_scene(self.chosen)

    def cursor(self) -> int:
        """The system cursor for where the mouse is."""
        return pygame.SYSTEM_CURSOR_HAND if self._pointed else pygame.SYSTEM_CURSOR_ARROW

    def click(self, place: tuple[int, int]) -> Choice:
        """The mouse was pressed there."""
        name = self._at(place)
        if name and not name.startswith(TOUR):
            self.chosen = name
        return self.taken(name)

    def wheel(self, notches: float, step: int) -> None:
        """Scroll by notches of ``step`` pixels."""
        if self._places is not None:
            wanted = round(self.scroll - notches * step)
            self.scroll = max(0, min(wanted, self._places.most_scroll))

    def draw(self, painter: Painter, packing: str, notice: str) -> None:
        """Draw the whole page."""
        contents = self.contents(packing, painter.theme.name)
        self._places = draw_menu(
            painter, contents, chosen=self.chosen, scroll=self.scroll, notice=notice
        )
        wanted = min(self.scroll, self._places.most_scroll)
        if self._follow:
            self._follow = False
            wanted = self._places.scroll_to(self.chosen, self.scroll)
        if wanted != self.scroll:
            self.scroll = wanted
            draw_menu(painter, contents, chosen=self.chosen, scroll=self.scroll, notice=notice)

    def place_of(self, name: str) -> pygame.Rect | None:
        """Where something was drawn, by its name; scenes also by theirs alone."""
        if self._places is None:
            return None
        shown = self._places.shown(name, self.scroll)
        return self._places.shown(SCENE + name, self.scroll) if shown is None else shown

    def go(self, name: str) -> None:
        """Put the choice on anything."""
        self.chosen = name
        self._note_scene(name)
        self._follow = True

    def _note_scene(self, name: str) -> None:
        if name.startswith(SCENE):
            self._scene = name.removeprefix(SCENE)

    def _at(self, place: tuple[int, int]) -> str:
        return "" if self._places is None else self._places.at(place, self.scroll)

    def _tour_here(self) -> bool:
        scene = self.chosen.removeprefix(SCENE)
        return self.chosen.startswith(SCENE) and scene in tours.scenes()

    @staticmethod
    def taken(name: str) -> Choice:
        """What the name of something pressed means."""
        kind, _, rest = name.partition("/")
        match kind + "/":
            case menu_layout.SCENE:
                return Choice(scene=rest)
            case menu_layout.FILE:
                return Choice(file=Path(rest))
            case menu_layout.TOUR:
                return Choice(tour=rest)
            case menu_layout.LESSON:
                return Choice(lesson=rest)
            case menu_layout.PACKING:
                return Choice(packing=rest)
        whats = (START, TAKE_UP, DISCARD, EXPLORE, LANGUAGE, THEME, KEYS)
        return Choice(what=name if name in whats else "")


def lesson_card(name: str, lesson: Lesson | None) -> Card:
    """A lesson in the menu, by its name or its path; None: what the file says is no lesson."""
    stem = Path(name).stem
    if lesson is None:
        return Card(LESSON + name, stem, words.LESSON_BROKEN.format(name=Path(name).name), "")
    length = words.LESSON_LENGTH.format(minutes=lesson.minutes, steps=len(lesson.steps))
    if not lesson.minutes:
        length = words.LESSON_STEPS.format(steps=len(lesson.steps))
    return Card(LESSON + name, str(lesson.title) or stem, str(lesson.about), length, lesson.scene)

"""What the parts of the window share, and what any of them may ask for."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import pygame

from core.errors import InputError, reason_of
from sandbox.draw.render import Renderer
from sandbox.files import preferences
from sandbox.files.autosave import Leftover
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Command
from sandbox.window.display import Looks, open_display
from sandbox.window.film import Recorder
from sandbox.window.focus import Focus
from sandbox.window.hand import Mouse
from sandbox.window.motion import little_motion_wished
from sandbox.window.notices import Notices
from sandbox.window.parts import Part
from sandbox.window.picture import Picture
from sandbox.window.solvers.panes import Panes
from sandbox.window.solvers.wanted import Wanted
from sandbox.window.sound import Sound
from sandbox.window.tone import Tone
from sandbox.words import words
from scenes.text import message


class Stage:
    """The panes and their picture, mouse and keyboard, notices, film and sound, and which page lies over them."""

    def __init__(
        self, panes: Panes, handle: Callable[[pygame.event.Event], None], looks: Looks
    ) -> None:
        """``handle`` takes an event, such as that of a key that is held and counts again."""
        self.panes = panes
        self.running = True
        self.show_menu = False
        self.show_help = False
        self.show_explore = False
        self.splash = True  # is that what the window shows, whatever page is open?
        self.over = pygame.Rect(0, 0, 0, 0)  # what a panel covers that lies over the canvas
        self.dirty = True  # is there something new to draw?
        self.parts: list[Part] = []  # while a scene runs they see events first, in this order
        self.mouse = Mouse()
        self.notices = Notices()
        self.screen, scale = open_display(looks)
        self.renderer = Renderer(self.screen.get_size(), scale, looks.theme, looks.view)
        self.picture = Picture(panes, self.renderer)
        self.recorder = Recorder()
        self.sound = Sound()
        self.tone = Tone()
        self.preferences = preferences.read()
        self.picture.still = self.still
        if self.preferences.tone and not self.tone.switch():
            self.toast(words.NO_SOUND)
        self.focus = Focus(handle)
        self.focus.busy = lambda: any(frame.busy for frame, _, _ in self.picture.panes())
        self._forget: list[Callable[[], None]] = []
        self._arranged = (False, 0)  # is there to be a panel, and how wide a card in its stead [px]
        self.arrange(panel=True)

    def at_new_scene(self, forget: Callable[[], None]) -> None:
        """Call ``forget`` whenever something else begins to run."""
        self._forget.append(forget)

    def start(
        self,
        scene: str,
        settings: Mapping[str, object] | None = None,
        packings: Sequence[str] = (),
        seed: int | None = None,
    ) -> None:
        """Run a scene, with these packings side by side if any are named; without a seed with that of the scene before.

        Raises InputError for what does not exist.
        """
        self.panes.start(scene, settings, packings, seed)
        self._begin()

    def start_beside(self, runs: Sequence[Wanted]) -> None:
        """Run these of one scene side by side. Raises InputError for what does not exist."""
        self.panes.start_beside(runs)
        self._begin()

    def open(self, file: str | os.PathLike[str] | SceneFile) -> None:
        """Go on where a scene file was written. Raises InputError for one that cannot be read."""
        self.panes.open(file)
        self._begin()

    def take_up(self, leftover: Leftover) -> None:
        """Go on where a program that is gone had to stop. Raises InputError if that cannot be."""
        self.panes.take_up(leftover)
        self._begin()

    def _begin(self) -> None:
        """Something else runs now."""
        self.picture.forget()
        self.mouse = Mouse()
        self.focus.leave()
        self.renderer.forget()
        for forget in self._forget:
            forget()
        self.show_menu = self.show_help = self.show_explore = False
        self.dirty = True

    def send(self, command: Command) -> None:
        """A command to the solvers."""
        try:
            self.panes.send(command)
        except InputError as error:
            self.toast(words.say(message(error)))
        self.dirty = True

    def arrange(self, *, panel: bool | None = None, card: int | None = None) -> None:
        """Divide the window anew if that has changed: is there to be a panel, and how wide a card where there is none [px]?"""
        wanted = (
            self._arranged[0] if panel is None else panel,
            self._arranged[1] if card is None else card,
        )
        if wanted != self._arranged:
            self._arranged = wanted
            self.renderer.arrange(panel=wanted[0], timeline=True, card=wanted[1])
            self.dirty = True

    def redraw(self, changed: bool) -> None:
        """Draw the next picture if something has changed."""
        self.dirty |= changed

    def has_begun(self) -> None:
        """A person has found out how to begin."""
        self.notices.hints = False

    def toast(self, text: str) -> None:
        """A notice of the window's own, for a moment."""
        self.notices.say(text)
        self.dirty = True

    @property
    def still(self) -> bool:
        """Is nothing to move by itself but the grains? As chosen, else as the system has it."""
        chosen = self.preferences.still
        return little_motion_wished() if chosen is None else chosen

    def prefer(self, **chosen: bool) -> None:
        """Choose something for this window and all to come."""
        self.preferences = replace(self.preferences, **chosen)
        self.picture.still = self.still
        try:
            preferences.write(self.preferences)
        except OSError as error:
            reason = reason_of(error)
            self.toast(words.NOT_SAVED.format(name=preferences.path().name, reason=reason))
        self.dirty = True

    def forget_picture(self) -> None:
        """The scene is to be built anew: nothing is held, the scales begin afresh."""
        self.mouse.forget()
        self.renderer.forget()

    def parts_now(self) -> list[Part]:
        """The parts that are there now: none under a page."""
        pages = self.show_menu or self.show_help or self.show_explore
        hidden = pages or self.panes.snapshot.frame is None
        return [] if hidden else self.parts

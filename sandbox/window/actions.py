"""What keys and buttons ask for, carried out."""

from __future__ import annotations

from pathlib import Path

import pygame

from core.errors import InputError
from sandbox.draw.views import view_after
from sandbox.files.scene_file import SUFFIX
from sandbox.session.commands import Change, Protocol
from sandbox.window.display import SCALES, save_picture, switch_fullscreen
from sandbox.window.export import free_stem
from sandbox.window.keys import PACKING_ACTIONS, Action, packing_for
from sandbox.window.menu import Choice
from sandbox.window.pages import Pages
from sandbox.window.picture import progress_of
from sandbox.window.stage import Stage
from sandbox.words import language, words
from scenes.text import message

# What a key would do that a lesson may keep out of sight.
HIDES = {
    **dict.fromkeys((*PACKING_ACTIONS, Action.NEXT_PACKING), "packing"),
    Action.NEW_SEED: "seed",
    Action.NEXT_VIEW: "view",
    Action.CHAINS: "chains",
    Action.COMPARE: "compare",
    Action.PROTOCOL: "drive",
    Action.BRUSH: "brush",
    Action.MEASURE: "measure",
    Action.EXPLORE: "explore",
    Action.RECORD: "record",
    Action.RECORD_GIF: "record",
    Action.EXPORT: "export",
    Action.SAVE: "files",
}


# On a page, where there is nothing to look at more closely.
ON_PAGES = {
    Action.NEARER: Action.LARGER,
    Action.FARTHER: Action.SMALLER,
    Action.LOOK_LEFT: Action.LEFT,
    Action.LOOK_RIGHT: Action.RIGHT,
    Action.LOOK_UP: Action.UP,
    Action.LOOK_DOWN: Action.DOWN,
    Action.FINE_LEFT: Action.LEFT,
    Action.FINE_RIGHT: Action.RIGHT,
    Action.FINE_UP: Action.UP,
    Action.FINE_DOWN: Action.DOWN,
}


class Actions:
    """All that can be asked for, under a page or not."""

    def __init__(self, stage: Stage, pages: Pages) -> None:
        self.stage, self.pages = stage, pages

    def act(self, action: Action) -> None:
        """What a key or a button asks for."""
        if self.stage.show_menu or self.stage.show_help or self.stage.show_explore:
            action = ON_PAGES.get(action, action)
        pages = self.stage.show_menu or self.stage.show_help or self.stage.show_explore
        if HIDES.get(action) in self.pages.guide.hidden and not pages:
            self.stage.toast(words.HIDDEN_HERE)
        elif action is Action.SCREENSHOT:
            name = (
                f"-{self.stage.panes.scene}"
                if self.stage.panes.scene and not self.stage.show_menu
                else ""
            )
            self.stage.toast(save_picture(self.stage.renderer.surface, f"sandbox{name}"))
        elif action is Action.THEME:
            self.stage.renderer.set_theme(
                "light" if self.stage.renderer.theme.name == "dark" else "dark"
            )
        elif action is Action.FULLSCREEN:
            switch_fullscreen()
        elif action is Action.SOUND:
            self._switch_sound()
        elif action is Action.TONE:
            self._switch_tone()
        elif action in (Action.RECORD, Action.RECORD_GIF):
            suffix = ".mp4" if action is Action.RECORD else ".gif"
            scene = self.stage.panes.scene or "menu"
            self.stage.toast(self.stage.recorder.switch(scene, self.stage.renderer.size, suffix))
        elif action is Action.LANGUAGE:
            self.speak(language.after(language.present()))
        elif action in (Action.LARGER, Action.SMALLER):
            self._rescale(1 if action is Action.LARGER else -1)
        elif action is Action.HELP or (action is Action.BACK and self.stage.show_help):
            self.stage.show_help = not self.stage.show_help
            self.pages.help.scroll = 0
        elif action is Action.MENU and (self.stage.show_help or self.stage.show_explore):
            self.pages.open_menu()
        elif (
            self.stage.show_explore and not self.stage.show_help and self.pages.explore.act(action)
        ):
            pass
        elif action is Action.EXPLORE and not self.stage.show_help:
            self.pages.open_explore()
        elif self.stage.show_explore:
            pass  # what is under the page hears nothing
        elif self.stage.show_help and (
            self.pages.help.act(action, round(60 * self.stage.renderer.scale))
            or self.stage.show_menu
        ):
            pass  # the page is on top of the menu
        elif self.stage.show_menu:
            self._in_menu(action)
        elif action in (Action.MENU, Action.BACK):
            if action is Action.BACK and any(
                progress_of(seen) for seen in self.stage.panes.snapshots
            ):
                self._cancel()
            else:
                self.pages.open_menu()
        elif self.stage.panes.snapshot.phase == "failed":
            if action is Action.RESET:
                self.stage.panes.reset()
        else:
            self._on_run(action)

    def _in_menu(self, action: Action) -> None:
        if action is Action.BACK and self.stage.notices.latest and not self.stage.splash:
            self.stage.notices.forget()
        elif action is Action.BACK:
            self.stage.running = False
        elif action is Action.MENU:
            if self.stage.panes.exists:
                self.stage.show_menu = False
                self.stage.panes.go_on()
        elif (packing := self._packing(action)) is not None:
            self.pages.take(Choice(packing=packing))
        else:
            self._take(self.pages.menu.key(action))

    def choose(self, name: str) -> None:
        """Something in the menu, by its name."""
        self._take(self.pages.menu.taken(name))

    def _take(self, choice: Choice) -> None:
        if (asked := self.pages.take(choice)) is not None:
            self.act(asked)

    def _on_run(self, action: Action) -> None:
        frame = self.stage.panes.snapshot.frame
        if any(part.act(action) for part in self.stage.parts_now()):
            return
        if action is Action.PAUSE:
            self.stage.panes.pause_or_go_on()
        elif action is Action.SAVE:
            self.save()
        elif action is Action.STEP:
            self.stage.panes.step()
        elif action is Action.RESET:
            self.stage.mouse.forget()
            self.stage.panes.reset()
        elif action is Action.NEXT_VIEW:
            self.change_view(view_after(self.stage.renderer.view).name)
        elif action is Action.CHAINS:
            self._switch_chains()
        elif action is Action.PROTOCOL and frame is not None:
            self.stage.mouse.release(self.stage.send)
            self.stage.has_begun()
            self.stage.send(Protocol(not frame.protocol))
            self.stage.toast(words.DRIVE_OFF if frame.protocol else words.DRIVE_ON)
        elif action is Action.NEW_SEED:
            self.change_seed(None)
        elif action is Action.COMPARE:
            self.compare()
        elif (packing := self._packing(action)) is not None:
            self.change_packing(packing)

    def change_view(self, name: str) -> None:
        """Look at the grains another way."""
        self.stage.renderer.set_view(name)
        self.stage.toast(words.VIEW.format(view=self.stage.renderer.view.title))

    def change_seed(self, seed: int | None) -> None:
        """Pack by other chances; None: by the next seed."""
        self.stage.forget_picture()
        self.stage.send(Change("seed", self.stage.panes.seed + 1 if seed is None else seed))
        self.stage.toast(words.NEW_SEED.format(seed=self.stage.panes.seed))

    def change_packing(self, packing: str) -> None:
        """Pack other grains, if they are others."""
        if self.stage.panes.comparing:
            self.stage.toast(words.COMPARE_ALL)
        elif packing != self.stage.panes.packing:
            self.stage.forget_picture()
            self.stage.send(Change("packing", packing))
            self.stage.toast(words.NEW_PACKING.format(packing=words.PACKINGS.get(packing, packing)))

    def compare(self) -> None:
        """All packings of the scene side by side, or one alone again."""
        self.stage.mouse.release(self.stage.send)
        self.stage.toast(self.stage.panes.compare())
        self.stage.picture.forget()

    def _cancel(self) -> None:
        """Break off what is being built."""
        self.stage.mouse.forget()
        if not self.stage.panes.cancel():
            self.pages.open_menu()
        if not any(seen.ending for seen in self.stage.panes.snapshots):  # else the picture says so
            self.stage.toast(words.CANCELLED)

    def _switch_chains(self) -> None:
        if self.stage.renderer.view.only_chains:
            self.stage.toast(words.ONLY_CHAINS)
            return
        self.stage.renderer.chains = not self.stage.renderer.chains
        self.stage.toast(words.CHAINS_ON if self.stage.renderer.chains else words.CHAINS_OFF)

    def _packing(self, action: Action) -> str | None:
        return packing_for(action, self.pages.menu.packings, self.stage.panes.packing)

    def save(self, stem: str = "") -> None:
        """Write what there is down as a scene file in the current folder, under a name that is still free."""
        if not stem or Path(stem + SUFFIX).exists():
            stem = free_stem(stem or f"sandbox-{self.stage.panes.scene}", (SUFFIX,))
        name = stem + SUFFIX
        try:
            self.stage.panes.save(name)
        except InputError as error:
            self.stage.toast(words.say(message(error)))
        else:
            self.stage.toast(words.SAVED.format(name=name))

    def speak(self, code: str) -> None:
        """Another language from now on."""
        language.use(code)
        pygame.display.set_caption(words.SPLASH_TITLE)
        self.stage.toast(words.NEW_LANGUAGE.format(language=language.find("name")))

    def _switch_sound(self) -> None:
        if not self.stage.sound.switch():
            self.stage.toast(words.NO_SOUND)
        else:
            self.stage.toast(words.SOUND_ON if self.stage.sound.on else words.SOUND_OFF)

    def _switch_tone(self) -> None:
        tone = self.stage.tone
        if not tone.switch():
            self.stage.toast(words.NO_SOUND)
        else:
            self.stage.toast(words.TONE_ON if tone.on else words.TONE_OFF)
            self.stage.prefer(tone=tone.on)

    def _rescale(self, way: int) -> None:
        nearest = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - self.stage.renderer.scale))
        self.rescale(SCALES[min(max(nearest + way, 0), len(SCALES) - 1)])

    def rescale(self, scale: float) -> None:
        """Another size of everything but the grains."""
        self.stage.renderer.resize(self.stage.renderer.size, scale)
        self.stage.redraw(True)

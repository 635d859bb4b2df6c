"""What keys and buttons ask for, carried out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pygame

from core.errors import InputError
from sandbox.draw.views import view_after
from sandbox.session.commands import Change
from sandbox.window.display import save_picture
from sandbox.window.export import export, free_stem
from sandbox.window.keys import Action, packing_for
from sandbox.window.menu import Choice
from sandbox.window.picture import progress_of
from sandbox.words import language, words
from scenes.text import message

if TYPE_CHECKING:
    from sandbox.window.app import App

SCALES = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0)


class Actions:
    """All that can be asked for, under a page or not."""

    def __init__(self, app: App) -> None:
        self.app = app

    def act(self, action: Action) -> None:
        """What a key or a button asks for."""
        if action is Action.SCREENSHOT:
            name = f"-{self.app.run.scene}" if self.app.run.scene and not self.app.show_menu else ""
            self.app.toast(save_picture(self.app.renderer.surface, f"sandbox{name}"))
        elif action is Action.THEME:
            self.app.renderer.set_theme(
                "light" if self.app.renderer.theme.name == "dark" else "dark"
            )
        elif action is Action.SOUND:
            self._switch_sound()
        elif action in (Action.RECORD, Action.RECORD_GIF):
            suffix = ".mp4" if action is Action.RECORD else ".gif"
            scene = self.app.run.scene or "menu"
            self.app.toast(self.app.recorder.switch(scene, self.app.renderer.size, suffix))
        elif action is Action.LANGUAGE:
            self.speak(language.after(language.present()))
        elif action in (Action.LARGER, Action.SMALLER):
            self._rescale(1 if action is Action.LARGER else -1)
        elif action is Action.HELP or (action is Action.BACK and self.app.show_help):
            self.app.show_help = not self.app.show_help
            self.app.help.scroll = 0
        elif self.app.show_help and (
            self.app.help.act(action, round(60 * self.app.renderer.scale)) or self.app.show_menu
        ):
            pass  # the page is on top of the menu
        elif self.app.show_menu:
            self._in_menu(action)
        elif action in (Action.MENU, Action.BACK):
            if action is Action.BACK and any(progress_of(seen) for seen in self.app.run.snapshots):
                self._cancel()
            else:
                self.app.open_menu()
        elif self.app.run.snapshot.phase == "failed":
            if action is Action.RESET:
                self.app.run.reset()
        else:
            self._on_run(action)

    def _in_menu(self, action: Action) -> None:
        if action is Action.BACK:
            self.app.running = False
        elif action is Action.MENU:
            if self.app.run.exists:
                self.app.show_menu = False
                self.app.run.go_on()
        elif (packing := self._packing(action)) is not None:
            self.app.beginnings.take(Choice(packing=packing))
        else:
            self.app.beginnings.take(self.app.menu.key(action))

    def _on_run(self, action: Action) -> None:
        frame = self.app.run.snapshot.frame
        if any(part.act(action) for part in self.app.parts_now()):
            return
        if action is Action.PAUSE:
            self.app.run.pause_or_go_on()
        elif action is Action.SAVE:
            self.save()
        elif action is Action.STEP:
            self.app.run.step()
        elif action is Action.RESET:
            self.app.mouse.forget()
            self.app.run.reset()
        elif action is Action.NEXT_VIEW:
            self.change_view(view_after(self.app.renderer.view).name)
        elif action is Action.CHAINS:
            self._switch_chains()
        elif action is Action.PROTOCOL and frame is not None:
            self.app.mouse.release(self.app.send)
            self.app.has_begun()
            self.app.run.drive(not frame.protocol)
            self.app.toast(words.DRIVE_OFF if frame.protocol else words.DRIVE_ON)
        elif action is Action.NEW_SEED:
            self.change_seed(None)
        elif action is Action.COMPARE:
            self.compare()
        elif action is Action.EXPORT and frame is not None:
            frames = [pane[0] for pane in self.app.panes()]
            self.app.toast(export(frames, self.app.run.curves.shown(frame)))
        elif (packing := self._packing(action)) is not None:
            self.change_packing(packing)

    def change_view(self, name: str) -> None:
        """Look at the grains another way."""
        self.app.renderer.set_view(name)
        self.app.toast(words.VIEW.format(view=self.app.renderer.view.title))

    def change_seed(self, seed: int | None) -> None:
        """Pack by other chances; None: by the next seed."""
        self.app.forget_picture()
        if seed is None:
            self.app.run.change_seed()
        else:
            self.app.send(Change("seed", seed))
        self.app.toast(words.NEW_SEED.format(seed=self.app.run.seed))

    def change_packing(self, packing: str) -> None:
        """Pack other grains, if they are others."""
        if self.app.run.comparing:
            self.app.toast(words.COMPARE_ALL)
        elif packing != self.app.run.packing:
            self.app.forget_picture()
            self.app.run.change_packing(packing)
            self.app.toast(words.NEW_PACKING.format(packing=words.PACKINGS.get(packing, packing)))

    def compare(self) -> None:
        """All packings of the scene side by side, or one alone again."""
        self.app.mouse.release(self.app.send)
        self.app.toast(self.app.run.compare())
        self.app.picture.forget()

    def _cancel(self) -> None:
        """Break off what is being built."""
        self.app.mouse.forget()
        if not self.app.run.cancel():
            self.app.open_menu()
        self.app.toast(words.CANCELLED)

    def _switch_chains(self) -> None:
        if self.app.renderer.view.only_chains:
            self.app.toast(words.ONLY_CHAINS)
            return
        self.app.renderer.chains = not self.app.renderer.chains
        self.app.toast(words.CHAINS_ON if self.app.renderer.chains else words.CHAINS_OFF)

    def _packing(self, action: Action) -> str | None:
        return packing_for(action, self.app.menu.packings, self.app.run.packing)

    def save(self, stem: str = "") -> None:
        """Write what there is down as a scene file in the current folder, under a name that is still free."""
        endings = (".toml", ".npz")
        if not stem or any(Path(stem + ending).exists() for ending in endings):
            stem = free_stem(stem or f"sandbox-{self.app.run.scene}", endings)
        name = stem + ".toml"
        try:
            self.app.run.save(name)
        except InputError as error:
            self.app.toast(words.say(message(error)))
        else:
            self.app.toast(words.SAVED.format(name=name))

    def speak(self, code: str) -> None:
        """Another language from now on."""
        language.use(code)
        pygame.display.set_caption(words.SPLASH_TITLE)
        self.app.toast(words.NEW_LANGUAGE.format(language=language.find("name")))

    def _switch_sound(self) -> None:
        if not self.app.sound.switch():
            self.app.toast(words.NO_SOUND)
        else:
            self.app.toast(words.SOUND_ON if self.app.sound.on else words.SOUND_OFF)

    def _rescale(self, way: int) -> None:
        nearest = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - self.app.renderer.scale))
        self.rescale(SCALES[min(max(nearest + way, 0), len(SCALES) - 1)])

    def rescale(self, scale: float) -> None:
        """Another size of everything but the grains."""
        self.app.renderer.resize(self.app.renderer.size, scale)
        self.app.redraw(True)

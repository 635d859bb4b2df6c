"""The window: shows what the solver's thread publishes, and turns keys and mouse into commands."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import pygame

from core.errors import InputError
from sandbox import autosave, language
from sandbox.autosave import Leftover
from sandbox.commands import Change, Command
from sandbox.draw import words
from sandbox.draw.cards import draw_error
from sandbox.draw.render import Renderer
from sandbox.draw.splash import draw_splash
from sandbox.draw.views import view_after
from sandbox.draw.warmup import Warmup
from sandbox.scene_file import SceneFile
from sandbox.views.solver_thread import Snapshot
from sandbox.views.window_arrows import Arrows
from sandbox.views.window_begin import Beginnings
from sandbox.views.window_brush import Brush
from sandbox.views.window_curves import CurvesSection
from sandbox.views.window_display import FRAMES, Rate, natural_scale, open_display, save_picture
from sandbox.views.window_export import export, free_stem
from sandbox.views.window_files import FilesSection
from sandbox.views.window_focus import Focus
from sandbox.views.window_general import GeneralSection
from sandbox.views.window_hand import REACH, Mouse
from sandbox.views.window_help import HelpPage
from sandbox.views.window_inspect import Inspector
from sandbox.views.window_keys import Action, action_of, packing_for
from sandbox.views.window_looks import LooksSection
from sandbox.views.window_menu import Choice, Menu
from sandbox.views.window_panel import Panel
from sandbox.views.window_parts import Part
from sandbox.views.window_picture import Pane, Picture, progress_of
from sandbox.views.window_record import Recorder
from sandbox.views.window_run import Run
from sandbox.views.window_settings import ParameterSection, Settings
from sandbox.views.window_sound import Sound
from sandbox.views.window_timeline import Timeline
from sandbox.views.window_tour import Guide
from scenes.text import message

REST = 0.25  # with nothing new the picture is drawn this seldom [s]
TOAST = 2.5  # how long the window's own notices stay [s]
PATIENCE = 2.0  # with a thread that is to end [s]
SWITCH = 0.001  # the solver's thread hands over this soon when a picture is due [s]
SCALES = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0)


def run(
    scene: str | SceneFile | None,
    packing: str = "mixed",
    seed: int = 1,
    settings: Mapping[str, object] | None = None,
    *,
    log: str | os.PathLike[str] | None = None,
    size: tuple[int, int] = (1280, 720),
    scale: float | None = None,
    theme: str = "dark",
    view: str = "kind",
    packings: Sequence[str] = (),
) -> int:
    """Open the window and stay until it is closed. Without a scene, or a file of one, it starts with the menu.

    ``packings``: side by side, if any are named. ``scale`` None: by the screen's size. ``log``: where the log of the last
    scene started is written at the end. Raises InputError without a display and for what does not exist.
    """
    sys.setswitchinterval(SWITCH)
    own = Run(packing, seed, autosave=autosave.begin())
    app = App(own, size=size, scale=scale, theme=theme, view=view)
    clean = False
    try:
        if scene is None:
            app.open_menu()
        elif isinstance(scene, SceneFile):
            app.open(scene)
        else:
            app.start(scene, settings, packings)
        while app.running:
            app.tick()
        clean = True
    except KeyboardInterrupt:
        clean = True
    finally:
        ended = app.close(log, clean)
    if app.farewell:
        sys.stdout.write(f"{app.farewell}\n")
    if not ended:
        # A thread is still compiling. That cannot be broken off, and when the interpreter ends
        # under it, LLVM aborts: leave at once. Nothing was built, so there is nothing to save.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(0)
    return 0


class App:
    """The window and its state; ``tick`` is one picture."""

    def __init__(
        self,
        run: Run,
        *,
        size: tuple[int, int] = (1280, 720),
        scale: float | None = None,
        theme: str = "dark",
        view: str = "kind",
    ) -> None:
        self.run = run
        self.running = True
        self.show_menu = False
        self.show_help = False
        self.help = HelpPage()
        self.mouse = Mouse()
        self.screen = open_display(size)
        self.renderer = Renderer(self.screen.get_size(), scale or natural_scale(), theme, view)
        self.picture = Picture(run, self.renderer)
        self.recorder = Recorder()
        self.sound = Sound()
        self.menu = Menu()
        self.beginnings = Beginnings(self)
        self.guide = Guide(self)
        self.focus = Focus(self.handle)
        self.focus.busy = lambda: any(frame.busy for frame, _, _ in self.panes())
        self.settings = Settings(self)
        self.timeline = Timeline(self)
        self.inspector = Inspector(self)
        self.brush = Brush(self)
        self.arrows = Arrows(self)
        own = [ParameterSection(name, self.settings) for name in ("grains", "geometry", "solver")]
        self.panel = Panel(self, folded={"solver", "files", "looks"})
        self.panel.sections += [
            GeneralSection(self),
            self.timeline,
            self.inspector,
            self.brush,
            *own,
        ]
        self.panel.sections += [CurvesSection(self), FilesSection(self), LooksSection(self)]
        self.focus.groups = [
            self.arrows.stops,
            self.guide.stops,
            self.panel.stops,
            self.timeline.stops,
        ]
        # While a scene runs they see events first, in this order.
        self.parts: list[Part] = [
            self.panel,
            self.timeline,
            self.settings,
            self.brush,
            self.inspector,
            self.arrows,
            self.guide,
            self.focus,
        ]
        self.arrange()
        self._toasts: list[tuple[float, str]] = []
        self.farewell = ""  # what is left to say when the window is closed
        self._hinted = False  # has a person found out how to begin?
        self._dirty = True  # is there something new to draw?
        self._splash = True  # is that what the window shows?
        self._drawn = 0.0
        self._serials: tuple[int, ...] = ()
        self._held_in = 0  # the pane in which the mouse holds something
        self._cursor: int | None = None
        self._rate = Rate()
        self._clock = pygame.time.Clock()
        self._begun = time.perf_counter()
        self._warmup = Warmup()
        self._warmup.start()

    def start(
        self,
        scene: str,
        settings: Mapping[str, object] | None = None,
        packings: Sequence[str] = (),
    ) -> None:
        """Run a scene, with these packings side by side if any are named. Raises InputError for what does not exist."""
        self.run.start(scene, settings, packings)
        self._begin()

    def open(self, file: str | os.PathLike[str] | SceneFile) -> None:
        """Go on where a scene file was written. Raises InputError for one that cannot be read."""
        self.run.open(file)
        self._begin()

    def take_up(self, leftover: Leftover) -> None:
        """Go on where a program that is gone had to stop. Raises InputError if that cannot be."""
        self.run.take_up(leftover)
        self._begin()

    def _begin(self) -> None:
        """Something else runs now."""
        self.picture.forget()
        self.mouse = Mouse()
        self.focus.leave()
        self.brush.on = False
        self.renderer.forget()
        self.menu.choose(self.run.scene)
        self.show_menu = self.show_help = False
        self._dirty = True

    def save(self, stem: str = "") -> None:
        """Write what there is down as a scene file in the current folder, under a name that is still free."""
        endings = (".toml", ".npz")
        if not stem or any(Path(stem + ending).exists() for ending in endings):
            stem = free_stem(stem or f"sandbox-{self.run.scene}", endings)
        name = stem + ".toml"
        try:
            self.run.save(name)
        except InputError as error:
            self.toast(words.say(message(error)))
        else:
            self.toast(words.SAVED.format(name=name))

    def close(self, log: str | os.PathLike[str] | None = None, clean: bool = True) -> bool:
        """Close the window, end the threads, write the log; False if one is still compiling.

        A ``clean`` end needs no autosave.
        """
        self.running = False
        self.mouse.release(self.send)
        self.sound.close()
        self.farewell = self.recorder.close()
        pygame.display.quit()
        ended = self.run.close(log, clean)
        return self._warmup.join(PATIENCE) and ended

    def send(self, command: Command) -> None:
        """A command to the solvers."""
        try:
            self.run.send(command)
        except InputError as error:
            self.toast(words.say(message(error)))
        self._dirty = True

    def arrange(self) -> None:
        """Divide the window anew: the panel may have been folded."""
        self.renderer.arrange(panel=not self.panel.drawer.folded, timeline=True)
        self._dirty = True

    def panes(self) -> tuple[Pane, ...]:
        """What is drawn where, from the left."""
        return self.picture.panes()

    def redraw(self, changed: bool) -> None:
        """Draw the next picture if something has changed."""
        self._dirty |= changed

    def has_begun(self) -> None:
        """A person has found out how to begin."""
        self._hinted = True

    # -- one picture --

    def tick(self) -> None:
        """Handle what has happened, draw if there is something new, wait for the next picture."""
        for event in pygame.event.get():
            self.handle(event)
        if not self.running:
            return
        self.mouse.send_move(self.send)
        now = time.perf_counter()
        self.run.tick()
        snapshot = self.run.snapshot
        serials = self.picture.serials
        if serials != self._serials:
            self._serials = serials
            self._dirty = True
        if self._toasts and self._toasts[0][0] < now:
            self._toasts = [toast for toast in self._toasts if toast[0] >= now]
            self._dirty = True
        for part in self._parts():
            self._dirty |= part.tick(now)
        if said := self.recorder.tick(self.renderer.surface, now):
            self.toast(said)
        self._dirty |= self.recorder.second_passed(now)
        moving = self._splash or self.picture.moving or self.mouse.holding
        if self._dirty or moving or now - self._drawn >= REST:
            self._draw(snapshot, now)
        self._show_cursor()
        self._clock.tick(FRAMES)

    def _draw(self, snapshot: Snapshot, now: float) -> None:
        self._dirty = False
        self._drawn = now
        self._rate.renew(now, self._clock.get_fps())
        begun = time.perf_counter()
        preparing = snapshot.phase == "building" and snapshot.frame is None
        self._splash = not self._warmup.ready or (preparing and not self.show_menu)
        if self._splash:
            draw_splash(
                self.renderer.surface,
                self.renderer.theme,
                self.renderer.type,
                text=_sentence(words.say(snapshot.text) or words.SPLASH_STEP),
                fraction=snapshot.fraction,
                seconds=now - self._begun,
            )
        elif self.show_menu:
            notice = self._toasts[-1][1] if self._toasts else ""
            self.menu.draw(self.renderer.painter(), self.run.packing, notice)
            if self.show_help:
                self.help.draw(self.renderer.painter())
        else:
            self._draw_run(snapshot, now)
        self.screen.blit(self.renderer.surface, (0, 0))
        self._draw_indicator()
        pygame.display.flip()
        self._rate.drew(time.perf_counter() - begun)

    def _draw_run(self, snapshot: Snapshot, now: float) -> None:
        if snapshot.frame is None:
            self.renderer.clear()
        else:
            self.picture.draw(
                hand=self.mouse.hand, rate=self._rate.text, notices=self._notices(snapshot), now=now
            )
            self.sound.play(self.picture.events)
        painter = self.renderer.painter()
        for part in self._parts():
            part.draw(painter)
        painter.flush()
        if snapshot.phase == "failed":
            draw_error(self.renderer.painter(), words.say(snapshot.error))
        if self.show_help:
            self.help.draw(self.renderer.painter())

    def _draw_indicator(self) -> None:
        """On the screen only, so that it is not in the film."""
        last, inset = self.renderer.bodies[-1], round(10 * self.renderer.scale)
        corner = last.right - inset, last.top + inset
        self.recorder.draw(self.screen, corner, self.renderer.theme, self.renderer.type)

    def _notices(self, snapshot: Snapshot) -> tuple[str, ...]:
        notices = [text for _, text in self._toasts]
        progress = "" if self.run.comparing else progress_of(snapshot)
        if progress:
            notices.append(progress)
        elif not self._hinted and not notices:
            notices.append(words.HINT)
        return tuple(notices)

    def _show_cursor(self) -> None:
        wanted = pygame.SYSTEM_CURSOR_ARROW
        if self.show_menu and not self.show_help:
            wanted = self.menu.cursor()
        elif not self.show_help:
            own = (part.cursor() for part in self._parts())
            wanted = next((cursor for cursor in own if cursor is not None), self.mouse.cursor())
        if wanted != self._cursor:
            self._cursor = wanted
            with contextlib.suppress(pygame.error):  # not every screen has these cursors
                pygame.mouse.set_cursor(wanted)

    def _parts(self) -> list[Part]:
        """The parts that are there now: none under a page."""
        hidden = self.show_menu or self.show_help or self.run.snapshot.frame is None
        return [] if hidden else self.parts

    # -- what a person does --

    def handle(self, event: pygame.event.Event) -> None:
        """One event."""
        self.focus.watch(event)
        if event.type == pygame.QUIT:
            self.running = False
        elif event.type in (pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED):
            self.screen = pygame.display.get_surface() or self.screen
            self.renderer.resize(self.screen.get_size())
        elif any(part.handle(event) for part in self._parts()) or (
            self.show_menu and not self.show_help and self.menu.handle(event)
        ):
            pass
        elif event.type == pygame.KEYDOWN:
            action = action_of(event)
            if action is not None:
                self.act(action)
        elif event.type in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            if self.show_help:
                self.show_help = event.type != pygame.MOUSEBUTTONDOWN
            elif self.show_menu:
                self._mouse_in_menu(event)
            else:
                self._mouse_on_canvas(event)
        elif event.type == pygame.MOUSEWHEEL and (self.show_menu or self.show_help):
            page = self.help if self.show_help else self.menu
            page.wheel(event.precise_y, round(60 * self.renderer.scale))
        elif event.type == pygame.WINDOWFOCUSLOST:
            self.mouse.release(self.send)
        elif event.type not in (pygame.WINDOWEXPOSED, pygame.WINDOWFOCUSGAINED):
            return
        self._dirty = True

    def _mouse_in_menu(self, event: pygame.event.Event) -> None:
        if event.type == pygame.MOUSEMOTION:
            self.menu.hover(event.pos)
        elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.beginnings.take(self.menu.click(event.pos))

    def _mouse_on_canvas(self, event: pygame.event.Event) -> None:
        panes, reach = self.panes(), REACH * self.renderer.scale
        if not panes or self.run.snapshot.phase == "failed":
            self.mouse.forget()
            return
        there = self.picture.pane_at(event.pos)
        index = self._held_in if self.mouse.holding or there is None else there
        frame, camera, canvas = panes[min(index, len(panes) - 1)]
        if event.type == pygame.MOUSEMOTION:
            self.mouse.move(event.pos, camera, canvas)
            if not self.mouse.holding:
                self.mouse.look(event.pos, frame, camera, reach)
        elif event.button != 1:
            return
        elif event.type == pygame.MOUSEBUTTONUP:
            self.mouse.move(event.pos, camera, canvas)
            self.mouse.release(self.send)
            self.mouse.look(event.pos, frame, camera, reach)
        elif there is not None and self.mouse.press(event.pos, frame, camera, reach, self.send):
            self._held_in = there
            self._hinted = True

    def act(self, action: Action) -> None:
        """What a key or a button asks for."""
        if action is Action.SCREENSHOT:
            name = f"-{self.run.scene}" if self.run.scene and not self.show_menu else ""
            self.toast(save_picture(self.renderer.surface, f"sandbox{name}"))
        elif action is Action.THEME:
            self.renderer.set_theme("light" if self.renderer.theme.name == "dark" else "dark")
        elif action is Action.SOUND:
            self._switch_sound()
        elif action in (Action.RECORD, Action.RECORD_GIF):
            suffix = ".mp4" if action is Action.RECORD else ".gif"
            scene = self.run.scene or "menu"
            self.toast(self.recorder.switch(scene, self.renderer.size, suffix))
        elif action is Action.LANGUAGE:
            self.speak(language.after(language.present()))
        elif action in (Action.LARGER, Action.SMALLER):
            self._rescale(1 if action is Action.LARGER else -1)
        elif action is Action.HELP or (action is Action.BACK and self.show_help):
            self.show_help = not self.show_help
            self.help.scroll = 0
        elif self.show_help and (
            self.help.act(action, round(60 * self.renderer.scale)) or self.show_menu
        ):
            pass  # the page is on top of the menu
        elif self.show_menu:
            self._act_in_menu(action)
        elif action in (Action.MENU, Action.BACK):
            if action is Action.BACK and any(progress_of(seen) for seen in self.run.snapshots):
                self._cancel()
            else:
                self.open_menu()
        elif self.run.snapshot.phase == "failed":
            if action is Action.RESET:
                self.run.reset()
        else:
            self._act_on_run(action)

    def _act_in_menu(self, action: Action) -> None:
        if action is Action.BACK:
            self.running = False
        elif action is Action.MENU:
            if self.run.exists:
                self.show_menu = False
                self.run.go_on()
        elif (packing := self._packing(action)) is not None:
            self.beginnings.take(Choice(packing=packing))
        else:
            self.beginnings.take(self.menu.key(action))

    def _act_on_run(self, action: Action) -> None:
        frame = self.run.snapshot.frame
        if any(part.act(action) for part in self._parts()):
            return
        if action is Action.PAUSE:
            self.run.pause_or_go_on()
        elif action is Action.SAVE:
            self.save()
        elif action is Action.STEP:
            self.run.step()
        elif action is Action.RESET:
            self.mouse.forget()
            self.run.reset()
        elif action is Action.NEXT_VIEW:
            self.change_view(view_after(self.renderer.view).name)
        elif action is Action.CHAINS:
            self._switch_chains()
        elif action is Action.PROTOCOL and frame is not None:
            self.mouse.release(self.send)
            self._hinted = True
            self.run.drive(not frame.protocol)
            self.toast(words.DRIVE_OFF if frame.protocol else words.DRIVE_ON)
        elif action is Action.NEW_SEED:
            self.change_seed(None)
        elif action is Action.COMPARE:
            self.compare()
        elif action is Action.EXPORT and frame is not None:
            frames = [pane[0] for pane in self.panes()]
            self.toast(export(frames, self.run.curves.shown(frame)))
        elif (packing := self._packing(action)) is not None:
            self.change_packing(packing)

    def change_view(self, name: str) -> None:
        """Look at the grains another way."""
        self.renderer.set_view(name)
        self.toast(words.VIEW.format(view=self.renderer.view.title))

    def change_seed(self, seed: int | None) -> None:
        """Pack by other chances; None: by the next seed."""
        self.forget_picture()
        if seed is None:
            self.run.change_seed()
        else:
            self.send(Change("seed", seed))
        self.toast(words.NEW_SEED.format(seed=self.run.seed))

    def change_packing(self, packing: str) -> None:
        """Pack other grains, if they are others."""
        if self.run.comparing:
            self.toast(words.COMPARE_ALL)
        elif packing != self.run.packing:
            self.forget_picture()
            self.run.change_packing(packing)
            self.toast(words.NEW_PACKING.format(packing=words.PACKINGS.get(packing, packing)))

    def compare(self) -> None:
        """All packings of the scene side by side, or one alone again."""
        self.mouse.release(self.send)
        self.toast(self.run.compare())
        self.picture.forget()

    def _cancel(self) -> None:
        """Break off what is being built."""
        self.mouse.forget()
        if not self.run.cancel():
            self.open_menu()
        self.toast(words.CANCELLED)

    def _switch_chains(self) -> None:
        if self.renderer.view.only_chains:
            self.toast(words.ONLY_CHAINS)
            return
        self.renderer.chains = not self.renderer.chains
        self.toast(words.CHAINS_ON if self.renderer.chains else words.CHAINS_OFF)

    def _packing(self, action: Action) -> str | None:
        return packing_for(action, self.menu.packings, self.run.packing)

    # -- what that leads to --

    def toast(self, text: str) -> None:
        """A notice of the window's own, for a moment."""
        self._toasts = [(time.perf_counter() + TOAST, text)]
        self._dirty = True

    def open_menu(self) -> None:
        """Show the scenes; what runs is held meanwhile."""
        self.mouse.release(self.send)
        self.run.hold()
        self.show_menu, self.show_help = True, False
        self.beginnings.look_for_leftovers()
        self.menu.open(self.run.scene if self.run.exists else "")
        self._dirty = True

    def speak(self, code: str) -> None:
        """Another language from now on."""
        language.use(code)
        pygame.display.set_caption(words.SPLASH_TITLE)
        self.toast(words.NEW_LANGUAGE.format(language=language.find("name")))

    def _switch_sound(self) -> None:
        if not self.sound.switch():
            self.toast(words.NO_SOUND)
        else:
            self.toast(words.SOUND_ON if self.sound.on else words.SOUND_OFF)

    def forget_picture(self) -> None:
        """The scene is to be built anew: nothing is held, the scales begin afresh."""
        self.mouse.forget()
        self.renderer.forget()

    def _rescale(self, way: int) -> None:
        nearest = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - self.renderer.scale))
        self.rescale(SCALES[min(max(nearest + way, 0), len(SCALES) - 1)])

    def rescale(self, scale: float) -> None:
        """Another size of everything but the grains."""
        self.renderer.resize(self.renderer.size, scale)
        self._dirty = True


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]

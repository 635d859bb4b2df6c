"""The window: shows what the solver's thread publishes, and turns keys and mouse into commands."""

from __future__ import annotations

import contextlib
import math
import os
import sys
import time
from collections.abc import Mapping

import pygame

from core.errors import InputError
from sandbox import language
from sandbox.commands import Change, Command
from sandbox.draw import words
from sandbox.draw.camera import Camera
from sandbox.draw.cards import MenuEntry, draw_error
from sandbox.draw.render import Renderer
from sandbox.draw.splash import draw_splash
from sandbox.draw.views import view_after
from sandbox.draw.warmup import Warmup
from sandbox.frame import Frame
from sandbox.views.solver_thread import Snapshot
from sandbox.views.window_arrows import Arrows
from sandbox.views.window_brush import Brush
from sandbox.views.window_display import FRAMES, Rate, natural_scale, open_display, save_picture
from sandbox.views.window_focus import Focus
from sandbox.views.window_general import GeneralSection
from sandbox.views.window_hand import REACH, Mouse
from sandbox.views.window_help import HelpPage
from sandbox.views.window_inspect import Inspector
from sandbox.views.window_keys import Action, action_of, packing_for
from sandbox.views.window_menu import Choice, Menu
from sandbox.views.window_panel import Panel
from sandbox.views.window_parts import Part
from sandbox.views.window_run import Run
from sandbox.views.window_settings import ParameterSection, Settings
from sandbox.views.window_timeline import Timeline
from scenes import registry
from scenes.text import message

REST = 0.25  # with nothing new the picture is drawn this seldom [s]
TOAST = 2.5  # how long the window's own notices stay [s]
PATIENCE = 2.0  # with a thread that is to end [s]
SWITCH = 0.001  # the solver's thread hands over this soon when a picture is due [s]
SCALES = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0)


def run(
    scene: str | None,
    packing: str = "mixed",
    seed: int = 1,
    settings: Mapping[str, object] | None = None,
    *,
    log: str | os.PathLike[str] | None = None,
    size: tuple[int, int] = (1280, 720),
    scale: float | None = None,
    theme: str = "dark",
    view: str = "kind",
) -> int:
    """Open the window and stay until it is closed. Without a scene it starts with the menu.

    ``scale`` None: by the screen's size. ``log``: where the log of the last scene started is
    written at the end. Raises InputError without a display and for what does not exist.
    """
    sys.setswitchinterval(SWITCH)
    app = App(Run(packing, seed), size=size, scale=scale, theme=theme, view=view)
    try:
        if scene is None:
            app.open_menu()
        else:
            app.start(scene, settings)
        while app.running:
            app.tick()
    except KeyboardInterrupt:
        pass
    finally:
        ended = app.close(log)
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
        scenes = [registry.get(name) for name in registry.names()]
        entries = [MenuEntry(s.name, s.title, s.question, s.about) for s in scenes]
        packings = dict.fromkeys(packing for s in scenes for packing in s.packings)
        self.menu = Menu(entries, tuple(packings))
        self.focus = Focus(self.handle)
        self.settings = Settings(self)
        self.timeline = Timeline(self)
        self.inspector = Inspector(self)
        self.brush = Brush(self)
        self.arrows = Arrows(self)
        own = [ParameterSection(name, self.settings) for name in ("grains", "geometry", "solver")]
        self.panel = Panel(self, folded={"solver"})
        self.panel.sections += [GeneralSection(self), self.inspector, self.brush, *own]
        self.focus.groups = [self.arrows.stops, self.panel.stops, self.timeline.stops]
        # While a scene runs they see events first, in this order.
        self.parts: list[Part] = [
            self.panel,
            self.timeline,
            self.settings,
            self.brush,
            self.inspector,
            self.arrows,
            self.focus,
        ]
        self.arrange()
        self._toasts: list[tuple[float, str]] = []
        self._hinted = False  # has a person found out how to begin?
        self._dirty = True  # is there something new to draw?
        self._splash = True  # is that what the window shows?
        self._drawn = 0.0
        self._serial = -1
        self._cursor: int | None = None
        self._rate = Rate()
        self._clock = pygame.time.Clock()
        self._begun = time.perf_counter()
        self._warmup = Warmup()
        self._warmup.start()

    def start(self, scene: str, settings: Mapping[str, object] | None = None) -> None:
        """Run a scene. Raises InputError for one that does not exist."""
        self.run.start(scene, settings)
        self.mouse = Mouse()
        self.focus.leave()
        self.brush.on = False
        self.renderer.forget()
        self.menu.choose(scene)
        self.show_menu = self.show_help = False
        self._dirty = True

    def close(self, log: str | os.PathLike[str] | None = None) -> bool:
        """Close the window, end the threads, write the log; False if one is still compiling."""
        self.running = False
        self.mouse.release(self.send)
        pygame.display.quit()
        ended = self.run.close(log)
        return self._warmup.join(PATIENCE) and ended

    def send(self, command: Command) -> None:
        """A command to the solver."""
        self.run.send(command)
        self._dirty = True

    def arrange(self) -> None:
        """Divide the window anew: the panel may have been folded."""
        self.renderer.arrange(panel=not self.panel.hidden, timeline=True)
        self._dirty = True

    def panes(self) -> tuple[tuple[Frame, Camera, pygame.Rect], ...]:
        """What is drawn where, from the left."""
        frame = self.run.snapshot.frame
        return (
            () if frame is None else ((frame, self.renderer.camera, self.renderer.layout.canvas),)
        )

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
        snapshot = self.run.snapshot
        if snapshot.serial != self._serial:
            self._serial = snapshot.serial
            self._dirty = True
        if self._toasts and self._toasts[0][0] < now:
            self._toasts = [toast for toast in self._toasts if toast[0] >= now]
            self._dirty = True
        for part in self._parts():
            self._dirty |= part.tick(now)
        moving = self._splash or snapshot.phase == "building" or self.mouse.holding
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
        else:
            self._draw_run(snapshot)
        self.screen.blit(self.renderer.surface, (0, 0))
        pygame.display.flip()
        self._rate.drew(time.perf_counter() - begun)

    def _draw_run(self, snapshot: Snapshot) -> None:
        if snapshot.frame is None:
            self.renderer.clear()
        else:
            self.renderer.draw(
                snapshot.frame,
                hand=self.mouse.hand,
                rate=self._rate.text,
                paused=self.run.paused,
                notices=self._notices(snapshot),
            )
        painter = self.renderer.painter()
        for part in self._parts():
            part.draw(painter)
        painter.flush()
        if snapshot.phase == "failed":
            draw_error(self.renderer.painter(), words.say(snapshot.error))
        if self.show_help:
            self.help.draw(self.renderer.painter())

    def _notices(self, snapshot: Snapshot) -> tuple[str, ...]:
        notices = [text for _, text in self._toasts]
        if snapshot.phase == "building":
            text = _sentence(words.say(snapshot.text) or words.SPLASH_STEP)
            if math.isfinite(snapshot.fraction):
                text = words.BUILDING.format(text=text, percent=100.0 * snapshot.fraction)
            notices.append(text)
        elif not self._hinted and not notices:
            notices.append(words.HINT)
        return tuple(notices)

    def _show_cursor(self) -> None:
        wanted = pygame.SYSTEM_CURSOR_ARROW
        if self.show_menu:
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
        elif any(part.handle(event) for part in self._parts()):
            pass
        elif event.type == pygame.KEYDOWN:
            action = action_of(event)
            if action is not None:
                self.act(action)
        elif event.type in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            if self.show_menu:
                self._mouse_in_menu(event)
            elif self.show_help:
                self.show_help = event.type != pygame.MOUSEBUTTONDOWN
            else:
                self._mouse_on_canvas(event)
        elif event.type == pygame.MOUSEWHEEL and (self.show_menu or self.show_help):
            page = self.menu if self.show_menu else self.help
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
            self._choose(self.menu.click(event.pos))

    def _mouse_on_canvas(self, event: pygame.event.Event) -> None:
        snapshot = self.run.snapshot
        frame, camera, canvas = snapshot.frame, self.renderer.camera, self.renderer.layout.canvas
        reach = REACH * self.renderer.scale
        if frame is None or snapshot.phase == "failed":
            self.mouse.forget()
        elif event.type == pygame.MOUSEMOTION:
            self.mouse.move(event.pos, camera, canvas)
            if not self.mouse.holding:
                self.mouse.look(event.pos, frame, camera, reach)
        elif event.button != 1:
            return
        elif event.type == pygame.MOUSEBUTTONUP:
            self.mouse.move(event.pos, camera, canvas)
            self.mouse.release(self.send)
            self.mouse.look(event.pos, frame, camera, reach)
        elif canvas.collidepoint(event.pos) and self.mouse.press(
            event.pos, frame, camera, reach, self.send
        ):
            self._hinted = True

    def act(self, action: Action) -> None:
        """What a key or a button asks for."""
        if action is Action.SCREENSHOT:
            name = f"-{self.run.scene}" if self.run.scene and not self.show_menu else ""
            self.toast(save_picture(self.renderer.surface, f"sandbox{name}"))
        elif action is Action.THEME:
            self.renderer.set_theme("light" if self.renderer.theme.name == "dark" else "dark")
        elif action is Action.LANGUAGE:
            self._speak(language.after(language.present()))
        elif action in (Action.LARGER, Action.SMALLER):
            self._rescale(1 if action is Action.LARGER else -1)
        elif self.show_menu:
            self._act_in_menu(action)
        elif action is Action.HELP or (action is Action.BACK and self.show_help):
            self.show_help = not self.show_help
            self.help.scroll = 0
        elif self.show_help and self.help.act(action, round(60 * self.renderer.scale)):
            pass
        elif action in (Action.MENU, Action.BACK):
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
            self._choose(Choice(packing=packing))
        else:
            self._choose(self.menu.key(action))

    def _act_on_run(self, action: Action) -> None:
        frame = self.run.snapshot.frame
        if any(part.act(action) for part in self._parts()):
            return
        if action is Action.PAUSE:
            self.run.pause_or_go_on()
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
        if packing != self.run.packing:
            self.forget_picture()
            self.run.change_packing(packing)
            self.toast(words.NEW_PACKING.format(packing=words.PACKINGS.get(packing, packing)))

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
        self._dirty = True

    def _choose(self, choice: Choice) -> None:
        if choice.packing is not None:
            self.run.packing = choice.packing
        if choice.scene is not None:
            try:
                self.start(choice.scene)
            except InputError as error:
                self.toast(words.say(message(error)))

    def _speak(self, code: str) -> None:
        language.use(code)
        pygame.display.set_caption(words.SPLASH_TITLE)
        self.toast(words.NEW_LANGUAGE.format(language=language.find("name")))

    def forget_picture(self) -> None:
        """The scene is to be built anew: nothing is held, the scales begin afresh."""
        self.mouse.forget()
        self.renderer.forget()

    def _rescale(self, way: int) -> None:
        nearest = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - self.renderer.scale))
        scale = SCALES[min(max(nearest + way, 0), len(SCALES) - 1)]
        self.renderer.resize(self.renderer.size, scale)


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]

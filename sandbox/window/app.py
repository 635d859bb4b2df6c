"""The window: shows what the solver's thread publishes, and turns keys and mouse into commands."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Mapping, Sequence

import pygame

from core.errors import InputError
from sandbox.draw.pages.cards import draw_error
from sandbox.draw.pages.splash import draw_splash
from sandbox.draw.render import Renderer
from sandbox.draw.warmup import Warmup
from sandbox.files import autosave
from sandbox.files.autosave import Leftover
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Command
from sandbox.window.actions import Actions
from sandbox.window.canvas.arrows import Arrows
from sandbox.window.canvas.brush import Brush
from sandbox.window.canvas.canvas import Canvas
from sandbox.window.canvas.inspector import Inspector
from sandbox.window.display import FRAMES, Rate, natural_scale, open_display
from sandbox.window.film import Recorder
from sandbox.window.focus import Focus
from sandbox.window.guide import Guide
from sandbox.window.hand import Mouse
from sandbox.window.help import HelpPage
from sandbox.window.keys import Action, action_of
from sandbox.window.menu import Menu
from sandbox.window.notices import Notices
from sandbox.window.pages import Beginnings
from sandbox.window.panel.curves import CurvesSection
from sandbox.window.panel.general import GeneralSection
from sandbox.window.panel.looks import LooksSection
from sandbox.window.panel.panel import Panel
from sandbox.window.panel.parameters import ParameterSection, Settings
from sandbox.window.panel.scene_files import FilesSection
from sandbox.window.parts import Part
from sandbox.window.picture import Pane, Picture, progress_of
from sandbox.window.solvers.panes import Run
from sandbox.window.solvers.solver_thread import Snapshot
from sandbox.window.sound import Sound
from sandbox.window.timeline import Timeline
from sandbox.words import words
from scenes.text import message

REST = 0.25  # with nothing new the picture is drawn this seldom [s]
PATIENCE = 2.0  # with a thread that is to end [s]
SWITCH = 0.001  # the solver's thread hands over this soon when a picture is due [s]


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
        self.notices = Notices()
        self.actions = Actions(self)
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
        self.canvas = Canvas(self)
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
            self.canvas,
        ]
        self.arrange()
        self.farewell = ""  # what is left to say when the window is closed
        self._dirty = True  # is there something new to draw?
        self._splash = True  # is that what the window shows?
        self._drawn = 0.0
        self._serials: tuple[int, ...] = ()
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
        self.notices.hints = False

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
        self._dirty |= self.notices.tick(now)
        for part in self.parts_now():
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
            self.menu.draw(self.renderer.painter(), self.run.packing, self.notices.latest)
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
            progress = "" if self.run.comparing else progress_of(snapshot)
            self.picture.draw(
                hand=self.mouse.hand,
                rate=self._rate.text,
                notices=self.notices.lines(progress),
                now=now,
            )
            self.sound.play(self.picture.events)
        painter = self.renderer.painter()
        for part in self.parts_now():
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

    def _show_cursor(self) -> None:
        wanted = pygame.SYSTEM_CURSOR_ARROW
        if self.show_menu and not self.show_help:
            wanted = self.menu.cursor()
        elif not self.show_help:
            own = (part.cursor() for part in self.parts_now())
            wanted = next((cursor for cursor in own if cursor is not None), wanted)
        if wanted != self._cursor:
            self._cursor = wanted
            with contextlib.suppress(pygame.error):  # not every screen has these cursors
                pygame.mouse.set_cursor(wanted)

    def parts_now(self) -> list[Part]:
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
        elif any(part.handle(event) for part in self.parts_now()) or (
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

    def act(self, action: Action) -> None:
        """What a key or a button asks for."""
        self.actions.act(action)

    def toast(self, text: str) -> None:
        """A notice of the window's own, for a moment."""
        self.notices.say(text)
        self._dirty = True

    def open_menu(self) -> None:
        """Show the scenes; what runs is held meanwhile."""
        self.mouse.release(self.send)
        self.run.hold()
        self.show_menu, self.show_help = True, False
        self.beginnings.look_for_leftovers()
        self.menu.open(self.run.scene if self.run.exists else "")
        self._dirty = True

    def forget_picture(self) -> None:
        """The scene is to be built anew: nothing is held, the scales begin afresh."""
        self.mouse.forget()
        self.renderer.forget()


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]

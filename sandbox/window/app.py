"""The window: shows what the solver's thread publishes, and turns keys and mouse into commands."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import pygame

from sandbox.draw.pages.cards import draw_error
from sandbox.draw.pages.splash import draw_splash
from sandbox.draw.warmup import Warmup
from sandbox.files import autosave
from sandbox.interrupts import requests_to_end
from sandbox.lessons.answers import Answers
from sandbox.lessons.lesson import Lesson
from sandbox.preparation.background import Background
from sandbox.session.beginning import SceneFile
from sandbox.session.commands import Protocol
from sandbox.window.access.reader import Reader
from sandbox.window.access.tree import Parts
from sandbox.window.actions import Actions
from sandbox.window.canvas.arrows import Arrows
from sandbox.window.canvas.brush import Brush
from sandbox.window.canvas.canvas import Canvas
from sandbox.window.canvas.inspector import Inspector
from sandbox.window.canvas.looking import Looking
from sandbox.window.display import FRAMES, USUAL, Looks, Rate
from sandbox.window.film import found_films
from sandbox.window.guide import Guide
from sandbox.window.keys import Action, action_of
from sandbox.window.measure.measuring import Measuring
from sandbox.window.pages import Pages
from sandbox.window.panel.curves import CurvesSection
from sandbox.window.panel.general import GeneralSection
from sandbox.window.panel.looks import LooksSection
from sandbox.window.panel.panel import Panel
from sandbox.window.panel.parameters import ParameterSection, Wishes
from sandbox.window.panel.scene_files import FilesSection
from sandbox.window.picture import progress_of
from sandbox.window.question import ExportQuestion
from sandbox.window.reel import Reel
from sandbox.window.solvers.panes import Panes
from sandbox.window.solvers.snapshot import Snapshot
from sandbox.window.stage import Stage
from sandbox.window.timeline import Timeline
from sandbox.words import words

REST = 0.25  # with nothing new the picture is drawn this seldom [s]
SWITCH = 0.001  # the solver's thread hands over this soon when a picture is due [s]


def run(
    scene: str | SceneFile | None,
    packing: str = "mixed",
    seed: int = 1,
    settings: Mapping[str, object] | None = None,
    *,
    log: str | os.PathLike[str] | None = None,
    packings: Sequence[str] = (),
    script: bool = False,
    lesson: Lesson | None = None,
    answers: Answers | None = None,
    looks: Looks = USUAL,
) -> int:
    """Open the window and stay until it is closed. Without a scene, a file of one or a lesson, it starts with the menu.

    ``packings``: side by side, if any are named. ``script``: the scene's own drive is on from the start. ``answers``: what is
    predicted in lessons is added to them. ``log``: where the first run is logged, all the time; further ones beside it. SIGTERM
    and SIGHUP close it too: the autosave stays then, and the code is 128 and the signal's number. Raises InputError without a
    display, for what does not exist and for a log that cannot be written.
    """
    sys.setswitchinterval(SWITCH)
    # Before there is a window: where nobody else listens, SDL makes of a request to end a click on the close button.
    with requests_to_end() as requests:
        panes = Panes(packing, seed, autosave=autosave.begin(), log=log)
        app = App(panes, looks, answers)
        if films := found_films(Path()):
            app.stage.toast(words.FILMS_FOUND.format(names=words.LIST_SIGN.join(films)))
        clean = False
        try:
            if lesson is not None:
                app.guide.begin(lesson)
            elif scene is None:
                app.pages.open_menu()
            elif isinstance(scene, SceneFile):
                app.stage.open(scene)
            else:
                app.stage.start(scene, settings, packings)
                if script:  # waits for the scene to be built
                    app.stage.send(Protocol(True))
            while app.stage.running and not requests:
                app.tick()
            clean = not requests  # who had to go finds the work where it was
        except KeyboardInterrupt:
            clean = True
        finally:
            ended = app.close(clean)
    with contextlib.suppress(OSError):  # a terminal that is closed
        if app.farewell:
            sys.stdout.write(f"{app.farewell}\n")
        sys.stdout.flush()
    code = 128 + requests[0] if requests else 0  # as shells count
    if not ended:
        # A thread is still compiling. That cannot be broken off, and when the interpreter ends
        # under it, LLVM aborts: leave at once. All that is finished is saved.
        os._exit(code)
    return code


class App:
    """The window, put together from its parts; ``tick`` is one picture."""

    def __init__(self, panes: Panes, looks: Looks, answers: Answers | None = None) -> None:
        stage = self.stage = Stage(panes, self.handle, looks)
        self.guide = Guide(stage, answers)
        self.pages = Pages(stage, self.guide)
        self.actions = Actions(stage, self.pages)
        wishes = Wishes(stage)
        self.timeline = Timeline(stage, self.actions)
        self.inspector = Inspector(stage)
        self.brush = Brush(stage)
        self.measuring = Measuring(stage, self.brush)
        reel = Reel(stage)
        self.question = ExportQuestion(stage, reel)
        arrows = Arrows(stage)
        self.panel = Panel(stage, self.guide, folded={"solver", "files", "looks"})
        self.panel.sections += [
            GeneralSection(stage, self.actions, self.brush, self.guide, self.measuring),
            self.timeline,
            self.inspector,
            self.brush,
            self.measuring,
            *(ParameterSection(name, wishes) for name in ("hand", "grains", "geometry", "solver")),
            CurvesSection(stage, self.actions),
            FilesSection(stage, self.actions),
            LooksSection(stage, self.actions),
        ]
        stage.focus.groups = [arrows.stops, self.guide.stops, self.panel.stops, self.timeline.stops]
        stage.parts = [
            self.question,
            self.panel,
            self.guide.asking,
            self.timeline,
            wishes,
            Looking(stage),
            self.measuring,
            self.brush,
            self.inspector,
            arrows,
            self.guide,
            stage.focus,
            reel,
            Canvas(stage),
        ]
        self.reader = Reader(
            Parts(
                stage,
                self.pages,
                self.actions,
                self.guide,
                self.panel,
                self.timeline,
                arrows,
                self.question,
            )
        )
        self.farewell = ""  # what is left to say when the window is closed
        self._splash = True  # is that what the window shows?
        self._drawn = 0.0
        self._serials: tuple[int, ...] = ()
        self._cursor: int | None = None
        self._rate = Rate()
        self._clock = pygame.time.Clock()
        self._begun = time.perf_counter()
        self._warmup = Warmup()
        self._warmup.start()
        self._background = Background()

    def close(self, clean: bool = True) -> bool:
        """Close the window, end the threads and the log; False if one is still compiling.

        A ``clean`` end needs no autosave. Raises InputError if the log cannot be written.
        """
        stage = self.stage
        stage.running = False
        stage.mouse.release(stage.send)
        stage.tone.close()
        stage.sound.close()
        self._background.close()
        self.pages.explore.explorer.stop()
        said = [stage.recorder.close()]
        pygame.display.quit()
        try:
            ended = stage.panes.close(clean)
        finally:
            warm = self._warmup.join(0.0)
            if len(logs := stage.panes.logs) > 1:
                said.append(words.LOGS_WRITTEN.format(names=words.LIST_SIGN.join(map(str, logs))))
            self.farewell = "\n".join(filter(None, said))
        return warm and ended

    @property
    def shows_splash(self) -> bool:
        """Is there nothing to be seen of a run yet?"""
        return self._splash

    # -- one picture --

    def tick(self) -> None:
        """Handle what has happened, draw if there is something new, wait for the next picture."""
        stage = self.stage
        if said := stage.panes.tick():  # before a hand that turns drops what is ready
            stage.toast(said)
        for event in pygame.event.get():
            self.handle(event)
        self.reader.tick(time.perf_counter())
        if not stage.running:
            return
        stage.mouse.send_move(stage.send)
        now = time.perf_counter()
        self.pages.explore.tick()
        snapshot = stage.panes.snapshot
        serials = stage.picture.serials
        if serials != self._serials:
            self._serials = serials
            stage.dirty = True
        stage.dirty |= stage.notices.tick(now)
        for part in stage.parts_now():
            stage.redraw(part.tick(now))
        if said := stage.recorder.tick(stage.renderer.surface, now):
            stage.toast(said)
        stage.dirty |= stage.recorder.second_passed(now)
        stage.tone.follow(snapshot.frame if stage.parts_now() else None, now)
        moving = self._splash or stage.picture.moving or stage.mouse.holding
        if stage.dirty or moving or now - self._drawn >= REST:
            self._draw(snapshot, now)
        self._show_cursor()
        self._clock.tick(FRAMES)

    def _draw(self, snapshot: Snapshot, now: float) -> None:
        stage, renderer = self.stage, self.stage.renderer
        stage.dirty = False
        self._drawn = now
        self._rate.renew(now, self._clock.get_fps())
        begun = time.perf_counter()
        preparing = snapshot.phase == "building" and snapshot.frame is None
        page = stage.show_menu or stage.show_explore
        self._splash = stage.splash = not self._warmup.ready or (preparing and not page)
        if not self._splash:
            self._background.begin()
        if self._splash:
            draw_splash(
                renderer.surface,
                renderer.theme,
                renderer.type,
                text=words.SPLASH_MENU
                if page
                else _sentence(words.say(snapshot.text) or words.SPLASH_STEP),
                fraction=snapshot.fraction,
                seconds=0.0 if stage.still else now - self._begun,
            )
        else:
            if not page:
                self._draw_run(snapshot, now)
            self.pages.draw()
        stage.screen.blit(renderer.surface, (0, 0))
        self._draw_indicator()
        pygame.display.flip()
        self._rate.drew(time.perf_counter() - begun)

    def _draw_run(self, snapshot: Snapshot, now: float) -> None:
        stage, renderer = self.stage, self.stage.renderer
        if snapshot.frame is None:
            renderer.clear()
        else:
            progress = "" if stage.panes.comparing else progress_of(snapshot)
            stage.picture.draw(
                hand=stage.mouse.hand,
                rate=self._rate.text,
                notices=stage.notices.lines(progress),
                now=now,
            )
            stage.sound.play(stage.picture.events)
        painter = renderer.painter()
        for part in stage.parts_now():
            part.draw(painter)
        self.question.draw_over(painter)
        painter.flush()
        if snapshot.phase == "failed":
            draw_error(renderer.painter(), words.say(snapshot.error))

    def _draw_indicator(self) -> None:
        """On the screen only, so that it is not in the film."""
        renderer = self.stage.renderer
        said = renderer.layout.said
        place = pygame.Rect(said.topleft, (renderer.end_of_words, said.height))
        self.stage.recorder.draw(self.stage.screen, place, renderer.theme, renderer.type)

    def _show_cursor(self) -> None:
        wanted = pygame.SYSTEM_CURSOR_ARROW
        if self.stage.show_explore:
            pass
        elif self.stage.show_menu and not self.stage.show_help:
            wanted = self.pages.menu.cursor()
        elif not self.stage.show_help:
            own = (part.cursor() for part in self.stage.parts_now())
            wanted = next((cursor for cursor in own if cursor is not None), wanted)
        if wanted != self._cursor:
            self._cursor = wanted
            with contextlib.suppress(pygame.error):  # not every screen has these cursors
                pygame.mouse.set_cursor(wanted)

    # -- what a person does --

    def handle(self, event: pygame.event.Event) -> None:
        """One event: for the parts, for a page, or a key that stands for an action."""
        stage = self.stage
        stage.focus.watch(event)
        self.reader.watch(event)
        if event.type == pygame.QUIT:
            stage.running = False
        elif event.type in (pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED):
            stage.screen = pygame.display.get_surface() or stage.screen
            stage.renderer.resize(stage.screen.get_size())
        elif event.type == pygame.KEYDOWN and action_of(event) is Action.FULLSCREEN:
            self._act(Action.FULLSCREEN)  # wherever the keyboard is
        elif event.type == pygame.KEYDOWN and action_of(event) is Action.BACK and self._waited_for:
            self._act(Action.BACK)  # one waits for that, whatever has the keyboard
        elif (
            any(part.handle(event) for part in stage.parts_now())
            or self.pages.handle(event)
            or self._typed_ahead(event)
        ):
            pass
        elif event.type == pygame.KEYDOWN:
            self._act(action_of(event))
        elif event.type in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            self._act(self.pages.mouse(event))
        elif event.type == pygame.WINDOWFOCUSLOST:
            stage.mouse.release(stage.send)
        elif event.type not in (pygame.WINDOWEXPOSED, pygame.WINDOWFOCUSGAINED):
            return
        stage.dirty = True

    def _typed_ahead(self, event: pygame.event.Event) -> bool:
        """What is written into a question before its scene is there to be seen is no key of the window's."""
        asking = self.guide.asking
        typing = event.type in (pygame.KEYDOWN, pygame.TEXTINPUT, pygame.TEXTEDITING)
        return typing and asking.on and not self._page_is_open and asking.handle(event)

    @property
    def _waited_for(self) -> bool:
        """Is something built that can be broken off, and is nothing over it?"""
        building = (progress_of(seen) and not seen.ending for seen in self.stage.panes.snapshots)
        return not self._page_is_open and any(building)

    @property
    def _page_is_open(self) -> bool:
        stage = self.stage
        return stage.show_menu or stage.show_help or stage.show_explore

    def _act(self, action: Action | None) -> None:
        if action is not None:
            self.actions.act(action)


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]

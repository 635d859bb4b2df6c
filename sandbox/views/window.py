"""The window: shows what the solver's thread publishes, and turns keys and mouse into commands."""

from __future__ import annotations

import io
import math
import os
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import pygame

from core.errors import InputError
from core.files import atomic_write
from sandbox.commands import Change, Command, Protocol, Reset
from sandbox.draw import words
from sandbox.draw.cards import MenuEntry, draw_error, draw_help
from sandbox.draw.render import Renderer
from sandbox.draw.splash import draw_splash
from sandbox.draw.warmup import Warmup
from sandbox.session import Session
from sandbox.views.solver_thread import Snapshot, SolverThread
from sandbox.views.window_hand import REACH, Mouse
from sandbox.views.window_keys import PACKING_ACTIONS, Action, action_of
from sandbox.views.window_menu import Menu
from scenes import registry

FRAMES = 60  # pictures a second, at most
REST = 0.25  # with nothing new the picture is drawn this seldom [s]
TOAST = 2.5  # how long the window's own notices stay [s]
SMALLEST = (480, 360)
SCALES = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0)
SLOW = 0.8  # fewer than this share of FRAMES is explained
NO_DISPLAY = "no display to open a window on; use `record SCENE --out FILE.mp4` to make a film"


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
) -> int:
    """Open the window and stay until it is closed. Without a scene it starts with the menu.

    ``scale`` None: by the screen's size. Raises InputError without a display and for a scene,
    packing or setting that does not exist.
    """
    app = App(packing, seed, size=size, scale=scale, theme=theme, log=log)
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
        app.close()
    return 0


class App:
    """The window and its state; ``tick`` is one picture."""

    def __init__(
        self,
        packing: str = "mixed",
        seed: int = 1,
        *,
        size: tuple[int, int] = (1280, 720),
        scale: float | None = None,
        theme: str = "dark",
        log: str | os.PathLike[str] | None = None,
    ) -> None:
        self.packing = packing
        self.seed = seed
        self.log = log
        self.running = True
        self.show_menu = False
        self.show_help = False
        self.mouse = Mouse()
        self.solver: SolverThread | None = None
        self._session: Session | None = None
        self._settings: Mapping[str, object] | None = None
        self._scene = ""
        self._theme = theme
        self._toasts: list[tuple[float, str]] = []
        self._hinted = False
        self._held_for_menu = False
        self._dirty = True
        self._drawn = 0.0
        self._drawing = 0.0  # how long a picture takes, smoothed [s]
        self._rate = ""
        self._rated = 0.0
        self._serial = -1
        self._cursor: int | None = None
        self._clock = pygame.time.Clock()
        self._begun = time.perf_counter()

        self.screen = open_display(size)
        self.renderer = Renderer(self.screen.get_size(), scale or natural_scale(), theme)
        scenes = [registry.get(name) for name in registry.names()]
        entries = [MenuEntry(s.name, s.title, s.question, s.about) for s in scenes]
        self.menu = Menu(entries, _packings(entries))
        self._warmup = Warmup()
        self._warmup.start()

    # -- running a scene --

    def start(self, scene: str, settings: Mapping[str, object] | None = None) -> None:
        """Leave what runs and run a scene. Raises InputError for one that does not exist."""
        session = Session(
            scene, self.packing, self.seed, None if settings is None else dict(settings)
        )
        self._leave()
        self._session, self._scene, self._settings = session, scene, settings
        self.solver = SolverThread(session)
        self.solver.start()
        self.renderer.forget()
        self.menu.choose(scene)
        self.show_menu = self.show_help = False
        self._dirty = True

    def _leave(self) -> None:
        if self.solver is not None:
            self.solver.stop(0.2)
        self.solver = None
        self.mouse = Mouse()

    def send(self, command: Command) -> None:
        """A command to the solver."""
        if self.solver is not None:
            self.solver.submit(command)
        self._dirty = True

    @property
    def snapshot(self) -> Snapshot:
        """What the solver's thread has published."""
        return Snapshot("stopped") if self.solver is None else self.solver.snapshot

    # -- one picture --

    def tick(self) -> None:
        """Handle what has happened, draw if there is something new, wait for the next picture."""
        for event in pygame.event.get():
            self.handle(event)
        if not self.running:
            return
        self.mouse.send_move(self.send)
        now = time.perf_counter()
        snapshot = self.snapshot
        if snapshot.serial != self._serial:
            self._serial = snapshot.serial
            self._dirty = True
        if self._toasts and self._toasts[0][0] < now:
            self._toasts = [toast for toast in self._toasts if toast[0] >= now]
            self._dirty = True
        if self._dirty or self._moving(snapshot) or now - self._drawn >= REST:
            self._draw(snapshot, now)
        self._show_cursor()
        self._clock.tick(FRAMES)

    def _moving(self, snapshot: Snapshot) -> bool:
        return not self._warmup.ready or snapshot.phase == "building" or self.mouse.holding

    def _draw(self, snapshot: Snapshot, now: float) -> None:
        self._dirty = False
        self._drawn = now
        self._rate_line(now)
        begun = time.perf_counter()
        frame = snapshot.frame
        if not self._warmup.ready or (snapshot.phase == "building" and frame is None):
            self._draw_splash(snapshot, now)
        elif self.show_menu:
            notice = self._toasts[-1][1] if self._toasts else ""
            self.menu.draw(self.renderer.painter(), self.packing, notice)
        else:
            if frame is None:
                painter = self.renderer.painter()
                painter.fill(painter.everything, self.renderer.theme.ground)
                painter.flush()
            else:
                self.renderer.draw(
                    frame,
                    hand=self.mouse.hand,
                    rate=self._rate,
                    paused=self.solver is not None and self.solver.paused,
                    notices=self._notices(snapshot),
                )
            if snapshot.phase == "failed":
                draw_error(self.renderer.painter(), snapshot.error)
            if self.show_help:
                draw_help(self.renderer.painter())
        self.screen.blit(self.renderer.surface, (0, 0))
        self._drawing += 0.1 * (time.perf_counter() - begun - self._drawing)
        pygame.display.flip()

    def _draw_splash(self, snapshot: Snapshot, now: float) -> None:
        draw_splash(
            self.renderer.surface,
            self.renderer.theme,
            self.renderer.type,
            text=_sentence(snapshot.text or words.SPLASH_STEP),
            fraction=snapshot.fraction,
            seconds=now - self._begun,
        )

    def _notices(self, snapshot: Snapshot) -> tuple[str, ...]:
        notices = [text for _, text in self._toasts]
        if snapshot.phase == "building":
            done = snapshot.fraction
            text = _sentence(snapshot.text or words.SPLASH_STEP)
            if math.isfinite(done):
                text = words.BUILDING.format(text=text, percent=100.0 * done)
            notices.append(text)
        elif not self._hinted and not notices:
            notices.append(words.HINT)
        return tuple(notices)

    def _rate_line(self, now: float) -> None:
        """Twice a second: how many pictures a second, and what holds them up."""
        if now - self._rated < 0.5:
            return
        self._rated = now
        rate, milliseconds = self._clock.get_fps(), 1e3 * self._drawing
        if rate >= SLOW * FRAMES or rate == 0.0:
            self._rate = words.RATE.format(fps=rate or FRAMES, ms=milliseconds)
            return
        slow_drawing = self._drawing > 0.5 / FRAMES
        reason = words.SLOW_DRAWING.format(ms=milliseconds) if slow_drawing else words.SLOW_MACHINE
        self._rate = words.RATE_SLOW.format(fps=rate, reason=reason)

    def _show_cursor(self) -> None:
        wanted = pygame.SYSTEM_CURSOR_ARROW
        if self.show_menu:
            if self.menu.hover_now:
                wanted = pygame.SYSTEM_CURSOR_HAND
        elif not self.show_help:
            wanted = self.mouse.cursor()
        if wanted != self._cursor:
            self._cursor = wanted
            pygame.mouse.set_cursor(wanted)

    # -- what a person does --

    def handle(self, event: pygame.event.Event) -> None:
        """One event."""
        if event.type == pygame.QUIT:
            self.running = False
        elif event.type in (pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED):
            self._resize()
        elif event.type == pygame.KEYDOWN:
            action = action_of(event)
            if action is not None:
                self._dirty = True
                self._act(action)
        elif event.type in (pygame.MOUSEMOTION, pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            self._dirty = True
            self._mouse(event)
        elif event.type == pygame.MOUSEWHEEL and self.show_menu:
            self._dirty = True
            self.menu.wheel(event.precise_y, round(60 * self.renderer.scale))
        elif event.type in (pygame.WINDOWEXPOSED, pygame.WINDOWFOCUSGAINED):
            self._dirty = True
        elif event.type == pygame.WINDOWFOCUSLOST:
            self.mouse.release(self.send)

    def _resize(self) -> None:
        self.screen = pygame.display.get_surface() or self.screen
        self.renderer.resize(self.screen.get_size())
        self._dirty = True

    def _mouse(self, event: pygame.event.Event) -> None:
        if self.show_menu:
            if event.type == pygame.MOUSEMOTION:
                self.menu.hover(event.pos)
            elif event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
                choice = self.menu.click(event.pos)
                self._choose(choice.scene, choice.packing)
            return
        if self.show_help:
            if event.type == pygame.MOUSEBUTTONDOWN:
                self.show_help = False
            return
        snapshot = self.snapshot
        frame, camera, canvas = snapshot.frame, self.renderer.camera, self.renderer.layout.canvas
        reach = REACH * self.renderer.scale
        if frame is None or snapshot.phase == "failed":
            self.mouse.forget()
            return
        if event.type == pygame.MOUSEMOTION:
            self.mouse.move(event.pos, camera, canvas)
            if not self.mouse.holding:
                self.mouse.look(event.pos, frame, camera, reach)
        elif event.button == 1 and event.type == pygame.MOUSEBUTTONDOWN:
            inside = canvas.collidepoint(event.pos)
            if inside and self.mouse.press(event.pos, frame, camera, reach, self.send):
                self._hinted = True
        elif event.button == 1:
            self.mouse.move(event.pos, camera, canvas)
            self.mouse.release(self.send)
            self.mouse.look(event.pos, frame, camera, reach)

    def _act(self, action: Action) -> None:
        if action is Action.SCREENSHOT:
            self._screenshot()
        elif action is Action.THEME:
            self._theme = "light" if self.renderer.theme.name == "dark" else "dark"
            self.renderer.set_theme(self._theme)
        elif action in (Action.LARGER, Action.SMALLER):
            self._rescale(1 if action is Action.LARGER else -1)
        elif self.show_menu:
            self._act_in_menu(action)
        elif action is Action.HELP:
            self.show_help = not self.show_help
        elif action is Action.BACK and self.show_help:
            self.show_help = False
        elif action in (Action.MENU, Action.BACK):
            self.open_menu()
        else:
            self._act_on_run(action)

    def _act_in_menu(self, action: Action) -> None:
        if action is Action.BACK:
            self.running = False
        elif action in (Action.MENU, Action.HELP):
            self._close_menu()
        elif action in PACKING_ACTIONS:
            self._choose(None, self._packing_number(PACKING_ACTIONS.index(action)))
        elif action is Action.NEXT_PACKING:
            self._choose(None, self._packing_after(self.packing))
        else:
            self._choose(self.menu.key(action).scene, None)

    def _act_on_run(self, action: Action) -> None:
        solver, snapshot = self.solver, self.snapshot
        if solver is None:
            return
        if snapshot.phase in ("failed", "stopped"):
            if action is Action.RESET:
                self.start(self._scene, self._settings)
            return
        frame = snapshot.frame
        if action is Action.PAUSE:
            solver.pause(not solver.paused)
        elif action in (Action.STEP, Action.RIGHT):
            solver.step()
        elif action is Action.RESET:
            self.mouse.forget()
            self.send(Reset())
        elif action is Action.CHAINS:
            self.renderer.chains = not self.renderer.chains
            self.toast(words.CHAINS_ON if self.renderer.chains else words.CHAINS_OFF)
        elif action is Action.PROTOCOL and frame is not None:
            self.mouse.release(self.send)
            self._hinted = True
            self.send(Protocol(not frame.protocol))
            self.toast(words.DRIVE_OFF if frame.protocol else words.DRIVE_ON)
        elif action is Action.NEW_SEED:
            self.seed += 1
            self._rebuild("seed", self.seed, words.NEW_SEED.format(seed=self.seed))
        elif action is Action.NEXT_PACKING:
            self._repack(self._packing_after(self.packing))
        elif action in PACKING_ACTIONS:
            self._repack(self._packing_number(PACKING_ACTIONS.index(action)))

    # -- what that leads to --

    def toast(self, text: str) -> None:
        """A notice of the window's own, for a moment."""
        self._toasts = [(time.perf_counter() + TOAST, text)]
        self._dirty = True

    def open_menu(self) -> None:
        """Show the scenes; what runs is held meanwhile."""
        self.mouse.release(self.send)
        self.show_menu, self.show_help = True, False
        if self.solver is not None and not self.solver.paused:
            self._held_for_menu = True
            self.solver.pause(True)
        self._dirty = True

    def _close_menu(self) -> None:
        if self.solver is None:
            return
        self.show_menu = False
        if self._held_for_menu:
            self.solver.pause(False)
        self._held_for_menu = False

    def _choose(self, scene: str | None, packing: str | None) -> None:
        if packing is not None:
            self.packing = packing
        if scene is not None:
            self._held_for_menu = False
            try:
                self.start(scene)
            except InputError as error:
                self.toast(str(error))

    def _packing_number(self, index: int) -> str:
        packings = self.menu.packings
        return packings[min(index, len(packings) - 1)]

    def _packing_after(self, packing: str) -> str:
        packings = self.menu.packings
        index = packings.index(packing) if packing in packings else -1
        return packings[(index + 1) % len(packings)]

    def _repack(self, packing: str) -> None:
        if packing != self.packing:
            self.packing = packing
            name = words.PACKINGS.get(packing, packing)
            self._rebuild("packing", packing, words.NEW_PACKING.format(packing=name))

    def _rebuild(self, name: str, value: str | int, notice: str) -> None:
        self.mouse.forget()
        self.renderer.forget()
        self.send(Change(name, value))
        self.toast(notice)

    def _rescale(self, way: int) -> None:
        nearest = min(range(len(SCALES)), key=lambda k: abs(SCALES[k] - self.renderer.scale))
        scale = SCALES[min(max(nearest + way, 0), len(SCALES) - 1)]
        self.renderer.resize(self.renderer.size, scale)

    def _screenshot(self) -> None:
        """The picture as it is shown, into the current folder, under a name that is still free."""
        stem = f"sandbox-{self._scene}" if self._scene and not self.show_menu else "sandbox"
        number = 1
        while (path := Path(f"{stem}-{number}.png")).exists():
            number += 1
        picture = io.BytesIO()
        pygame.image.save(self.renderer.surface, picture, "picture.png")
        try:
            with atomic_write(path) as file:
                file.write(picture.getvalue())
        except OSError as error:
            reason = error.strerror or str(error)
            self.toast(words.NOT_SAVED.format(name=path.name, reason=reason))
        else:
            self.toast(words.SAVED.format(name=path.name))

    def close(self) -> None:
        """End the solver, write the log, close the window."""
        self.running = False
        ended = True
        if self.solver is not None:
            self.mouse.release(self.send)
            ended = self.solver.stop()
        pygame.display.quit()
        if self.log is not None and self._session is not None and ended:
            self._session.write_log(os.fspath(self.log))


def open_display(size: tuple[int, int]) -> pygame.Surface:
    """A resizable window no larger than the screen. Raises InputError where there is no display."""
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform.startswith("linux") and not display and not os.environ.get("SDL_VIDEODRIVER"):
        raise InputError(NO_DISPLAY)
    # Pixels are pixels: no blurred enlargement on high-resolution screens.
    os.environ.setdefault("SDL_WINDOWS_DPI_AWARENESS", "permonitorv2")
    os.environ.setdefault("SDL_VIDEO_X11_WMCLASS", "auxetic-sandbox")
    try:
        pygame.display.init()
        desktop = pygame.display.get_desktop_sizes()[0]
        fitting = (
            max(min(size[0], desktop[0]), SMALLEST[0]),
            max(min(size[1], desktop[1]), SMALLEST[1]),
        )
        screen = pygame.display.set_mode(fitting, pygame.RESIZABLE)
    except (pygame.error, IndexError) as error:
        raise InputError(f"{NO_DISPLAY} ({error})") from None
    pygame.display.set_caption(words.SPLASH_TITLE)
    return screen


def natural_scale() -> float:
    """The UI scale that suits the screen: larger on one with many pixels."""
    sizes = pygame.display.get_desktop_sizes()
    height = sizes[0][1] if sizes else 1080
    return 2.0 if height >= 2000 else 1.5 if height >= 1400 else 1.0


def _packings(entries: list[MenuEntry]) -> tuple[str, ...]:
    """All packings that any scene knows, in their order."""
    found: dict[str, None] = {}
    for entry in entries:
        found.update(dict.fromkeys(registry.get(entry.name).packings))
    return tuple(found)


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]

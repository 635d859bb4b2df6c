"""A window under a driver that shows nothing, and a person at it who posts events."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pygame

from sandbox.window.app import App
from sandbox.window.display import Looks
from sandbox.window.solvers.panes import Panes
from tests.window.fake_session import FakeSession


class Desk:
    """A window, the sessions made for it, and a person at it."""

    def __init__(
        self, size: tuple[int, int] = (800, 600), scale: float = 1.0, log: Path | None = None
    ) -> None:
        self.sessions: list[FakeSession] = []
        self.app = App(Panes("mixed", 1, self._make, log=log), Looks(size, scale))

    def _make(self, *arguments: Any) -> Any:
        session = FakeSession(*arguments)
        self.sessions.append(session)
        return session

    @property
    def session(self) -> FakeSession:
        return self.sessions[-1]

    @property
    def seen(self) -> int:
        """Increments that the window has shown; a session may be ahead of that."""
        frame = self.app.stage.panes.snapshot.frame
        return 0 if frame is None else frame.increment

    def page(self) -> str:
        if not self.app.stage.running:
            return "closed"
        return "menu" if self.app.stage.show_menu else "help" if self.app.stage.show_help else "run"

    def paused(self) -> bool:
        return self.app.stage.panes.paused

    def start(self, scene: str = "intruder") -> None:
        self.app.stage.start(scene)
        self.until(lambda: not self.app._splash)

    def until(self, condition: Callable[[], bool], seconds: float = 60.0) -> None:
        patience = time.perf_counter() + seconds
        while not condition():
            assert time.perf_counter() < patience, f"in vain: {self._where()}"
            self.app.tick()

    def _where(self) -> str:
        """What a person would see: the page, how far each packing is, what was said last."""
        stage = self.app.stage
        runs = [
            (s.phase, s.text, s.error, s.frame and s.frame.increment) for s in stage.panes.snapshots
        ]
        return f"{self.page()}, {runs}, {list(stage.notices.said)[-3:]}"

    def post(self, kind: int, **more: Any) -> None:
        pygame.event.post(pygame.event.Event(kind, more))
        self.app.tick()

    def key(self, key: int, unicode: str = "", mod: int = 0) -> None:
        sign = unicode or (chr(key) if 32 <= key < 127 else "")
        self.post(pygame.KEYDOWN, key=key, unicode=sign, mod=mod)
        if sign and sign.isprintable() and not mod & (pygame.KMOD_CTRL | pygame.KMOD_META):
            self.post(pygame.TEXTINPUT, text=sign)
        self.post(pygame.KEYUP, key=key, mod=mod)

    def type(self, text: str) -> None:
        for sign in text:
            self.key(ord(sign) if ord(sign) < 127 else 0, sign)

    def click(self, place: tuple[float, float]) -> None:
        self.point(place)
        self.press(place)
        self.release(place)

    def point(self, place: tuple[float, float], pressed: bool = False) -> None:
        pos = (round(place[0]), round(place[1]))
        self.post(pygame.MOUSEMOTION, pos=pos, rel=(0, 0), buttons=(int(pressed), 0, 0))

    def press(self, place: tuple[float, float]) -> None:
        pos = (round(place[0]), round(place[1]))
        self.post(pygame.MOUSEBUTTONDOWN, pos=pos, button=1)

    def release(self, place: tuple[float, float]) -> None:
        pos = (round(place[0]), round(place[1]))
        self.post(pygame.MOUSEBUTTONUP, pos=pos, button=1)

    def handle_place(self) -> tuple[float, float]:
        frame = self.app.stage.panes.snapshot.frame
        assert frame is not None
        handle = frame.handles[0]
        return self.app.stage.renderer.camera.to_screen(handle.x, handle.y)
